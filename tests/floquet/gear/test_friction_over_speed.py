"""Is one fit with factors on its friction the law at every speed, and refitted where it is not?"""

import numpy as np
import pytest

from floquet import gear_block, stability_chart
from floquet.gear.axes import GearVariation, friction_families, vary
from floquet.gear.multipliers import feedback_system, fitted_block
from lumped import load_gear_pair
from lumped.errors import LawRangeWarning
from lumped.friction import LAWS, base
from lumped.friction.average_coefficient import mean_of_law_two
from lumped.path_of_contact.friction import contact_path, friction_path_function
from tests.evidence.floquet.extended import as_periodic_system
from tests.unlike_pairs import UNLIKE, unlike_pair

SPEEDS = np.array([500.0, 1300.0, 2000.0, 2030.0, 6000.0, 9000.0, 20000.0])


def with_law(law: str, **changes: object) -> GearVariation:
    """Of a pair whose gears and finishes differ."""
    pair = unlike_pair("heavily_relieved_under_load")
    one = {"friction.law": law, "friction.coefficient": None, "friction.sharpness": None}
    return GearVariation(pair.with_(one | {"mesh.contact": "prescribed"} | changes), supports="springs")


#: Laws whose value goes with the speed, each on its own pair and on one that has another path of contact.
WITH_LAW = {
    "contact_ratio_1_1_large_shifts": ("coulomb", "xu_kahraman"),
    "contact_ratio_2_3_on_shafts": ("xu_kahraman", "composite"),
    "heavily_relieved_under_load": ("composite",),
    "larger_gear_drives_contact_lost": ("smoothed_coulomb", "benedict_kelley"),
    "rack_25_degrees_always_pushing": ("benedict_kelley", "composite"),
    "unlike_teeth_finite_elements": ("iso_14179", "xu_kahraman"),
}


@pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")  # law II at 20000 rpm
@pytest.mark.parametrize(("name", "law"), [(name, law) for name, laws in WITH_LAW.items() for law in laws])
def test_families_give_the_law_of_every_speed(name: str, law: str) -> None:
    pair = unlike_pair(name).healthy
    variation = GearVariation(pair.with_(mesh__contact="prescribed", friction__law=law), supports="springs")
    families = friction_families(variation, SPEEDS)
    seen = np.concatenate([family.members for family in families])
    assert sorted(seen) == list(range(SPEEDS.size))  # every speed once
    for family in families:
        reference = friction_path_function(vary(variation.pair, {"speed_rpm": family.speed_rpm}).pair)
        low, high = reference.interval
        xi = np.linspace(low, high, 300)[1:-1]  # none at the pitch point of equal gears
        sign = np.sign(xi - _pitch(variation))
        for member, factors in zip(family.members, family.factors, strict=True):
            fitted = friction_path_function(vary(variation.pair, {"speed_rpm": float(SPEEDS[member])}).pair)
            if family.level is None:
                ours = factors[0] * reference(xi)
            else:
                ours = factors[0] * (reference(xi) - family.level * sign) + factors[1] * family.level * sign
            # Both are fits within 1e-10 of the law; the factors are below 5.
            assert np.abs(ours - fitted(xi)).max() < 1e-9


#: Pairs with laws whose mean coefficient is that of law II. The bounds of law II move at low speeds, with the
#: rack at all speeds, where they are far from the pitch point.
MEANS = [
    ("heavily_relieved_under_load", "smoothed_coulomb"), ("unlike_teeth_finite_elements", "coulomb"),
    ("rack_25_degrees_always_pushing", "smoothed_coulomb"),
]  # fmt: skip


@pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")
@pytest.mark.parametrize(("name", "law"), MEANS)
def test_the_mean_coefficient_is_a_line_in_the_logarithm_of_speed_within_a_group(name: str, law: str) -> None:
    """Between the speeds of a group too. Law II (docs/theory/friction.md) is linear in log10 of the speed."""
    changes = {"friction.law": law, "friction.coefficient": None, "friction.sharpness": None}
    variation = GearVariation.of(unlike_pair(name).healthy.with_(changes), supports="springs")
    speeds = np.linspace(500.0, 20000.0, 101)
    (family,) = friction_families(variation, speeds)
    groups = family.smooth_groups(speeds)
    path = contact_path(variation.pair)

    def bend(rpm: np.ndarray) -> float:
        """Largest distance of the mean from a line through both ends, over the mean."""
        mean = [mean_of_law_two(path.at_speed(n * np.pi / 30.0), variation.pair.friction) for n in rpm]
        line = np.interp(np.log(rpm), np.log(rpm[[0, -1]]), [mean[0], mean[-1]])
        return float(np.abs(line / mean - 1.0).max())

    assert (np.diff(groups) >= 0).all()
    for group in range(groups.max() + 1):
        ends = speeds[groups == group][[0, -1]]
        assert bend(np.geomspace(*ends, 40)) < 1e-8  # fits of law II are within 1e-10 of mu above 0.01
    slowest = speeds[groups == groups.max()][0]
    assert bend(np.geomspace(speeds[0], slowest, 40)) > 1e-7
    assert groups.max() < 0.4 * speeds.size or name.startswith("rack")


