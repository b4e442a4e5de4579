"""Do the bounds hold, and say something, with many modes, full damping and gyroscopic terms?"""

from dataclasses import replace

import numpy as np
import pytest

from floquet import RankOneSystem, fast_monodromies, fast_multipliers, monodromy
from floquet.engine.multipliers import radii_with_bounds
from floquet.rank_one.system import Gains
from lumped.errors import NumericalError, ParameterError
from tests.evidence.floquet.extended import as_periodic_system, extended_matrix


def shafts(m: int, seed: int = 1) -> RankOneSystem:
    """Modes as of gears on shafts: light damping, bearings that couple them, unsymmetric feedback."""
    rng = np.random.default_rng(seed)
    omega = 2.0 * np.pi * np.geomspace(300.0, 1000.0 * m, m) * rng.uniform(0.9, 1.1, m)
    v = rng.normal(size=m) * np.exp(-np.linspace(0.0, 1.5, m))
    k = 1.5 * omega.min() ** 2 / (v @ v)
    mesh, friction = k * rng.uniform(-1.0, 1.0, (2, 3, 4)) * 0.4 ** np.arange(4)
    mesh[:, 0] += k
    w = mesh[:, None] * v[:, None] + 0.1 * friction[:, None] * rng.normal(size=m)[:, None]
    turn, bearing = 0.3 * rng.normal(size=(2, m, m))
    return RankOneSystem(
        stiffness=np.diag(omega**2), damping=np.diag(0.002 * omega) + bearing @ bearing.T, v=v,
        phases=np.array([0.0, 0.3, 0.55, 1.0]), metric=np.ones(m), gyroscopic=turn - turn.T,
        gains=Gains(w, 1e-6 * (w + 0.1 * rng.normal(size=w.shape) * np.abs(w)), np.zeros((3, 2))),
        period=1e-3 if m < 10 else 4e-4,
    )  # fmt: skip


@pytest.mark.parametrize("m", [4, 10, 20])
def test_errors_are_below_bounds_that_allow_a_verdict(m: int) -> None:
    system = shafts(m)
    exact = extended_matrix(system)
    flow = fast_monodromies(system)
    error = float(np.sqrt(np.square(flow.matrices[0] - exact).sum()))
    assert 1e-6 * flow.errors[0] < error <= flow.errors[0] < 1e-7
    multipliers = fast_multipliers(system)
    distance = np.abs(multipliers.multipliers[0][:, None] - np.linalg.eigvals(exact.astype(float)))
    # LAPACK's own error in the eigenvalues of the reference is no error of ours.
    assert (distance.min(axis=1) <= multipliers.errors[0] + 1e-13).all()
    radius, bound = radii_with_bounds(multipliers.multipliers, multipliers.errors)
    assert bound[0] < 1e-3 * abs(radius[0] - 1.0)


def test_general_engine_and_other_speeds_agree() -> None:
    # One call over periods: the gyroscopic part goes with speed, that of the general engine too.
    system = shafts(4)
    periods = np.array([3e-4, 8e-4])
    fast = fast_multipliers(system, periods)
    for T, values, errors in zip(periods, fast.multipliers, fast.errors, strict=True):
        slow = monodromy(as_periodic_system(replace(system, period=float(T))), rtol=1e-9)
        distance = np.abs(values[:, None] - slow.multipliers)
        assert (distance.min(axis=1) <= errors + slow.multiplier_errors.max()).all()
    still = fast_multipliers(replace(system, gyroscopic=None), periods)
    assert np.abs(fast.multipliers - still.multipliers).max() > 1e-4


def test_a_matrix_that_is_not_skew_drives_and_enters_the_bound() -> None:
    # Taken as skew, G = -4 would let no energy grow, and the bound would be e^4 too small.
    e = 1e-6
    zero = np.zeros((1, 1, 1))
    system = RankOneSystem(
        stiffness=np.array([[1e-3]]), damping=np.zeros((1, 1)), v=np.array([1.0]),
        phases=np.array([0.0, 1.0]), gains=Gains(np.array([[[0.25]]]), zero, np.array([[e, 0.0]])),
        period=1.0, metric=np.array([1.0]), gyroscopic=np.array([[-4.0]]),
    )  # fmt: skip
    damped = replace(system, damping=np.array([[-4.0]]), gyroscopic=None)
    assert fast_monodromies(system).errors == pytest.approx(fast_monodromies(damped).errors, rel=1e-6)


def test_equal_shafts_have_double_multipliers_within_small_bounds() -> None:
    # Modes that do not feel the mesh, twice the same: no eigenvector is the only one.
    system = shafts(6)
    v = system.v.copy()
    w = system.gains.w.copy()
    v[4:] = w[:, 4:] = 0.0
    L = np.diag(system.stiffness).copy()
    C = np.diag(np.diag(system.damping)).copy()
    # Two coordinates that nothing excites become equal.
    one = 4
    other = 5
    L[other] = L[one]
    C[other, other] = C[one, one]
    gains = replace(system.gains, w=w, wd=1e-6 * w)
    equal = replace(system, v=v, gains=gains, stiffness=np.diag(L), damping=C, gyroscopic=None)
    spectrum = fast_multipliers(equal)
    s = -0.5 * C[one, one] + 1j * np.sqrt(L[one] - 0.25 * C[one, one] ** 2)
    distance = np.abs(spectrum.multipliers[0] - np.exp(s * equal.period))
    twice = np.argsort(distance)[:2]
    assert (distance[twice] <= spectrum.errors[0][twice]).all()
    assert spectrum.errors.max() < 1e-8


def test_what_is_too_much_is_said() -> None:
    with pytest.raises(ParameterError, match="at most 20"):
        fast_monodromies(shafts(21))
    with pytest.raises(NumericalError, match="natural frequencies"):
        fast_monodromies(shafts(10), [1e3])
    system = shafts(4)
    with pytest.raises(ParameterError, match="symmetric"):
        fast_monodromies(replace(system, stiffness=system.stiffness + 1e5 * np.eye(4, k=1)))
