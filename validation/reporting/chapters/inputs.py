"""Inputs of the pair with source and range, and the quantities that follow from the inputs."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from lumped.schema.assumed import WORDS, State
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair, field_values, stated_unit
from validation.exchange.drawing_table import HEADINGS, drawing_rows
from validation.exchange.new_pair_file import reasons
from validation.prediction.inputs import read_values, source_of, uncertain_inputs
from validation.prediction.static import mean_mesh_stiffness
from validation.reporting.blocks import (
    Badge,
    Cell,
    Column,
    Content,
    NamedNumber,
    Table,
    named_numbers,
    table_of,
)
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    pair = results.given
    known_count, assumed = results.inputs
    words = f"{assumed} of {known_count + assumed} values are assumed. {pair.stiffness_note}"
    return Content(words.rstrip(), (_gears_table(pair), _derived_table(results), _parameters_table(results)))


def _parameters_table(results: Results) -> Table:
    """Every field of the parameter file with source, range and state."""
    pair = results.given
    values = {path: value for path, value in field_values(pair).items() if path not in WORDS}
    ranges = {
        part.field: uncertain.range_of(part)
        for uncertain in uncertain_inputs(pair)
        for part in uncertain.parts
    }
    known_count, assumed = results.inputs
    read = read_values(pair, contact_lost=results.backlash_counts)
    reason_of = reasons(pair)
    unread = len(values) - len(read)
    return table_of(
        "parameters",
        f"All values: {known_count} known, {assumed} assumed, {unread} that the chosen laws and models do "
        "not read.",
        list(values),
        (
            Column[str]("field", "field", lambda path: path),
            Column[str]("value", "value", lambda path: _shown(values[path])),
            Column[str]("unit", "unit", lambda path: _unit(path, values[path])),
            Column[str](
                "source", "source", lambda path: source_of(pair, path) or reason_of.get(path, "none stated")
            ),
            Column[str]("range", "range", lambda path: ranges.get(path, "")),
            Column[str]("state", "", lambda path: _state(pair, path) if path in read else "not read"),
        ),
    )


def _derived_table(results: Results) -> Table:
    """Quantities that follow from the parameter file."""
    pair = results.given
    g = results.pair.geometry
    angle = math.degrees(g.operating_pressure_angle)
    stiffness = mean_mesh_stiffness(pair)
    mass = bodies_of(pair).effective_mass
    return named_numbers(
        "derived",
        "What follows from them.",
        (
            NamedNumber("contact ratio", g.contact_ratio, "1"),
            NamedNumber("base pitch", g.base_pitch, "m"),
            NamedNumber("operating pressure angle", angle, "°"),
            NamedNumber("path of contact, A to D", g.L_XD - g.L_XA, "m"),
            NamedNumber("mesh frequency", g.mesh_frequency, "Hz"),
            NamedNumber("pitch line velocity", g.pitch_line_velocity, "m/s"),
            NamedNumber("mean mesh stiffness", stiffness, "N/m", pair.stiffness_words),
            NamedNumber("effective mass", mass, "kg", "of both gears on the line of action"),
        ),
    )


def _gears_table(pair: GearPair) -> Table:
    """Both gears as in their drawings. ``spurcheck init`` prints the same table."""

    def column(heading: str) -> Column[Mapping[str, str]]:
        return Column(heading, heading, lambda row: row[heading])

    return table_of(
        "gears",
        "Both gears as their drawings state them: hold the table against the drawings.",
        [dict(zip(HEADINGS, row, strict=True)) for row in drawing_rows(pair)],
        [column(heading) for heading in HEADINGS],
        "Thickness, span and dimension over balls are those of teeth as made: each gear has half of the "
        "thinning mesh.backlash.",
    )


def _state(pair: GearPair, path: str) -> Cell:
    state = pair.state(path)
    return Badge("warning", state.value) if state is State.ASSUMED else ""


def _shown(value: Any) -> Cell:
    return ", ".join(f"{v:g}" for v in value) if isinstance(value, list) else value


def _unit(path: str, value: Any) -> str:
    unit = stated_unit(path) or ""
    return "" if unit == "1" or isinstance(value, str) else unit_text(unit)


def unit_text(unit: str) -> str:
    """Return a unit of the parameter file as the page prints the unit: ``kg*m**2`` as kg m²."""
    text = re.sub(
        r"\*\*(\d)", lambda power: power[1].translate(str.maketrans("123456789", "¹²³⁴⁵⁶⁷⁸⁹")), unit
    )
    return {"um": "µm", "deg": "°", "degC": "°C"}.get(text, text.replace("*", " "))


CHAPTER = Chapter("inputs", "Inputs", write, seconds=0.1, needs_motion=False)
