"""Floquet theory for any linear system with periodic coefficients, and its application to the gear pair."""

from floquet.monodromy import Monodromy, monodromy
from floquet.propagators import PROPAGATORS, Propagator
from floquet.system import PeriodicSystem

__all__ = ["PROPAGATORS", "Monodromy", "PeriodicSystem", "Propagator", "monodromy"]
