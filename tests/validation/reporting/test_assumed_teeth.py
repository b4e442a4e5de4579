"""Does page 1 say which teeth it assumed, and are its ranges those of the machines that it names?"""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import lumped
from lumped.outcomes import Absent
from tests.unlike_pairs import known_sizes, unlike_pair
from tests.validation.reporting.written import SMALL, plain
from validation.prediction.assumed_teeth import (
    REVOLUTION,
    WIDENED,
    assumed_teeth,
    revolution_range,
    widened,
)
from validation.prediction.uncertainty import speed_band
from validation.reporting.blocks import Text
from validation.reporting.chapters import how_sure
from validation.reporting.effort import FULL, QUICK
from validation.reporting.facts import assumed_teeth_words, facts_of, of_assumed_teeth
from validation.reporting.page_one import PageOne, page_one
from validation.reporting.results import Results

#: Torque and damping alone are uncertain; a short hunting period.
PAIR = known_sizes(unlike_pair("rack_25_degrees_always_pushing")).with_(
    {"assumed": {}, "uncertainty": {"operating.pinion_torque": "+- 20 %", "mesh.damping_ratio": "/ 2 .. * 2"}}
)
#: No range of page 1 is of the jumps, whose search takes longer than all else.
EFFORT = replace(SMALL, drawn_machines=4, chart_speeds=31, chart_dampings=5, jump_seconds=0.5)


@pytest.fixture(scope="module")
def results() -> Results:
    return Results(PAIR, EFFORT, "pair.toml")


@pytest.fixture(scope="module")
def first(results) -> PageOne:
    return page_one(results)


def test_parts_that_either_process_computes_are_the_whole(results):
    """Band over speed and drawn teeth, of which a second process computes any part."""
    speeds = results.band["speed_rpm"].to_numpy()
    band = speed_band(results.pair_on_springs, speeds, results.uncertainty, EFFORT.band_samples)
    xr.testing.assert_identical(results.band, band)
    teeth = assumed_teeth(PAIR, results.uncertainty, EFFORT.drawn_machines)
    xr.testing.assert_identical(results.assumed_teeth, teeth)


def test_ranges_of_page_1_are_those_of_samples_and_drawn_teeth(results, first):
    samples = results.uncertainty
    teeth = results.assumed_teeth
    assert not isinstance(samples, Absent)
    assert teeth is not None
    rows = {row.key: row for row in first.numbers}
    for name in WIDENED:
        ends = samples[f"{name}_percentile"].to_numpy()[[0, 2]]
        assert (rows[name].low, rows[name].high) == pytest.approx(widened(samples, teeth, name))
        assert rows[name].low <= ends[0]
        assert rows[name].high >= ends[1]
        assert rows[name].value == results.like.numbers[name]
        assert rows[name].low < rows[name].value < rows[name].high
    assert rows["dynamic_factor"].high > 1.01 * samples["dynamic_factor_percentile"][2].item()
    for name in ("dte_peak_to_peak", "efficiency"):
        ends = samples[f"{name}_percentile"].to_numpy()[[0, 2]]
        assert (rows[name].low, rows[name].high) == pytest.approx(ends)


def test_the_row_over_all_teeth(results, first):
    row = first.numbers[1]
    teeth = results.assumed_teeth
    assert (row.key, row.unit) == ("assumed_teeth", "m")
    assert row.label == "Transmission error over all teeth, class 6 assumed"
    period = int(np.lcm(PAIR.pinion.teeth, PAIR.gear.teeth))
    assert row.note == (
        f"4 machines with teeth drawn of class 6, assumed; {period} mesh cycles; the result is the median"
    )
    assert (row.low, row.value, row.high) == pytest.approx(revolution_range(teeth))
    # The drawn teeth as teeth of a file: another road, the prediction of unlike teeth.
    drawn = lumped.steady_state(
        PAIR.with_({"gears.deviations": {"tolerance_class": 6}}), contact="unilateral"
    )
    assert row.low < float(np.ptp(drawn["dte"].to_numpy())) < row.high
    assert "teeth drawn of class 6, assumed; inputs varied, 4 samples; small report" in row.scope


def test_the_sentences_of_page_1(results, first):
    fact = facts_of(results)["assumed_teeth"]
    low, _, high = revolution_range(results.assumed_teeth)
    match = re.fullmatch(
        r"4 machines with teeth drawn of class 6, assumed, have a transmission error of (\S+) to (\S+) µm "
        "over all teeth, and widen the ranges of dynamic factor, tooth load and bearing force",
        plain(fact.claim),
    )
    assert [float(end) for end in match.groups()] == pytest.approx([1e6 * low, 1e6 * high], rel=0.06)
    assert fact.value == first.numbers[1].value
    assert plain(fact.claim) in plain(first.sure[1])
    assert first.not_modelled.startswith(
        "The parameter file states no tooth errors: the results are those of"
    )
    assert first.ranged


