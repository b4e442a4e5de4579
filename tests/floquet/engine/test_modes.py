"""Are exponents on the right branch, modes right in shape, and multipliers right however small?"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import block_diag

from floquet import PeriodicSystem, floquet_modes, gear_block, gear_pair_system, monodromy
from lumped import load_gear_pair
from lumped.errors import ParameterError


def oscillators(*exponents: complex) -> np.ndarray:
    """Real matrix with these eigenvalues and their conjugates."""
    return block_diag(*([[s.real, s.imag], [-s.imag, s.real]] for s in exponents))


def test_branch_of_a_constant_system_is_its_own_frequency() -> None:
    # 3 to 40 turns per period: the principal logarithm knows none of them.
    T = 2.0
    wanted = np.array([-0.1 + 9.7j, -0.4 + 33.0j, -1.0 + 125.3j])
    rng = np.random.default_rng(1)
    P = rng.normal(size=(6, 6))
    A = P @ oscillators(*wanted) @ np.linalg.inv(P)
    modes = floquet_modes(PeriodicSystem(lambda t: A, T))
    up = modes.exponents[modes.exponents.imag > 0]
    assert np.abs(np.sort_complex(up) - np.sort_complex(wanted)).max() < 1e-7  # rtol 1e-10, 250 rad
    assert np.allclose(np.exp(modes.exponents * T), modes.multipliers, rtol=1e-12)


@pytest.mark.parametrize("decay", [5.0, 25.0, 60.0, 500.0])
def test_tiny_multipliers_have_the_relative_accuracy_that_is_claimed(known_system, decay: float) -> None:
    # Phi(T, 0) is similar to exp(B T) by construction: multipliers exp(s T) down to exp(-1000).
    T = 2.0
    wanted = np.array([-0.2 + 1.1j, -0.5 * decay + 2.0j, -decay + 7.0j])
    B = oscillators(*wanted)
    rng = np.random.default_rng(9)
    system, _ = known_system(B, 0.3 * rng.normal(size=(6, 6)), T)
    modes = floquet_modes(system, rtol=1e-11)
    for s in wanted:
        nearest = np.argmin(np.abs(modes.exponents.real - s.real) + (modes.exponents.imag < 0))
        turns = (modes.exponents[nearest] - s) * T / (2j * np.pi)
        error = abs(np.expm1((modes.exponents[nearest] - s) * T - 2j * np.pi * np.round(turns.real)))
        assert error <= modes.relative_errors[nearest]
        # rtol 1e-11 for each of some hundred factors; coupling of decays 500 times apart adds four digits.
        assert modes.relative_errors[nearest] < 1e-9 if decay < 100.0 else 1e-3


def test_modes_of_a_reducible_system(known_system) -> None:
    # x = (I + g N) y, y' = B y: the modes are p(t) = (I + g(t) N) b with the eigenvectors b of B.
    T = 1.5
    B = oscillators(-0.3 + 1.9j, -0.8 + 0.6j)
    rng = np.random.default_rng(3)
    S = 0.5 * rng.normal(size=(4, 4))
    system, _ = known_system(B, S, T)
    modes = floquet_modes(system, samples=32)
    a, b = S[:, 0], S[:, 1] - S[:, 0] * (S[:, 0] @ S[:, 1]) / (S[:, 0] @ S[:, 0])
    g = np.sin(2 * np.pi * modes.times / T)
    values, vectors = np.linalg.eig(B)
    for i, s in enumerate(modes.exponents):
        j = int(np.argmin(np.abs(np.exp((values - s) * T) - 1.0)))
        shift = np.exp((values[j] - s) * modes.times)  # another branch of s turns p
        exact = (vectors[:, j] + g[:, None] * (np.outer(a, b) @ vectors[:, j])) * shift[:, None]
        factor = np.vdot(exact, modes.modes[i]) / np.vdot(exact, exact)
        assert np.abs(modes.modes[i] - factor * exact).max() < 1e-8  # rtol 1e-10, p of order one
    assert modes.residuals.max() < 1e-9


def test_real_multipliers_are_seen_at_half_the_mesh_frequency(mathieu) -> None:
    # Inside the first tongue (DLMF 28.2: between b_1 and a_1) both multipliers are negative: the motion has
    # odd multiples of half the parametric frequency 2, mostly 1.
    modes = floquet_modes(mathieu(1.0, 0.2))
    assert modes.frequencies == pytest.approx([1.0, 1.0], abs=1e-9)
    assert modes.multipliers[0].real * modes.multipliers[1].real == pytest.approx(1.0, rel=1e-9)


def test_slow_gear_pair() -> None:
    # 200 rpm: 200 rad per cycle, multipliers of the stiffest mode near 1e-20. The mesh mode is damped, the
    # frequencies are near those of the mean system: within 12 %, the span of stiffness over the cycle.
    pair = load_gear_pair("nasa_28_28").with_(operating__pinion_speed=200)
    modes = floquet_modes(gear_pair_system(pair, "feedback"))
    assert np.abs(modes.multipliers).min() < 1e-19
    assert modes.relative_errors.max() < 1e-6
    natural = gear_block(pair).modal().omega
    assert np.sort(modes.frequencies)[::2] == pytest.approx(natural, rel=0.12)


def test_agrees_with_the_monodromy_matrix_and_bounds() -> None:
    pair = load_gear_pair("nasa_28_28").with_(operating__pinion_speed=9000)
    system = gear_pair_system(pair, "feedback")
    modes, whole = floquet_modes(system), monodromy(system)
    distance = np.abs(modes.multipliers[:, None] - whole.multipliers[None, :]).min(axis=1)
    allowed = modes.relative_errors * np.abs(modes.multipliers) + whole.multiplier_errors.max()
    assert (distance <= allowed).all()


def test_defective_multipliers_are_not_given_a_bound() -> None:
    modes = floquet_modes(PeriodicSystem(lambda t: [[-0.3, 1.0], [0.0, -0.3]], 1.0))
    assert np.isinf(modes.relative_errors).all()


def test_odd_samples_are_refused() -> None:
    with pytest.raises(ParameterError, match="power of two"):
        floquet_modes(PeriodicSystem(lambda t: [[-1.0]], 1.0), samples=20)