#: Pairs, laws and speeds at which breaks move: bounds of law II in its mean or itself, regimes of law V.
MOVING = [
    ("heavily_relieved_under_load", "smoothed_coulomb", (900.0, 2500.0)),
    ("rack_25_degrees_always_pushing", "benedict_kelley", (5000.0, 5300.0)),
    ("fzg_c", "composite", (5000.0, 5400.0)),
]


@pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")
@pytest.mark.parametrize(("name", "law", "ends"), MOVING)
def test_cells_are_proven_where_breaks_of_friction_move(
    name: str, law: str, ends: tuple[float, float]
) -> None:
    """A proven cell has the verdict of the full grid at random points in it."""
    changes = {"friction.law": law, "friction.coefficient": None, "friction.sharpness": None}
    pair = (unlike_pair(name) if name in UNLIKE else load_gear_pair(name)).healthy.with_(changes)
    speeds = np.linspace(*ends, 9)
    axes = {"speed_rpm": speeds, "damping_ratio": np.linspace(0.01, 0.06, 4)}
    chart = stability_chart(pair, axes, rtol=1e-8, prove=True, supports="springs")
    cells = chart.cell_verdict.to_numpy()
    families = friction_families(GearVariation.of(pair, "springs"), speeds)
    moves = np.ones(speeds.size - 1, dtype=bool)
    for family in families:
        for group in range(int(family.smooth_groups(speeds[family.members]).max()) + 1):
            of_group = family.members[family.smooth_groups(speeds[family.members]) == group]
            moves[of_group[:-1][np.diff(of_group) == 1]] = False
    assert moves.any()
    assert (cells[moves] != 0).mean() > 0.9
    rng = np.random.default_rng(2)
    rows = np.flatnonzero((cells != 0).any(axis=1))
    points = {
        "speed_rpm": speeds[rows] + rng.uniform(size=rows.size) * np.diff(speeds)[rows],
        "damping_ratio": axes["damping_ratio"][:-1] + rng.uniform(0.0, np.diff(axes["damping_ratio"])),
    }
    full = stability_chart(pair, points, rtol=1e-8, refine=False, supports="springs")
    proven = cells[rows] != 0
    assert (full.verdict.to_numpy() == cells[rows])[proven].all()


def _pitch(variation: GearVariation) -> float:
    return float(variation.cycle().geometry.L_XP)


def test_factors_follow_the_equations() -> None:
    # Law III goes with the entraining velocity to the power b6 = -0.100601 (equation 18). In law II speed is
    # inside a logarithm only, to the power -3 (equation 14).
    variation = with_law("xu_kahraman")
    (family,) = friction_families(variation, SPEEDS)
    assert family.factors[:, 0] == pytest.approx((SPEEDS / family.speed_rpm) ** -0.100601, rel=1e-11)
    # Of a light load, where the bound of law II is nowhere in force at these speeds.
    light = load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed", friction__law="benedict_kelley")
    (family,) = friction_families(GearVariation(light, supports="springs"), SPEEDS)
    assert family.factors[:, 0] == pytest.approx(1.0, rel=1e-12)
    slope = np.diff(family.factors[:, 1] * family.level) / np.diff(np.log10(SPEEDS))
    roughness = 0.5e6 * (light.pinion.roughness + light.gear.roughness)
    assert slope == pytest.approx(-3.0 * 0.0127 * 1.13 / (1.13 - roughness), rel=1e-9)


def test_moving_regimes_are_fitted_apart() -> None:
    # At some speeds a limit of the film parameter falls inside the path: there law V changes.
    variation = with_law("composite")
    speeds = np.linspace(500.0, 20000.0, 60)
    families = friction_families(variation, speeds)
    sizes = sorted(family.members.size for family in families)
    assert sizes[-1] > 30  # full film
    assert sizes[0] == 1  # a switch on the path
    for family in families:
        if family.members.size > 1:
            # No family joins speeds on either side of another one's.
            inside = (speeds >= speeds[family.members].min()) & (speeds <= speeds[family.members].max())
            assert inside.sum() == family.members.size


