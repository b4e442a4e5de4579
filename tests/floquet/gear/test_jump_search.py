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
    least[3] = -1.0
    least[4] = np.nan
    radius[7] = 1.02
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
    kept = floquet.contact_loss_windows(sweep(speeds, np.abs(speeds - 1450.0) + 20.0), (1000.0, 1900.0))
    assert kept == ()


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
    found = floquet.search_jumps(shifted, [(26_000.0, 28_000.0)], seconds=60.0, seeds=0, speeds=LARGE_SHIFTS)
    assert len(everywhere) == 2
    assert min(speeds_of(everywhere)) < 26_000.0
    assert max(speeds_of(everywhere)) > 28_000.0
    assert speeds_of(found.jumps) == pytest.approx(speeds_of(everywhere), rel=1e-6)
    assert found.open == ()
    ((low, high),) = found.windows
    assert low < min(speeds_of(everywhere))
    assert high > max(speeds_of(everywhere))
    middle = float(np.mean(speeds_of(everywhere)))
    assert len([o for o in found.at(middle) if o.n == 1]) == 3
    with pytest.raises(ParameterError, match="18000 to 47000 rpm"):
        found.at(1000.0)


def test_large_motions_of_a_resonance_above_the_range_are_found(frictionless):
    """From 8558 to 12,000 rpm they exist beside the small ones, which keep contact at 11,000 rpm."""
    assert not floquet.periodic_orbit(frictionless.with_(operating__pinion_speed="11000 rpm")).contact_lost
    range_rpm = 10_800.0, 11_800.0
    linear = lumped.speed_sweep(frictionless, np.linspace(*range_rpm, 9))
    windows = floquet.contact_loss_windows(linear, range_rpm)
    assert windows == ()
    found = floquet.search_jumps(frictionless, windows, seconds=60.0, seeds=0, speeds=range_rpm)
    sizes = sorted(o.dte_rms for o in found.at(11_000.0) if o.n == 1)
    whole = floquet.response_branches(frictionless, (10_800.0, 20_000.0), (1,), seeds=0)
    assert sizes[-1] == pytest.approx(max(o.dte_rms for o in whole.at(11_000.0)), rel=1e-6)
    assert sizes[-1] > 20e-6


class Ticks:
    """Processor time that passes by a second whenever somebody looks."""

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
    """Whenever the time ends: each jump is one of the whole search, each that is missing lies in ``open``.

    Also where its branch has not come out of a window yet. In 500 s, of which each look takes one, the branch
    is cut several times, and all is found in the end.
    """
    monkeypatch.setattr(clock, "time", Ticks())
    found = floquet.search_jumps(
        shifted, [window], seconds=seconds, seeds=0, speeds=LARGE_SHIFTS, first=24_000.0
    )
    true = speeds_of(everywhere)
    own = speeds_of(found.jumps)
    assert len(set(own)) == len(own)
    assert all(min(abs(one - other) for other in true) < 0.05 for one in own)
    for one in true:
        known = any(abs(one - other) < 0.05 for other in own)
        assert known or any(low <= one <= high for low, high in found.open)
    assert found.open if seconds < 300.0 else seconds < 400.0 or not found.open


def test_an_end_behind_which_no_run_had_time_leaves_its_window_open(shifted, monkeypatch):
    """The branch has its folds, but what the pair does there is not known: no jump, and no claim."""

    def late(*arguments):
        raise OutOfTimeError

    monkeypatch.setattr(Member, "leads_to", late)
    window = 20_000.0, 47_000.0
    found = floquet.search_jumps(shifted, [window], seconds=60.0, seeds=0, speeds=LARGE_SHIFTS)
    assert found.jumps == ()
    assert [b.kind for one in found.branches for b in one.bifurcations].count("fold") == 2
    assert found.open == found.windows


def test_the_time_is_kept():
    """A lightly damped pair follows branches for half an hour; 3155 rpm is the jump next to its speed."""
    damping = {f"bearings.{g}.{d}_damping_ratio": 0.002 for g in ("pinion", "gear") for d in ("loa", "oloa")}
    pair = lumped.load_gear_pair("fzg_c").with_(damping | {
        "operating.pinion_speed": "3157.87 rpm", "mesh.contact": "prescribed", "mesh.relief": "ignored",
        "mesh.damping_ratio": 0.0043,
    })  # fmt: skip
    found = floquet.search_jumps(pair, [(2974.0, 3909.0)], seconds=1.0, seeds=0)
    assert found.seconds < 1.2
    assert found.open
    assert all(3000.0 < jump.speed_rpm < 3300.0 for jump in found.jumps)


def test_a_deadline_is_shared():
    whole = Deadline(100.0)
    assert 24.0 < whole.share(0.25).left <= 25.0
    assert not whole.passed
    assert Deadline(0.0).passed
    assert Deadline().share(0.5).left == np.inf
