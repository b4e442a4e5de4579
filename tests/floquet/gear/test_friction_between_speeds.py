"""Is mu at every speed of an interval as near to the sum with factors as the bound says?"""

import numpy as np
import pytest

from floquet.gear.axes import GearVariation, LawOverSpeed
from floquet.gear.friction_between_speeds import FrictionBetweenSpeeds, SpeedPatch, clipped_lengths
from lumped import load_gear_pair
from lumped.friction.registry import LAWS
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


def positions(law: LawOverSpeed) -> tuple[np.ndarray, np.ndarray]:
    """Positions dense around the pitch point and everywhere, and the lengths that they stand for."""
    low, high = law.ends
    P = law.path.L_XP
    near = np.geomspace(1e-9, 1.0, 4000)
    edges = np.unique(
        np.concatenate([P - near * (P - low), P + near * (high - P), np.linspace(low, high, 4001)])
    )
    return 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)


def deviation(between: FrictionBetweenSpeeds, patch: SpeedPatch, rpm: float) -> float:
    """Integral of |mu - sum with factors| over the path at a speed, by the formulas of the laws."""
    law = between.law
    xi, length = positions(law)

    def mu(speed: float) -> np.ndarray:
        return law.law.signed(xi, *law.where_friction_acts(speed))

    factors = patch.factors(np.array([rpm]))[0]
    at_reference = mu(patch.reference)
    sign = np.sign(xi - law.path.L_XP)
    level = 0.0 if patch.level is None else patch.level
    model = factors[0] * (at_reference - level * sign) + (factors[-1] * level * sign if level else 0.0)
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
