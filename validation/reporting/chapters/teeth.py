"""Teeth that differ: what they do to loads, orders and indicators, beside the twin with like teeth."""

from __future__ import annotations

import numpy as np

from lumped.labelling import labelled_dataset
from validation.plots.teeth import loads_figure, sidebands_figure, turn_figure
from validation.reporting.blocks import Block, Content, Picture, Quantity, Table, Text, quantities
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.signals.findings import GEARS, NOISE, TeethFindings, deviations_table, rpm_and_period

#: Turns of the pinion that the figure over time shows.
_MOST_TURNS = 4


def write(results: Results) -> Content | None:
    """Write the chapter; None where all teeth are alike."""
    found = results.teeth
    return None if found is None else Content(found.sentence, (*_tables(found), *_pictures(found)))


def _tables(found: TeethFindings) -> list[Block]:
    given = deviations_table(found.pair)
    rows = tuple(
        (
            gear,
            Quantity(float(given["cumulative"][number]), "m"),
            Quantity(float(given["pitch"][number]), "m"),
            Quantity(float(given["eccentricity"][number]), "m"),
            int(given["tolerance_class"][number]) if given["tolerance_class"][number] < 12 else "none",
        )
        for number, gear in enumerate(GEARS)
    )
    columns = {
        "gear": "gear",
        "cumulative": "range of the index deviations",
        "pitch": "largest step",
        "eccentricity": "eccentricity",
        "tolerance_class": "class of ISO 1328-1 that holds",
    }
    force, motion, twin, peak = found.static_force, found.motion, found.twin, "dte_peak_to_peak"
    numbers = quantities(
        "teeth_numbers",
        "Teeth as given, with the value of like teeth in the note.",
        *(
            (words, value, unit, f"like teeth: {healthy:.3g}{'' if unit == '1' else ' um'}")
            for words, value, unit, healthy in (
                ("transmission error, peak to peak", motion.attrs[peak], "m", 1e6 * twin.attrs[peak]),
                (
                    "largest load on one tooth / mean",
                    *(found.load(motion) / force, "1", found.load(twin) / force),
                ),
                ("growth of a perturbation in a mesh cycle", found.rates[0], "1", found.rates[1]),
            )
        ),
        ("meeting teeth at which contact is lost", float(len(found.contact_lost)), "1"),
    )
    return [
        Text(f"The motion at {rpm_and_period(found)}. Contact: {motion.attrs['touch']}."),
        Table(
            "teeth_deviations",
            "Index deviations of the teeth, and the class of ISO 1328-1 that they keep.",
            columns,
            rows,
        ),
        numbers,
        _indicators(found),
    ]


def _indicators(found: TeethFindings) -> Table:
    rows = []
    for gear in GEARS:
        table = found.indicators(gear)
        for name in table["indicator"].to_numpy():
            pair, twin = (
                float(table["value"].sel(indicator=name, record=r)) for r in ("pair", "healthy twin")
            )
            rows.append((gear, str(name), pair, twin))
    return Table(
        "teeth_indicators",
        "Condition indicators of the pinion's acceleration along the line of action, averaged over the turns "
        "of each shaft.",
        {"shaft": "shaft", "indicator": "indicator", "pair": "teeth as given", "twin": "like teeth"},
        tuple(rows),
        f"With white noise of {100 * NOISE:.0f} % of the root mean square of like teeth. RMS in m/s².",
    )


def _pictures(found: TeethFindings) -> list[Block]:
    motion, twin, pair = found.motion, found.twin, found.pair
    count = motion.sizes["time"]
    turns, samples = found.period / pair.pinion.teeth, twin.sizes["time"]
    shown_count = min(count, _MOST_TURNS * pair.pinion.teeth * samples)
    turn = np.arange(count) * (found.period / (pair.pinion.teeth * count))
    healthy = np.tile(twin["dte"].to_numpy(), found.period)
    over_turn = labelled_dataset(
        {
            "dte": ("turn", motion["dte"].to_numpy()[:shown_count], "m", "transmission error"),
            "healthy": ("turn", healthy[:shown_count], "m", "transmission error of like teeth"),
        },
        {"turn": (turn[:shown_count], "1", "turns of the pinion")},
    )
    caption = f"Transmission error over {min(turns, _MOST_TURNS):g} of the {turns:g} turns of the period."
    shown: list[Block] = [Picture("teeth_turn", caption, over_turn, turn_figure), *_loads(found)]
    for gear in GEARS:
        if getattr(pair, gear).has_own_teeth:
            data = found.spectrum(gear).assign_attrs(teeth=getattr(pair, gear).teeth)
            words = (
                f"Orders of the {gear}: the mesh harmonics and the sidebands beside them. Dots: like teeth."
            )
            shown.append(Picture(f"teeth_orders_{gear}", words, data, sidebands_figure))
    return shown


def _loads(found: TeethFindings) -> list[Picture]:
    """Map of all meeting pairs over the hunting period; else the teeth of the gear whose teeth differ."""
    pair, share = found.pair, found.largest_loads / found.static_force
    words = "largest load over the mean mesh force"
    teeth = {gear: np.arange(getattr(pair, gear).teeth) + 1 for gear in GEARS}
    if found.period not in (pair.pinion.teeth, pair.gear.teeth):
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
            {"shaft": gear, "healthy": found.load(found.twin) / found.static_force},
        )
        caption = f"Largest load of each tooth of the {gear} over the mean mesh force."
        pictures.append(Picture(f"teeth_loads_{gear}", caption, data, loads_figure))
    return pictures


CHAPTER = Chapter("teeth", "Teeth that differ", write, seconds=4.0)
