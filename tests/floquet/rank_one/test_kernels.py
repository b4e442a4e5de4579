"""Do the parts of the compiled kernel keep what they promise, each by itself?"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

pytest.importorskip("flint", reason="needs python-flint (extra: test)")

from flint import arb_mat

from floquet import RankOneSystem, fast_monodromies
from floquet.engine.kernels.eigenvalue_bounds import _gershgorin, _join
from floquet.engine.kernels.simd import LANES
from floquet.engine.many_multipliers import quick_multipliers
from floquet.rank_one.kernels.gains import MAX_TERMS, enough_terms, table_of_radii
from floquet.rank_one.kernels.product import Steps, carry, divide, product_workspace
from floquet.rank_one.system import Gains
from tests.evidence.floquet.extended import state_matrix
from tests.floquet.engine.judge.balls import worst_ratio
from tests.floquet.engine.judge.enclosures import (
    balls,
    disks,
    energy_monodromy,
    least_norm,
    nearly_defective,
    real_balls,
    worst_errors,
)


def test_too_many_terms_are_said() -> None:
    for a in (40.0, np.nan, np.inf):
        assert enough_terms(np.array([a]), 0, np.log(1e-10), table_of_radii(1))[0] == -1
    assert enough_terms(np.array([20.0]), 0, np.log(1e-4), table_of_radii(1))[0] <= MAX_TERMS


@pytest.mark.parametrize("n", [2, 4, 6])
def test_step_from_its_halves(n: int) -> None:
    rng = np.random.default_rng(n)
    for trial in range(50):
        end = np.zeros((n, LANES))
        start = np.zeros((n, LANES))
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
        error = np.linalg.norm(step[:, :n] - end[:, :n] @ inverse)
        assert error < 1e-13 * np.linalg.norm(inverse, 2) ** 2 * size
        assert not step[:, n:].any()


def test_supports_that_feed_energy_in_enter_the_bound() -> None:
    # x'' - 4 x' + (0.25 + e) x = 0 over T = 1, with e declared as the misfit of the gain. The state grows by
    # e^4 within the one step that this takes.
    e = 1e-6
    zero = np.zeros((1, 1, 1))
    declared = Gains(np.array([[[0.25]]]), zero, np.array([[e, 0.0]]))
    system = RankOneSystem(
        stiffness=np.array([[1e-3]]), damping=np.array([[-4.0]]), v=np.array([1.0]),
        phases=np.array([0.0, 1.0]), gains=declared, period=1.0, metric=np.array([1.0]),
    )  # fmt: skip
    flow = fast_monodromies(system)
    S = state_matrix(system.modal())
    exact = np.linalg.solve(S, expm(np.array([[0.0, 1.0], [-0.251 - e, 4.0]])) @ S)
    distance = np.linalg.norm(flow.matrices[0] - exact)
    assert distance <= flow.errors[0]
    silent = fast_monodromies(replace(system, gains=replace(declared, fit_errors=np.zeros((1, 2)))))
    assert distance > 1000 * silent.errors[0]
    assert flow.errors[0] < 1000 * distance


def test_a_break_that_is_off_enters_the_bound() -> None:
    # The gain jumps at 0.7 + e of the period and is given as if it did at 0.7.
    e = 1e-6
    zero = np.zeros((2, 1, 1))
    w = np.array([[[30.0]], [[2000.0]]])
    jump = np.array([[0.0, 0.0], [2000.0 * e, 0.0], [0.0, 0.0]])

    def system(place: float, edge_errors: np.ndarray | None) -> RankOneSystem:
        return RankOneSystem(
            stiffness=np.array([[1.0]]), damping=np.array([[0.1]]), v=np.array([1.0]), period=1.0,
            phases=np.array([0.0, place, 1.0]), metric=np.array([1.0]),
            gains=Gains(w, zero, np.zeros((2, 2)), edge_errors),
        )  # fmt: skip

    exact = system(0.7 + e, None)
    declared = system(0.7, jump)
    silent = system(0.7, None)
    S = np.linalg.solve(state_matrix(declared.modal()), state_matrix(exact.modal()))
    exact_flow = S @ fast_monodromies(exact).matrices[0] @ np.linalg.inv(S)
    flow = fast_monodromies(declared)
    distance = np.linalg.norm(flow.matrices[0] - exact_flow)
    assert distance <= flow.errors[0]
    bound_of_jump = 2000.0 * e * exact.period * np.linalg.norm(1.0 / declared.modal().omega)
    assert flow.errors[0] - fast_monodromies(silent).errors[0] >= 0.99 * bound_of_jump
    assert distance > 1000.0 * fast_monodromies(silent).errors[0]
    assert flow.errors[0] < 1000.0 * distance


def spectrum(M: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Eigenvalues, radii of their disks, and whether these are safe."""
    return tuple(part[0] for part in quick_multipliers(M[None], np.zeros(1)))


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
    D = np.diag(np.arange(1.0, 7.0))
    worst = 0.0
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
        _, _, is_trusted = spectrum(M)
        assert is_trusted == trusted


