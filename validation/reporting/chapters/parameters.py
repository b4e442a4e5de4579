"""Parameters with their sources, and what follows from them."""

from __future__ import annotations

import math
import re
from functools import cache

from lumped import GearPair, bodies, load_gear_pair, mesh_elements
from lumped.schema.files import leaf_paths, preset_names
from lumped.schema.pair import stated_unit
from validation.reporting.blocks import Badge, Chapter, Fact, Facts, Quantity, Rows, Table, Text
from validation.reporting.results import Results

#: Source of a value that the parameter file leaves to the schema.
DEFAULT = "default of the schema"


def parameters(results: Results) -> Chapter:
    """Write the chapter."""
    pair, g = results.pair, results.geometry
    rows: Rows = []
    assumed: set[int] = set()
    for path, value in leaf_paths(pair).items():
        if path in ("name", "description"):
            continue
        source = source_of(pair, path)
        if is_assumed(source):
            assumed.add(len(rows))
        unit = stated_unit(path) or ""
        shown = ", ".join(f"{v:g}" for v in value) if isinstance(value, list) else value
        flag = Badge("warning", "assumed") if is_assumed(source) else ""
        worded = unit == "1" or isinstance(value, str)
        rows.append((path, shown, "" if worded else unit_text(unit), source, flag))
    table = Table(
        "parameters",
        f"Parameters of {pair.name}. {len(assumed)} of {len(rows)} values are assumed.",
        {
            "field": "field",
            "value": "value",
            "unit": "unit",
            "source": "source",
            "assumed": "",
        },
        tuple(rows),
        frozenset(assumed),
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
    return Chapter("parameters", "Parameters", (table, Text("What follows from the parameters:"), derived))


_EXPONENTS = str.maketrans("123456789", "¹²³⁴⁵⁶⁷⁸⁹")


def unit_text(unit: str) -> str:
    """A unit of the parameter file as it is printed: ``kg*m**2`` as kg m²."""
    text = re.sub(r"\*\*(\d)", lambda power: power[1].translate(_EXPONENTS), unit).replace("*", " ")
    return {"um": "µm", "deg": "°", "degC": "°C"}.get(text, text)


def source_of(pair: GearPair, path: str) -> str:
    """Where the value of a field comes from: the source of the longest prefix of its path that has one.

    A file that began as a preset may still give the preset's source for a value changed since: that value is
    assumed, for all the file says.
    """
    source = _stated(pair, path)
    presets = [preset for preset in _presets() if _stated(preset, path) == source]
    value = leaf_paths(pair).get(path)
    if is_assumed(source) or not presets or any(leaf_paths(p).get(path) == value for p in presets):
        return source
    return f"assumed; the source in the file is that of {presets[0].name} for another value"


def _stated(pair: GearPair, path: str) -> str:
    sources = dict(pair.sources)
    parts = path.split(".")
    prefixes = (".".join(parts[:length]) for length in range(len(parts), 0, -1))
    return next((sources[prefix] for prefix in prefixes if prefix in sources), DEFAULT)


@cache
def _presets() -> tuple[GearPair, ...]:
    return tuple(map(load_gear_pair, preset_names()))


def is_assumed(source: str) -> bool:
    """Whether a source says that nobody measured or published the value for this pair."""
    return "assumed" in source.lower() or source == DEFAULT
