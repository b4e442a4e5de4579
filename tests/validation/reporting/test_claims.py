"""Every claim of page 1, for every kind of pair, computed again by other functions over its own scope."""

from __future__ import annotations

import math
import re
import warnings
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import xarray as xr

import floquet
import lumped
from lumped.errors import NumericalError
from lumped.model.periodic_system import without_shafts
from lumped.outcomes import Absent
from tests.validation.reporting.kinds import KINDS
from tests.validation.reporting.written import plain
from validation.prediction.inputs import read_values
from validation.reporting.chapters import response
from validation.reporting.effort import QUICK, Effort
from validation.reporting.facts import facts_of
from validation.reporting.page_one import page_one
from validation.reporting.results import Results
from validation.reporting.verdict import NEAR, Verdict

#: As a quick report, but for charts that are drawn, and for the time of a search that may stay open.
EFFORT = Effort(0, 0, 0, QUICK.sweep_speeds, 41, 5, 9, 0.3, 0, "quick report")
#: Kinds whose jumps are all found: their search ends by itself, not by its time, on a busy machine too.
JUMPING = ("jump near", "jump far", "contact lost")


@cache
def results_of(kind: str) -> Results:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lumped.LawRangeWarning)
        effort = replace(EFFORT, jump_seconds=4.0 * QUICK.jump_seconds) if kind in JUMPING else EFFORT
        return Results(KINDS[kind](), effort, kind)


@pytest.fixture(params=list(KINDS))
def results(request) -> Results:
    return results_of(request.param)


def operating_rpm(pair: lumped.GearPair) -> float:
    return pair.operating.pinion_speed * 30.0 / math.pi


def linear(pair: lumped.GearPair, rpm: float) -> xr.Dataset | None:
    try:
        return lumped.steady_state(pair.at_speed(rpm), samples_per_cycle=128)
    except NumericalError:
        return None


def test_contact_is_that_of_the_second_program(results):
    """Teeth that differ have no second program here: their loads are added up pair by pair."""
    claim = facts_of(results)["contact"]
    assert claim.scope.speeds_rpm == (operating_rpm(results.given),) * 2
    if results.teeth is None:
        second = results.second
        assert not isinstance(second, Absent)
        least = float(second.cycle["normal_load"].sum("pair").min())
        assert (least <= 0.0) == ("lose contact" in claim.claim)
        return
    assert claim.scope.teeth == "as given"
    motion = lumped.steady_state(results.given, contact="unilateral")
    lost = float(motion["normal_load"].sum("pair").min()) <= 0.0
    assert lost == ("lose contact" in claim.claim)


def test_no_speed_is_unstable_over_the_range_that_is_named(results):
    claim = facts_of(results)["unstable_speeds"]
    pair = without_shafts(results.pair)
    low, high = claim.scope.speeds_rpm
    assert claim.scope.supports == "springs"
    assert claim.claim == "no speed is unstable", "these pairs have none"
    assert results.proven_stability.stable_rpm == pytest.approx((low, high), rel=1e-9)
    assert results.proven_stability.widest_undecided == 0.0
    for rpm in np.geomspace(low, high, 14):
        multipliers = floquet.gear_pair_multipliers(pair.at_speed(float(rpm)), supports="springs")
        assert multipliers.verdict != "unstable", rpm


def test_where_no_jump_was_looked_for_the_linear_motion_keeps_contact(results):
    """At speeds of its own, between those of the report."""
    search = results.jump_search
    claim = facts_of(results)["jumps"]
    if search.windows:
        assert claim.claim != "contact is kept, and no jump was found"
        return
    pair = without_shafts(results.pair)
    static = results.like.static_force
    for rpm in np.geomspace(*claim.scope.speeds_rpm, 23):
        motion = linear(pair, float(rpm))
        assert motion is not None
        assert float(motion["normal_load"].sum("pair").min()) > -1e-6 * static, rpm


@cache
def all_branches(pair: lumped.GearPair) -> floquet.ResponseBranches:
    """The search of the whole range, without a limit of time, with runs from other starts."""
    return floquet.response_branches(pair, (6900.0, 10_000.0), (1, 2, 3), seeds=20)


