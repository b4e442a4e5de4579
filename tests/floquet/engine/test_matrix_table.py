"""Is a table of matrices the function that its argument names, and is anything else refused?"""

import numpy as np
import pytest

from floquet import (
    FourierSeries,
    PeriodicMatrix,
    PeriodicSystem,
    PiecewisePolynomial,
    from_second_order,
    monodromy,
    sampled_matrix,
)
from floquet.engine.matrix_table import changing_entries, matrix_table
from lumped.errors import ParameterError

T = 0.7
MEAN = np.array([[-0.2, 1.0, 0.0], [-30.0, -0.5, 4.0], [0.3, -2.0, -1.5]])
WAVE = np.array([[0.0, 0.0, 0.6], [8.0, 0.1, 0.0], [0.0, -1.0, 0.0]])


def three_states(times):
    """A damped system without any symmetry, with one harmonic."""
    return MEAN + np.cos(2.0 * np.pi * np.asarray(times) / T)[:, None, None] * WAVE


def exact_multipliers():
    wave = FourierSeries(T, 0.0, [1.0])
    return monodromy(PeriodicSystem(PeriodicMatrix(MEAN, (wave, WAVE)), T), 1e-12)


def of_table(times, matrices, **options):
    return monodromy(PeriodicSystem(sampled_matrix(times, matrices, **options), T), 1e-12)


def distance(first, second):
    return np.abs(first.matrix - second.matrix).max() / np.abs(second.matrix).max()


@pytest.mark.parametrize(("between", "order"), [("linear", 2), ("cubic", 4)])
def test_the_matrix_between_the_samples_has_the_order_of_its_interpolation(between, order):
    """The error of A, h^2 of lines and h^4 of splines (de Boor 1978), is that of the flow."""
    exact = exact_multipliers()
    errors = []
    for count in (40, 80):
        times = np.linspace(0.0, T, count + 1)
        table = of_table(times, three_states(times), between=between)
        assert table.certificate == "proven"
        errors.append(distance(table, exact))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.2)


def test_steps_hold_until_the_next_time():
    times = np.array([0.0, 0.1, 0.35, T])
    A = sampled_matrix(times, three_states([0.0, 0.2, 0.4, 0.0]), between="steps")
    for t, phase in ((0.05, 0.0), (0.2, 0.2), (0.6, 0.4)):
        np.testing.assert_array_equal(A(np.array([t]))[0], three_states([phase])[0])


def test_samples_are_met_and_lines_lie_between():
    times = np.array([0.0, 0.1, 0.3, 0.55])
    values = three_states(times)
    A = sampled_matrix(times, values, period=T)
    np.testing.assert_allclose(A(times), values, rtol=1e-13)
    np.testing.assert_allclose(A(np.array([0.2]))[0], 0.5 * (values[1] + values[2]), rtol=1e-13)
    # After the last row the line leads to the first matrix at the end of the period.
    np.testing.assert_allclose(A(np.array([0.625]))[0], 0.5 * (values[3] + values[0]), rtol=1e-13)


@pytest.mark.parametrize("between", ["linear", "cubic"])
def test_the_first_time_does_not_matter(between):
    """A table of one period that begins elsewhere: another monodromy matrix, the same multipliers."""
    first = np.linspace(0.0, T, 24, endpoint=False)
    expected = of_table(first, three_states(first), period=T, between=between).multipliers
    for begin in (-14, 7, 171):  # the same samples, in another order
        times = begin * T / 24 + first
        result = of_table(times, three_states(times), period=T, between=between).multipliers
        np.testing.assert_allclose(result, expected, rtol=1e-9)


def test_a_time_that_stands_twice_is_a_jump():
    """A sawtooth and a jump inside, against the same function as polynomials."""
    # K = 40 + 20 t/T up to 0.4 T, then 90, falling to 50 at T, where it jumps to 40.
    times = T * np.array([0.0, 0.4, 0.4, 1.0, 1.0])
    stiffness = np.array([40.0, 48.0, 90.0, 50.0, 40.0])
    slopes = [[40.0, 20.0 / T], [90.0, -40.0 / (0.6 * T)]]
    exact = PiecewisePolynomial(T * np.array([0.0, 0.4, 1.0]), slopes)
    K = sampled_matrix(times, stiffness[:, None, None])
    table = monodromy(from_second_order(1.0, 0.3, K, T), 1e-12)
    expected = monodromy(from_second_order(1.0, 0.3, PeriodicMatrix(0.0, (exact, 1.0)), T), 1e-12)
    assert distance(table, expected) < 1e-11


