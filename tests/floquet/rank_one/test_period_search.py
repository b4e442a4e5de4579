"""Is the nearest unstable period that of the closed form, however narrow its zone is?"""

from dataclasses import replace

import numpy as np
import pytest

from floquet.rank_one.batch import fast_monodromies
from floquet.rank_one.boxes import (
    FlowPolynomial,
    GainDeviation,
    NodeCounts,
    PatchSize,
    _flow_in_patch,
    growth_at,
    slow_period,
)
from floquet.rank_one.kernel_input import packed
from floquet.rank_one.kernels.gains import Limits, Point
from floquet.rank_one.largest_flow import largest_flow
from floquet.rank_one.period_search import Effort, PatchSystem, PeriodVerdicts, proven_periods
from floquet.rank_one.system import Gains, RankOneSystem
from tests.floquet.rank_one.test_boxes import mathieu, meissner, no_factors

PLENTY = Effort(1e5, 100_000, 5000)
EXACT = GainDeviation(0.0, 0.0)


class OneSystem:
    """A system for all periods."""

    widest = 1.0

    def __init__(self, system: RankOneSystem, deviation: GainDeviation = EXACT) -> None:
        self.patch = PatchSystem(system, packed(system), no_factors, deviation)

    def __call__(self, shortest: float, longest: float) -> PatchSystem:
        return self.patch


def damped(system: RankOneSystem, zeta: float) -> RankOneSystem:
    """The system with the damping factor zeta as its own."""
    gains = system.gains
    return replace(system, gains=Gains(gains.w, zeta * gains.wd, gains.fit_errors, gains.edge_errors))


def adjoins(result: PeriodVerdicts, start: float) -> bool:
    """Whether the intervals have no gap, increase, and hold the start."""
    whole = (result.high[:-1] == result.low[1:]).all() and (result.low < result.high).all()
    return bool(whole and result.low[0] <= start <= result.high[-1])


