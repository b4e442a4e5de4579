"""Monodromy matrix and Floquet multipliers with error bounds.

Sources: docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss

from floquet.engine.coefficients import PeriodicMatrix
from floquet.engine.formula_steps import proven_propagation
from floquet.engine.multipliers import Certificate, Spectrum, multipliers_with_bounds
from floquet.engine.neutral import definite_signatures, on_unit_circle
from floquet.engine.propagation import LOOKS, Propagation, error_of_product, propagate
from floquet.engine.propagators.one_step import Propagator
from floquet.engine.propagators.registry import propagator
from floquet.engine.system import PeriodicSystem
from lumped.arguments import of_type, real_number, whole_number
from lumped.errors import NumericalError
from lumped.typing import FloatArray

DEAD = 1e-150
"""Where |M| is below this, the tolerance is no longer relative: such a system is dead after one period."""


@dataclass(frozen=True, eq=False, repr=False)
class Monodromy(Spectrum):
    """The result of `monodromy`; multipliers, exponents, radius, error and verdict are those of `Spectrum`.

    Attributes
    ----------
    matrix : (n, n) Phi(T, 0)
    matrix_error : bound on the 2-norm of the error of D^-1 M D, D = diag(``scaling``): truncation and
        rounding, carried to the end of the period; an estimate, from each step and its two halves, for a
        callable A
    scaling : (n,) the balancing scales d
    liouville_residual : |sum over substeps of log det - integral of tr A|. Taken per substep it stays
        meaningful when M is so nearly singular that its own determinant carries no information.
    method : of computing it
    resolution : features of A(t) that are narrower than this may have been missed [s]; 0 where A is a formula
    """

    matrix: FloatArray
    matrix_error: float
    scaling: FloatArray
    liouville_residual: float
    method: str
    resolution: float


def monodromy(
    system: PeriodicSystem,
    rtol: float = 1e-10,
    *,
    method: str | Propagator = "auto",
    max_substeps: int = 200_000,
) -> Monodromy:
    """Monodromy matrix of x' = A(t) x over one period, with multipliers and error bounds.

    Parameters
    ----------
    system : the periodic system; its forcing, if any, plays no part
    rtol : wanted error of the matrix relative to its norm (in balanced coordinates), 1e-14 to 1e-1
    method : "auto": where A is a `PeriodicMatrix`, Taylor steps with a proven bound, else "gauss"; or a name
        in `floquet.PROPAGATORS`, or a propagator, whose error is an estimate: nothing is known of a callable
        between the samples
    max_substeps : largest number of substeps; more are refused

    Returns
    -------
    Monodromy

    Warns
    -----
    ResolutionWarning
        Further samples between the steps found features that the first ones had missed.

    Raises
    ------
    ParameterError
        rtol out of range or unknown method.
    NumericalError
        Non-finite A, growth beyond floating point, too many substeps, or rounding alone exceeds rtol. The
        text says what to try.
    """
    of_type("system", system, PeriodicSystem, "a PeriodicSystem; of a gear pair: gear_pair_system")
    rtol, max_substeps = checked_effort(rtol, max_substeps)
    automatic = isinstance(method, str) and method == "auto"
    if automatic and isinstance(system.A, PeriodicMatrix):
        return _proven(system, system.A, rtol, max_substeps)
    step = propagator("gauss" if automatic else method)
    local = rtol
    for _attempt in range(4):
        propagation = propagate(system, step, local, max_substeps)
        M, delta, rounding = error_of_product(propagation)
        size = max(float(np.linalg.norm(M, 2)), DEAD)
        if delta <= rtol * size:
            return _record(system, propagation, M, delta, step.name, "estimate")
        if rounding > 0.9 * rtol * size:
            break
        # Growth and decay inside the period amplified the local errors: ask for that much more. What the
        # steps have reached already is the measure, or else the same steps serve again.
        norms = np.linalg.norm(propagation.steps, axis=(1, 2))
        share = np.diff(propagation.times) / system.period
        local = min(local, float((propagation.truncation / (share * norms)).max()))
        local *= max(0.3 * (rtol * size - rounding) / delta, 1e-4)
        if local < 1e-16:
            break
    raise NumericalError(
        f"rtol = {rtol:g} cannot be met: the error bound of the monodromy matrix is {delta / size:.2g} "
        f"of its norm, of which rounding makes {rounding / size:.2g}. Ask for rtol >= "
        f"{2.0 * max(delta, rounding) / size:.1g}, or use a method of higher order (fewer steps, less "
        "rounding); if that is too coarse, the period is too long for double precision."
    )


def checked_effort(rtol: float, max_substeps: int) -> tuple[float, int]:
    """Return tolerance and limit of a propagation, each in its range."""
    advice = "Use 1e-10 for verdicts, 1e-6 for a quick look."
    return (
        real_number("rtol", rtol, 1e-14, 0.1, action=advice),
        whole_number("max_substeps", max_substeps, 2, 10**9, "Leave it at its default."),
    )


def _record(
    system: PeriodicSystem,
    propagation: Propagation,
    balanced: FloatArray,
    delta: float,
    method: str,
    certificate: Certificate,
) -> Monodromy:
    d = propagation.scaling
    multipliers, bounds = multipliers_with_bounds(balanced, delta)
    form = system.kept_form if certificate == "proven" else None
    neutral = False
    if form is not None:
        circle = on_unit_circle(balanced[None], np.array([delta]), multipliers[None], bounds[None])
        neutral = bool(circle[0]) or definite_signatures(balanced, delta, form.scaled(d))
    return Monodromy(
        multipliers=multipliers,
        multiplier_errors=bounds,
        period=system.period,
        matrix=balanced * d[:, None] / d[None, :],
        matrix_error=delta,
        scaling=d,
        liouville_residual=liouville_residual(system, propagation),
        method=method,
        resolution=0.0 if certificate == "proven" else system.period / LOOKS,
        certificate=certificate,
        symplectic=form is not None,
        neutral=neutral,
    )


def _proven(system: PeriodicSystem, A: PeriodicMatrix, rtol: float, max_substeps: int) -> Monodromy:
    propagation, M, delta = proven_propagation(system, A, rtol, max_substeps)
    size = max(float(np.linalg.norm(M, 2)), DEAD)
    if not delta <= rtol * size:
        raise NumericalError(
            f"rtol = {rtol:g} cannot be proven: the bound on the error of the monodromy matrix is "
            f"{delta / size:.2g} of its norm, rounding included. Ask for rtol >= {2.0 * delta / size:.1g}, "
            'or for an estimate: method = "gauss".'
        )
    return _record(system, propagation, M, delta, "taylor", "proven")


def liouville_residual(system: PeriodicSystem, propagation: Propagation) -> float:
    """|sum log det(step) - integral of tr A dt| over one period (Liouville's formula), dimensionless."""
    sign, log_det = np.linalg.slogdet(propagation.steps)
    if (sign <= 0).any():
        return math.inf
    return abs(float(log_det.sum()) - integral_of_trace(system, propagation.times))


def integral_of_trace(system: PeriodicSystem, times: FloatArray) -> float:
    """Integral of tr A over times (N,) by an 8-point Gauss rule between each two, no propagator involved."""
    x, w = leggauss(8)
    start = times[:-1]
    end = times[1:]
    nodes = start[:, None] + (end - start)[:, None] * 0.5 * (x + 1.0)
    total = 0.0
    for first in range(0, start.size, 4096):
        part = slice(first, first + 4096)
        inside = system.inside(nodes[part], start[part, None], end[part, None])
        trace = np.trace(system.evaluate(inside.ravel()), axis1=1, axis2=2).reshape(inside.shape)
        total += float(((end - start)[part] * 0.5 * (trace @ w)).sum())
    return total
