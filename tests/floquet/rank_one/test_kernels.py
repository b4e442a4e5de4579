"""Do the parts of the compiled kernel keep what they promise, each by itself?"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from floquet import RankOneSystem, fast_monodromies
from floquet.rank_one.batch import _quick
from floquet.rank_one.kernels.gains import MAX_TERMS, enough_terms, powers_of_radii
from floquet.rank_one.kernels.product import divide
from floquet.rank_one.kernels.simd import LANES
from floquet.rank_one.system import Gains
from tests.evidence.floquet.extended import state_matrix


def test_too_many_terms_are_said() -> None:
    for a in (40.0, np.nan, np.inf):
        assert enough_terms(np.array([a]), 0, np.log(1e-10), powers_of_radii(1))[0] == -1
    assert enough_terms(np.array([20.0]), 0, np.log(1e-4), powers_of_radii(1))[0] <= MAX_TERMS


@pytest.mark.parametrize("n", [2, 4, 6])
def test_step_from_its_halves(n: int) -> None:
    rng = np.random.default_rng(n)
    for trial in range(50):
        end, start = np.zeros((n, LANES)), np.zeros((n, LANES))
        end[:, :n] = rng.normal(size=(n, n))
        start[:, :n] = np.roll(np.eye(n), 1, axis=0)  # nothing on the diagonal: rows must change places
        if trial:
            start[:, :n] += 0.3 * rng.normal(size=(n, n))
        step = np.empty((n, LANES))
        size, residual = divide(end, start, np.eye(LANES), np.empty((2, n, LANES)), step)
        P, E, S = (x[:, :n].astype(np.longdouble) for x in (step, end, start))
        assert size == pytest.approx(np.linalg.norm(step[:, :n]), rel=1e-14)
        # Summed in extended precision: what is left of P S - E, not its rounding.
        exact = float(np.sqrt(np.square(P @ S - E).sum()))
        assert exact <= residual <= exact + 100 * n * 2.2e-16 * size * np.linalg.norm(start)
        inverse = np.linalg.inv(start[:, :n])
        off = np.linalg.norm(step[:, :n] - end[:, :n] @ inverse)
        assert off < 1e-13 * np.linalg.norm(inverse, 2) ** 2 * size
        assert not step[:, n:].any()


def test_supports_that_feed_energy_in_enter_the_bound() -> None:
    # x'' - 4 x' + (0.25 + e) x = 0 over T = 1, with e declared as the misfit of the gain. The state grows by
    # e^4 within the one step that this takes.
    e, zero = 1e-6, np.zeros((1, 1, 1))
    declared = Gains(np.array([[[0.25]]]), zero, np.array([[e, 0.0]]))
    system = RankOneSystem(
        stiffness=np.array([[1e-3]]), damping=np.array([[-4.0]]), v=np.array([1.0]),
        phases=np.array([0.0, 1.0]), gains=declared, period=1.0, metric=np.array([1.0]),
    )  # fmt: skip
    found = fast_monodromies(system)
    S = state_matrix(system.modal())
    exact = np.linalg.solve(S, expm(np.array([[0.0, 1.0], [-0.251 - e, 4.0]])) @ S)
    distance = np.linalg.norm(found.matrices[0] - exact)
    assert distance <= found.errors[0]
    silent = fast_monodromies(replace(system, gains=replace(declared, fit_errors=np.zeros((1, 2)))))
    assert distance > 1000 * silent.errors[0]
    assert found.errors[0] < 1000 * distance


def test_a_break_that_is_off_enters_the_bound() -> None:
    # The gain jumps at 0.7 + e of the period and is given as if it did at 0.7.
    e, zero = 1e-6, np.zeros((2, 1, 1))
    w, jump = np.array([[[30.0]], [[2000.0]]]), np.array([[0.0, 0.0], [2000.0 * e, 0.0], [0.0, 0.0]])

    def system(place: float, edge_errors: np.ndarray | None) -> RankOneSystem:
        return RankOneSystem(
            stiffness=np.array([[1.0]]), damping=np.array([[0.1]]), v=np.array([1.0]), period=1.0,
            phases=np.array([0.0, place, 1.0]), metric=np.array([1.0]),
            gains=Gains(w, zero, np.zeros((2, 2)), edge_errors),
        )  # fmt: skip

    exact, given, silent = system(0.7 + e, None), system(0.7, jump), system(0.7, None)
    S = np.linalg.solve(state_matrix(given.modal()), state_matrix(exact.modal()))
    moved = S @ fast_monodromies(exact).matrices[0] @ np.linalg.inv(S)
    found = fast_monodromies(given)
    distance = np.linalg.norm(found.matrices[0] - moved)
    assert distance <= found.errors[0]
    told = 2000.0 * e * exact.period * np.linalg.norm(1.0 / given.modal().omega)
    assert found.errors[0] - fast_monodromies(silent).errors[0] >= 0.99 * told
    assert distance > 1000.0 * fast_monodromies(silent).errors[0]
    assert found.errors[0] < 1000.0 * distance


def spectrum(M: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Eigenvalues, radii of their disks, and whether these are safe."""
    return tuple(part[0] for part in _quick(M[None], np.zeros(1)))


@pytest.mark.parametrize("n", [3, 4, 6])
def test_cyclic_permutations_do_not_stall_the_iteration(n: int) -> None:
    # Both shifts of the corner are zero, with which a sweep leaves an orthogonal matrix as it is.
    values, _, safe = spectrum(np.roll(np.eye(n), 1, axis=0))
    assert safe
    roots = np.exp(2j * np.pi * np.arange(n) / n)
    assert np.abs(values[:, None] - roots).min(axis=0).max() < 1e-14


def test_rounding_of_the_eigenvalues_is_inside_their_disks() -> None:
    # L D L^-1 with whole numbers, L of unit diagonal: no rounding in the matrix, eigenvalues 1 to 6.
    rng = np.random.default_rng(21)
    D, worst = np.diag(np.arange(1.0, 7.0)), 0.0
    for _ in range(40):
        L = np.eye(6) + np.tril(rng.integers(-3, 4, (6, 6)), -1)
        M = L @ D @ np.round(np.linalg.inv(L))
        assert (M @ L == L @ D).all()
        values, radii, safe = spectrum(M)
        if safe:
            error = np.abs(np.sort(values.real) - np.arange(1, 7))
            assert (error <= radii[np.argsort(values.real)]).all()
            worst = max(worst, float(error.max()))
    assert worst > 1e-13


def test_nearly_defective_eigenvalues_are_left_to_the_careful_bound() -> None:
    # Condition number 1/gap: beyond 1e6 rounding of the recurrence decides it.
    for gap, trusted in ((1e-4, True), (1e-8, False)):
        M = np.diag([0.5, 0.5 + gap, -0.3])
        M[0, 1] = 1.0
        assert spectrum(M)[2] == trusted
