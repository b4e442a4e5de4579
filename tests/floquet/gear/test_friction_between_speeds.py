"""Is mu at every speed of an interval as near to the sum with factors as the bound says?"""

import numpy as np
import pytest

from floquet import fast_multipliers
from floquet.engine.multipliers import multipliers_with_bounds
from floquet.gear.axes import GEAR_AXES, GearVariation, LawOverSpeed
from floquet.gear.cells_of_moving_friction import CellParts, CellsOfMovingFriction
from floquet.gear.friction_between_speeds import FrictionBetweenSpeeds, SpeedPatch, Speeds, clipped_lengths
from floquet.gear.multipliers import feedback_system, fitted_block
from floquet.gear.systems_between_speeds import SystemsBetweenSpeeds
from floquet.rank_one.batch import fast_monodromies
from floquet.rank_one.boxes import GainDeviation, PatchSize, growth_at
from floquet.rank_one.kernels.gains import Point
from floquet.rank_one.period_search import PatchSystem
from lumped import load_gear_pair
from lumped.friction.registry import LAWS
from tests.friction_factors import example_factor, with_factor
from tests.unlike_pairs import UNLIKE, unlike_pair

PAIRS = ("fzg_c", *(name for name in UNLIKE if "shafts" not in name))
NO_PARAMETERS = {
    "friction.coefficient": None,
    "friction.maximum": None,
    "friction.sharpness": None,
    "friction.thresholds": None,
}

pytestmark = pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")


def friction(name: str, law: str, **changes) -> FrictionBetweenSpeeds:
    pair = (unlike_pair(name) if name in UNLIKE else load_gear_pair(name)).healthy
    variation = GearVariation.of(pair.with_(NO_PARAMETERS | {"friction.law": law} | changes), "springs")
    return FrictionBetweenSpeeds(variation)


def positions(law: LawOverSpeed, *speeds: float) -> tuple[np.ndarray, np.ndarray]:
    """Positions dense around the pitch point and everywhere, and the lengths that they stand for.

    No length contains a switch of mu at some speeds.
    """
    low, high = law.ends
    P = law.path.L_XP
    near = np.geomspace(1e-9, 1.0, 4000)
    switches = np.concatenate([law.values(rpm)[1] for rpm in speeds])
    inside = switches[(low < switches) & (switches < high)]
    edges = np.unique(
        np.concatenate([P - near * (P - low), P + near * (high - P), np.linspace(low, high, 4001), inside])
    )
    return 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)


def deviation(between: FrictionBetweenSpeeds, patch: SpeedPatch, rpm: float) -> float:
    """Integral of |mu - sum with factors| over the path at a speed, by the formulas of the laws."""
    law = between.law
    xi, length = positions(law, rpm, patch.reference)

    def mu(speed: float) -> np.ndarray:
        return law.law.signed(xi, *law.where_friction_acts(speed))

    factors = patch.factors(np.array([rpm]))[0]
    at_reference = mu(patch.reference)
    sign = np.sign(xi - law.path.L_XP)
    level = (0.0 if patch.level is None else patch.level) * sign
    if patch.acts is not None:
        level = level * sum((low < xi) & (xi < high) for low, high in patch.acts)
    model = factors[0] * (at_reference - level) + factors[-1] * level
    return float((np.abs(mu(rpm) - model) * length).sum())


@pytest.mark.parametrize("law", [name for name in LAWS if name != "none"])
@pytest.mark.parametrize("name", PAIRS)
def test_no_speed_of_an_interval_deviates_more_than_the_bound(name: str, law: str) -> None:
    between = friction(name, law)
    rng = np.random.default_rng(8)
    for width in (0.002, 0.3, 2.0):
        low = between.reference * float(np.exp(rng.uniform(-1.5, 1.0)))
        high = low * (1.0 + width)
        patch = between.patch(low, high)
        if patch is None:
            assert law == "composite", "every other law has a bound at all speeds"
            continue
        worst = max(deviation(between, patch, float(rpm)) for rpm in rng.uniform(low, high, 6))
        # Fits of law II are within 1e-10 of mu.
        assert worst <= patch.deviation + 2e-10 * between.length
        ends = between.bounds(low, high)
        if ends is not None:
            factors = ends.factors(np.array([low, *np.linspace(low, high, 9), high]))
            between_ends = np.sort(factors[[0, -1]], axis=0)
            assert (factors >= between_ends[0] - 1e-9).all()
            assert (factors <= between_ends[1] + 1e-9).all()
            assert (
                max(deviation(between, ends, rpm) for rpm in (low, high))
                <= ends.deviation + 2e-10 * between.length
            )


