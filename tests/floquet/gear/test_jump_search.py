"""Does a search within a time find the jumps of the whole range, and does it name what it left open?"""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import floquet
import lumped
from floquet.orbits import deadline as clock
from floquet.orbits.deadline import Deadline, OutOfTimeError
from floquet.orbits.response import Member
from lumped import ParameterError
from tests.unlike_pairs import unlike_pair


def sweep(speeds, least, radius=None):
    """Of three numbers a speed: the speed, the least load and the spectral radius."""
    radius = np.full(len(speeds), 0.9) if radius is None else radius
    curves = {"normal_load_min": ("speed", np.array(least, float)), "spectral_radius": ("speed", radius)}
    return xr.Dataset(curves, {"speed": np.array(speeds, float)})


def test_windows_are_where_the_linear_motion_pulls_or_grows():
    speeds = np.arange(1000.0, 2000.0, 100.0)
    least = np.full(10, 50.0)
    radius = np.full(10, 0.9)
    least[speeds == 1300.0] = -1.0
    least[speeds == 1400.0] = np.nan
    radius[speeds == 1700.0] = 1.02
    windows = floquet.contact_loss_windows(sweep(speeds, least, radius), (1000.0, 1900.0))
    assert windows == ((1200.0, 1500.0), (1600.0, 1800.0))
    # Cut to the speeds asked for.
    windows = floquet.contact_loss_windows(sweep(speeds, least, radius), (1250.0, 1650.0))
    assert windows == ((1250.0, 1500.0), (1600.0, 1650.0))
    assert floquet.contact_loss_windows(sweep(speeds, np.full(10, 50.0)), (1000.0, 1900.0)) == ()


def test_a_resonance_between_two_speeds_is_not_lost():
    """The least load of |v - 1450| - 20 is positive at all speeds of the sweep and negative between two."""
    speeds = np.arange(1000.0, 2000.0, 100.0)
    windows = floquet.contact_loss_windows(sweep(speeds, np.abs(speeds - 1450.0) - 20.0), (1000.0, 1900.0))
    assert windows == ((1400.0, 1500.0),)
    windows_with_contact = floquet.contact_loss_windows(
        sweep(speeds, np.abs(speeds - 1450.0) + 20.0), (1000.0, 1900.0)
    )
    assert windows_with_contact == ()


def test_speeds_that_the_sweep_does_not_cover_are_refused():
    with pytest.raises(ParameterError, match="1000 to 1900 rpm"):
        floquet.contact_loss_windows(sweep(np.arange(1000.0, 2000.0, 100.0), np.ones(10)), (500.0, 1500.0))


@pytest.fixture(scope="module")
def frictionless():
    """28 equal teeth, and no friction; the linear motion loses contact from 12,900 to 18,956 rpm."""
    return lumped.load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed", mesh__damping_ratio=0.05, mesh__relief="ignored", friction__law="none"
    )


#: Pinion speeds of that pair in which its linear motion loses contact [rpm].
LARGE_SHIFTS = (18_000.0, 47_000.0)


@pytest.fixture(scope="module")
def shifted():
    """A pair with a contact ratio of 1.1, large shifts and Coulomb friction."""
    return unlike_pair("contact_ratio_1_1_large_shifts")


@pytest.fixture(scope="module")
def everywhere(shifted):
    """Its jumps by the search without windows and without limit."""
    return floquet.response_branches(shifted, LARGE_SHIFTS, seeds=0).jumps


def speeds_of(jumps):
    return [round(jump.speed_rpm, 2) for jump in jumps]


def test_a_window_that_is_too_narrow_grows_to_the_end_of_its_branch(shifted, everywhere):
    """Its fold on running down lies far below the window, where the large motion ends."""
    search = floquet.search_jumps(shifted, [(26_000.0, 28_000.0)], seconds=60.0, seeds=0, speeds=LARGE_SHIFTS)
    assert len(everywhere) == 2
    assert min(speeds_of(everywhere)) < 26_000.0
    assert max(speeds_of(everywhere)) > 28_000.0
    assert speeds_of(search.jumps) == pytest.approx(speeds_of(everywhere), rel=1e-6)
    assert search.open == ()
    ((low, high),) = search.windows
    assert low < min(speeds_of(everywhere))
    assert high > max(speeds_of(everywhere))
    middle = float(np.mean(speeds_of(everywhere)))
    assert len([o for o in search.at(middle) if o.n == 1]) == 3
    with pytest.raises(ParameterError, match="18000 to 47000 rpm"):
        search.at(1000.0)


