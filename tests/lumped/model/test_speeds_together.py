"""Are motions at several speeds, computed together, those of each speed alone?"""

import numpy as np
import pytest

from lumped.errors import NumericalError
from lumped.model.period_closure import BRAKE_TORQUE, MORE_PINION_TORQUE
from lumped.model.periodic_system import LTVSystem
from lumped.model.propagation import fastest_frequencies, fastest_frequency
from lumped.model.speeds_together import goes_with
from lumped.model.steady import periodic_solution, sample_times, solutions_over_speed
from lumped.model.sweep import systems_over_speed
from tests.unlike_pairs import unlike_pair

#: Shares of the operating speed: slow speeds have many steps, fast ones few.
SHARES = np.array([0.2, 0.55, 1.0, 1.7])
SAMPLES = 24
#: Brake torque and spectral radius, relative.
TOLERANCE = 1e-11
EPSILON = np.finfo(np.float64).eps


def systems_of(pair, shares=SHARES):
    rpm = pair.operating.pinion_speed * 30.0 / np.pi
    return list(systems_over_speed([pair.at_speed(rpm * share) for share in shares], "springs", warn=False))


def over_sizes(solution, sizes, weights):
    """Map over the cycle (n, n) and states by each weighted forcing (n, 3), over the sizes (n,) of states."""
    phi, forced = solution.over_cycle
    return phi * sizes / sizes[:, None], forced * weights / sizes[:, None]


