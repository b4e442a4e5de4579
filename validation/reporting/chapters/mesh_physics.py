"""Mesh physics: stiffness of the teeth, load sharing, static transmission error, tip relief."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from lumped import GearPair, Geometry
from lumped.quasi_static import OptimalRelief
from validation.plots.mesh import (
    energy_mesh_figure,
    harris_figure,
    load_sharing_figure,
    relief_figure,
    stiffness_components_figure,
)
from validation.reporting.blocks import Block, Content, Picture, Quantity, Table, Text, facts, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.mesh_physics import mesh_physics
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    results.stage("mesh physics")
    found = mesh_physics(results.pair, quick=not results.effort.full)
    blocks: list[Block] = [Text(_introduction(results.pair))]
    if found.components is not None:
        blocks += _components(results.geometry, found.components)
    if found.energy_mesh is not None:
        caption = "Potential-energy stiffness of the mesh over one mesh cycle, its mean, and the standard's."
        draw = partial(energy_mesh_figure, found.energy_mesh)
        blocks.append(Picture("energy_mesh_stiffness", caption, draw))
    if found.iso is not None:
        blocks += _against_iso(found.iso)
    if found.curves is not None:
        caption = (
            "Share of one tooth pair in the load over its position. Under load the teeth deflect and touch "
            "before A and behind D; relief lets them take up the load gradually."
        )
        draw = partial(load_sharing_figure, results.geometry, found.curves)
        blocks.append(Picture("load_sharing", caption, draw))
        if found.harris is not None:
            blocks += _harris(found.curves, found.harris, results.pair.operating.pinion_torque)
    if found.optimum is not None and found.relief is not None:
        blocks += _relief(found.optimum, found.relief)
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


def _components(g: Geometry, components: xr.Dataset) -> list[Block]:
    compliance = components["compliance"]
    places = {"A": 0, "P": int(np.argmin(np.abs(compliance["position"].to_numpy() - g.L_XP))), "D": -1}
    with np.errstate(divide="ignore"):  # a load across the tooth does not compress it
        stiffness = 1.0 / compliance.transpose("component", ...).to_numpy()
    rows = list(zip(map(str, compliance["component"].to_numpy()), stiffness, strict=True))
    rows.append(("pair", components["stiffness"].to_numpy()))
    return [
        Picture(
            "stiffness_components",
            "Left: compliance of the parts of one tooth pair by the potential-energy method, stacked. "
            "Right: stiffness of the pair, of each tooth with its body, and the standard's single "
            "stiffness.",
            partial(stiffness_components_figure, g, components),
        ),
        Table(
            "stiffness_components",
            "Stiffness of the parts of one tooth pair.",
            {"part": "part", **{f"at_{name}": f"at {name}" for name in places}},
            tuple((part, *(Quantity(float(k[i]), "N/m") for i in places.values())) for part, k in rows),
            frozenset({len(rows) - 1}),
            note=f"Error of the Gauss integration: {components.attrs['quadrature_error']:.0e}, relative.",
        ),
    ]


def _against_iso(iso: xr.Dataset) -> list[Block]:
    headings = {
        "variant": "assumption",
        "mean_ratio": "mean mesh stiffness, ratio",
        "single_ratio": "size: largest pair stiffness over c'",
        "shape_ratio": "shape over the path, ratio",
    }
    variants = [iso.sel(variant=name) for name in iso["variant"].to_numpy()]
    blocks: list[Block] = [
        Table(
            "energy_against_iso",
            "Potential-energy stiffness over that of ISO 6336-1, method B.",
            headings,
            tuple((str(v["variant"].item()), *(float(v[key]) for key in iso.data_vars)) for v in variants),
            frozenset({0}),
            note="The mean is size times shape. Rows below the first change one assumption. The "
            "standard's stiffness does not depend on the load between 100 and 1600 N/mm; a Hertzian "
            "contact does.",
        ),
        facts(
            "iso_6336",
            ("single", "ISO 6336-1 c' × face width", iso.attrs["iso_single"], "N/m"),
            ("mean", "ISO 6336-1 c_γ × face width", iso.attrs["iso_mean"], "N/m"),
        ),
    ]
    if iso.attrs["range_warnings"]:
        warnings = tuple(iso.attrs["range_warnings"])
        blocks.append(Text("Ranges that the two methods leave for this pair:", warnings))
    return blocks


def _harris(curves: xr.Dataset, harris: xr.Dataset, operating: float) -> list[Block]:
    torques = harris["torque"].to_numpy()
    return [
        Picture(
            "harris_map",
            "Static transmission error over two mesh cycles by torque (left), and its peak to peak over "
            "torque (right: Harris map).",
            partial(harris_figure, curves, harris),
        ),
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
            marked=lambda one: float(one["torque"]) == operating,
        ),
        table_of(
            "harris_minimum",
            "Torque of the least peak to peak in the Harris map.",
            [harris["peak_to_peak"].sel(flank=name) for name in harris["flank"].to_numpy()],
            {
                "flank": ("flanks", lambda row: str(row["flank"].item())),
                "torque": (
                    "torque of the least error",
                    lambda row: Quantity(float(torques[int(row.to_numpy().argmin())]), "N m"),
                ),
                "least": ("least peak to peak", lambda row: Quantity(float(row.min()), "m")),
            },
            note=f"Among {torques.size} torques from {torques[0]:.4g} to {torques[-1]:.4g} N m: between "
            "two of them it may be less, and a least at an end may lie beyond it.",
        ),
    ]


def _relief(best: OptimalRelief, relief: xr.Dataset) -> list[Block]:
    # What is rounding beside the peak to peak without relief is zero.
    vanishes = best.peak_to_peak < 1e-6 * best.unmodified
    note = "below a millionth of that without relief" if vanishes else ""
    start_pinion, start_gear = np.degrees([best.start_roll_angle_pinion, best.start_roll_angle_gear])
    return [
        Picture(
            "relief_map",
            "Peak to peak static transmission error at the operating torque over amount and length of "
            "linear tip relief on both gears; the dot is the optimum.",
            partial(relief_figure, relief, best),
        ),
        facts(
            "relief_optimum",
            ("amount", "best linear tip relief, amount", best.amount, "m", "both gears"),
            ("length", "its length along the line of action", best.length, "m"),
            ("start_pinion", "its start on the pinion", start_pinion, "°", "roll angle"),
            ("start_gear", "its start on the gear", start_gear, "°", "roll angle"),
            ("peak_to_peak", "peak to peak with it", 0.0 if vanishes else best.peak_to_peak, "m", note),
            ("unmodified", "peak to peak without relief", best.unmodified, "m"),
        ),
    ]


CHAPTER = Chapter("mesh_physics", "Mesh physics", write, seconds=2)
