"""Mesh physics: stiffness of the teeth, load sharing, static transmission error, tip relief."""

from __future__ import annotations

import numpy as np

from lumped import GearPair
from lumped.quasi_static import OptimalRelief
from validation.plots.loaded_mesh import harris_figure, load_sharing_figure, relief_figure
from validation.plots.stiffness import energy_mesh_figure, stiffness_components_figure
from validation.reporting.blocks import (
    Block,
    Content,
    Fact,
    Facts,
    Picture,
    Quantity,
    Rows,
    Table,
    Text,
    table_of,
)
from validation.reporting.chapter import Chapter
from validation.reporting.mesh_physics import MeshPhysics, mesh_physics
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    results.stage("mesh physics")
    found = mesh_physics(results.pair, quick=not results.effort.full)
    blocks: list[Block] = [
        Text(_introduction(results.pair)),
        *_stiffness(results, found),
        *_loaded_mesh(results, found),
    ]
    if found.refused:
        blocks.append(Text("Not computed for this pair:", found.refused))
    data = {
        "stiffness_components": found.components,
        "static_transmission_error": found.curves,
        "harris_map": found.harris,
        "relief_map": found.relief,
    }
    return Content(tuple(blocks), data={name: one for name, one in data.items() if one is not None})


def _introduction(pair: GearPair) -> str:
    model = pair.mesh.stiffness.model
    text = f"The loaded mesh without vibration, with the stiffness model of this report, “{model}”"
    text += "." if model == "energy" else ", and the potential-energy stiffness of the same teeth beside it."
    reliefs = (gear.tip_relief or gear.root_relief for gear in (pair.pinion, pair.gear))
    if pair.mesh.relief == "ignored" and any(reliefs):
        text += (
            " Tip and root relief enter here; the dynamic chapters take perfect involutes (mesh.relief = "
            "ignored)."
        )
    return text


def _stiffness(results: Results, found: MeshPhysics) -> list[Block]:
    g, components, iso, energy_mesh = results.geometry, found.components, found.iso, found.energy_mesh
    blocks: list[Block] = []
    if components is not None:
        compliance = components["compliance"]
        places = {"A": 0, "P": int(np.argmin(np.abs(compliance["position"].to_numpy() - g.L_XP))), "D": -1}
        blocks.append(
            Picture(
                "stiffness_components",
                "Left: compliance of the parts of one tooth pair by the potential-energy method, stacked. "
                "Right: stiffness of the pair, of each tooth with its body, and the standard's single "
                "stiffness.",
                lambda: stiffness_components_figure(g, components),
            )
        )
        rows: Rows = []
        for part in compliance["component"].to_numpy():
            values = compliance.sel(component=part).to_numpy()
            with np.errstate(divide="ignore"):  # a load across the tooth does not compress it
                stiffness = 1.0 / values
            rows.append((str(part), *(Quantity(float(stiffness[i]), "N/m") for i in places.values())))
        total = components["stiffness"].to_numpy()
        rows.append(("pair", *(Quantity(float(total[i]), "N/m") for i in places.values())))
        blocks.append(
            Table(
                "stiffness_components",
                "Stiffness of the parts of one tooth pair.",
                {"part": "part", **{f"at_{name}": f"at {name}" for name in places}},
                tuple(rows),
                frozenset({len(rows) - 1}),
                note=f"Error of the Gauss integration: {components.attrs['quadrature_error']:.0e}, relative.",
            )
        )
    if energy_mesh is not None:
        blocks.append(
            Picture(
                "energy_mesh_stiffness",
                "Potential-energy stiffness of the mesh over one mesh cycle, its mean, and the standard's.",
                lambda: energy_mesh_figure(energy_mesh),
            )
        )
    if iso is not None:
        blocks.append(
            Table(
                "energy_against_iso",
                "Potential-energy stiffness over that of ISO 6336-1, method B.",
                {
                    "variant": "assumption",
                    "mean_ratio": "mean mesh stiffness, ratio",
                    "single_ratio": "size: largest pair stiffness over c'",
                    "shape_ratio": "shape over the path, ratio",
                },
                tuple(
                    (str(name), *(float(iso[key].sel(variant=name)) for key in iso.data_vars))
                    for name in iso["variant"].to_numpy()
                ),
                frozenset({0}),
                note="The mean is size times shape. Rows below the first change one assumption. The "
                "standard's stiffness does not depend on the load between 100 and 1600 N/mm; a Hertzian "
                "contact does.",
            )
        )
        blocks.append(
            Facts(
                "iso_6336",
                (
                    Fact("single", "ISO 6336-1 c' × face width", Quantity(iso.attrs["iso_single"], "N/m")),
                    Fact("mean", "ISO 6336-1 c_γ × face width", Quantity(iso.attrs["iso_mean"], "N/m")),
                ),
            )
        )
        if iso.attrs["range_warnings"]:
            blocks.append(
                Text("Ranges that the two methods leave for this pair:", tuple(iso.attrs["range_warnings"]))
            )
    return blocks