def closing_gain(system, sizes, phi, forced):
    """Largest state at the start by a mismatch of 1 at the end of the cycle, maps as of ``over_sizes``.

    The equations are those of ``balanced_start``: x = phi x + forced, with a torque as the last unknown and
    no common rotation at the start.
    """
    n = system.size
    unknown = BRAKE_TORQUE if system.pair.operating.brake_torque == "balanced" else MORE_PINION_TORQUE
    common = system.supports.common_weights * sizes[: n // 2]
    matrix = np.zeros((n + 1, n + 1))
    matrix[:n, :n] = np.eye(n) - phi
    matrix[:n, n] = -forced[:, unknown]
    matrix[n, : n // 2] = common / np.abs(common).max()
    return np.linalg.norm(np.linalg.inv(matrix)[:n, :n], np.inf)


def assert_each_is_its_own(systems):
    """Motions differ by no more than rounding can make of them.

    Each of k steps rounds what it carries by the machine epsilon: the motion from the start and that by each
    torque. Each torque alone moves the gears up to a thousand times as far as both do, which balance. So the
    maps differ by k epsilon times the largest of these, and the closed motion by this times the inverse of
    the closing equations. Times on the clock of one speed and back add rounding of the same size.
    """
    together = list(solutions_over_speed(systems, SAMPLES))
    assert len(together) == len(systems)
    for system, one in zip(systems, together, strict=True):
        alone = periodic_solution(system, sample_times(system.period, SAMPLES), estimate_error=False)
        assert one.system is system
        np.testing.assert_array_equal(one.time, alone.time)
        sizes = np.abs(alone.cycle_states).max(axis=0)
        sizes[sizes == 0.0] = 1.0  # nothing moves across the line of action without friction
        start = np.abs(alone.cycle_states[0] / sizes)
        phi, forced = over_sizes(alone, sizes, alone.weights)
        carried = np.abs(phi) @ start + np.abs(forced).sum(axis=1)
        rounding = (alone.cycle_time.size - 1) * EPSILON * carried.max()
        other_phi, other_forced = over_sizes(one, sizes, alone.weights)
        mismatch = np.abs(other_phi - phi) @ start + np.abs(other_forced - forced).sum(axis=1)
        assert mismatch.max() <= rounding
        bound = rounding * closing_gain(system, sizes, phi, forced)
        for name in ("states", "cycle_states"):
            ours, expected = getattr(one, name), getattr(alone, name)
            np.testing.assert_allclose(ours / sizes, expected / sizes, rtol=0.0, atol=bound)
        assert one.brake_torque == pytest.approx(alone.brake_torque, rel=TOLERANCE)
        assert one.spectral_radius == pytest.approx(alone.spectral_radius, rel=TOLERANCE)
        assert one.energy_residual == pytest.approx(
            alone.energy_residual,
            rel=1e-8,
            abs=1e-12 * alone.pinion_torque * system.pair.geometry.omega_pinion,
        )  # a small difference of large powers


def test_every_speed_is_computed_as_if_it_were_alone(unlike):
    assert_each_is_its_own(systems_of(unlike.healthy))


@pytest.mark.parametrize("law", ["none", "coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb"])
def test_every_law_of_friction(coulomb_pair, law):
    assert_each_is_its_own(systems_of(coulomb_pair.with_({"friction": {"law": law}})))


@pytest.mark.parametrize("law", ["none", "coulomb", "xu_kahraman", "iso_14179"])
def test_speeds_of_a_law_that_speed_only_scales_go_together(coulomb_pair, law):
    """Without this each speed would be computed alone, and nothing would say so."""
    first, *others = systems_of(coulomb_pair.with_({"friction": {"law": law}}))
    assert all(goes_with(first, other) for other in others)
    np.testing.assert_allclose(
        fastest_frequencies([first, *others]),
        [fastest_frequency(one) for one in (first, *others)],
        rtol=1e-12,
    )


def test_what_does_not_go_together(coulomb_pair):
    (system,) = systems_of(coulomb_pair, np.ones(1))
    for changes in ({"mesh.damping_ratio": 0.2}, {"pinion.mass": 2.0}, {"friction.law": "smoothed_coulomb"}):
        other = LTVSystem.of(coulomb_pair.with_(changes), "full", supports="springs")
        assert not goes_with(system, other)


def test_on_shafts_each_speed_has_its_own_gyroscopic_moments():
    pair = unlike_pair("contact_ratio_2_3_on_shafts").healthy
    rpm = pair.operating.pinion_speed * 30.0 / np.pi
    pairs = [pair.at_speed(rpm * share) for share in (0.8, 1.2)]
    first, other = systems_over_speed(pairs, "shafts", warn=False)
    assert not goes_with(first, other)
    assert_each_is_its_own([first, other])


def test_a_speed_without_a_motion_leaves_the_others(coulomb_pair):
    """Undamped, where a mesh order meets the frequency of a bearing: None, between two motions."""
    none = {f"bearings.{g}.{d}_damping_ratio": 0.0 for g in ("pinion", "gear") for d in ("loa", "oloa")}
    none |= {"friction.law": "none", "mesh.damping_ratio": 0.0}
    pair = coulomb_pair.with_(none | {"gear.mass": 0.3})
    frequency = np.sqrt(pair.bearings.gear.oloa_stiffness / 0.3)
    speed = frequency * 60.0 / (2.0 * np.pi * pair.pinion.teeth) / 3.0
    pairs = [pair.at_speed(share * speed) for share in (0.97, 1.0, 1.03)]
    below, at, above = solutions_over_speed(systems_over_speed(pairs), 8)
    assert at is None
    assert below is not None
    assert above is not None
    with pytest.raises(NumericalError, match="a multiplier is at"):
        periodic_solution(
            LTVSystem.of(pairs[1], "full", supports="springs"), np.zeros(1), estimate_error=False
        )


def test_slow_speeds_are_divided_into_parts_and_one_too_slow_is_left_out(coulomb_pair):
    """A mesh cycle at 1 rpm has more steps than are computed together; below 0.01 rpm it has too many."""
    rpm = [2000.0, 1.0, 1e-3, 2500.0]
    pairs = [coulomb_pair.at_speed(one) for one in rpm]
    fast, slow, too_slow, faster = solutions_over_speed(systems_over_speed(pairs, warn=False), 8)
    assert too_slow is None
    for one in (fast, slow, faster):
        alone = periodic_solution(one.system, np.zeros(1), estimate_error=False)
        assert one.spectral_radius == pytest.approx(alone.spectral_radius, abs=1e-9)
