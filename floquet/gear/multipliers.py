"""Multipliers of a gear pair: the states that feed back, and what moves by itself in closed form.

Sources: docs/theory/floquet.md, "Structure".
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import get_args

import numpy as np

from floquet.engine.monodromy import integral_of_trace, monodromy
from floquet.engine.multipliers import Spectrum
from floquet.engine.propagators.one_step import Propagator
from floquet.engine.system import PeriodicSystem
from floquet.gear.axes import GearVariation
from floquet.gear.block import Feedback, feedback_system, fitted_block
from floquet.rank_one.batch import fast_multipliers
from lumped.arguments import one_of, real_number
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.model.supports import Form
from lumped.schema.files import AnyPair
from lumped.typing import ComplexArray, FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)


@dataclass(frozen=True, eq=False)
class GearPairMultipliers(Spectrum):
    """Multipliers of a gear pair over one mesh cycle, 10 in all; on shafts two for each mode.

    They do not include the double +1 of the free rotation: angle and speed of the pair are arbitrary.

    Attributes
    ----------
    feedback : (6,) of q = r_bp theta_p - r_bg theta_g, x_p, x_g, which alone can become unstable; on shafts
        those of the modes that count most
    oloa : (4,) of y_p, y_g, two each: driven by friction without acting back, so those of their bearings;
        on shafts those of the other modes, each by itself
    variation : the pair, as it was varied
    """

    feedback: ComplexArray
    oloa: ComplexArray
    variation: GearVariation

    @cached_property
    def liouville_residual(self) -> float:
        """Product of ``feedback`` less exp of the integral of tr A(t) over the period (Liouville's formula).

        The integral takes A(t) of the lumped model, which the compiled kernel does not see. Where damping
        leaves little of a motion in one period, both are next to 0 and the residual says little.
        """
        system = gear_pair_system(self.variation, "mesh")
        edges = np.array([0.0, *system.breakpoints, system.period])
        expected = np.exp(integral_of_trace(system, edges))
        return float(abs(np.prod(self.feedback) - expected))


def gear_pair_system(
    source: AnyPair | GearVariation, form: Form = "elastic", *, supports: Supports = "springs"
) -> PeriodicSystem:
    """Return the gear pair (or a variation of it) as a `PeriodicSystem`.

    Parameters
    ----------
    source : the pair
    form : "elastic" (10 states), "mesh" (6) or "full" (12), as in ``lumped.periodic_system``; on
        shafts more, and "mesh" with the modes that count only, see `gear_pair_multipliers`
    supports : of a pair: "springs", its ``bearings``, or its "shafts"
    """
    variation = GearVariation.of(source, supports)
    one_of("form", form, get_args(Form))
    if form == "mesh":
        system = feedback_system(variation).system
    else:
        system = LTVSystem.of(variation.pair, form, cycle=variation.cycle(), supports=variation.supports)
    coefficients = _Coefficients(system, variation.stiffness_variation)
    return PeriodicSystem(coefficients, system.period, tuple(system.breakpoints), vectorized=True)


@dataclass(frozen=True, eq=False)
class _Coefficients:
    """A(t) strictly inside the smooth segments, the total mesh stiffness k being mean + factor (k - mean).

    Every pair keeps its share of k, so k_i is multiplied by f = (mean + factor (k - mean))/k and c_i, which
    goes with sqrt(k_i), by sqrt(f).
    """

    system: LTVSystem
    factor: float

    def __call__(self, times: FloatArray) -> FloatArray:
        system, edges = self.system, self.system.cycle.edges
        # The mesh cycle by itself takes a time just before a switch as the switch: name the segment.
        segment = np.clip(np.searchsorted(edges, times, side="right") - 1, 0, edges.size - 2)
        gain = system.gain(times, segment)
        stiffness, damping = gain.stiffness, gain.damping
        if self.factor != 1.0:
            total, mean = gain.pairs.stiffness.sum(axis=0), system.cycle.mean_stiffness
            f = ((mean + self.factor * (total - mean)) / total)[:, None]
            stiffness, damping = f * stiffness, np.sqrt(f) * damping
        m = len(system.coordinates)
        A = np.repeat(system.constant[None], times.size, axis=0)
        A[:, m:, :m] += stiffness[:, :, None] * system.deflection
        A[:, m:, m:] += damping[:, :, None] * system.deflection
        return A


@dataclass(frozen=True, eq=False)
class OffLineOfAction:
    """Exponents of the motions y_p, y_g off the line of action, or of separate modes on shafts; closed form.

    m y'' + c y' + K y = 0 for each: s = -d +- sqrt(r), d = c/(2 m), r = d^2 - K/m, multipliers exp(s T).

    Attributes
    ----------
    exponents : (4,) s [1/s]; on shafts two for each mode
    errors : (4,) bounds on their errors for m, c and K that are right to rounding [1/s]. With e a bound on
        the error of r, sqrt(r) is wrong by at most min(sqrt e, e/sqrt |r|): at critical damping by sqrt e.
    """

    exponents: ComplexArray
    errors: FloatArray

    @classmethod
    def of(cls, feedback: Feedback) -> OffLineOfAction:
        """Of what the mesh does not couple."""
        decay, square = feedback.separate
        r = decay**2 - square
        root = np.sqrt(r.astype(complex))
        # Twelve units of rounding: those of m, c and K, of d^2, of K/m and of the difference.
        e = 12.0 * _U * (decay**2 + square)
        with np.errstate(divide="ignore", invalid="ignore"):
            wrong = np.minimum(np.sqrt(e), np.where(r == 0.0, np.inf, e / np.abs(root)))
        errors = wrong + 4.0 * _U * (decay + np.abs(root))
        return cls(np.concatenate([-decay + root, -decay - root]), np.concatenate([errors, errors]))

    def multipliers(self, periods: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """Multipliers over periods (N,) -> (N, 4), and bounds on their errors."""
        angle = self.exponents * periods[:, None]
        values = np.exp(angle)
        # Sixteen units: the product, and periods that are made of speeds in rpm.
        wrong = self.errors * periods[:, None] + 16.0 * _U * np.abs(angle)
        return values, np.abs(values) * (np.expm1(wrong) + 8.0 * _U)


def gear_pair_multipliers(
    source: AnyPair | GearVariation,
    rtol: float = 1e-10,
    *,
    method: str | Propagator = "taylor",
    supports: Supports = "springs",
) -> GearPairMultipliers:
    """Floquet multipliers of a gear pair over one mesh cycle.

    The equations of y_p and y_g contain q, x_p, x_g but not the other way round, so the 10 x 10 matrix is
    block triangular: its multipliers are those of the 6 x 6 feedback block and of the bearings of y. On
    shafts gyroscopic moments close this circle. The feedback block then has the 12 modes that count most in
    the motion of the mesh, and the bounds are those of a system in which the others move each by itself.

    Parameters
    ----------
    source : a gear pair, or a variation from a chart
    rtol : wanted error of the monodromy matrix relative to its norm, 1e-13 to 1e-1
    method : "taylor", the compiled kernel, whose bound is proven; or a method of `monodromy` on A(t) as a
        callable, for an independent estimate
    supports : of a pair: "springs", its ``bearings``, or its "shafts"

    Returns
    -------
    GearPairMultipliers

    Raises
    ------
    ParameterError : rtol out of range, unknown method or supports
    NumericalError : as in `monodromy`
    """
    variation = GearVariation.of(source, supports)
    rtol = real_number("rtol", rtol, 1e-13, 0.1)
    feedback = feedback_system(variation)
    own: Spectrum
    if isinstance(method, str) and method == "taylor":
        own = _proven(feedback, variation.stiffness_variation, rtol)
    else:
        own = monodromy(gear_pair_system(variation, "mesh"), rtol, method=method)
    (oloa,), (oloa_errors,) = OffLineOfAction.of(feedback).multipliers(np.array([own.period]))
    values = np.concatenate([own.multipliers, oloa])
    errors = np.concatenate([own.multiplier_errors, oloa_errors])
    order = np.argsort(-np.abs(values), kind="stable")
    return GearPairMultipliers(
        multipliers=values[order],
        multiplier_errors=errors[order],
        period=own.period,
        feedback=own.multipliers,
        oloa=oloa,
        variation=variation,
        certificate=own.certificate,
    )


def _proven(feedback: Feedback, factor: float, rtol: float) -> Spectrum:
    """Multipliers of the feedback block by the compiled kernel."""
    block = fitted_block(feedback, factor, max(0.01 * rtol, 1e-13), [])
    result = fast_multipliers(block, tolerance=max(1e-4 * rtol, 1e-14))
    order = np.argsort(-np.abs(result.multipliers[0]), kind="stable")
    return Spectrum(result.multipliers[0][order], result.errors[0][order], block.period, certificate="proven")
