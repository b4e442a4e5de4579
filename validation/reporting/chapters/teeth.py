"""Teeth that differ: effect on loads, orders and indicators, beside the twin with like teeth."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lumped.labelling import labelled_dataset
from validation.plots.teeth import loads_figure, sidebands_figure, turn_figure
from validation.reporting.blocks import (
    Block,
    Column,
    Content,
    NamedNumber,
    Picture,
    Table,
    Text,
    named_numbers,
    table_of,
)
from validation.reporting.chapter import Chapter
from validation.reporting.facts import sampled_words
from validation.reporting.results import Results
from validation.signals.averages import Gear
from validation.signals.findings import GEARS, NOISE, TeethFindings, deviations_table, rpm_and_period

#: Most turns of the pinion in the figure over time.
_MOST_TURNS = 4


def write(results: Results) -> Content | None:
    """Write the chapter. None: all teeth are alike."""
    findings = results.teeth
    if findings is None:
        return None
    blocks = (
        Text(f"At {rpm_and_period(findings)}. Contact: {findings.motion.attrs['touch']}."),
        _deviations_table(findings),
        _numbers_table(findings),
        _indicators_table(findings),
        *_spread(results),
        *_pictures(findings),
    )
    return Content(findings.sentence, blocks)


def _spread(results: Results) -> list[Block]:
    """Range of the results with the uncertain inputs; the teeth of a tolerance class are drawn anew."""
    if (band := results.teeth_band) is None:
        return []
    if band["sideband_ratio"].isnull().any():
        return [
            Text(f"{sampled_words('range of teeth that differ', band.attrs, results.effort.band_seconds)}.")
        ]
    swings, shares = (
        "{:.2g} to {:.2g}".format(*(factor * band[name].to_numpy()))
        for name, factor in (("revolution_dte_peak_to_peak", 1e6), ("sideband_ratio", 100.0))
    )
    text = "With the uncertain inputs, teeth of a class drawn anew, the transmission error of the linear form"
    return [Text(f"{text} is {swings} µm and the largest sideband {shares} % of the mesh tone (5 to 95 %).")]


def _deviations_table(findings: TeethFindings) -> Table:
    """Index deviations and eccentricity of both gears."""
    deviations = deviations_table(findings.pair)

    def length(name: str, heading: str) -> Column[Gear]:
        return Column(name, heading, lambda gear: float(deviations[name].sel(gear=gear)), "m")

    def tolerance_class(gear: Gear) -> int | str:
        number = int(deviations["tolerance_class"].sel(gear=gear))
        return number if number < 12 else "none"

    return table_of(
        "teeth_deviations",
        "Index deviations of the teeth, and the class of ISO 1328-1 that they keep.",
        GEARS,
        (
            Column[Gear]("gear", "gear", lambda gear: gear),
            length("cumulative", "range of the index deviations"),
            length("pitch", "largest step"),
            length("eccentricity", "eccentricity"),
            Column[Gear]("tolerance_class", "class of ISO 1328-1 that holds", tolerance_class),
        ),
    )


def _numbers_table(findings: TeethFindings) -> Table:
    """Numbers of the teeth as given; the note of each has the number of like teeth."""
    swing = findings.motion.attrs["dte_peak_to_peak"]
    twin_swing = findings.twin.attrs["dte_peak_to_peak"]
    load = findings.tooth_load(findings.motion)
    twin_load = findings.tooth_load(findings.twin)
    rate, twin_rate = findings.rates
    lost = float(len(findings.contact_lost))
    return named_numbers(
        "teeth_numbers",
        "Teeth as given, with the value of like teeth in the note.",
        (
            NamedNumber(
                "transmission error, peak to peak", swing, "m", f"like teeth: {1e6 * twin_swing:.3g} µm"
            ),
            NamedNumber("largest load on one tooth / mean", load, "1", f"like teeth: {twin_load:.3g}"),
            NamedNumber(
                "growth of a perturbation in a mesh cycle", rate, "1", f"like teeth: {twin_rate:.3g}"
            ),
            NamedNumber("meeting teeth at which contact is lost", lost, "1"),
        ),
    )


class _Indicator(NamedTuple):
    """A row of the table of indicators: shaft, name, value with the teeth as given and with like teeth."""

    shaft: Gear
    name: str
    pair: float
    twin: float


def _indicators_of(findings: TeethFindings, shaft: Gear) -> list[_Indicator]:
    """Condition indicators, averaged over the turns of one shaft."""
    indicators = findings.indicators(shaft)
    values = indicators["value"]
    return [
        _Indicator(
            shaft,
            str(name),
            float(values.sel(indicator=name, record="pair")),
            float(values.sel(indicator=name, record="healthy twin")),
        )
        for name in indicators["indicator"].to_numpy()
    ]


def _indicators_table(findings: TeethFindings) -> Table:
    return table_of(
        "teeth_indicators",
        "Condition indicators of the pinion's acceleration along the line of action, averaged over the turns "
        "of each shaft.",
        [row for gear in GEARS for row in _indicators_of(findings, gear)],
        (
            Column[_Indicator]("shaft", "shaft", lambda row: row.shaft),
            Column[_Indicator]("indicator", "indicator", lambda row: row.name),
            Column[_Indicator]("pair", "teeth as given", lambda row: row.pair),
            Column[_Indicator]("twin", "like teeth", lambda row: row.twin),
        ),
        f"With white noise of {100 * NOISE:.0f} % of the root mean square of like teeth. RMS in m/s².",
    )


def _pictures(findings: TeethFindings) -> list[Block]:
    """Transmission error over time, largest loads, and orders of each gear whose teeth differ."""
    motion = findings.motion
    twin = findings.twin
    pair = findings.pair
    count = motion.sizes["time"]
    turns = findings.period / pair.pinion.teeth
    samples = twin.sizes["time"]
    shown_count = min(count, _MOST_TURNS * pair.pinion.teeth * samples)
    turn = np.arange(count) * (findings.period / (pair.pinion.teeth * count))
    healthy = np.tile(twin["dte"].to_numpy(), findings.period)
    over_turn = labelled_dataset(
        {
            "dte": ("turn", motion["dte"].to_numpy()[:shown_count], "m", "transmission error"),
            "healthy": ("turn", healthy[:shown_count], "m", "transmission error of like teeth"),
        },
        {"turn": (turn[:shown_count], "1", "turns of the pinion")},
    )
    caption = f"Transmission error over {min(turns, _MOST_TURNS):g} of the {turns:g} turns of the period."
    pictures: list[Block] = [Picture("teeth_turn", caption, over_turn, turn_figure), *_loads(findings)]
    for gear in GEARS:
        if getattr(pair, gear).has_own_teeth:
            data = findings.spectrum(gear).assign_attrs(teeth=getattr(pair, gear).teeth)
            words = (
                f"Orders of the {gear}: the mesh harmonics and the sidebands beside them. Dots: like teeth."
            )
            pictures.append(Picture(f"teeth_orders_{gear}", words, data, sidebands_figure))
    return pictures


def _loads(findings: TeethFindings) -> list[Picture]:
    """Largest loads: a map of all meeting pairs over the hunting period, or the teeth of one gear.

    One gear is drawn where the motion repeats after a turn of the pinion or of the gear.
    """
    pair = findings.pair
    share = findings.largest_loads / findings.mean_force
    words = "largest load over the mean mesh force"
    teeth = {gear: np.arange(getattr(pair, gear).teeth) + 1 for gear in GEARS}
    if findings.period not in (pair.pinion.teeth, pair.gear.teeth):
        coordinates = {f"{gear}_tooth": (teeth[gear], "1", f"tooth of the {gear}") for gear in GEARS}
        data = labelled_dataset({"share": (tuple(coordinates), share, "1", words)}, coordinates)
        white = " White: these teeth never meet." if np.isnan(share).any() else ""
        caption = f"Largest load of each meeting pair over the mean mesh force.{white}"
        return [Picture("teeth_loads", caption, data, loads_figure)]
    pictures = []
    for axis, gear in enumerate(GEARS):
        if not getattr(pair, gear).has_own_teeth:
            continue
        data = labelled_dataset(
            {"share": ("tooth", np.nanmax(share, axis=1 - axis), "1", words)},
            {"tooth": (teeth[gear], "1", f"tooth of the {gear}")},
            {"shaft": gear, "healthy": findings.tooth_load(findings.twin)},
        )
        caption = f"Largest load of each tooth of the {gear} over the mean mesh force."
        pictures.append(Picture(f"teeth_loads_{gear}", caption, data, loads_figure))
    return pictures


CHAPTER = Chapter("teeth", "Teeth that differ", write, seconds=4.0)