def ratios(M: np.ndarray, delta: float) -> tuple[float, float, bool]:
    """Largest error over the bound and least one that is called safe; whether disks overlap."""
    values, radii, safe = (part[0] for part in quick_multipliers(M[None], np.array([delta])))
    if not safe:
        return 0.0, False, False
    error_ratios = [worst_ratio(values, radii, disks(balls(M) + balls(E)))[0] for E in worst_errors(M, delta)]
    apart = np.abs(values[:, None] - values) > radii[:, None] + radii
    return max(error_ratios), True, int((~apart).sum()) > 6


def test_disks_hold_the_worst_errors_until_they_are_called_unsafe() -> None:
    """Three multipliers have nearly parallel eigenvectors with the condition 10 2^(2 power).

    Above a condition of 1e6 the disks are called unsafe. Overlapping disks are widened to their union, so
    that a union of k disks holds k multipliers.
    """
    worst_ratios = {}
    overlapping = 0
    for power in (2, 4, 6, 8, 12):
        for delta in (1e-14, 1e-9, 1e-7, 1e-5):
            worst_ratios[power, delta], safe, overlap = ratios(nearly_defective(power), delta)
            assert worst_ratios[power, delta] <= 1.0
            assert safe == (power <= 8)
            overlapping += overlap
    assert overlapping >= 3
    # Above the rounding of the residuals, 1e-12, the worst error moves one of them by all of its radius.
    assert min(worst_ratios[power, delta] for power in (2, 4) for delta in (1e-9, 1e-7)) > 0.95


@pytest.mark.parametrize("diagonal_sign", [-1.0, 1.0])
@pytest.mark.parametrize("coupling", [-1.0, 1.0])
def test_a_scaled_disk_holds_what_its_coupling_moves(diagonal_sign: float, coupling: float) -> None:
    """Errors of modulus f move the first eigenvalue of a 2 x 2 matrix by f_11 + f_12 f_21/gap.

    By more where both eigenvalues attract each other.
    """
    values = np.array([0.5 + 0j, 0.75])
    rows = np.empty(2)
    radii = np.empty(2)
    f = np.array([[1e-6, 1e-2], [2e-2, 1e-6]])
    _gershgorin(values, f, rows, radii)
    F = f * [[diagonal_sign, 1.0], [coupling, diagonal_sign]]
    distance = min(abs(disk[0] - 0.5) for disk in disks(balls(np.diag(values) + F)))
    assert distance <= radii[0] < 2.03 * distance  # the theorem allows for twice f_12 f_21/gap
    if diagonal_sign > coupling:
        assert distance > 1e-6 + 2e-4 / 0.25


def test_disks_that_hang_together_are_widened_around_all_of_them() -> None:
    """A union of k disks holds k eigenvalues, each anywhere in it: here a chain of three."""
    values = np.array([0.0, 1.0 + 0j, 1.9, 5.0, 3.4j])
    radii = np.array([0.6, 0.7, 0.4, 0.5, 0.1])
    radii_before = radii.copy()
    _join(values, radii, np.empty(5), np.empty(5, dtype=np.int64))
    chain = np.abs(values[:3, None] - values[:3]) + radii_before[:3]
    apart = np.array([3, 4])
    assert radii[:3] == pytest.approx(chain.max(axis=1), rel=1e-10)
    assert (radii[:3] >= chain.max(axis=1)).all()
    assert (radii[apart] == radii_before[apart]).all()
    # Row sums of three entries of 6e-4 overlap over a gap of 1e-3; the third disk is scaled by 2 6e-4/0.8.
    values, radii, safe = (
        part[0] for part in quick_multipliers(np.diag([0.5, 0.501, -0.3])[None], np.array([6e-4]))
    )
    assert safe
    order = np.argsort(-values.real)
    assert radii[order] == pytest.approx([2.8e-3, 2.8e-3, 6e-4 + 1.5e-3 * 1.2e-3], rel=1e-5)


