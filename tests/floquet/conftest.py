"""Periodic systems whose monodromy matrix is known in closed form."""

from collections.abc import Callable

import numpy as np
import pytest

from floquet import PeriodicSystem
from tests.evidence.floquet import reference_systems


def accurate_expm(A: np.ndarray) -> np.ndarray:
    """exp(A) by Taylor, scaling and squaring in extended precision.

    scipy.linalg.expm loses up to 1e-12 of the norm when |A| is about 7: more than the errors measured
    against it here.
    """
    X = A.astype(np.longdouble) / 2**10
    total = term = np.eye(len(A), dtype=np.longdouble)
    for k in range(1, 25):
        term = term @ X / k
        total = total + term
    for _ in range(10):
        total = total @ total
    return total.astype(float)


def triangle(t: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Triangle wave g from 0 up to 1 at T/2 and back, with its slope, which jumps at 0 and T/2."""
    phase = np.mod(t / period, 1.0)
    up = phase < 0.5
    return np.where(up, 2 * phase, 2 - 2 * phase), np.where(up, 2 / period, -2 / period)


def lyapunov_system(
    B: np.ndarray, S: np.ndarray, period: float, shape: str = "sine"
) -> tuple[PeriodicSystem, np.ndarray]:
    """A system that the change of variables x = (I + g(t) N) y turns into y' = B y, and Phi(T, 0).

    N = a b^T with a, b the first two columns of S made orthogonal: N^2 = 0, (I + g N)^-1 = I - g N. With g
    periodic and g(0) = 0:  A(t) = g'(t) N + (I + g N) B (I - g N)  and  Phi(T, 0) = exp(B T).
    """
    a, b = S[:, 0], S[:, 1] - S[:, 0] * (S[:, 0] @ S[:, 1]) / (S[:, 0] @ S[:, 0])
    N = np.outer(a, b)

    def A(t: np.ndarray) -> np.ndarray:
        if shape == "sine":
            w = 2 * np.pi / period
            g, slope = np.sin(w * t), w * np.cos(w * t)
        else:
            g, slope = triangle(t, period)
        gN = g[:, None, None] * N
        # (g' N) (I + g N)^-1 = g' N because N^2 = 0.
        return slope[:, None, None] * N + (np.eye(len(B)) + gN) @ B @ (np.eye(len(B)) - gN)

    breaks = () if shape == "sine" else (period / 2,)
    return PeriodicSystem(A, period, breaks, vectorized=True), accurate_expm(B * period)


@pytest.fixture
def known_system() -> Callable[..., tuple[PeriodicSystem, np.ndarray]]:
    return lyapunov_system


@pytest.fixture
def mathieu() -> Callable[..., PeriodicSystem]:
    """x'' + 2 c x' + (a - 2 q cos 2t) x = 0 with its basic period pi."""
    return reference_systems.mathieu