@pytest.mark.parametrize("kind", JUMPING)
def test_all_jumps_of_the_range_are_found_in_a_quick_report(kind):
    """The three are one pair at three speeds, so that one search has the jumps of all."""
    results = results_of(kind)
    assert results.jump_search.open == ()
    branches = all_branches(results.pair.at_speed(8000.0))
    expected = [jump.speed_rpm for jump in branches.jumps]
    assert len(expected) >= 4
    jumps = np.array([jump.speed_rpm for jump in results.jump_search.jumps])
    for speed in expected:
        assert np.abs(jumps / speed - 1.0).min() < 2e-3, speed
    operating_rpm = results.operating_rpm
    nearest = jumps[np.abs(jumps - operating_rpm).argmin()]
    assert (
        next(one for one in page_one(results).numbers if one.key == "hazard").value == nearest - operating_rpm
    )


def test_a_resonance_is_where_an_order_meets_a_natural_frequency(results):
    resonance = results.resonance
    pair = results.pair
    claim = plain(facts_of(results)["resonance"].claim)
    if resonance is None:
        assert claim == "no mesh order resonates"
        return
    supports = "springs" if pair.shafts is None else "shafts"
    order, share, side, hertz = re.fullmatch(
        r"order (\d+) is ([\d.]+) % (above|below) the .* \((\d+) Hz\)", claim
    ).groups()
    frequencies = lumped.natural_frequencies(pair, supports=supports).to_numpy()
    frequency = frequencies[np.abs(frequencies - float(hertz)).argmin()]
    assert frequency == pytest.approx(float(hertz), abs=0.51)
    apart = int(order) * operating_rpm(pair) / 60.0 * pair.pinion.teeth / frequency - 1.0
    assert 100.0 * abs(apart) == pytest.approx(float(share), rel=0.06)
    assert side == ("above" if apart > 0.0 else "below")
    row = next(one for one in page_one(results).numbers if one.key == "resonance")
    assert row.value == pytest.approx(operating_rpm(pair) * (1.0 / (1.0 + apart) - 1.0), rel=1e-6)


def test_the_headline_is_smooth_only_off_a_resonance(results):
    first = page_one(results)
    if first.verdict not in (Verdict.UNCERTAIN, Verdict.ABSOLUTE):
        assert "smoothly" not in first.reason
        return
    near = results.resonance is not None and abs(results.resonance.apart) <= NEAR
    assert ("runs on a resonance" in first.reason) == near
    assert ("runs smoothly" in first.reason) == (not near)


def test_the_force_of_a_resonance_falls_where_the_page_says():
    """Root mean square of the bearing force over speed, by motions of its own: a peak, and half beside it."""
    results = results_of("resonance")
    resonance = results.resonance
    pair = results.pair
    assert resonance is not None
    assert resonance.near

    def size(rpm: float) -> float:
        motion = linear(pair, rpm)
        assert motion is not None
        gear = {"mesh force": "", "force on the pinion bearings": "p", "force on the gear bearings": "g"}[
            resonance.place
        ]
        if not gear:
            return float(motion["normal_load"].sum("pair").std())
        return math.hypot(*(float(motion[f"bearing_force_{line}_{gear}"].std()) for line in "xy"))

    peak = size(resonance.speed_rpm)
    around = [size(factor * resonance.speed_rpm) for factor in (0.94, 0.97, 1.03, 1.06)]
    assert peak > max(around)
    for side in (resonance.below_rpm, resonance.above_rpm):
        if math.isfinite(side):
            assert size(side) <= 0.5 * peak
            inside = side + 0.025 * operating_rpm(pair) * (1.0 if side < operating_rpm(pair) else -1.0)
            assert size(inside) > 0.5 * peak


def test_inputs_are_counted_field_by_field(results):
    claim = facts_of(results)["inputs"].claim
    assumed, all_inputs = map(int, re.fullmatch(r"(\d+) of (\d+) inputs are assumed", claim).groups())
    read = read_values(results.given, contact_lost=results.contact_lost)
    assert all_inputs == len(read)
    assert assumed == sum(results.given.state(path) is lumped.State.ASSUMED for path in read)


