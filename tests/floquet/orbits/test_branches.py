"""Are orbits, multipliers and bifurcations of simple systems those that are known?"""

import numpy as np
import pytest
from scipy.linalg import expm

from floquet.orbits.bifurcations import doubling_direction
from floquet.orbits.branch import Continuation, Family, Limits
from floquet.orbits.branch_search import _Trace, find_branches
from floquet.orbits.closing import close_orbit
from floquet.orbits.deadline import Deadline, OutOfTimeError
from floquet.orbits.long_run import _run, long_run, lyapunov_exponent
from floquet.orbits.response import Member
from floquet.orbits.system import Contact, ContactSystem
from lumped import NumericalError

LIMITS = Limits(
    slowest=0.1, fastest=1.0, length=1.0, parameter=1.0, amplitude=50.0, frequency=1.0 / (2.0 * np.pi)
)


def meissner(e=0.4, damping=0.1):
    """A Meissner oscillator that may bounce: k jumps between 1 + e and 1 - e in the middle of the period."""
    contact = Contact([1.0], [-1.0], [[1.0 + e], [1.0 - e]], damping)
    return ContactSystem([[0.0]], [[0.0]], [1.0], (contact,), phases=[0.0, 0.5, 1.0], output=[1.0])


def meissner_map(T, e=0.4, damping=0.1):
    """Monodromy matrix of the oscillator that never leaves contact, in closed form, by (z, z')."""
    half = [expm(0.5 * T * np.array([[0.0, 1.0], [-(1.0 + s * e), -damping]])) for s in (1.0, -1.0)]
    return half[1] @ half[0]


def test_where_contact_holds_the_multipliers_are_meissners():
    T = 4.0
    orbit = close_orbit(meissner(), np.array([1.0, 0.0]), T)
    assert not orbit.contact_lost
    expected = np.linalg.eigvals(meissner_map(T))
    assert np.sort_complex(orbit.multipliers) == pytest.approx(np.sort_complex(expected), abs=1e-12)
    assert orbit.error < 1e-10


def start(T):
    return np.array([1.0, 0.0]), 0.0


def test_the_doubling_of_the_bouncing_meissner_oscillator_is_the_tongue():
    """While contact holds, a period doubling is where the trace of the closed map is -1 - det."""
    system = meissner(e=0.6, damping=0.1)
    response = find_branches(Member(Family(lambda T: system, True), LIMITS, start), periods=(1, 2), seeds=1)
    doublings = [
        1.0 / b.orbit.period
        for branch in response.branches
        for b in branch.bifurcations
        if branch.n == 1 and b.kind == "period doubling" and not b.orbit.contact_lost
    ]
    assert doublings
    for rate in doublings:
        M = meissner_map(1.0 / rate, e=0.6)
        assert np.linalg.det(M + np.eye(2)) == pytest.approx(0.0, abs=1e-10)
    along = Continuation(Family(lambda T: system, True), 1, LIMITS)
    for branch in response.branches:
        for b in branch.bifurcations:
            if branch.n == 1 and b.kind == "period doubling":
                direction = doubling_direction(along, b.orbit)[:2] * along.scale[:2]
                assert b.orbit.monodromy @ direction == pytest.approx(
                    -direction, abs=1e-6 * np.abs(direction).max()
                )
    # Inside the tongue, where no motion that holds contact is stable, the doubled one bounces and is stable.
    T = 1.0 / (max(doublings) - 0.005)
    assert not any(o.stable for o in response.at(T) if not o.contact_lost)
    assert any(o.stable and o.contact_lost and o.n == 2 for o in response.at(T))


def test_a_fold_ends_the_jump_of_the_bouncing_resonance():
    """At speeds beyond a fold no motion of its branch is left, and at the fold a multiplier is 1."""
    system = meissner(e=0.3, damping=0.3)
    response = find_branches(Member(Family(lambda T: system, True), LIMITS, start), periods=(1,), seeds=0)
    folds = [b for branch in response.branches for b in branch.bifurcations if b.kind == "fold" and b.sharp]
    assert len(folds) == 2
    for fold in folds:
        assert np.abs(fold.orbit.multipliers - 1.0).min() < 1e-6
        rate = 1.0 / fold.orbit.period
        counts = [len(response.at(1.0 / (rate * (1.0 + change)))) for change in (-1e-4, 1e-4)]
        assert abs(counts[0] - counts[1]) == 2
    with pytest.raises(NumericalError, match="no motion of 3 cycles"):
        close_orbit(system, np.array([-1e6, -1e6]), 5.0, 3)


