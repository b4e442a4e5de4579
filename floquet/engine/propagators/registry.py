"""The propagators by name."""

from __future__ import annotations

from scipy.integrate import DOP853

from floquet.engine.propagators.one_step import ExplicitRungeKutta, GaussLegendre, Propagator
from lumped.arguments import one_of

_CLASSICAL = [[0.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]

PROPAGATORS: dict[str, Propagator] = {
    "gauss": GaussLegendre(6),
    "gauss4": GaussLegendre(2),
    "rk4": ExplicitRungeKutta("rk4", 4, _CLASSICAL, [1 / 6, 1 / 3, 1 / 3, 1 / 6], [0.0, 0.5, 0.5, 1.0]),
    "dop853": ExplicitRungeKutta("dop853", 8, DOP853.A, DOP853.B, DOP853.C),
}
"""Name -> propagator; "gauss" is the default: order 12, symplectic, A-stable."""


def propagator(method: str | Propagator) -> Propagator:
    """Return the propagator of this name, or the given propagator itself; refuse other names."""
    if isinstance(method, Propagator):
        return method
    return PROPAGATORS[one_of("method", method, PROPAGATORS, "Choose one of these, or pass a Propagator.")]