def test_the_numbers_of_the_second_program_are_those_of_the_sentence(results):
    claim = plain(facts_of(results)["second_program"].claim)
    numbers = {row.key: row for row in page_one(results).numbers}
    if claim.startswith("Not checked"):
        assert all(math.isnan(row.second) for row in numbers.values())
        return
    share = float(re.search(r"differs most, by ([\d.]+) %", claim)[1])
    if results.teeth is None:
        rows = [numbers[key] for key in ("dte_peak_to_peak", "dynamic_factor", "tooth_load")]
        apart = [abs(row.second / row.value - 1.0) for row in rows]
        if "bearing_rms" in numbers:
            apart.append(abs(numbers["bearing_rms"].second / numbers["bearing_rms"].value - 1.0))
        assert 100.0 * max(apart) <= share * 1.06
        if "bearing_rms" in numbers:
            assert 100.0 * max(apart) == pytest.approx(share, rel=0.06)


def test_teeth_as_given_lead():
    results = results_of("class")
    first = page_one(results).numbers[0]
    motion = lumped.steady_state(results.given, contact="unilateral")
    swing = float(np.ptp(motion["dte"].to_numpy()))
    assert first.value == pytest.approx(swing, rel=0.01)
    like = lumped.steady_state(results.given.healthy, contact="unilateral")
    assert f"like teeth {1e6 * float(like.attrs['dte_peak_to_peak']):.3g}" in plain(first.note)
    assert first.value > 2.0 * float(like.attrs["dte_peak_to_peak"])
    # K_v is of the coarser class of the file.
    rows = response.write(results).blocks[0].rows
    note = next(note for symbol, _, note, *_ in rows if str(symbol).startswith("K_v"))
    assert note.endswith("tolerances of class 6")


def test_a_scope_is_what_was_computed(results):
    """No claim of a quick report is said to be of a full one, of other supports, or of a wider range."""
    facts = facts_of(results)
    for one in facts.values():
        low, high = one.scope.speeds_rpm
        assert one.scope.effort == "quick report"
        assert results.speeds[0] <= low <= high <= results.speeds[1]
    supports = "shafts" if results.given.shafts is not None else "springs"
    assert {facts[key].scope.supports for key in ("contact", "stable", "resonance", "inputs")} == {supports}
    assert facts["jumps"].scope.teeth == facts["unstable_speeds"].scope.teeth == "alike"


def test_what_the_budget_left_open_is_said_and_not_claimed():
    """A search that ends after the first speeds: the range shrinks, and the command goes on."""
    complete = results_of("jump far")
    results = Results(complete.given, EFFORT, "pair.toml")
    vars(results).update({name: vars(complete)[name] for name in vars(complete) if name != "jump_search"})
    vars(results)["name"] = "pair.toml"
    search = complete.jump_search
    vars(results)["jump_search"] = type(search)(
        pair=search.pair, speeds_rpm=search.speeds_rpm, windows=search.windows, branches=(),
        open=((7000.0, 9900.0),), seconds=5.0,
    )  # fmt: skip
    first = page_one(results)
    row = next(one for one in first.numbers if one.key == "hazard")
    proof = "the linear motion is proven stable from 650 to 13000 rpm"
    assert plain(row.note) == f"none found from 650 to 7000 rpm; {proof}"
    assert "jumps from 7000 to 9900 rpm were not searched to the end" in plain(first.reason).lower()
    assert first.actions[0].command == "spurcheck response pair.toml --range 7000..9900"
    vars(results)["jump_search"] = type(search)(
        pair=search.pair, speeds_rpm=search.speeds_rpm, windows=search.windows, branches=(),
        open=((6000.0, 9900.0),), seconds=5.0,
    )  # fmt: skip
    row = next(one for one in page_one(results).numbers if one.key == "hazard")
    assert plain(row.note) == f"jumps were not searched to the end; {proof}"