def test_a_long_run_tells_chaos_from_a_periodic_motion():
    """The exponent of a periodic motion is the log of its largest multiplier, whatever the contact does."""
    system = meissner(e=0.4, damping=0.1)
    orbit = close_orbit(system, np.array([1.0, 0.0]), 4.0)
    exponent, _ = lyapunov_exponent(system, orbit.start, 4.0, cycles=200)
    assert exponent == pytest.approx(np.log(orbit.spectral_radius), abs=2e-2)
    run = long_run(system, 1.3 * orbit.start, 4.0)
    assert run.kind == "periodic"
    assert run.orbit is not None
    assert run.orbit.start == pytest.approx(orbit.start, abs=1e-8)


class PassesAfterChecks(Deadline):
    """A deadline that passes after a number of checks."""

    def __init__(self, checks):
        super().__init__(1e9)
        self.checks = checks

    @property
    def passed(self):
        self.checks -= 1
        return self.checks < 0

    def share(self, part):
        return PassesAfterChecks(self.checks)


def away(rate):
    return abs(np.log(rate / 0.3))


@pytest.mark.parametrize("rate", [0.11, 0.3, 0.9])
def test_a_branch_followed_in_parts_is_the_branch_followed_at_once(rate):
    """Points, speeds of folds and places of folds do not depend on the number of interruptions."""
    system = meissner(e=0.3, damping=0.3)
    along = Continuation(Family(lambda T: system, True), 1, LIMITS)
    orbit = close_orbit(system, np.array([1.0, 0.0]), 1.0 / rate)

    def trace(count):
        limit = PassesAfterChecks(count)
        up, down = (along.follow(orbit, direction, deadline=limit.share(0.5)) for direction in (1.0, -1.0))
        result = _Trace(along, up, down, down.end, [], [])
        result.left = list(range(len(result.path.orbits) - 1))
        result.refine(away, limit)
        return result

    uninterrupted = trace(10**9)
    parts = trace(7)
    turns = 0
    while parts.unfinished:
        parts.extend(PassesAfterChecks(9))
        parts.refine(away, PassesAfterChecks(1))
        turns += 1
    assert turns > 3
    one = uninterrupted.branch()
    two = parts.branch()
    assert parts.ends == uninterrupted.ends == ("range", "range")
    assert two.rates == pytest.approx(one.rates, rel=1e-9)
    folds = [b for b in one.bifurcations if b.kind == "fold"]
    assert len(folds) == 2
    assert [b.kind for b in two.bifurcations] == [b.kind for b in one.bifurcations]
    assert [b.place for b in two.bifurcations] == pytest.approx([b.place for b in one.bifurcations], rel=1e-6)


def test_a_long_run_in_parts_is_the_run_at_once():
    """A deadline that does not pass changes only rounding. A deadline that has passed raises an error."""
    system = meissner(e=0.6, damping=0.1)
    T = 1.0 / 0.29
    one = long_run(system, np.array([1.3, 0.2]), T, settle=100, observe=100)
    two = long_run(system, np.array([1.3, 0.2]), T, settle=100, observe=100, deadline=Deadline(1e9))
    assert (one.kind, one.rms) == (two.kind, pytest.approx(two.rms, rel=1e-9))
    with pytest.raises(OutOfTimeError):
        long_run(system, np.array([1.3, 0.2]), T, deadline=Deadline(0.0))


def test_parts_of_a_run_join_to_the_run():
    system = meissner(e=0.3, damping=0.1)
    # it decays: the extremes are of the first part
    start = np.array([1.5, 0.2])
    T = 2.0
    one_run = system.run(start, T, 100)
    parts = _run(system, start, T, 100, 0.0, Deadline(1e9))
    assert 0.0 < one_run.least_load < 0.9 * system.run(one_run.end, T, 10).least_load
    assert parts.end == pytest.approx(one_run.end, rel=1e-9)
    for name in ("mean", "mean_square", "least", "most", "largest_load", "least_load"):
        assert getattr(parts, name) == pytest.approx(getattr(one_run, name), rel=1e-8, abs=1e-12), name
