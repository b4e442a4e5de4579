"""Does a report whose samples ran out of time say so everywhere, and claim no more than it computed?"""

from __future__ import annotations

import copy
import json
import math
from dataclasses import replace

import pytest

from tests.validation.reporting.written import PAIRS, SMALL, Written, known, plain, write_report
from validation.prediction import uncertainty as module
from validation.reporting.effort import FULL, QUICK
from validation.reporting.results import Results

#: Known results of the pair that the samples do not change.
_KEPT = (
    "like",
    "linear",
    "check",
    "second",
    "sweep",
    "chart",
    "jump_search",
    "modes",
    "multipliers",
    "resonance",
)


def hurried(seconds: float, band_seconds: float) -> Results:
    """Results of a pair with little time for samples, all else computed once."""
    reference = known("calm")
    results = Results(
        PAIRS["calm"](), replace(SMALL, sample_seconds=seconds, band_seconds=band_seconds), "calm"
    )
    for name in _KEPT:
        getattr(reference, name)
    vars(results).update({name: vars(reference)[name] for name in _KEPT})
    return results


@pytest.fixture(scope="module")
def nothing(tmp_path_factory) -> Written:
    """A report without any time for samples."""
    folder = tmp_path_factory.mktemp("nothing") / "report"
    return write_report("calm", folder, drawn=True, results=hurried(1e-9, 1e-9))


def test_without_time_page_1_has_no_range_and_says_why(nothing):
    sentence = plain(nothing.document["how_sure"][1])
    inputs = nothing.data("uncertainty").sizes["input"]
    claim = (
        "There is no range: it needs 8 possible machines, and 0 of 16 were computed; the time of 1e-09 s was "
        f"used up; 0 of {inputs} inputs were moved alone. There is no range over speed: it needs 2 possible "
        "machines, and 0 of 4 were computed; the time of 1e-09 s was used up."
    ).replace("1e-09", "1.00 × 10⁻⁹")
    _, _, after_assumed = sentence.partition("assumed. ")
    assert after_assumed == claim
    assert claim.replace("⁻⁹", "").split(". ")[0][:60] in plain(nothing.page)
    for row in nothing.document["numbers"].values():
        assert row["low"] is row["high"] is row["median"] is None
    assert not any(cell.endswith("%)") for row in nothing.printed["numbers"].rows for cell in row)
    assert "there is no range" in nothing.document["verdict"]["headline"]
    assert nothing.document["actions"][0]["command"] == "spurcheck uncertainty calm --samples 16"
    assert "trouble" not in nothing.document["facts"]
    fact = nothing.document["facts"]["samples"]
    assert (fact["value"], fact["unit"], fact["scope"]["inputs"]) == (0.0, "1", "0 samples")
    assert nothing.document["facts"]["range_over_speed"]["computed_by"] == "speed_band"
    assert "NaN" not in json.dumps(nothing.document)
    chapter = plain(nothing.sentences["how_sure"])
    assert chapter.startswith("There is no range: it needs 8 possible machines, and 0 of 16 were computed")
    assert "nan" not in plain(nothing.page).lower().split()
    assert not nothing.document["failed_checks"]


def test_a_part_of_the_samples_is_a_range_of_that_part(monkeypatch):
    """Time that runs in predictions alone: two thirds are for samples, and facts and page say how many."""
    clock = [0.0]
    predict = module._numbers

    def slow(*arguments):
        clock[0] += 1.0
        return predict(*arguments)

    results = hurried(60.0, 1e9)
    ends = sum(len(module.end_shares(one)) for one in module.uncertain_inputs(results.pair))
    results.effort = replace(results.effort, sample_seconds=1.0 + 3.0 * ends)
    monkeypatch.setattr(module, "_numbers", slow)
    with monkeypatch.context() as patch:
        patch.setattr("floquet.orbits.deadline.time.process_time", lambda: clock[0])
        results.effort = replace(results.effort, samples=128)
        ranges = results.uncertainty
    from validation.reporting.facts import facts_of
    from validation.reporting.page_one import page_one

    assert ranges.attrs["taken"] == ranges.sizes["sample"] == 2 * ends >= 32
    assert ranges.attrs["alone"] == ranges.sizes["input"]
    claims = facts_of(results)
    first = page_one(results)
    sentence = (
        f"the range is from {2 * ends} of 128 possible machines; the time of {1 + 3 * ends} s was used up"
    )
    assert claims["samples"].claim == sentence
    assert claims["samples"].value == 2.0 * ends
    assert claims["levels"].scope.inputs == f"{2 * ends} samples"
    assert f"{sentence[0].upper()}{sentence[1:]}." in first.sure[1]
    assert first.numbers[0].range
    low, _, high = ranges["dte_peak_to_peak_percentile"].to_numpy()
    assert (first.numbers[0].low, first.numbers[0].high) == pytest.approx((low, high))


def test_all_samples_are_said_in_the_facts_alone():
    results = known("calm")
    from validation.reporting.facts import facts_of
    from validation.reporting.page_one import page_one

    assert facts_of(results)["samples"].claim == "the range is from 16 possible machines"
    assert page_one(results).sure[1].endswith("inputs are assumed.")
    changed = copy.copy(results)
    vars(changed)["uncertainty"] = results.uncertainty.assign_attrs(refused=2, taken=18, asked=18, linear=3)
    words = "16 possible machines"
    assert facts_of(changed)["samples"].claim == (
        f"the range is from {words.replace('16', '18')}, of which 2 have no motion and are left out; "
        "in 3 of 16 the linear motion stands in"
    )
    assert "The range is from 18 possible machines, of which 2" in page_one(changed).sure[1]


def test_times_of_a_full_and_of_a_quick_report():
    """A quick report takes no samples; a full one 30 s at most, and a third for each range of few samples."""
    assert (FULL.sample_seconds, FULL.band_seconds) == (30.0, 10.0)
    assert QUICK.samples == QUICK.band_samples == 0
    assert math.isclose(module.ALONE, 1.0 / 3.0)
