"""Are the multipliers of the gear pair those of its equations of motion, with the rotation kept apart?"""

from itertools import pairwise

import numpy as np
import pytest

from floquet import gear_pair_multipliers, gear_pair_system, monodromy, stability_chart
from floquet.gear.axes import GEAR_AXES, GearVariation, vary
from floquet.gear.multipliers import OffLineOfAction, feedback_system
from lumped import GearPair, geometry, load_gear_pair, periodic_system
from lumped.errors import ParameterError
from lumped.model.averaged import averaged_matrix
from lumped.model.equations import X_P, Y_P
from lumped.model.mesh_cycle import mesh_cycle
from tests.unlike_pairs import UNLIKE, unlike_pair

#: State of the system in the form "mesh": elongation of the mesh and places of both gears, then the rates.
Q, _, _, DQ, DX_P, _ = range(6)

LAWS = ["none", "coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb", "composite"]
LIKE_TEETH = [name for name in UNLIKE if unlike_pair(name).healthy is unlike_pair(name)]


@pytest.fixture(scope="module")
def pair():
    """Rectangular stiffness, rack of 25 degrees, unequal gears and bearings."""
    return unlike_pair("rack_25_degrees_always_pushing").with_(mesh__contact="prescribed")


def unmatched(computed: np.ndarray, reference: np.ndarray) -> float:
    """Largest distance when every multiplier is paired with a partner of the other set."""
    remaining = list(reference)
    worst = 0.0
    for value in computed:
        nearest = int(np.argmin([abs(value - other) for other in remaining]))
        worst = max(worst, abs(value - remaining.pop(nearest)))
    return worst


@pytest.mark.parametrize("name", LIKE_TEETH)
def test_block_and_closed_form_equal_the_ten_states(name: str) -> None:
    """Each pair has a law, a stiffness model and four bearings of its own."""
    one = unlike_pair(name)
    parts = gear_pair_multipliers(one, supports="springs")
    ten_states = monodromy(gear_pair_system(one, "elastic", supports="springs"))
    assert parts.multipliers.shape == (10,)
    # 1e-8: both runs at rtol 1e-10; where bearings make two multipliers coincide, rounding is magnified.
    assert unmatched(parts.multipliers, ten_states.multipliers) < 1e-8
    assert abs(parts.spectral_radius - ten_states.spectral_radius) <= parts.error + ten_states.error
    assert parts.verdict == ten_states.verdict
    # Both sides of Liouville's formula are 0.01 and less; each is right to some roundings.
    assert parts.liouville_residual < 1e-14


def test_low_speeds_are_proven_too(pair) -> None:
    """All but the slowest decay of a bearing have died away after a mesh cycle at 5 rpm."""
    multipliers = gear_pair_multipliers(pair.with_(operating__pinion_speed=5))
    assert (multipliers.certificate, multipliers.verdict) == ("proven", "stable")
    assert multipliers.spectral_radius + multipliers.error < 1e-50
    with pytest.raises(ParameterError, match="rtol"):
        gear_pair_multipliers(pair, 1e-14)


@pytest.mark.parametrize("factor", [0.0, 0.5, 1.0, 1.7])
def test_stiffness_variation_keeps_the_mean(pair, factor: float) -> None:
    system = periodic_system(pair, "mesh")
    edges = system.cycle.edges
    times = np.concatenate([a + (b - a) * (np.arange(400) + 0.5) / 400 for a, b in pairwise(edges)])
    weights = np.repeat(np.diff(edges) / 400, 400)
    varied = GearVariation(pair, stiffness_variation=factor, supports="springs")
    total = -gear_pair_system(varied, "mesh").evaluate(times)
    # Row of x_p: m_p x_p'' = -sum N_i, so the q column holds k(t)/m_p whatever the friction.
    k = total[:, DX_P, Q] * system.structure.mass[X_P]
    mean = system.cycle.mean_stiffness
    assert weights @ k / system.period == pytest.approx(mean, rel=1e-12)  # piecewise constant: rounding only
    ratio = 2.0  # double against single contact with the rectangular model
    full = np.ptp(k) / factor if factor else 0.0
    if factor:
        single = mean / geometry(pair).contact_ratio  # so many pairs on average
        assert full == pytest.approx((ratio - 1) * single, rel=1e-9)
    else:
        assert np.ptp(k) < 1e-9 * mean


def test_stiffness_variation_keeps_the_damping_law(pair) -> None:
    # c_i goes with sqrt(k_i): scaling every k_i by f scales every c_i by sqrt(f), in the same row of x_p.
    unvaried = gear_pair_system(pair, "mesh")
    varied = gear_pair_system(GearVariation(pair, stiffness_variation=0.4, supports="springs"), "mesh")
    times = np.array([0.1, 0.5, 0.9]) * unvaried.period
    before = unvaried.evaluate(times)[:, DX_P]
    after = varied.evaluate(times)[:, DX_P]
    f = after[:, Q] / before[:, Q]
    assert np.abs(f - 1.0).min() > 0.05
    assert np.allclose(after[:, DQ] / before[:, DQ], np.sqrt(f), rtol=1e-12)  # rounding