@pytest.mark.parametrize("name", UNLIKE)
def test_charts_are_proven_and_share_the_polynomials_of_single_speeds(name) -> None:
    """Law III goes with n^-0.100601: a chart has the very polynomials of each speed, times a factor."""
    pair = unlike_pair(name).healthy.with_(friction__law="xu_kahraman", friction__coefficient=None)
    chart = stability_chart(pair, {"speed_rpm": SPEEDS[:-1], "damping_ratio": [0.0, 0.03]})
    assert chart.certificate == "proven"
    for speed in SPEEDS[[0, 3, 4]]:
        there = friction_path_function(pair.with_(operating__pinion_speed=float(speed)))
        (family,) = friction_families(GearVariation(pair, supports="springs"), SPEEDS)
        mu_at_speed = friction_path_function(vary(pair, {"speed_rpm": family.speed_rpm}).pair)
        factor = family.factors[speed == SPEEDS, 0].item()
        np.testing.assert_array_equal(there.breaks, mu_at_speed.breaks)
        np.testing.assert_allclose(
            there.coefficients, factor * mu_at_speed.coefficients, rtol=2e-15, atol=0.0
        )


@pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")  # of some of these laws
@pytest.mark.parametrize("law", sorted(set(LAWS) - {"none"}))
def test_charts_over_speed_rest_on_formulas_and_are_proven(law) -> None:
    """Factor or shift of a law are those of mu at any position where no bound is in force."""
    pair = load_gear_pair("fzg_c").with_(friction__law=law)
    assert stability_chart(pair, {"speed_rpm": [2000.0, 2100.0]}).certificate == "proven"
    path = contact_path(pair)
    record = LAWS[law]
    xi = np.linspace(path.L_XA, path.L_XD, 40)
    slow, fast = (path.at_speed(omega) for omega in (30.0, 60.0))
    mu, before = (record.signed(xi, contact, pair.friction) for contact in (fast, slow))
    if record.factor is not None:
        ratio = record.factor(fast, pair.friction) / record.factor(slow, pair.friction)
        np.testing.assert_allclose(mu, ratio * before, rtol=1e-13)
    elif record.shift is not None:
        rise = record.shift(fast, pair.friction) - record.shift(slow, pair.friction)
        np.testing.assert_allclose(np.abs(mu) - np.abs(before), rise, rtol=1e-11)


@pytest.mark.parametrize("law", ["xu_kahraman", "smoothed_coulomb"])
def test_the_error_of_the_polynomials_is_in_the_bound(law, monkeypatch) -> None:
    """Polynomials that err by 1e-4 move the multipliers by more than all other errors together."""
    pair = with_law(law, **{"mesh.damping_ratio": 0.01}).pair
    axes = {"friction_coefficient": [0.02, 0.06]}
    fine = stability_chart(pair, axes)
    monkeypatch.setattr(base, "FIT_TOLERANCE", 1e-4)  # of a load that no cache knows
    other = pair.with_(operating__pinion_torque=pair.operating.pinion_torque * (1.0 + 1e-13))
    coarse = stability_chart(other, axes)
    difference = np.abs(fine.spectral_radius - coarse.spectral_radius)
    assert (difference > 5.0 * fine.error).all()
    assert (difference <= fine.error + coarse.error).all()


def test_level_apart_changes_nothing() -> None:
    variation = with_law("benedict_kelley")
    one_part = gear_block(variation)
    apart = fitted_block(feedback_system(variation), 1.0, 1e-11, [0.0, 0.04])
    assert len(apart.parts) == 3
    t = np.linspace(0.01, 0.99, 50) * one_part.period
    one, other = (as_periodic_system(block).evaluate(t) for block in (one_part, apart))
    assert np.abs(one - other).max() <= 1e-10 * np.abs(one).max()


@pytest.mark.parametrize("far", [0.5, 2.0])
def test_a_table_of_one_speed_is_told_at_either_end_of_the_speeds(far):
    """The table was made at 1000 rpm; more than 5 % away it says so, below as above."""
    g = unlike_pair("rack_25_degrees_always_pushing").geometry
    xi = np.linspace(g.L_XA, g.L_XD, 9)
    table = {
        "axis": "position_mm", "points": (1e3 * xi).tolist(), "speed": 1000.0,
        "coefficient": [0.05] * 9,
    }  # fmt: skip
    pair = unlike_pair("rack_25_degrees_always_pushing").with_(friction={"law": "table", "table": table})
    variation = GearVariation(pair.with_(speed=1000.0), supports="springs")
    with pytest.warns(LawRangeWarning, match="speed"):
        friction_families(variation, np.array([1000.0, 1000.0 * far]))