def _loaded_mesh(results: Results, found: MeshPhysics) -> list[Block]:
    g, curves, harris = results.geometry, found.curves, found.harris
    blocks: list[Block] = []
    if curves is not None:
        blocks.append(
            Picture(
                "load_sharing",
                "Share of one tooth pair in the load over its position. Under load the teeth deflect and "
                "touch before A and behind D; relief lets them take up the load gradually.",
                lambda: load_sharing_figure(g, curves),
            )
        )
    if curves is not None and harris is not None:
        torques = harris["torque"].to_numpy()
        blocks.append(
            Picture(
                "harris_map",
                "Static transmission error over two mesh cycles by torque (left), and its peak to peak over "
                "torque (right: Harris map).",
                lambda: harris_figure(curves, harris),
            )
        )
        blocks.append(
            table_of(
                "static_transmission_error",
                "Static transmission error by torque.",
                [curves.isel(torque=i) for i in range(curves.sizes["torque"])],
                {
                    "torque": ("pinion torque", lambda one: Quantity(float(one["torque"]), "N m")),
                    "mean": ("mean", lambda one: Quantity(float(one["transmission_error"].mean()), "m")),
                    "peak_to_peak": ("peak to peak", lambda one: Quantity(float(one["peak_to_peak"]), "m")),
                    "contact_ratio": ("mean number of loaded pairs", lambda one: float(one["contact_ratio"])),
                },
                marked=lambda one: float(one["torque"]) == results.pair.operating.pinion_torque,
            )
        )
        blocks.append(
            Table(
                "harris_minimum",
                "Torque of the least peak to peak in the Harris map.",
                {
                    "flank": "flanks",
                    "torque": "torque of the least error",
                    "least": "least peak to peak",
                },
                tuple(
                    (
                        str(name),
                        Quantity(float(torques[int(np.argmin(row))]), "N m"),
                        Quantity(float(row.min()), "m"),
                    )
                    for name, row in zip(
                        harris["flank"].to_numpy(), harris["peak_to_peak"].to_numpy(), strict=True
                    )
                ),
                note=f"Among {torques.size} torques from {torques[0]:.4g} to {torques[-1]:.4g} N m: between "
                "two of them it may be less, and a least at an end may lie beyond it.",
            )
        )
    best, relief = found.optimum, found.relief
    if best is not None and relief is not None:
        blocks.append(
            Picture(
                "relief_map",
                "Peak to peak static transmission error at the operating torque over amount and length of "
                "linear tip relief on both gears; the dot is the optimum.",
                lambda: relief_figure(relief, best),
            )
        )
        blocks.append(
            Facts(
                "relief_optimum",
                (
                    Fact(
                        "amount", "best linear tip relief, amount", Quantity(best.amount, "m"), "both gears"
                    ),
                    Fact("length", "its length along the line of action", Quantity(best.length, "m")),
                    Fact(
                        "start_pinion",
                        "its start on the pinion",
                        Quantity(float(np.degrees(best.start_roll_angle_pinion)), "°"),
                        "roll angle",
                    ),
                    Fact(
                        "start_gear",
                        "its start on the gear",
                        Quantity(float(np.degrees(best.start_roll_angle_gear)), "°"),
                        "roll angle",
                    ),
                    Fact("peak_to_peak", "peak to peak with it", *_remaining(best)),
                    Fact("unmodified", "peak to peak without relief", Quantity(best.unmodified, "m")),
                ),
            )
        )
    return blocks


def _remaining(best: OptimalRelief) -> tuple[Quantity, str]:
    """Peak to peak with the best relief: what is rounding beside that without relief is zero."""
    if best.peak_to_peak < 1e-6 * best.unmodified:
        return Quantity(0.0, "m"), "below a millionth of that without relief"
    return Quantity(best.peak_to_peak, "m"), ""


CHAPTER = Chapter("mesh_physics", "Mesh physics", write, seconds=2)
