"""Parameters with their sources, and what follows from them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from typing import Any

from lumped import GearPair, bodies, load_gear_pair, mesh_elements
from lumped.friction import LAWS
from lumped.schema.files import preset_names
from lumped.schema.pair import field_at, leaf_paths, stated_unit
from lumped.stiffness.foundation import body_twist
from validation.reporting.blocks import Badge, Cell, Content, Text, facts, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.reporting.sources import is_assumed, sources

Columns = dict[str, tuple[str, Callable[[str], Cell]]]


def write(results: Results) -> Content:
    """Write the chapter."""
    pair, g = results.pair, results.geometry
    values, stated = leaf_paths(pair), sources(pair)
    assumed = {path for path, source in stated.items() if is_assumed(source)}
    columns: Columns = {
        "field": ("field", lambda path: path),
        "value": ("value", lambda path: _shown(values[path])),
        "unit": ("unit", lambda path: _unit(path, values[path])),
        "source": ("source", lambda path: stated[path]),
        "assumed": ("", lambda path: Badge("warning", "assumed") if path in assumed else ""),
    }
    table = table_of(
        "parameters",
        f"Parameters of {pair.name}. {len(assumed)} of {len(stated)} values are assumed.",
        list(stated),
        columns,
        marked=lambda path: path in assumed,
    )
    b = bodies(pair)
    stiffness = mesh_elements(pair).stiffness
    derived = facts(
        "derived",
        ("contact_ratio", "contact ratio", g.contact_ratio),
        ("base_pitch", "base pitch", g.base_pitch, "m"),
        (
            "operating_pressure_angle",
            "operating pressure angle",
            math.degrees(g.operating_pressure_angle),
            "°",
        ),
        ("base_radius_pinion", "base radius, pinion", g.base_radius_pinion, "m"),
        ("base_radius_gear", "base radius, gear", g.base_radius_gear, "m"),
        *(
            (f"L_X{letter}", f"X to {letter}", getattr(g, f"L_X{letter}"), "m", note)
            for letter, note in (
                ("A", "start of contact"),
                ("B", "lowest point of single contact, pinion"),
                ("P", "pitch point"),
                ("C", "highest point of single contact, pinion"),
                ("D", "end of contact"),
                ("Y", "gear's tangent point"),
            )
        ),
        ("mesh_frequency", "mesh frequency", g.mesh_frequency, "Hz"),
        ("pitch_line_velocity", "pitch line velocity", g.pitch_line_velocity, "m/s"),
        ("static_load", "static load along the line of action", results.static_load, "N"),
        ("mass_pinion", "mass, pinion", b.mass_pinion, "kg"),
        ("mass_gear", "mass, gear", b.mass_gear, "kg"),
        ("inertia_pinion", "inertia, pinion", b.inertia_pinion, "kg m²"),
        ("inertia_gear", "inertia, gear", b.inertia_gear, "kg m²"),
        (
            "mean_mesh_stiffness",
            "mean mesh stiffness",
            stiffness.mean() * g.contact_ratio,
            "N/m",
            "of all pairs in contact, over a mesh cycle",
        ),
        *_twist(results),
    )
    reference, like = _reference(pair)
    own = [path for path in stated if path not in reference or reference[path] != values[path]]
    given = table_of(
        "given",
        f"The {len(own)} parameters that differ from {like} or add to it; "
        f"the evidence has all {len(stated)}.",
        own,
        columns,
        marked=lambda path: path in assumed,
    )
    key_parameters = facts(
        "key_parameters",
        ("teeth", "teeth", f"{pair.pinion.teeth} / {pair.gear.teeth}"),
        ("speed", "pinion speed", results.operating_rpm, "rpm"),
        ("torque", "pinion torque", pair.operating.pinion_torque, "N m"),
        ("mesh_frequency", "mesh frequency", g.mesh_frequency, "Hz"),
        ("contact_ratio", "contact ratio", g.contact_ratio),
        ("law", "friction law", LAWS[pair.friction.law].title),
    )
    front = (key_parameters, given) if own else (key_parameters, Text(f"All parameters are those of {like}."))
    return Content((*front, table, Text("What follows from the parameters:"), derived))


def _reference(pair: GearPair) -> tuple[dict[str, Any], str]:
    """Values that a reader can look up elsewhere, and where: the preset of this name, or the defaults."""
    if pair.name in preset_names():
        return leaf_paths(load_gear_pair(pair.name)), f"the preset {pair.name}"
    return {path: field_at(path).default for path in leaf_paths(pair)}, "the schema's defaults"


def _twist(results: Results) -> Iterator[tuple[str, str, float, str, str]]:
    """Torsional stiffness of the bored gear bodies, with what it is along the line of action."""
    g = results.geometry
    radii = (g.base_radius_pinion, g.base_radius_gear)
    for name, torsional, radius in zip(("pinion", "gear"), body_twist(results.pair), radii, strict=True):
        if math.isfinite(torsional):
            yield (
                f"body_twist_{name}",
                f"torsional stiffness from rim to bore, {name}",
                torsional,
                "N m/rad",
                f"{torsional / radius**2:.3g} N/m along the line of action; not in the mesh stiffness: it "
                "acts in series with the shaft, which the model has not",
            )


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


CHAPTER = Chapter("parameters", "Parameters", write, front=("key_parameters", "given"))
