"""Path of contact, friction laws and mesh stiffness."""

from __future__ import annotations

from lumped import mesh_cycle
from lumped.friction import LAWS
from validation.plots.mesh import friction_laws_figure, path_figure, stiffness_figure
from validation.reporting.blocks import Block, Content, Picture, Quantity, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    pair, g, profile = results.pair, results.geometry, results.profile
    chosen = pair.friction.law
    laws = table_of(
        "friction_laws",
        "Friction coefficient along the path of contact by law.",
        [profile.sel(law=law) for law in profile["law"].to_numpy()],
        {
            "law": ("law", lambda one: str(one["law_title"].item())),
            "mean_mu": ("mean |µ| [-]", lambda one: float(one["mean_mu"])),
            "largest_mu": ("largest |µ| [-]", lambda one: float(abs(one["mu"]).max())),
            "used": ("used in this report", lambda one: str(one["law"].item()) == chosen),
        },
        marked=lambda one: str(one["law"].item()) == chosen,
        note="Largest values are those at the sampled positions; law II is bounded at the pitch point by "
        f"friction.maximum = {pair.friction.maximum:g}.",
    )
    names = ("sliding_velocity", "entraining_velocity", "hertz_pressure", "film_thickness", "film_parameter")
    conditions = table_of(
        "contact_conditions",
        "Contact conditions over the path of contact.",
        [profile[name] for name in names],
        {
            "quantity": ("quantity", lambda one: str(one.attrs["long_name"])),
            "smallest": ("smallest", lambda one: Quantity(float(one.min()), str(one.attrs["units"]))),
            "largest": ("largest", lambda one: Quantity(float(one.max()), str(one.attrs["units"]))),
        },
    )
    blocks: list[Block] = [
        Picture(
            "path_of_contact",
            "Velocities and film parameter (central film thickness over composite roughness; shaded: the "
            "regimes of the pair's thresholds) over the path of contact at nominal speed. A to D: start of "
            "contact, lowest point of single contact, pitch point P, highest point of single contact, end "
            "of contact.",
            lambda: path_figure(g, profile, pair.friction.thresholds),
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