def nearest_of_closed_form(radius, zeta: float, start: float, ends: tuple[float, float]) -> float:
    """Distance in 1/T of the nearest unstable period, by 20001 periods and bisection."""
    T = np.sort(np.append(np.geomspace(*ends, 20_001), start))
    unstable = radius(T, np.full(T.size, zeta)) > 1.0
    if unstable[np.searchsorted(T, start)]:
        return 0.0
    distance = np.inf
    for k in np.flatnonzero(unstable[1:] != unstable[:-1]):
        low, high = T[k], T[k + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            same = (radius(np.array([middle]), np.array([zeta]))[0] > 1.0) == unstable[k]
            low, high = (middle, high) if same else (low, middle)
        distance = min(distance, abs(1.0 / low - 1.0 / start))
    return distance


@pytest.mark.parametrize("case", [meissner, mathieu])
@pytest.mark.parametrize(("zeta", "start"), [(0.004, 9.6), (0.02, 7.7), (0.001, 13.9)])
def test_the_nearest_unstable_period_is_that_of_the_closed_form(case, zeta: float, start: float) -> None:
    system, radius = case()
    ends = (1.2, 30.0)
    result = proven_periods(OneSystem(damped(system, zeta)), ends, start, np.inf, PLENTY)
    assert adjoins(result, start)
    distance = np.maximum(np.maximum(1.0 / result.high - 1.0 / start, 1.0 / start - 1.0 / result.low), 0.0)
    nearest = distance[result.verdict < 0].min()
    expected = nearest_of_closed_form(radius, zeta, start, ends)
    # The interval at the edge is as narrow as 1e-7 of its period.
    assert expected - 1e-12 <= nearest <= expected + 4e-7 / start
    rng = np.random.default_rng(3)
    for share in rng.beta(0.5, 0.5, (4, result.low.size)):
        T = result.low + share * (result.high - result.low)
        exact = radius(T, np.full(T.size, zeta))
        assert ((exact < 1.0) == (result.verdict > 0))[result.verdict != 0].all()
    undecided = result.verdict == 0
    undecided &= distance < nearest
    assert (result.high - result.low)[undecided].sum() < 1e-5


def test_a_zone_far_narrower_than_the_steps_of_a_grid_is_met() -> None:
    """Meissner's zone next below the tip of its tongue: some 1e-4 of the period wide."""
    system, radius = meissner()
    T = np.linspace(9.65, 9.85, 20_001)
    zeta_of = lambda z: radius(T, np.full(T.size, z)).max()  # noqa: E731
    low, high = 0.0, 0.2
    for _ in range(26):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if zeta_of(middle) > 1.0 else (low, middle)
    zeta = low - 2e-8
    unstable = T[radius(T, np.full(T.size, zeta)) > 1.0]
    width = np.ptp(unstable)
    assert 0.0 < width < 5e-3
    assert not (radius(np.linspace(8.6, 10.4, 181), np.full(181, zeta)) > 1.0).any()
    result = proven_periods(OneSystem(damped(system, zeta)), (8.6, 10.4), 8.7, np.inf, PLENTY)
    met = result.low[result.verdict < 0]
    assert unstable.min() - 1e-4 < met.min() < unstable.max() + 1e-4


def test_slow_periods_and_a_spent_effort_end_the_search() -> None:
    system, _ = meissner()
    strong = damped(system, 0.2)
    slow = slow_period(strong, np.ones(2), np.empty((2, 0)))
    result = proven_periods(OneSystem(strong), (1.0, 50.0), 2.0, slow, PLENTY)
    assert (result.low[0], result.high[-1]) == (1.0, 50.0)
    assert (result.verdict == 1).all()
    short = proven_periods(OneSystem(damped(system, 0.004)), (1.0, 50.0), 9.6, np.inf, Effort(1e5, 1000, 2))
    assert adjoins(short, 9.6)
    assert short.low[0] > 1.0
    assert short.high[-1] < 50.0


def test_no_system_or_a_system_that_is_on_the_circle_ends_a_side() -> None:
    class Nothing(OneSystem):
        def __call__(self, shortest: float, longest: float):
            return None if longest > 9.7 else self.patch

    system, _ = meissner()
    result = proven_periods(Nothing(damped(system, 0.2)), (1.0, 50.0), 9.6, np.inf, PLENTY)
    assert result.high[-1] <= 9.7
    undamped = proven_periods(OneSystem(damped(system, 0.0)), (9.6, 9.7), 9.65, np.inf, PLENTY)
    assert not (undamped.verdict > 0).any()


@pytest.mark.parametrize("where", [0.05, 0.3, 0.77])
@pytest.mark.parametrize("part", ["w", "wd"])
def test_gains_that_deviate_change_the_matrix_by_no_more_than_the_bound(where: float, part: str) -> None:
    """A short bump of the gains anywhere in the cycle, over a narrow and over a wide patch."""
    system, _ = meissner()
    system = damped(system, 0.01)
    bump = 2e-3
    phases = np.sort(np.append(system.phases, [where, where + 0.01]))
    middle = 0.5 * (phases[1:] + phases[:-1])
    piece = np.searchsorted(system.phases, middle) - 1
    height = np.where((middle > where) & (middle < where + 0.01), bump / 0.01, 0.0)[:, None, None]
    w = system.gains.w[piece] + (height if part == "w" else 0.0)
    wd = system.gains.wd[piece] + (height if part == "wd" else 0.0)
    changed = replace(system, phases=phases, gains=Gains(w, wd, np.zeros((phases.size - 1, 2)), None),
                      mean=system.mean_of(system.gains.w))  # fmt: skip
    deviation = GainDeviation(bump, 0.0) if part == "w" else GainDeviation(0.0, bump)
    for ends in (np.array([9.0, 9.0001]), np.array([9.0, 9.6])):
        patch, exact = (
            FlowPolynomial.of(
                system, packed(system), ends, np.ones(2), no_factors, NodeCounts(24, 1), deviation=one
            )
            for one in (deviation, None)
        )
        T = np.linspace(*ends, 7)
        apart = np.linalg.norm(
            fast_monodromies(changed, T).matrices - fast_monodromies(system, T).matrices, 2, axis=(1, 2)
        ).max()
        bound = patch.error - exact.error
        assert apart <= bound
        if ends[1] < 9.1:
            assert apart > bound / 40.0
    slow = [slow_period(system, np.ones(2), np.empty((2, 0)), one) for one in (None, deviation)]
    assert slow[0] < slow[1]


@pytest.mark.parametrize(
    ("T", "damping"), [((2.0, 12.0), (-0.9, -0.4)), ((6.0, 6.1), (0.01, 0.3)), ((6.0, 6.1), (0.2, 0.2))]
)
def test_flows_in_a_patch_are_bounded_and_hardly_more_than_they_are(T, damping) -> None:
    """With negative damping they grow to the corner of the patch; with damping they stay near one."""
    system, _ = meissner()
    problem = packed(system)
    ends, ratios = np.array(T), np.array(damping)
    size = PatchSize(problem, growth_at(problem, PatchSize(problem, 1.0), at(ends.mean(), ratios.mean())))
    no_change = np.zeros((1, 40))
    bound = _flow_in_patch(problem, size, at(ends.mean(), ratios.mean()), ends, ratios, no_change)
    largest = max(
        largest_flow(problem, at(period, zeta), Limits(1e-12, 0.5))[0]
        for period in np.linspace(*ends, 5)
        for zeta in np.linspace(*ratios, 7)
    )
    assert largest <= bound
    assert bound < 3.0 * largest or ratios[0] < 0.0
    if ratios[1] > ratios[0] > 0.0:  # Gronwall from the middle alone
        assert size.flow(ends, ratios, no_change, size.growth) > 5.0 * bound


def at(period: float, zeta: float) -> Point:
    """A point of a system without varied gains."""
    return Point(np.ones(1), float(zeta), float(period))


def test_a_patch_is_narrowed_where_its_gains_deviate_more_than_at_its_front() -> None:
    """Beyond 9.7 the gains deviate by so much that a wide patch would decide nothing."""
    system, _ = meissner()
    near, far = (OneSystem(damped(system, 0.1), GainDeviation(w, 0.0)).patch for w in (0.0, 5e-2))

    class Changing(OneSystem):
        def __call__(self, shortest: float, longest: float):
            return near if longest <= 9.7 else far

    result = proven_periods(Changing(damped(system, 0.1)), (9.6, 20.0), 9.61, np.inf, PLENTY)
    assert result.high[result.verdict > 0].max() > 9.6 + 0.5 * (9.7 - 9.6)