def test_friction_axis_sets_the_mean(pair) -> None:
    for law in LAWS:
        variation = vary(pair.with_(friction__law=law), {"friction_coefficient": 0.07})
        xi = np.linspace(*variation.cycle().elements.friction.interval, 20001)
        mean = np.abs(variation.cycle().elements.friction(xi)).mean()
        # 1 %: law IV rounds the sign change off within 1/Phi = 0.02 mm of the pitch point, on a 15 mm path;
        # the sum over 20001 points adds 1e-4.
        assert mean == pytest.approx(0.07, rel=0.01)


def test_contact_ratio_axis_moves_both_tips(pair) -> None:
    # Approach and recess grow alike, the centre distance stays; the path is contact ratio times base pitch.
    before = geometry(pair)
    for value in (1.2, 1.3, 1.45):
        varied = vary(
            load_gear_pair("fzg_c").with_(mesh__contact="prescribed"), {"contact_ratio": value}
        ).pair
        assert geometry(varied).contact_ratio == pytest.approx(value, rel=1e-12)
        after = geometry(vary(pair, {"contact_ratio": value}).pair)
        length = after.L_XD - after.L_XA
        assert length == pytest.approx(value * before.base_pitch, rel=1e-12)
        share = (after.L_XP - after.L_XA) / (after.L_XD - after.L_XA)
        assert share == pytest.approx((before.L_XP - before.L_XA) / (before.L_XD - before.L_XA), rel=1e-12)
        assert after.centre_distance == before.centre_distance
    with pytest.raises(ParameterError, match="tip_diameter"):
        vary(pair, {"contact_ratio": 2.5})


def test_every_axis_acts(pair) -> None:
    values = {
        "speed_rpm": [3000, 3100], "damping_ratio": [0.03, 0.04], "friction_coefficient": [0.05, 0.1],
        "torque": [50.0, 100.0], "stiffness_variation": [0.8, 1.0], "bearing_stiffness": [1e8, 2e8],
        "contact_ratio": [1.5, 1.6],
    }  # fmt: skip
    assert set(values) == set(GEAR_AXES)
    for name, pair_of_values in values.items():
        radius = stability_chart(pair, {name: pair_of_values}, rtol=1e-9).spectral_radius.values
        assert abs(np.diff(radius)).item() > 1e-7  # far above rtol


def with_table(points: int, factor: float) -> GearPair:
    """A constant table with one sample that stands out."""
    pair = unlike_pair("larger_gear_drives_contact_lost").with_(
        {"mesh.contact": "prescribed", "friction.law": "none", "mesh.damping_ratio": 0.02}
    )
    stiffness = np.full(points, 60e6)
    stiffness[int(0.437 * points)] *= factor
    table = {
        "model": "table", "axis": "phase", "stiffness": stiffness.tolist(),
        "points": np.linspace(0.0, pair.geometry.contact_ratio, points).tolist(),
    }  # fmt: skip
    return pair.with_({"mesh.stiffness": table})


def test_breaks_hold_every_knot_of_every_law() -> None:
    named = load_gear_pair("fzg_c").with_(mesh__contact="prescribed", friction__law="benedict_kelley")
    for pair in (with_table(1000, 3.0), named):
        cycle = mesh_cycle(pair)
        g = cycle.geometry
        e = cycle.elements
        for law in (e.stiffness, e.damping, e.friction, e.error):
            times = np.mod((law.breaks - g.L_XA) / g.base_pitch, 1.0) * cycle.period
            assert np.abs(times[:, None] - cycle.breaks).min(axis=1).max() <= 1e-13 * cycle.period
        assert np.isin(cycle.edges, cycle.breaks).all()
        assert set(cycle.breaks) - {0.0, cycle.period} == set(periodic_system(pair).breakpoints)


def test_the_average_of_a_table_is_exact() -> None:
    system = periodic_system(with_table(400, 50.0), "mesh")
    mean = system.cycle.elements.stiffness.mean() * system.cycle.geometry.contact_ratio
    direct = averaged_matrix(system)[3:, :3] - system.constant[3:, :3]
    per_stiffness = (system.structure.normal / system.structure.mass) @ system.reduction.T
    assert direct == pytest.approx(mean * np.outer(per_stiffness, system.deflection), rel=1e-12)


@pytest.mark.parametrize("ratio", [1.0, 1.0 - 1e-15, 1.0 + 1e-12, 0.3])
def test_bearings_at_critical_damping_are_within_their_bound(ratio: float) -> None:
    pair = unlike_pair("contact_ratio_1_1_large_shifts").with_(
        {"mesh.contact": "prescribed", "bearings.pinion.oloa_damping_ratio": min(ratio, 1.0)}
    )
    system = periodic_system(pair, "elastic")
    T = np.array([system.period])
    values, errors = OffLineOfAction.of(feedback_system(GearVariation(pair, supports="springs"))).multipliers(
        T
    )
    omega = np.sqrt(system.structure.stiffness[Y_P] / system.structure.mass[Y_P])
    zeta = min(ratio, 1.0)
    root = np.emath.sqrt(zeta**2 - 1.0)
    exact = np.exp(omega * system.period * np.array([-zeta + root, -zeta - root]))
    assert (np.abs(values[0, [0, 2]] - exact) <= errors[0, [0, 2]]).all()
    if ratio == 0.3:
        assert errors[0, [0, 2]].max() < 1e-14
