"""Teeth that differ: what they do to loads, orders and indicators, beside the twin with like teeth."""

from __future__ import annotations

import numpy as np

from lumped.labelling import labelled_dataset
from validation.plots.teeth import loads_figure, sidebands_figure, turn_figure
from validation.reporting.blocks import Block, Content, Picture, Quantity, Table, Text, quantities
from validation.reporting.chapter import Chapter
from validation.reporting.facts import sampled_words
from validation.reporting.results import Results
from validation.signals.findings import GEARS, NOISE, TeethFindings, deviations_table, rpm_and_period

#: Turns of the pinion that the figure over time shows.
_MOST_TURNS = 4


def write(results: Results) -> Content | None:
    """Write the chapter; None where all teeth are alike."""
    found = results.teeth
    if found is None:
        return None
    return Content(found.sentence, (*_tables(found), *_spread(results), *_pictures(found)))


def _spread(results: Results) -> list[Block]:
    """What a class, and every other uncertain input, leaves open."""
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


def _tables(found: TeethFindings) -> list[Block]:
    given = deviations_table(found.pair)
    lengths = ("cumulative", "pitch", "eccentricity")
    held = (int(one) if one < 12 else "none" for one in given["tolerance_class"])
    sizes = ([Quantity(float(given[name].sel(gear=gear)), "m") for name in lengths] for gear in GEARS)
    rows = tuple((gear, *size, one) for gear, size, one in zip(GEARS, sizes, held, strict=True))
    columns = {
        "gear": "gear",
        "cumulative": "range of the index deviations",
        "pitch": "largest step",
        "eccentricity": "eccentricity",
        "tolerance_class": "class of ISO 1328-1 that holds",
    }
    swing, twin = (one.attrs["dte_peak_to_peak"] for one in (found.motion, found.twin))
    load, healthy = (found.load(one) / found.static_force for one in (found.motion, found.twin))
    rate, of_twin = found.rates
    numbers = quantities(
        "teeth_numbers",
        "Teeth as given, with the value of like teeth in the note.",
        ("transmission error, peak to peak", swing, "m", f"like teeth: {1e6 * twin:.3g} µm"),
        ("largest load on one tooth / mean", load, "1", f"like teeth: {healthy:.3g}"),
        ("growth of a perturbation in a mesh cycle", rate, "1", f"like teeth: {of_twin:.3g}"),
        ("meeting teeth at which contact is lost", float(len(found.contact_lost)), "1"),
    )
    return [
        Text(f"At {rpm_and_period(found)}. Contact: {found.motion.attrs['touch']}."),
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
    motion = found.motion
    twin = found.twin
    pair = found.pair
    count = motion.sizes["time"]
    turns = found.period / pair.pinion.teeth
    samples = twin.sizes["time"]
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
    pair = found.pair
    share = found.largest_loads / found.static_force
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