def test_the_product_keeps_terms_of_second_order_and_of_blocks() -> None:
    """Scalars, where nothing is lost: the bound is the difference of the products with errors and without."""
    for sizes, e in ((np.ones(40), 0.05), (np.repeat([3.0, 0.2, 2.0], 13), 0.01), (np.full(7, -1.5), 0.1)):
        count = sizes.size
        steps = np.zeros((count, 1, LANES))
        steps[:, 0, 0] = sizes
        flow = np.zeros((1, LANES))
        work = product_workspace(count, 1, LANES)
        bound = carry(Steps(steps, np.full(count, e), np.abs(sizes)), count, work, flow)
        exact = np.prod(np.abs(sizes) + e) - np.prod(np.abs(sizes))
        assert flow[0, 0] == pytest.approx(np.prod(sizes), rel=1e-14)
        assert exact * (1.0 - 1e-12) <= bound <= 1.001 * exact


def driven(
    c: float, wd: float = 0.0, errors: float = 0.0, edges: tuple[float, float] = (0.0, 0.0), w: float = 0.0
) -> RankOneSystem:
    """x'' + (wd - c) x' + (1e-3 + w) x = 0 over T = 1, with errors of wd declared: bounds are nearly so."""
    zero = np.zeros((1, 1, 1))
    edge_errors = np.array([[0.0, edge] for edge in edges])
    return RankOneSystem(
        stiffness=np.array([[1e-3]]), damping=np.array([[-c]]), v=np.ones(1), phases=np.array([0.0, 1.0]),
        gains=Gains(zero + w, zero + wd, np.array([[0.0, errors]]), edge_errors), period=1.0,
        metric=np.ones(1),
    )  # fmt: skip


def exact_matrix(system: RankOneSystem) -> arb_mat:
    """Its monodromy matrix in balls."""
    return energy_monodromy(system, system.period, 1.0, np.ones(len(system.parts)))


def error_of(
    system: RankOneSystem, exact: arb_mat, tolerance: float = 1e-13, zeta: float = 1.0
) -> tuple[float, float]:
    """Error of the monodromy matrix against balls, and its bound."""
    flow = fast_monodromies(system, [system.period], zeta, tolerance=tolerance)
    return least_norm(exact - real_balls(flow.matrices[0])), flow.errors[0]


@pytest.mark.parametrize("driver", ["supports", "gain", "gain like that of the deflection"])
@pytest.mark.parametrize("c", [-4.0, 2.0, 4.0, 8.0])
def test_the_tail_of_the_series_is_in_the_bound(c: float, driver: str) -> None:
    """|A| is c and the flow is exp(c): but for Stirling's root and the tolerance the majorant is attained.

    Damped, the flow from the middle back to the start grows, and the bound with it, but not its error.
    """
    system = driven(c) if driver == "supports" else driven(0.0, wd=-c, w=1e-3 * ("like" in driver))
    exact = exact_matrix(system)
    error_ratios = [
        np.divide(*error_of(system, exact, tolerance)) for tolerance in np.geomspace(1e-1, 1e-5, 13)
    ]
    assert max(error_ratios) <= 1.0
    # Of a gain the bound does not know that it damps: exp(2 |c|) more.
    assert max(error_ratios) > (0.03 if c > 0.0 else 1e-4)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_errors_of_a_gain_of_either_sign_are_in_the_bound_and_hardly_more(sign: float) -> None:
    """Everywhere, as much as is declared; the norm of the bound is that of two states, sqrt(2)."""
    e = 1e-6
    c = 4.0
    error, bound = error_of(driven(c, errors=e), exact_matrix(driven(c, sign * e)))
    assert error <= bound < 1.5 * error
    # At an end alone, as a pulse that is as wide as a thousandth of the period.
    for place, edges in ((0, (e, 0.0)), (1, (0.0, e))):
        phases = np.array([0.0, 1e-3, 1.0] if place == 0 else [0.0, 0.999, 1.0])
        wd = np.zeros((2, 1, 1))
        wd[place] = sign * e / 1e-3
        pulse = replace(driven(c), phases=phases, gains=Gains(np.zeros((2, 1, 1)), wd, np.zeros((2, 2))))
        error, bound = error_of(driven(c, edges=edges), exact_matrix(pulse))
        assert error <= bound < 1.5 * error


