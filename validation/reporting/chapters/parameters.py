"""Parameters with their sources, and what follows from them."""

from __future__ import annotations

import math
import re
from typing import Any

from lumped import bodies, mesh_elements
from lumped.schema.files import leaf_paths
from lumped.schema.pair import stated_unit
from validation.reporting.blocks import Badge, Cell, Content, Fact, Facts, Quantity, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.reporting.sources import is_assumed, sources


def write(results: Results) -> Content:
    """Write the chapter."""
    pair, g = results.pair, results.geometry
    values, stated = leaf_paths(pair), sources(pair)
    assumed = {path for path, source in stated.items() if is_assumed(source)}
    table = table_of(
        "parameters",
        f"Parameters of {pair.name}. {len(assumed)} of {len(stated)} values are assumed.",
        list(stated),
        {
            "field": ("field", lambda path: path),
            "value": ("value", lambda path: _shown(values[path])),
            "unit": ("unit", lambda path: _unit(path, values[path])),
            "source": ("source", lambda path: stated[path]),
            "assumed": ("", lambda path: Badge("warning", "assumed") if path in assumed else ""),
        },
        marked=lambda path: path in assumed,
    )
    b = bodies(pair)
    stiffness = mesh_elements(pair).stiffness
    derived = Facts(
        "derived",
        (
            Fact("contact_ratio", "contact ratio", g.contact_ratio),
            Fact("base_pitch", "base pitch", Quantity(g.base_pitch, "m")),
            Fact(
                "operating_pressure_angle",
                "operating pressure angle",
                Quantity(math.degrees(g.operating_pressure_angle), "°"),
            ),
            Fact("base_radius_pinion", "base radius, pinion", Quantity(g.base_radius_pinion, "m")),
            Fact("base_radius_gear", "base radius, gear", Quantity(g.base_radius_gear, "m")),
            *(
                Fact(f"L_X{letter}", f"X to {letter}", Quantity(getattr(g, f"L_X{letter}"), "m"), note)
                for letter, note in (
                    ("A", "start of contact"),
                    ("B", "lowest point of single contact, pinion"),
                    ("P", "pitch point"),
                    ("C", "highest point of single contact, pinion"),
                    ("D", "end of contact"),
                    ("Y", "gear's tangent point"),
                )
            ),
            Fact("mesh_frequency", "mesh frequency", Quantity(g.mesh_frequency, "Hz")),
            Fact("pitch_line_velocity", "pitch line velocity", Quantity(g.pitch_line_velocity, "m/s")),
            Fact("static_load", "static load along the line of action", Quantity(results.static_load, "N")),
            Fact("mass_pinion", "mass, pinion", Quantity(b.mass_pinion, "kg")),
            Fact("mass_gear", "mass, gear", Quantity(b.mass_gear, "kg")),
            Fact("inertia_pinion", "inertia, pinion", Quantity(b.inertia_pinion, "kg m²")),
            Fact("inertia_gear", "inertia, gear", Quantity(b.inertia_gear, "kg m²")),
            Fact(
                "mean_mesh_stiffness",
                "mean mesh stiffness",
                Quantity(stiffness.mean() * g.contact_ratio, "N/m"),
                "of all pairs in contact, over a mesh cycle",
            ),
        ),
    )
    return Content((table, Text("What follows from the parameters:"), derived))


def _shown(value: Any) -> Cell:
    return ", ".join(f"{v:g}" for v in value) if isinstance(value, list) else value


def _unit(path: str, value: Any) -> str:
    unit = stated_unit(path) or ""
    return "" if unit == "1" or isinstance(value, str) else unit_text(unit)


_EXPONENTS = str.maketrans("123456789", "¹²³⁴⁵⁶⁷⁸⁹")


def unit_text(unit: str) -> str:
    """A unit of the parameter file as it is printed: ``kg*m**2`` as kg m²."""
    text = re.sub(r"\*\*(\d)", lambda power: power[1].translate(_EXPONENTS), unit).replace("*", " ")
    return {"um": "µm", "deg": "°", "degC": "°C"}.get(text, text)


CHAPTER = Chapter("parameters", "Parameters", write)
