"""Inputs of the pair with source and range, and what follows from them."""

from __future__ import annotations

import math
import re
from typing import Any

from lumped.path_of_contact import pair_stiffness
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import leaf_paths, stated_unit
from validation.prediction.inputs import source_of, uncertain_inputs
from validation.reporting.blocks import Badge, Cell, Content, quantities, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    pair, g = results.pair, results.pair.geometry
    values = {path: v for path, v in leaf_paths(pair).items() if path not in ("name", "description")}
    spreads = {part.field: one.written for one in uncertain_inputs(pair) for part in one.parts}
    given, assumed, word = results.inputs
    table = table_of(
        "parameters",
        f"All values: {given} given, {assumed} {word}.",
        list(values),
        {
            "field": ("field", lambda path: path),
            "value": ("value", lambda path: _shown(values[path])),
            "unit": ("unit", lambda path: _unit(path, values[path])),
            "source": ("source", lambda path: source_of(pair, path) or "none stated"),
            "range": ("range", lambda path: spreads.get(path, "")),
            "state": (
                "",
                lambda path: (
                    Badge("warning", "assumed") if "assumed" in (source_of(pair, path) or "assumed") else ""
                ),
            ),
        },
    )
    b = bodies_of(pair)
    derived = quantities(
        "derived",
        "What follows from them.",
        ("contact ratio", g.contact_ratio, "1"),
        ("base pitch", g.base_pitch, "m"),
        ("operating pressure angle", math.degrees(g.operating_pressure_angle), "°"),
        ("path of contact, A to D", g.L_XD - g.L_XA, "m"),
        ("mesh frequency", g.mesh_frequency, "Hz"),
        ("pitch line velocity", g.pitch_line_velocity, "m/s"),
        ("mean mesh stiffness", pair_stiffness(pair).mean() * g.contact_ratio, "N/m", "all pairs in contact"),
        ("effective mass", b.effective_mass, "kg", "of both gears on the line of action"),
    )
    return Content(f"{assumed} of {given + assumed} values are {word}.", (derived, table))


def _shown(value: Any) -> Cell:
    return ", ".join(f"{v:g}" for v in value) if isinstance(value, list) else value


def _unit(path: str, value: Any) -> str:
    unit = stated_unit(path) or ""
    return "" if unit == "1" or isinstance(value, str) else unit_text(unit)


def unit_text(unit: str) -> str:
    """A unit of the parameter file as it is printed: ``kg*m**2`` as kg m²."""
    text = re.sub(
        r"\*\*(\d)", lambda power: power[1].translate(str.maketrans("123456789", "¹²³⁴⁵⁶⁷⁸⁹")), unit
    )
    return {"um": "µm", "deg": "°", "degC": "°C"}.get(text, text.replace("*", " "))


CHAPTER = Chapter("inputs", "Inputs", write, seconds=0.1)
