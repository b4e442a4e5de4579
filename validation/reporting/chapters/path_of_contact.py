"""Path of contact, friction laws and mesh stiffness."""

from __future__ import annotations

from lumped import mesh_cycle
from lumped.friction import LAWS
from validation.plots.path_of_contact import friction_laws_figure, path_figure
from validation.plots.stiffness import stiffness_figure
from validation.reporting.blocks import Block, Content, Picture, Quantity, Rows, Table, Text
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    pair, g, profile = results.pair, results.geometry, results.profile
    chosen = pair.friction.law
    rows: Rows = []
    marked: set[int] = set()
    for index, law in enumerate(profile["law"].to_numpy()):
        if str(law) == chosen:
            marked.add(index)
        mu = abs(profile["mu"].sel(law=law))
        rows.append(
            (
                str(profile["law_title"].sel(law=law).item()),
                float(profile["mean_mu"].sel(law=law)),
                float(mu.max()),
                str(law) == chosen,
            )
        )
    laws = Table(
        "friction_laws",
        "Friction coefficient along the path of contact by law.",
        {
            "law": "law",
            "mean_mu": "mean |µ| [-]",
            "largest_mu": "largest |µ| [-]",
            "used": "used in this report",
        },
        tuple(rows),
        frozenset(marked),
        note="Largest values are those at the sampled positions; law II is bounded at the pitch point by "
        f"friction.maximum = {pair.friction.maximum:g}.",
    )
    conditions = Table(
        "contact_conditions",
        "Contact conditions over the path of contact.",
        {"quantity": "quantity", "smallest": "smallest", "largest": "largest"},
        tuple(
            (
                str(profile[name].attrs["long_name"]),
                Quantity(float(profile[name].min()), str(profile[name].attrs["units"])),
                Quantity(float(profile[name].max()), str(profile[name].attrs["units"])),
            )
            for name in (
                "sliding_velocity",
                "entraining_velocity",
                "hertz_pressure",
                "film_thickness",
                "film_parameter",
            )
        ),
    )
    blocks: list[Block] = [
        Picture(
            "path_of_contact",
            "Velocities and film parameter over the path of contact at nominal speed. A to D: start of "
            "contact, lowest point of single contact, pitch point P, highest point of single contact, end "
            "of contact.",
            lambda: path_figure(g, profile),
        ),
        conditions,
        Picture(
            "friction_laws",
            "Friction coefficient of all laws over the path of contact, negative in approach. The law used "
            "is drawn strongest; law V follows the law of its lubrication regime and lies on top of it.",
            lambda: friction_laws_figure(g, profile, chosen),
        ),
        laws,
        Picture(
            "mesh_stiffness",
            "Stiffness of each tooth pair and of the mesh over one mesh cycle.",
            lambda: stiffness_figure(mesh_cycle(pair)),
        ),
    ]
    left_out = list(profile.attrs["left_out"])
    if left_out:
        blocks.append(Text("Laws that this pair does not allow:", tuple(left_out)))
    if chosen == "none":
        blocks.append(Text(f"The pair runs without friction ({LAWS['none'].title})."))
    return Content(tuple(blocks), data={"friction_laws": profile})


CHAPTER = Chapter("path_of_contact", "Path of contact", write, seconds=0.2)