@pytest.mark.parametrize("factor", [0.63, 1.7])
@pytest.mark.parametrize("law", ["coulomb", "benedict_kelley", "composite"])
def test_a_factor_on_mu_is_in_the_bounds(law: str, factor: float) -> None:
    """All of mu, its rise and its deviations are those without the factor, times the factor."""
    name = "heavily_relieved_under_load"
    with example_factor():
        plain, scaled = (
            FrictionBetweenSpeeds(
                GearVariation.of(
                    with_factor(unlike_pair(name).healthy, one, **NO_PARAMETERS | {"friction.law": law}),
                    "springs",
                )
            )
            for one in (1.0, factor)
        )
        low = 1.1 * plain.reference
        for high in (1.003 * low, 1.2 * low):
            one, other = (between.patch(low, high) for between in (plain, scaled))
            if one is None or other is None:
                assert one is other
                continue
            worst = max(deviation(scaled, other, float(rpm)) for rpm in np.linspace(low, high, 5))
            assert worst <= other.deviation + 2e-10 * scaled.length
            rpm = np.array([low, high])
            np.testing.assert_allclose(other.factors(rpm), one.factors(rpm), rtol=1e-6)
            fits = 2e-9 * scaled.length  # errors of fits are absolute
            assert other.deviation == pytest.approx(factor * one.deviation, rel=1e-3, abs=fits)


def test_bounds_are_small_where_little_of_the_path_is_clipped_and_near_the_truth_where_much_is() -> None:
    exact = friction("fzg_c", "benedict_kelley").patch(1000.0, 1400.0)
    assert exact.deviation < 1e-6 * 0.05 * 0.02
    clipped = friction("fzg_c", "benedict_kelley", **{"friction.maximum": 0.065})
    assert sum(clipped_lengths(clipped.law, clipped.reference)) > 0.05 * clipped.length
    low, high = clipped.reference * 1.2, clipped.reference * 1.205
    patch = clipped.patch(low, high)
    worst = max(deviation(clipped, patch, rpm) for rpm in (low, high))
    assert 0.05 * patch.deviation < worst <= patch.deviation


def test_regimes_that_move_are_in_the_bound() -> None:
    """Law V with several regimes: between the speeds of an interval a part of the path changes its law."""
    between = friction("heavily_relieved_under_load", "composite")
    mixed = [
        rpm
        for rpm in np.geomspace(0.1, 3.0, 25) * between.reference
        if between.law.in_force(float(rpm)) is None
    ]
    assert mixed
    for rpm in mixed[::4]:
        patch = between.patch(float(rpm), 1.004 * float(rpm))
        worst = max(deviation(between, patch, float(one)) for one in np.linspace(rpm, 1.004 * rpm, 5))
        assert 0.01 * patch.deviation < worst <= patch.deviation


def mixed_speeds(between: FrictionBetweenSpeeds) -> list[float]:
    """Speeds at which several laws are in force."""
    speeds = np.geomspace(0.05, 20.0, 60) * between.reference
    return [rpm for rpm in speeds.tolist() if between.law.in_force(rpm) is None]


def speeds_of_one_law(between: FrictionBetweenSpeeds) -> list[float]:
    """Slowest and fastest speed of law IV, law II and law III, each in force everywhere, if there are any."""
    speeds = np.geomspace(0.05, 20.0, 60) * between.reference
    laws = [between.law.in_force(rpm) for rpm in speeds.tolist()]
    parts = [LAWS[name] for name in ("smoothed_coulomb", "benedict_kelley", "xu_kahraman")]
    of_each = [[rpm for rpm, law in zip(speeds.tolist(), laws, strict=True) if law is one] for one in parts]
    return [rpm for of_law in of_each for rpm in (*of_law[:1], *of_law[-1:])]