def test_a_quick_report_has_the_row_and_no_wider_ranges():
    results = Results(PAIR, replace(EFFORT, samples=0, band_samples=0, drawn_machines=4), "pair.toml")
    teeth = results.assumed_teeth
    assert teeth is not None
    assert (teeth.attrs["inputs"], teeth.attrs["taken"]) == ("as given", 4)
    assert all(results.spread(name) is None for name in WIDENED)
    assert assumed_teeth_words(teeth, 3.0, widens=False).endswith(" over all teeth")


def test_without_a_range_of_the_inputs_nothing_is_widened(results):
    """Too few samples: the percentiles are missing, and the claim says nothing of ranges."""
    few = Results(PAIR, EFFORT, "pair.toml")
    vars(few).update(like=results.like, prediction=results.like, assumed_teeth=results.assumed_teeth)
    samples = results.uncertainty
    missing = {f"{name}_percentile": samples[f"{name}_percentile"] * np.nan for name in WIDENED}
    vars(few)["uncertainty"] = samples.assign(missing)
    assert all(few.spread(name) is None for name in WIDENED)
    assert "widen" not in of_assumed_teeth(few).claim
    assert "widen" in of_assumed_teeth(results).claim


def perfect(pair: lumped.GearPair) -> dict[str, object]:
    return {f"{gear}.deviations": {"index": [0.0] * getattr(pair, gear).teeth} for gear in ("pinion", "gear")}


@pytest.mark.parametrize(
    "pair",
    [
        PAIR.with_({"pinion.deviations": {"tolerance_class": 9}}),
        PAIR.with_({"gear.deviations": {"tolerance_class": 5}}),
        PAIR.with_(perfect(PAIR)),
        PAIR.with_({"pinion.mounting": {"eccentricity": 4.0}}),
        PAIR.with_({"uncertainty": {}}),
    ],
    ids=["class", "class of the gear", "zeros", "eccentricity", "all known"],
)
def test_where_the_teeth_are_known_nothing_is_drawn(pair):
    assert Results(pair, EFFORT, "pair.toml").assumed_teeth is None


def test_where_contact_is_lost_or_no_machines_are_asked_for_nothing_is_drawn():
    lost = lumped.load_gear_pair("nasa_28_28").with_({"speed": 8700.0, "mesh.relief": "ignored"})
    assert Results(lost, EFFORT, "pair.toml").assumed_teeth is None
    assert Results(PAIR, SMALL, "pair.toml").assumed_teeth is None
    assert (FULL.drawn_machines, QUICK.drawn_machines) == (8, 4)
    assert (FULL.drawn_seconds, QUICK.drawn_seconds) == (15.0, 4.0)


@pytest.mark.parametrize(
    ("counts", "words"),
    [
        (
            {"samples": 4, "taken": 4, "asked": 8, "contact_lost": 1},
            "4 of 8 machines with teeth drawn of class 6, assumed, have a transmission error of LOW to HIGH "
            "µm over all teeth, and widen the ranges of dynamic factor, tooth load and bearing force; "
            "1 of 4 lose contact; the time of 10 s was used up",
        ),
        (
            {"samples": 2, "taken": 3, "asked": 8, "contact_lost": 0},
            "there is no range of teeth: it needs 3 machines, and there are 2 of 8 machines with teeth drawn "
            "of class 6, assumed; 1 without a motion left out; the time of 10 s was used up",
        ),
    ],
)
def test_what_the_time_left_out_is_said(counts, words):
    swings = 1e-5 * np.array([1.0, 1.1, 1.3, 1.4])[: counts["samples"]]
    teeth = xr.Dataset({REVOLUTION: ("machine", swings)})
    teeth.attrs |= counts | {"tolerance_class": 6, "inputs": "varied", "period": 40}
    said = plain(assumed_teeth_words(teeth, 10.0, widens=True))
    assert re.sub(r"[\d.]+ to [\d.]+ µm", "LOW to HIGH µm", said) == words


def test_the_chapter_says_which_results_have_perfect_teeth(results):
    texts = [plain(block.text) for block in how_sure.write(results).blocks if isinstance(block, Text)]
    claim = plain(of_assumed_teeth(results).claim)
    assert f"On page 1: {claim}. The table of results above has perfect teeth." in texts
