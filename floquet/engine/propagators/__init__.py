"""One-step methods for X' = A(t) X, one small file per family, and the registry of their names.

Sources: each propagator names its own; docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

from collections.abc import Callable

from floquet.engine.propagators.base import Propagator
from floquet.engine.propagators.gauss import GaussLegendre
from floquet.engine.propagators.magnus import Magnus4, Magnus6, PiecewiseExponential
from floquet.engine.propagators.runge_kutta import ExplicitRungeKutta, dop853, rk4
from lumped.arguments import one_of

PROPAGATORS: dict[str, Callable[[], Propagator]] = {
    "gauss": lambda: GaussLegendre(6),
    "gauss4": lambda: GaussLegendre(2),
    "gauss6": lambda: GaussLegendre(3),
    "gauss8": lambda: GaussLegendre(4),
    "magnus4": Magnus4,
    "magnus6": Magnus6,
    "expm": PiecewiseExponential,
    "rk4": rk4,
    "dop853": dop853,
}
"""Registered methods; "gauss" is the default: order 12, symplectic, A-stable."""


def propagator(method: str | Propagator) -> Propagator:
    """Return the method of this name, or the given propagator itself.

    Raises
    ------
    ParameterError
        The name is not registered.
    """
    if isinstance(method, Propagator):
        return method
    return PROPAGATORS[one_of("method", method, PROPAGATORS, "Choose one of these, or pass a Propagator.")]()


__all__ = [
    "PROPAGATORS",
    "ExplicitRungeKutta",
    "GaussLegendre",
    "Magnus4",
    "Magnus6",
    "PiecewiseExponential",
    "Propagator",
    "dop853",
    "propagator",
    "rk4",
]
