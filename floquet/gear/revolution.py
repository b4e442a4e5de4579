"""Multipliers of a pair whose teeth differ, over its whole period.

Sources: docs/theory/teeth.md, "Stability".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from floquet.engine.multipliers import Certificate, radii_with_bounds
from floquet.gear.multipliers import gear_pair_multipliers
from lumped.arguments import one_of, whole_number
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.teeth.linear import LinearForm, linear_steps
from lumped.teeth.pairs import period_of
from lumped.typing import ComplexArray, FloatArray

#: Multipliers below this share of the largest are rounding of the product of all cycles.
_NOISE = 1e-13
#: Growth beyond the largest number, as a logarithm.
_LARGEST = 700.0


@dataclass(frozen=True, eq=False)
class RevolutionMultipliers:
    """Floquet multipliers over the period of teeth that differ; those below rounding are left out.

    Attributes
    ----------
    multipliers : over the whole period, largest first; 0 where they are below the smallest number
    rates : |multiplier|^(1/cycles), growth of each in one mesh cycle
    rate : the largest one; above 1 the motion is unstable
    error : bound on the error of ``rate``, see ``certificate``
    certificate : "proven" where all mesh cycles have one map, with prescribed contact, no faults and no
        eccentricity: the error is a bound by a theorem; "estimate" else: four times the change of the rate
        with half the steps
    cycles : mesh cycles of the period
    healthy_rate : that of the twin with like teeth, by the same method
    """

    multipliers: ComplexArray
    rates: FloatArray
    rate: float
    error: float
    cycles: int
    healthy_rate: float
    certificate: Certificate

    @property
    def stable(self) -> bool:
        """Whether perturbations fade, beyond the error."""
        return self.rate + self.error < 1.0


def revolution_multipliers(
    pair: AnyPair, *, steps: int | None = None, supports: Supports = "springs"
) -> RevolutionMultipliers:
    """Multipliers over a revolution or hunting period of teeth that differ: docs/theory/teeth.md.

    Perturbations see the tangent of the contact about the own static state of every meeting pair. The maps of
    the mesh cycles are multiplied one after the other and scaled, so that a hunting period of thousands of
    cycles neither overflows nor underflows. With own contacts the error is an estimate: a pair of teeth comes
    into contact where its own gap closes, inside a step, and there the tangent of the contact jumps.

    Parameters
    ----------
    pair : a validated gear pair
    steps : least number of steps in a mesh cycle, 32 to 65536, the error is found with half of them; default
        by the fastest vibration
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``

    Raises
    ------
    ParameterError : steps out of range
    NumericalError : at some position no tooth pair can carry the load
    """
    pair = load_gear_pair(pair)
    one_of("supports", supports, ("springs", "shafts"))
    system = LTVSystem.of(pair.healthy, "mesh" if supports == "springs" else "elastic", supports=supports)
    steps = 4 * linear_steps(system) if steps is None else whole_number("steps", steps, 32, 65536)
    cycles = period_of(pair)
    if LinearForm(pair, system, 1, steps, 1).alike:
        one = gear_pair_multipliers(pair.healthy, supports=supports)
        kept = np.isin(one.multipliers, one.feedback)
        values, sizes = one.multipliers[kept], np.abs(one.multipliers[kept])
        radius, error = map(float, radii_with_bounds(values, one.multiplier_errors[kept]))
        with np.errstate(under="ignore"):
            whole = values**cycles
        return RevolutionMultipliers(whole, sizes, radius, error, cycles, radius, one.certificate)
    multipliers, rates = _of_period(pair, system, cycles, steps)
    coarse = _of_period(pair, system, cycles, steps // 2)[1]
    return RevolutionMultipliers(
        multipliers=multipliers,
        rates=rates,
        rate=float(rates[0]),
        error=4.0 * abs(float(rates[0] - coarse[0])),
        cycles=cycles,
        healthy_rate=float(_of_period(pair.healthy, system, 1, steps)[1][0]),
        certificate="estimate",
    )


def _of_period(pair: GearPair, system: LTVSystem, cycles: int, steps: int) -> tuple[ComplexArray, FloatArray]:
    """Multipliers, largest first, and their rates; those that are rounding left out."""
    product, logarithm = np.eye(2 * len(system.coordinates)), 0.0
    for one in LinearForm(pair, system, 1, steps).cycle_maps()[..., : product.shape[0]]:
        product = one @ product
        size = float(np.abs(product).max())
        product, logarithm = product / size, logarithm + np.log(size)
    values = np.linalg.eigvals(product)
    values = values[np.argsort(-np.abs(values), kind="stable")]
    values = values[np.abs(values) > _NOISE * np.abs(values[0])]
    with np.errstate(under="ignore"):
        rates = np.exp((np.log(np.abs(values)) + logarithm) / cycles)
        return np.asarray(values * np.exp(min(logarithm, _LARGEST))), np.asarray(rates, dtype=np.float64)
