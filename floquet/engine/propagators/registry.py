"""The propagators by name, with all that is known of each before it is imported.

Sources: each propagator names its own; docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from floquet.engine.propagators.base import Propagator


@dataclass(frozen=True)
class Registered:
    """A propagator as lists, help texts and tests know it.

    Attributes
    ----------
    title : what it is called
    order : p; the error over a period falls with the p-th power of the step
    needs : what one step takes for a system of n states
    home : file in this folder and the name there of what makes the propagator
    arguments : of the maker
    symplectic : whether a Hamiltonian A(t) makes every step symplectic to rounding
    coarse_steps : number of steps over the period of Mathieu's equation, a = 3 and q = 2, from which halving
        the step shows the order: the error is asymptotic there and well above rounding
    """

    title: str
    order: int
    needs: str
    home: tuple[str, str]
    arguments: tuple[int, ...] = ()
    symplectic: bool = False
    coarse_steps: int = 16

    def make(self) -> Propagator:
        """Import the file and return the propagator."""
        module = import_module(f"{__package__}.{self.home[0]}")
        made: Propagator = getattr(module, self.home[1])(*self.arguments)
        return made


def _gauss(stages: int, coarse_steps: int) -> Registered:
    return Registered(
        f"Gauss-Legendre collocation, {stages} stages", 2 * stages, f"a linear solve of {stages} n unknowns",
        ("gauss", "GaussLegendre"), (stages,), symplectic=True, coarse_steps=coarse_steps,
    )  # fmt: skip


PROPAGATORS: dict[str, Registered] = {
    "gauss": _gauss(6, 8),
    "gauss4": _gauss(2, 16),
    "gauss6": _gauss(3, 8),
    "gauss8": _gauss(4, 8),
    "magnus4": Registered(
        "Magnus series with one commutator", 4, "a matrix exponential", ("magnus", "Magnus4"), symplectic=True
    ),
    "magnus6": Registered(
        "Magnus series with three commutators", 6, "a matrix exponential", ("magnus", "Magnus6"),
        symplectic=True, coarse_steps=8,
    ),
    "expm": Registered(
        "A(t) frozen at the middle of the step", 2, "a matrix exponential",
        ("magnus", "PiecewiseExponential"), symplectic=True, coarse_steps=32,
    ),
    "rk4": Registered(
        "Runge-Kutta, explicit, classical", 4, "4 products", ("runge_kutta", "rk4"), coarse_steps=64
    ),
    "dop853": Registered(
        "Runge-Kutta, explicit, Dormand-Prince", 8, "12 products", ("runge_kutta", "dop853")
    ),
}  # fmt: skip
"""Name -> propagator; "gauss" is the default: order 12, symplectic, A-stable."""


def propagator(method: str | Propagator) -> Propagator:
    """Return the propagator of this name, or the given propagator itself.

    Raises
    ------
    ParameterError : the name is not registered
    """
    # Imported here: help texts read the names above, and must not wait for the numerics.
    from floquet.engine.propagators.base import Propagator
    from lumped.arguments import one_of

    if isinstance(method, Propagator):
        return method
    return PROPAGATORS[
        one_of("method", method, PROPAGATORS, "Choose one of these, or pass a Propagator.")
    ].make()
