"""Inputs of the pair with source and range, and what follows from them."""

from __future__ import annotations

import math
import re
from typing import Any

from lumped.path_of_contact import pair_stiffness
from lumped.schema.assumed import WORDS, State
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair, field_values, stated_unit
from validation.exchange.drawing_table import HEADINGS, drawing_rows
from validation.exchange.new_pair_file import reasons
from validation.prediction.inputs import read_values, source_of, uncertain_inputs
from validation.reporting.blocks import Badge, Cell, Content, Table, quantities, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    pair = results.given
    g = results.pair.geometry
    values = {path: v for path, v in field_values(pair).items() if path not in WORDS}
    spreads = {part.field: one.written for one in uncertain_inputs(pair) for part in one.parts}
    given, assumed = results.inputs
    read = read_values(pair, contact_lost=results.like.contact_lost)
    why = reasons(pair)
    unread = len(values) - len(read)
    table = table_of(
        "parameters",
        f"All values: {given} known, {assumed} assumed, {unread} that the chosen laws and models do not "
        "read.",
        list(values),
        {
            "field": ("field", lambda path: path),
            "value": ("value", lambda path: _shown(values[path])),
            "unit": ("unit", lambda path: _unit(path, values[path])),
            "source": ("source", lambda path: source_of(pair, path) or why.get(path, "none stated")),
            "range": ("range", lambda path: spreads.get(path, "")),
            "state": ("", lambda path: _state(pair, path) if path in read else "not read"),
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
        ("mean mesh stiffness", pair_stiffness(pair).mean() * g.contact_ratio, "N/m", pair.stiffness_words),
        ("effective mass", b.effective_mass, "kg", "of both gears on the line of action"),
    )
    gears = Table(
        "gears",
        "Both gears as their drawings state them: hold the table against the drawings.",
        {heading: heading for heading in HEADINGS},
        tuple(drawing_rows(pair)),
        "Thickness, span and dimension over balls are those of teeth as made: each gear has half of the "
        "thinning mesh.backlash.",
    )
    words = f"{assumed} of {given + assumed} values are assumed. {pair.stiffness_note}"
    return Content(words.rstrip(), (gears, derived, table))


def _state(pair: GearPair, path: str) -> Cell:
    state = pair.state(path)
    return Badge("warning", state.value) if state is State.ASSUMED else ""


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
