"""Are the errors of coefficients given as formulas, and of the steps through them, inside their bounds?

What is exact is computed with 77 digits, floating point numbers being exact. Where all terms have one sign a
bound is attained; each tolerance says by how much a bound may exceed the error, and why.
"""

import numpy as np
import pytest

pytest.importorskip("flint", reason="needs python-flint (extra: test)")

from flint import arb, arb_mat, arb_poly, ctx

from floquet import FourierSeries, PeriodicMatrix, PiecewisePolynomial, monodromy
from floquet.engine.formula_steps import _steps
from floquet.engine.kernels.steps import frobenius_bound, two_norm_bound
from floquet.engine.second_order import from_second_order
from floquet.engine.stacked import StackedMatrices
from lumped.errors import NumericalError
from tests.floquet.engine.judge.balls import worst_ratio
from tests.floquet.engine.judge.enclosures import disks, least

_PLACES = np.append(np.linspace(0.0, 1.0, 17), [1e-3, 0.999])


def exact_polynomial(ends, rows):
    """`PiecewisePolynomial` at an exact time on a step that starts at a time."""

    def value(start, time):
        j = min(max(np.searchsorted(ends, start, side="right") - 1, 0), len(rows) - 1)
        return arb_poly([arb(c) for c in rows[j]])(time - arb(ends[j]))

    return value


def exact_series(period, mean, cosines, sines):
    """`FourierSeries` likewise."""

    def value(start, time):
        angle = time * 2 * arb.pi() / arb(period)
        total = arb(mean)
        for k, (a, b) in enumerate(zip(cosines, sines, strict=True), 1):
            total += (angle * k).cos() * arb(a) + (angle * k).sin() * arb(b)
        return total

    return value


def ratios(function, exact, start, length, degree) -> np.ndarray:
    """Largest error over the bound of each of some steps."""
    ctx.prec = 256
    series, bounds = function.taylor(np.asarray(start), np.asarray(length), degree)
    error_ratios = []
    for t, h, row, bound in zip(start, length, series, bounds, strict=True):
        poly = arb_poly([arb(c) for c in row])
        errors = [least(exact(t, arb(t) + arb(h) * arb(s)) - poly(arb(s))) for s in _PLACES]
        error_ratios.append(max(errors) / bound)
    return np.array(error_ratios)


def test_polynomials_with_terms_of_one_sign_attain_their_bound() -> None:
    ends = [0.0, 1.0, 2.5]
    rows = [[1.0, 2.0, 3.0, 0.5, 4.0], [-1.0, -2.0, -0.1, -3.0, -0.7]]
    function = PiecewisePolynomial(ends, rows)
    exact = exact_polynomial(ends, rows)
    for degree in (0, 1, 3):
        error_ratios = ratios(function, exact, [0.0, 1.0, 0.5, 2.0], [1.0, 1.5, 0.5, 0.5], degree)
        assert (error_ratios <= 1.0).all()
        assert (error_ratios > 1.0 - 1e-10).all()  # rounding
    # 2 s - 2 s^2 is 0 at both ends, and 1/2 between them.
    signed = [[1.0, 2.0, -2.0]]
    error_ratios = ratios(
        PiecewisePolynomial([0.0, 1.0], signed), exact_polynomial([0.0, 1.0], signed), [0.0], [1.0], 0
    )
    assert error_ratios == pytest.approx(0.5 / 4.0, rel=1e-10)


@pytest.mark.parametrize("degree", [2, 6, 14])
def test_signed_coefficients_are_inside_their_bounds(degree: int) -> None:
    """Sums and products on steps between breaks. One step is an ulp wide, one ends an ulp before a break."""
    rng = np.random.default_rng(degree)
    rows = rng.normal(size=(2, 5)) * (-1.0) ** np.arange(5)
    a = rng.normal(size=3)
    b = rng.normal(size=3)
    ends = [0.0, 1.0, 2.0]
    formula = FourierSeries(2.0, 0.3, a.tolist(), b.tolist()) * PiecewisePolynomial(ends, rows) - 0.7
    wave = exact_series(2.0, 0.3, a, b)
    poly = exact_polynomial(ends, rows)
    before = float(np.nextafter(1.0, 0.0))
    start = [0.1, 0.75, 1.0, 0.0, before, 1.0, 0.999]
    length = [0.3, 0.25, 1.0, 1.0, 1.0 - before, 2.0**-52, before - 0.999]
    error_ratios = ratios(formula, lambda t, x: wave(t, x) * poly(t, x) - arb(0.7), start, length, degree)
    assert (error_ratios <= 1.0).all()
    # Over long steps truncation counts, where the largest of three harmonics does not meet the others.
    assert error_ratios[:4].max() > (0.1 if degree < 14 else 1e-4)