def test_large_motions_of_a_resonance_above_the_range_are_found(frictionless):
    """Large motions exist from 8558 to 12,000 rpm beside small motions that keep contact at 11,000 rpm."""
    assert not floquet.periodic_orbit(frictionless.with_(operating__pinion_speed="11000 rpm")).contact_lost
    range_rpm = 10_800.0, 11_800.0
    linear = lumped.speed_sweep(frictionless, np.linspace(*range_rpm, 9))
    windows = floquet.contact_loss_windows(linear, range_rpm)
    assert windows == ()
    search = floquet.search_jumps(frictionless, windows, seconds=60.0, seeds=0, speeds=range_rpm)
    sizes = sorted(o.dte_rms for o in search.at(11_000.0) if o.n == 1)
    all_branches = floquet.response_branches(frictionless, (10_800.0, 20_000.0), (1,), seeds=0)
    assert sizes[-1] == pytest.approx(max(o.dte_rms for o in all_branches.at(11_000.0)), rel=1e-6)
    assert sizes[-1] > 20e-6


class Ticks:
    """Processor time that increases by a second at each reading."""

    def __init__(self):
        self.now = 0.0

    def process_time(self):
        self.now += 1.0
        return self.now


@pytest.mark.parametrize("window", [(20_000.0, 47_000.0), (26_000.0, 28_000.0)])
@pytest.mark.parametrize("seconds", [3.0, 50.0, 110.0, 170.0, 230.0, 320.0, 500.0])
def test_what_is_found_in_a_time_is_right_and_the_rest_is_named(
    shifted, everywhere, monkeypatch, seconds, window
):
    """At any end of the time each jump is a jump of the complete search. ``open`` covers the missing jumps.

    This is also true for a branch that has not yet left a window. Each check of the clock takes 1 s: in 500 s
    the branch is cut several times, and all jumps are found in the end.
    """
    monkeypatch.setattr(clock, "time", Ticks())
    search = floquet.search_jumps(
        shifted, [window], seconds=seconds, seeds=0, speeds=LARGE_SHIFTS, first=24_000.0
    )
    all_jump_speeds = speeds_of(everywhere)
    jump_speeds = speeds_of(search.jumps)
    assert len(set(jump_speeds)) == len(jump_speeds)
    assert all(min(abs(one - other) for other in all_jump_speeds) < 0.05 for one in jump_speeds)
    for one in all_jump_speeds:
        has_jump = any(abs(one - other) < 0.05 for other in jump_speeds)
        assert has_jump or any(low <= one <= high for low, high in search.open)
    assert search.open if seconds < 300.0 else seconds < 400.0 or not search.open


def test_an_end_behind_which_no_run_had_time_leaves_its_window_open(shifted, monkeypatch):
    """The branch has its folds, but what the pair does there is not known: no jump, and no claim."""

    def late(*arguments):
        raise OutOfTimeError

    monkeypatch.setattr(Member, "leads_to", late)
    window = 20_000.0, 47_000.0
    search = floquet.search_jumps(shifted, [window], seconds=60.0, seeds=0, speeds=LARGE_SHIFTS)
    assert search.jumps == ()
    assert [b.kind for one in search.branches for b in one.bifurcations].count("fold") == 2
    assert search.open == search.windows


def test_the_time_is_kept():
    """A lightly damped pair follows branches for half an hour; 3155 rpm is the jump next to its speed."""
    damping = {f"bearings.{g}.{d}_damping_ratio": 0.002 for g in ("pinion", "gear") for d in ("loa", "oloa")}
    pair = lumped.load_gear_pair("fzg_c").with_(damping | {
        "operating.pinion_speed": "3157.87 rpm", "mesh.contact": "prescribed", "mesh.relief": "ignored",
        "mesh.damping_ratio": 0.0043,
    })  # fmt: skip
    search = floquet.search_jumps(pair, [(2974.0, 3909.0)], seconds=1.0, seeds=0)
    assert search.seconds < 1.2
    assert search.open
    assert all(3000.0 < jump.speed_rpm < 3300.0 for jump in search.jumps)


def test_a_deadline_is_shared():
    deadline = Deadline(100.0)
    assert 24.0 < deadline.share(0.25).left <= 25.0
    assert not deadline.passed
    assert Deadline(0.0).passed
    assert Deadline().share(0.5).left == np.inf