@pytest.mark.parametrize(("name", "maximum"), [*((name, None) for name in PAIRS), ("fzg_c", 0.06)])
def test_the_rise_of_law_two_is_in_the_factors_where_laws_are_mixed(name: str, maximum: float | None) -> None:
    """What is left is less than half of what mu changes by, but where regimes move fast along the path.

    With a low maximum of law II its bound moves along the path, too.
    """
    between = friction(name, "composite", **{"friction.maximum": maximum})
    speeds = mixed_speeds(between)
    rng = np.random.default_rng(3)
    shares = []
    for low in speeds[:: max(1, len(speeds) // 8)] + speeds_of_one_law(between):
        for width in (0.004, 0.02, 0.1):
            patch = between.bounded_change(Speeds(low, low * (1.0 + width)))
            if patch is None:
                continue
            rpm = [low, *rng.uniform(low, low * (1.0 + width), 4).tolist(), low * (1.0 + width)]
            worst = max(deviation(between, patch, one) for one in rpm)
            assert worst <= patch.deviation
            plain = SpeedPatch(patch.reference, None, lambda n: np.ones((n.size, 1)), 0.0)
            if patch.acts:
                shares.append(patch.deviation / max(deviation(between, plain, one) for one in rpm))
    assert len(speeds) < 5 or min(shares) < 0.5


def test_a_place_that_passes_through_three_laws_between_two_speeds_has_no_bound() -> None:
    """With thresholds next to each other: within 1 % of speed the film parameter passes both."""
    between = friction("fzg_c", "composite", **{"friction.thresholds": [1.0, 1.001, 3.0]})
    mixed = mixed_speeds(between)
    if not mixed:
        low = next(
            rpm for rpm in np.geomspace(0.05, 20.0, 4000) * between.reference
            if between.law.in_force(float(rpm)) is not between.law.in_force(float(1.01 * rpm))
        )  # fmt: skip
        mixed = [float(low)]
    assert any(between.bounded_change(Speeds(rpm, 1.02 * rpm)) is None for rpm in mixed)


@pytest.mark.parametrize("name", ["fzg_c", "heavily_relieved_under_load"])
def test_the_system_between_speeds_has_the_multipliers_of_each_speed(name: str) -> None:
    """One fit, its factors and its deviation against the fit at the speed itself, laws mixed."""
    pair = (unlike_pair(name) if name in UNLIKE else load_gear_pair(name)).healthy
    variation = GearVariation.of(pair.with_(NO_PARAMETERS | {"friction.law": "composite"}), "springs")
    systems = SystemsBetweenSpeeds(variation)
    speeds = mixed_speeds(systems.friction)
    for low in speeds[:: max(1, len(speeds) // 3)]:
        high = 1.003 * low
        patch = systems.friction.bounded_change(Speeds(low, high))
        assert patch is not None
        one = systems.of(patch)
        for rpm in (low, high):
            T = np.array([systems.period_times_rpm / rpm])
            flow = fast_monodromies(one.system, T, gain_factors=one.factors(T))
            size = PatchSize(one.problem, growth_at(one.problem, PatchSize(one.problem, 1.0), point(one, T)))
            error = size.deviation(
                np.append(T, T), np.ones(2), np.zeros((len(one.system.parts), 1)), one.deviation
            )
            values, bounds = multipliers_with_bounds(flow.matrices[0], float(flow.errors[0]) + error)
            exact = fast_multipliers(
                fitted_block(feedback_system(GEAR_AXES["speed_rpm"].apply(variation, rpm)), 1.0, 1e-12, [])
            )
            distance = np.abs(values[:, None] - exact.multipliers[0]).min(axis=0)
            assert (distance <= bounds.max() + exact.errors[0]).all()
            assert distance.max() > 1e-3 * bounds.min()


def test_cells_are_proven_for_gains_that_deviate_and_not_for_gains_that_deviate_without_a_limit() -> None:
    variation = GearVariation.of(
        load_gear_pair("fzg_c").healthy.with_(NO_PARAMETERS | {"friction.law": "composite"}), "springs"
    )
    cells = CellsOfMovingFriction(variation, np.linspace(0.5, 1.0, 3), CellParts(1, 1))
    speeds = np.array([5300.0, 5310.0])
    systems = cells.systems(None, 5300.0)
    patch = systems.friction.bounded_change(Speeds(*speeds.tolist()))
    assert patch is not None
    one = systems.of(patch)
    assert (cells.proven(systems, one, speeds) == 1).all()
    without_limit = one._replace(deviation=GainDeviation(1e12, 1e12))
    assert not cells.proven(systems, without_limit, speeds).any()


def point(one: PatchSystem, T: np.ndarray) -> Point:
    """The point of a patch at a period."""
    return Point(np.append(1.0, one.factors(T)[0]), 1.0, float(T[0]))