@pytest.mark.parametrize("end", [0, 1, 2, 3])
def test_errors_at_an_end_count_on_each_side_that_it_has(end: int) -> None:
    """Of four ends of three pieces: pulses of damping, a thousandth of the period wide, before and behind."""
    e = 1e-6
    width = 1e-3
    zero = np.zeros((3, 1, 1))
    ends = np.array([0.0, 0.3, 0.6, 1.0])
    declared = np.zeros((4, 2))
    declared[end, 1] = e
    with_declared_errors = replace(
        driven(4.0), phases=ends, gains=Gains(zero, zero, np.zeros((3, 2)), declared)
    )
    phases = np.unique(np.clip([*ends, ends[end] - width, ends[end] + width], 0.0, 1.0))
    pulse = np.abs(0.5 * (phases[1:] + phases[:-1]) - ends[end]) < width
    wd = np.where(pulse, e / width, 0.0)[:, None, None]
    none = np.zeros((pulse.size, 1, 1))
    with_pulses = replace(driven(4.0), phases=phases, gains=Gains(none, wd, np.zeros((pulse.size, 2))))
    error, bound = error_of(with_declared_errors, exact_matrix(with_pulses))
    assert error <= bound < 1.5 * error


@pytest.mark.parametrize("wd", ["proportional", "not proportional"])
@pytest.mark.parametrize("w", [-3.0, 3.0])
def test_signed_gains_of_high_degree_are_inside_their_bounds(w: float, wd: str) -> None:
    """One gain on two pieces, alternating and growing within each, at tolerances that leave the tail."""
    powers = w * np.array([[[1.0, -0.5, 2.0, -3.0]], [[-2.0, 1.0, -1.0, 4.0]]])
    rates = -0.4 * powers if wd == "proportional" else np.array([[[0.3, -2.0]], [[-1.0, 2.5]]])
    system = RankOneSystem(
        stiffness=np.array([[7.0]]), damping=np.array([[0.1]]), v=np.array([-1.0]), period=2.0,
        phases=np.array([0.0, 0.4, 1.0]), gains=Gains(powers, rates, np.zeros((2, 2))), metric=np.ones(1),
        mean=np.array([-1.0]),
    )  # fmt: skip
    twin = replace(system, gains=replace(system.gains, wd=-rates))
    exact = exact_matrix(system)
    for tolerance in (1e-2, 1e-4, 1e-13):
        error, bound = error_of(system, exact, tolerance)
        assert error <= bound
        assert bound == pytest.approx(error_of(twin, exact, tolerance, zeta=-1.0)[1], rel=1e-12)


UP = float(np.nextafter(0.7, 1.0))


@pytest.mark.parametrize("phases", [
    [0.0, 0.5, np.nextafter(0.5, 1.0), 1.0], [0.0, UP, np.nextafter(UP, 1.0), 1.0], [0.0, 2.0**-60, 0.4, 1.0],
    [0.0, 0.4, np.nextafter(1.0, 0.0), 1.0],
], ids=["even", "odd", "first", "last"])  # fmt: skip
@pytest.mark.parametrize("impulse", [-4.0, 4.0, 40.0])
def test_a_pulse_of_one_ulp_is_in_the_bound(phases: list[float], impulse: float) -> None:
    """In the stiffness and in the damping, between pieces of other gains: its ends are exact."""
    phases = np.array(phases)
    pulse = int(np.argmin(np.diff(phases)))
    w = np.array([1.0, 2.0, 3.0])[:, None, None]
    wd = np.array([0.2, 0.3, -0.1])[:, None, None]
    w[pulse], wd[pulse] = np.array([1.0, 0.25]) * impulse / np.diff(phases)[pulse]
    system = RankOneSystem(
        stiffness=np.array([[5.0]]), damping=np.array([[0.1]]), v=np.ones(1), phases=phases, period=1.3,
        gains=Gains(w, wd, np.zeros((3, 2))), metric=np.ones(1), mean=np.array([2.0]),
    )  # fmt: skip
    error, bound = error_of(system, exact_matrix(system))
    assert error <= bound < 1e-7