def test_a_harmonic_nearly_attains_lagranges_remainder() -> None:
    """The derivative in the remainder is nearly the largest possible one at a point of the step."""
    for cosine, sine in ((1.0, 0.0), (0.0, -1.0)):
        function = FourierSeries(1.0, 5.0, [cosine], [sine])
        exact = exact_series(1.0, 5.0, [cosine], [sine])
        start = 0.25 if cosine else 0.5  # odd terms alone of the cosine, and of the sine
        for degree in (4, 8):
            error_ratios = ratios(function, exact, [start, start + 0.01], [0.05, 0.05], degree)
            assert (error_ratios <= 1.0).all()
            assert error_ratios[0] > 0.9


def series_of(matrix, degree):
    """Taylor polynomial of a matrix from 0 to 1."""
    stack = StackedMatrices([matrix], np.ones((1, matrix.dimension)))
    return stack.taylor(np.zeros(1, dtype=int), np.zeros(1), np.ones(1), degree)


def test_errors_of_second_order_of_a_product_and_of_a_sum_are_attained() -> None:
    """1 + s by its constant: off by 1, the square by 3, and the sum of two by 2."""
    line = PiecewisePolynomial([0.0, 1.0], [[1.0, 1.0]])
    for function, error in ((line * line, 3.0), (line + line, 2.0)):
        series, bounds = function.taylor(np.zeros(1), np.ones(1), 0)
        assert function(np.ones(1))[0] - series[0, 0] == error
        assert error <= bounds[0] < error * (1.0 + 1e-13)


def test_moduli_count_where_coefficients_cancel() -> None:
    """1 - s, whose coefficients sum to 0, times s^2, which is beyond degree 1, and times a matrix."""
    falling = PiecewisePolynomial([0.0, 1.0], [[1.0, -1.0]])
    square = PiecewisePolynomial([0.0, 1.0], [[0.0, 0.0, 1.0]])
    for function in (falling * square, square * falling):
        series, bounds = function.taylor(np.zeros(1), np.ones(1), 1)
        assert not series.any()
        assert 4.0 / 27.0 <= bounds[0] < 2.0 + 1e-12  # at s = 2/3; the sum of the moduli is 2
    matrix = PeriodicMatrix(0.0, (falling, 2.0), errors=np.array([[[0.0]], [[0.1]]]))
    assert 0.1 <= series_of(matrix, 1).errors[0] < 0.2 + 1e-8


def test_errors_of_the_matrices_are_those_of_all_products() -> None:
    """(1 + s) (2 + 0.1) less 2 is 2.2 at s = 1, and the constant adds 0.3."""
    line = PiecewisePolynomial([0.0, 1.0], [[1.0, 1.0]])
    matrix = PeriodicMatrix(5.0, (line, 2.0), errors=np.array([[[0.3]], [[0.1]]]))
    bound = series_of(matrix, 0).errors
    assert 2.5 <= bound[0] < 2.5 + 0.1 * 1.0 + 1e-8  # 0.1 of the error of the line counts once more


def test_rounding_of_a_shifted_origin_and_of_a_large_angle_is_inside() -> None:
    """(t - 1e3)^6 in powers of t near 1e3, where all cancels; a wave after a million periods."""
    rows = [[float(c) for c in np.poly1d([1.0, -1e3]) ** 6][::-1]]
    error_ratios = ratios(
        PiecewisePolynomial([0.0, 2e3], rows), exact_polynomial([0.0, 2e3], rows), [1e3 - 0.7], [0.3], 6
    )
    assert 1e-4 < error_ratios[0] <= 1.0  # of 4 m + 8 roundings of all moduli at the largest time
    wave = FourierSeries(0.3, 0.0, [1.0], [0.5])
    exact = exact_series(0.3, 0.0, [1.0], [0.5])
    error_ratios = ratios(wave, exact, np.array([1.1e5, 2.3e5, 3.1e5]), np.full(3, 1e-3), 14)
    assert (error_ratios <= 1.0).all()
    assert error_ratios.max() > 0.05  # of 4 roundings of the angle, three products' and that of pi


def one_step(A, *, indivisible: bool, rtol: float):
    """Transition matrix from 0 to 1 and its bound."""
    stack = StackedMatrices([A], np.ones((1, A.dimension)))
    zero = np.zeros(1, dtype=int)
    steps = _steps(stack, zero, np.zeros(1), np.ones(1), np.array([indivisible]), rtol)
    assert steps.good.all()
    return steps.flows, steps.errors


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(("a", "loose"), [(0.1, 100.0), (0.3, 1000.0)])
def test_the_tail_of_a_step_is_in_its_bound(a: float, loose: float, sign: float) -> None:
    """x' = a s^14 x: of exp(a s^15/15) the 40 terms hold s^15 and s^30; the next one is (a/15)^3/6.

    The bound is exp(a R^15/15) R^-40/(R - 1) for R = 1.5, the smallest one that is tried: not the best here.
    """
    rows = [[0.0] * 14 + [sign * a]]
    A = PeriodicMatrix(0.0, (PiecewisePolynomial([0.0, 1.0], rows), 1.0))
    flow, bounds = one_step(A, indivisible=True, rtol=2e-3)  # so small that 40 terms are taken
    ctx.prec = 256
    error = least((arb(sign * a) / 15).exp() - arb(flow[0, 0, 0]))
    assert error == pytest.approx((a / 15.0) ** 3 / 6.0, rel=0.01)
    assert error <= bounds[0] < loose * error


