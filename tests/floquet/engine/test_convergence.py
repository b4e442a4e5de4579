"""Does every propagator show the order that theory gives it, and lose it across a switch?"""

from __future__ import annotations

import numpy as np
import pytest

from floquet import PROPAGATORS, PeriodicSystem
from floquet.engine.propagation import propagate_fixed
from floquet.engine.propagators import GaussLegendre, Propagator, propagator

# Steps over the period at which the error is well above rounding and already asymptotic.
STEPS = {"gauss": 2, "gauss8": 8, "gauss6": 8, "gauss4": 16, "magnus6": 8, "magnus4": 16, "expm": 32,
         "rk4": 64, "dop853": 8}  # fmt: skip


def observed_order(
    method: Propagator, system: PeriodicSystem, exact: np.ndarray, n: int, factor: int
) -> float:
    coarse = np.linalg.norm(propagate_fixed(system, method, n) - exact)
    fine = np.linalg.norm(propagate_fixed(system, method, factor * n) - exact)
    return float(np.log(coarse / fine) / np.log(factor))


@pytest.mark.parametrize("name", sorted(PROPAGATORS))
def test_order_on_smooth_coefficients(name: str, known_system) -> None:
    rng = np.random.default_rng(11)
    B, S = rng.normal(size=(2, 3, 3))
    system, exact = known_system(0.5 * B, 0.45 * S, 4.0)
    method = propagator(name)
    # 0.3: the next term of the error series at these coarse steps.
    assert observed_order(method, system, exact, STEPS[name], 2) == pytest.approx(method.order, abs=0.3)


@pytest.mark.parametrize("stages", [1, 2, 3, 4, 5])
def test_order_of_collocation_is_twice_its_stages(stages: int, known_system) -> None:
    rng = np.random.default_rng(12)
    B, S = rng.normal(size=(2, 3, 3))
    system, exact = known_system(0.5 * B, 0.45 * S, 4.0)
    # 0.3 here and below: the next term of the error series, as above.
    assert observed_order(GaussLegendre(stages), system, exact, 4 if stages > 1 else 32, 2) == pytest.approx(
        2 * stages, abs=0.3
    )


@pytest.mark.parametrize("name", sorted(PROPAGATORS))
def test_order_survives_declared_switches(name: str, known_system) -> None:
    rng = np.random.default_rng(13)
    B, S = rng.normal(size=(2, 3, 3))
    system, exact = known_system(0.5 * B, 0.6 * S, 7.0, "triangle")
    method = propagator(name)
    n = max(1, STEPS[name] // 2)  # per segment
    assert observed_order(method, system, exact, n, 2) == pytest.approx(method.order, abs=0.3)


@pytest.mark.parametrize("name", sorted(PROPAGATORS))
def test_order_falls_to_one_across_an_undeclared_switch(name: str) -> None:
    # A jumps at T/3 and nobody says so. The jump cuts a step of size h at the same fraction for N and 4 N
    # steps (N = 4^k), so the error there is a constant times h.
    low, high = np.array([[0.0, 1.0], [-1.0, 0.0]]), np.array([[0.0, 1.0], [-4.0, 0.0]])

    def A(t: np.ndarray) -> np.ndarray:
        return np.where((t < 1.0 / 3.0)[:, None, None], low, high)

    told = PeriodicSystem(A, 1.0, (1.0 / 3.0,), vectorized=True)
    untold = PeriodicSystem(A, 1.0, vectorized=True)
    exact = propagate_fixed(told, propagator("gauss"), 8)
    order = observed_order(propagator(name), untold, exact, 256, 4)
    assert order == pytest.approx(1.0, abs=0.1)  # h = 1/256: the h^2 term is below a few percent