def test_equal_entries_are_one_function_and_symmetry_stays_exact():
    """Two coupled oscillators without damping: the verdict is proven by the symmetry of the samples."""
    times = np.linspace(0.0, T, 17)
    wave = np.cos(2.0 * np.pi * times / T) ** 3
    K = np.array([[60.0, -7.0], [-7.0, 95.0]]) + wave[:, None, None] * np.array([[4.0, 1.3], [1.3, -2.0]])
    entries = changing_entries(K)
    assert entries.values.shape[0] == 3
    for between in ("linear", "cubic"):
        system = from_second_order(np.eye(2), np.zeros((2, 2)), sampled_matrix(times, K, between=between), T)
        assert system.conservative
        assert monodromy(system).verdict == "neutral"
    one_sided = K.copy()
    one_sided[3, 0, 1] *= 1.0 + 1e-12
    other = from_second_order(np.eye(2), np.zeros((2, 2)), sampled_matrix(times, one_sided), T)
    assert not other.conservative


def test_a_hamiltonian_matrix_of_the_first_order_stays_one():
    """A = [[B, D], [-K, -B^T]] with a and -a on the diagonal: entries that are equal but for the sign."""
    times = np.linspace(0.0, T, 9)
    a, k = 0.3 * np.sin(2.0 * np.pi * times / T), 50.0 + np.cos(2.0 * np.pi * times / T)
    a[-1], k[-1] = a[0], k[0]
    A = np.array([[a, 1.0 + 0.0 * a], [-k, -a]]).transpose(2, 0, 1)
    system = PeriodicSystem(sampled_matrix(times, A, between="cubic"), T)
    assert system.symplectic
    assert monodromy(system).verdict == "neutral"


def test_variation_is_about_the_mean_and_the_period_is_stretched():
    times = np.array([0.0, 0.1, 0.3, 0.55])
    table = matrix_table(times, three_states(times), period=T)
    fine = (np.arange(20000) + 0.5) / 20000
    mean = table.matrix()(fine * T).mean(axis=0)
    np.testing.assert_allclose(table.matrix(variation=0.0)(np.array([0.2]))[0], mean, atol=1e-6)
    stretched = table.matrix(2.0, 1.5)(2.0 * fine[::777])
    np.testing.assert_allclose(stretched, mean + 1.5 * (table.matrix()(fine[::777] * T) - mean), atol=1e-6)


def test_every_second_row_tells_what_the_samples_leave_out():
    """Lines: the distance of the rows is doubled, so the change is three times the error of the table."""
    times = np.linspace(0.0, T, 81)
    table = matrix_table(times, three_states(times))
    exact, fine, coarse = (
        m.spectral_radius
        for m in (
            exact_multipliers(),
            monodromy(PeriodicSystem(table.matrix(), T), 1e-12),
            monodromy(PeriodicSystem(table.coarser().matrix(), T), 1e-12),
        )
    )
    assert (coarse - fine) / (fine - exact) == pytest.approx(3.0, rel=0.1)
    with_jump = matrix_table([0.0, 0.1, 0.1, 0.4, T], three_states([0.0, 0.1, 0.3, 0.2, 0.0]))
    assert with_jump.coarser().rows.times.tolist() == [0.0, 0.1, 0.1, T]
    assert matrix_table(times, three_states(times), between="steps").coarser() is None


@pytest.mark.parametrize(("times", "options", "field", "word"), [
    ([0.0, 0.2, 0.1, T], {}, "times", "0.1 s after 0.2 s"),
    ([0.0, 0.2, 0.4, T], {"period": 0.5}, "period", "at least 0.7 s"),
    ([0.0, 0.1, 0.2, 0.3], {"period": T}, "times", "up to the end of the period"),
    ([0.0, 0.2, 0.4, 0.55], {}, "matrices", "Name the period"),
    ([0.0, 0.2, 0.4, 0.55], {"period": -1.0}, "period", "> 0"),
    ([0.0, 0.2, 0.2, 0.2], {}, "times", "three times"),
    ([0.0, 0.2, 0.2, T], {"between": "steps"}, "times", "twice"),
    ([0.0, 0.2, 0.4, T], {"between": "cubic"}, "times", "at least 5"),
    ([0.0, 0.2, 0.4, T], {"between": "quadratic"}, "between", "linear, cubic, steps"),
    ([0.0, 0.2, T], {}, "matrices", "(3, n, n)"),
    ([0.0, 0.2, np.nan, T], {}, "times", "finite"),
])  # fmt: skip
def test_what_is_no_table_of_one_period_is_refused(times, options, field, word):
    with pytest.raises(ParameterError) as refused:
        sampled_matrix(times, three_states([0.0, 0.2, 0.4, 0.55 if times[-1] == 0.55 else T]), **options)
    assert refused.value.problems[0].field == field
    assert word in str(refused.value)


def test_matrices_with_the_times_last_are_recognised():
    times = np.array([0.0, 0.2, 0.4, T])
    with pytest.raises(ParameterError, match="moveaxis"):
        sampled_matrix(times, np.moveaxis(three_states(times), 0, -1))


def test_a_table_contradicts_another_period_of_the_system():
    times = np.array([0.0, 0.2, 0.4, T])
    A = sampled_matrix(times, three_states(times))
    with pytest.raises(ParameterError, match=r"the period 0\.7 s.*repeats after the period, 0\.8 s"):
        PeriodicSystem(A, 0.8)
    PeriodicSystem(A, 2.0 * T)