def test_an_error_of_the_coefficient_grows_with_the_flow() -> None:
    """x' = (c + e) x: the flow is off by exp(c) (exp(e) - 1), of which the bound takes exp(2 c)."""
    e = 1e-4
    c = 0.9
    for sign in (-1.0, 1.0):
        A = PeriodicMatrix(sign * c, errors=np.array([[[e]]]))
        flow, bounds = one_step(A, indivisible=True, rtol=1.0)
        error = np.exp(sign * c + e) - flow[0, 0, 0]
        assert error <= bounds[0] < 1.01 * error * np.exp(2.0 * c - sign * c)


def pulsed(start: float, end: float, impulse: float):
    """x'' + 0.02 x' + (9 + impulse/width from start to end) x = 0 of period 1, and its exact multipliers."""
    width = end - start  # exact, as are the ends
    ends = np.unique([0.0, start, end, 1.0])
    values = [impulse / width if low == start else 0.0 for low in ends[:-1]]
    stiffness = PeriodicMatrix(9.0, (PiecewisePolynomial(ends, [[v] for v in values]), 1.0))
    ctx.prec = 256
    flow = arb_mat([[1, 0], [0, 1]])
    for low, high, value in zip(ends[:-1], ends[1:], values, strict=True):
        A = arb_mat([[arb(0), arb(1)], [-(arb(9) + arb(value)), -arb(0.02)]])
        flow = (A * (arb(high) - arb(low))).exp() * flow
    return from_second_order([[1.0]], [[0.02]], stiffness, 1.0), disks(flow)


def ulps(place: float, count: int) -> float:
    """The number so many units in the last place above."""
    for _ in range(count):
        place = float(np.nextafter(place, 2.0))
    return place


PULSES = {
    **{f"{k} ulp at {p}": (p, ulps(p, k)) for p in (0.5, 0.618, 0.9) for k in (1, 3)},
    **{f"{k} ulp at odd {p}": (ulps(p, 1), ulps(p, 1 + k)) for p in (0.5, 0.75) for k in (1, 2)},
    "at 0": (0.0, 2.0**-60),
    "an ulp before 1": (ulps(0.5, 0), 1.0 - 2.0**-53),
    "the last ulp": (1.0 - 2.0**-53, 1.0),
    **{f"width {w:g}": (0.3, 0.3 + w) for w in (1e-3, 1e-5, 1e-7, 1e-9)},
}


@pytest.mark.parametrize("impulse", [-4.0, 0.5, 4.0])
@pytest.mark.parametrize("pulse", PULSES)
def test_a_pulse_is_proven_whatever_its_width_and_sign(pulse: str, impulse: float) -> None:
    """The middle of a piece one unit in the last place wide with an odd start rounds to its end.

    Coordinates are balanced by the mean of |A| over time, in which a spike counts as its impulse does.
    """
    system, exact = pulsed(*PULSES[pulse], impulse)
    result = monodromy(system, 1e-10)
    assert result.certificate == "proven"
    assert worst_ratio(result.multipliers, result.multiplier_errors, exact)[0] <= 1.0
    assert result.error < 1e-10


@pytest.mark.parametrize("impulse", [-20.0, 20.0])
def test_a_pulse_too_strong_for_one_step_is_cut_or_refused(impulse: float) -> None:
    """A step of one ulp cannot be cut, and the bound on the rounding of its impulse is above 1e-10."""
    system, exact = pulsed(0.3, 0.3 + 1e-9, impulse)
    result = monodromy(system, 1e-10)
    assert worst_ratio(result.multipliers, result.multiplier_errors, exact)[0] <= 1.0
    place = ulps(0.5, 1)
    with pytest.raises(NumericalError, match=f"near t = {place:.17g} s: the step fell to rounding"):
        monodromy(pulsed(place, ulps(place, 1), impulse)[0], 1e-10)


@pytest.mark.parametrize("n", [1, 2, 6])
def test_norms_are_bounded_and_hardly_above(n: int) -> None:
    """|A|_2 by |A^T A|_F^(1/2): too large by n^(1/4) at most, where all singular values are the same."""
    rng = np.random.default_rng(n)
    for spread in (1.0, 2.0, 10.0, 1e200):
        U, V = (np.linalg.qr(rng.normal(size=(n, n)))[0] for _ in range(2))
        A = U * np.geomspace(spread, 1.0, n) @ V
        true = spread if n > 1 else float(np.abs(A).max())
        assert true * (1.0 - 1e-13) <= two_norm_bound(A) <= true * n**0.25 * (1.0 + 1e-8)
        assert np.sqrt(n) * np.abs(A).mean() <= frobenius_bound(A) <= np.sqrt(n) * true * (1.0 + 1e-8)
    assert two_norm_bound(np.eye(n)) == pytest.approx(n**0.25, rel=1e-8)
