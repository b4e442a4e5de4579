"""Is the order of every propagator kept across declared switches, and lost across undeclared ones?"""

import numpy as np
import pytest

from floquet import PROPAGATORS, PeriodicSystem
from floquet.engine.propagators.one_step import GaussLegendre, Propagator
from floquet.engine.propagators.registry import propagator
from tests.evidence.floquet.closed_forms import propagate_fixed


def error(method: Propagator, system: PeriodicSystem, exact: np.ndarray, steps: int) -> float:
    return float(np.linalg.norm(propagate_fixed(system, method, steps) - exact))


def observed_order(method: Propagator, system: PeriodicSystem, exact: np.ndarray) -> float:
    """Order from the last two numbers of steps, each twice the one before, whose error is above rounding."""
    errors = [error(method, system, exact, 1)]
    while errors[-1] > 1e-10 * np.linalg.norm(exact) and len(errors) < 9:
        errors.append(error(method, system, exact, 2 ** len(errors)))
    return float(np.log2(errors[-2] / errors[-1]))


@pytest.mark.parametrize("method", [*PROPAGATORS.values(), *map(GaussLegendre, (1, 5))])
def test_order_survives_declared_switches(method, known_system) -> None:
    B, S = np.random.default_rng(13).normal(size=(2, 3, 3))
    system, exact = known_system(0.5 * B, 0.6 * S, 7.0, "triangle")
    # 0.3: the next term of the error series.
    assert observed_order(method, system, exact) == pytest.approx(method.order, abs=0.3)


@pytest.mark.parametrize("name", PROPAGATORS)
def test_order_falls_to_one_across_an_undeclared_switch(name: str) -> None:
    # A jumps at T/3 and nobody says so. The jump cuts a step of size h at the same fraction for N and 4 N
    # steps (N = 4^k), so the error there is a constant times h.
    low, high = np.array([[0.0, 1.0], [-1.0, 0.0]]), np.array([[0.0, 1.0], [-4.0, 0.0]])

    def A(t: np.ndarray) -> np.ndarray:
        return np.where((t < 1.0 / 3.0)[:, None, None], low, high)

    told = PeriodicSystem(A, 1.0, (1.0 / 3.0,), vectorized=True)
    untold = PeriodicSystem(A, 1.0, vectorized=True)
    exact = propagate_fixed(told, propagator("gauss"), 8)
    coarse, fine = (error(propagator(name), untold, exact, n) for n in (256, 1024))
    order = np.log(coarse / fine) / np.log(4.0)
    assert order == pytest.approx(1.0, abs=0.1)  # h = 1/256: the h^2 term is below a few percent
