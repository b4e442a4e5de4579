"""Periodic motion as plain arrays, for maps and samples of many motions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from lumped.model.periodic_system import periodic_system
from lumped.model.results import response
from lumped.model.steady import periodic_solution, sample_times
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: A largest multiplier above this is an instability. Without damping it is 1, and steps and rounding move a
#: defective multiplier by up to the root of their error, 1e-12.
UNSTABLE = 1.0 + 1e-6


@dataclass(frozen=True, eq=False)
class PeriodicCycle:
    """Periodic motion over one mesh cycle.

    Attributes
    ----------
    values : variable of ``lumped.model.results.VARIABLES`` -> (k,) or (pairs, k), in SI
    spectral_radius : largest modulus of the Floquet multipliers
    """

    values: Mapping[str, FloatArray]
    spectral_radius: float


def periodic_cycle(pair: GearPair, samples: int) -> PeriodicCycle:
    """Periodic motion of the lumped model without error estimate, labels and provenance: half the time.

    Parameters
    ----------
    pair : a validated gear pair
    samples : times per mesh cycle

    Raises
    ------
    NumericalError : the speed sits on a stability boundary, where no periodic motion exists
    """
    system = periodic_system(pair, "absolute")
    times = sample_times(system.period, samples)
    solution = periodic_solution(system, times, estimate_error=False)
    return PeriodicCycle(response(system, times, solution.states), solution.spectral_radius)
