"""Is a callable of one time or of many times taken as its argument says, and is a mistake named?"""

import numpy as np
import pytest

from floquet import PeriodicSystem, from_second_order, monodromy
from lumped.errors import ParameterError

T = 1.3


def many(n):
    """A(t) of n states for an array of times."""
    root = np.random.default_rng(n).normal(size=(2, n, n))

    def A(times):
        return root[0] + np.cos(2.0 * np.pi * times / T)[:, None, None] * root[1]

    return A


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_one_time_and_many_times_are_one_system(n):
    A = many(n)
    together = monodromy(PeriodicSystem(A, T, vectorized=True))
    alone = monodromy(PeriodicSystem(lambda t: A(np.array([t]))[0], T))
    np.testing.assert_allclose(together.matrix, alone.matrix, rtol=1e-9, atol=1e-9)


def test_matrices_of_second_order_take_many_times_too():
    def K(times):
        return (
            np.array([[30.0, 2.0], [-1.0, 50.0]]) * (1.0 + 0.2 * np.cos(2 * np.pi * times / T))[:, None, None]
        )

    together = monodromy(from_second_order(np.eye(2), 0.1 * np.eye(2), K, T, vectorized=True))
    alone = monodromy(from_second_order(np.eye(2), 0.1 * np.eye(2), lambda t: K(np.array([t]))[0], T))
    np.testing.assert_allclose(together.matrix, alone.matrix, rtol=1e-9)
    with pytest.raises(ParameterError, match=r"K\(t\).*Put the times first"):
        from_second_order(np.eye(2), 0.0 * np.eye(2), lambda t: np.moveaxis(K(t), 0, -1), T, vectorized=True)


@pytest.mark.parametrize(("A", "vectorized", "field", "word"), [
    (many(2), False, "vectorized", "set vectorized=True"),
    (lambda t: np.array([[0.0, 1.0], [-1.0 - np.cos(t), -0.1]]), True, "vectorized", "leave vectorized out"),
    (lambda t: np.array([[0.0, 1.0], [-1.0, -0.1]]), True, "vectorized", "leave vectorized out"),
    (lambda t: many(3)(np.atleast_1d(t)), False, "vectorized", "set vectorized=True"),
    (lambda t: np.moveaxis(many(2)(t), 0, -1), True, "A with vectorized=True", "moveaxis"),
    (lambda t: np.moveaxis(many(3)(t), 0, -1), True, "A with vectorized=True", "moveaxis"),
    (lambda t: np.moveaxis(many(5)(t), 0, -1), True, "A with vectorized=True", "moveaxis"),
    (lambda t: many(2)(t)[:, :1], True, "A with vectorized=True", "(k, n, n) for k = 3"),
    (lambda t: many(2)(t)[0] if t.size == 1 else many(2)(t), True, "A with vectorized=True", "for one time"),
    (lambda t: many(2)(t - t.min()), True, "A with vectorized=True", "of its own time alone"),
    (lambda t: many(3)(t - t.max()), True, "A with vectorized=True", "of its own time alone"),
    (lambda t: many(2)(np.array([t]))[0, :1], False, "A", "(n, n)"),
    (lambda t: [["a"]], False, "A", "real numbers"),
])  # fmt: skip
def test_a_mistake_is_named(A, vectorized, field, word):
    with pytest.raises(ParameterError) as refused:
        PeriodicSystem(A, T, vectorized=vectorized)
    assert refused.value.problems[0].field == field
    assert word in str(refused.value)


def test_an_error_inside_a_callable_is_not_hidden():
    with pytest.raises(ZeroDivisionError):
        PeriodicSystem(lambda t: 1 / 0, T)
