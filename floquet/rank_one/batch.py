"""Monodromy matrices of rank-one feedback systems by the compiled Taylor kernel, for many points at once.

Sources: docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from floquet.engine.many_multipliers import FastMultipliers, multipliers_of, quick_multipliers
from floquet.rank_one.kernel_input import own, packed
from floquet.rank_one.kernels.gains import Limits, Points, Problem, most_steps
from floquet.rank_one.kernels.taylor import propagate_points
from floquet.rank_one.largest_flow import no_steps
from floquet.rank_one.system import RankOneSystem
from lumped.arguments import real_array, real_number, real_numbers
from lumped.cache import cores
from lumped.compiler import in_threads
from lumped.errors import NumericalError, refuse, shown
from lumped.typing import FloatArray

_T = TypeVar("_T")

MOST = 20
"""Coordinates at most: the time and the memory of a step grow like their square and more."""
_FEWEST = 24  # points of a thread: to start one takes as long as some points
_DIES_OUT = 0.9  # spectral radius below which a motion is far from any boundary


@dataclass(frozen=True, eq=False)
class FastMonodromy:
    """Monodromy matrices of N variants of one system, in energy coordinates.

    Attributes
    ----------
    matrices : (N, 2m, 2m) in x = (omega eta, eta') of `ModalForm`, dimensionless
    errors : (N,) bound on the Frobenius norm of the error of each: majorant of the truncation, misfit of the
        polynomials, rounding; proven, see docs/theory/proven_bounds.md
    """

    matrices: FloatArray
    errors: FloatArray


def fast_monodromies(
    system: RankOneSystem,
    periods: npt.ArrayLike | None = None,
    damping_factors: npt.ArrayLike = 1.0,
    gain_factors: npt.ArrayLike = 1.0,
    *,
    tolerance: float = 1e-13,
    problem: Problem | None = None,
) -> FastMonodromy:
    """Monodromy matrices for many periods T and factors on wd and on the varied gains.

    Parameters
    ----------
    system : the system; its phases, w and wd are taken as independent of T
    periods : (N,) [s]; default the system's own
    damping_factors : (N,) or scalar, factor on wd
    gain_factors : (N,) or scalar, factor on the gains ``system.varied``, or (N, Q-1), one for each set
    tolerance : largest neglected remainder of one step, in units of the energy norm
    problem : the same system in the form of the kernels, by `packed`; default made here

    Raises
    ------
    NumericalError : too many steps or terms, or a result that is not finite
    """
    if system.v.size > MOST:
        raise refuse(
            "coordinates", system.v.size, f"at most {MOST}", "Use floquet.monodromy for larger systems."
        )
    request = system.period if periods is None else periods
    T = own(real_numbers("periods", request, 0.0, above=True, unit="s"))
    tolerance = real_number("tolerance", tolerance, 1e-16, 0.1)
    factors = np.ones((T.size, len(system.parts)))
    gains = _factors("gain_factors", gain_factors, T.shape, factors[:, 1:].shape)
    factors[:, 1:] = gains if gains.ndim == 2 else gains[:, None]
    zeta = own(_factors("damping_factors", damping_factors, T.shape))
    # Longer steps have fewer terms per unit of time, but amplify rounding, 30 eps = exp(-32.6), by
    # exp(angle): to an eighth of the tolerance.
    limits = Limits(tolerance, min(max(math.log(tolerance) + 30.5, 3.0), 9.0))
    problem = packed(system) if problem is None else problem
    n = 2 * system.v.size
    M = np.empty((T.size, n, n))
    bound = np.empty(T.size)

    def run(part: slice) -> int:
        points = Points(factors[part], zeta[part], T[part])
        failed = propagate_points(problem, points, limits, M[part], bound[part], no_steps(n))
        return -1 if failed < 0 else part.start + failed

    bad = [index for index in _in_slices(run, T.size) if index >= 0]
    if bad:
        raise NumericalError(
            f"period {T[bad[0]]:g} s needs more than {most_steps(n)} Taylor steps, or a step more terms than "
            "the kernel has. Loosen the tolerance, raise the speed, or leave out the highest natural "
            "frequencies."
        )
    if not np.isfinite(M).all():
        raise NumericalError(
            "the state grows beyond floating point within one period; shorten the period (raise the speed)."
        )
    return FastMonodromy(M, bound)


def fast_multipliers(
    system: RankOneSystem,
    periods: npt.ArrayLike | None = None,
    damping_factors: npt.ArrayLike = 1.0,
    gain_factors: npt.ArrayLike = 1.0,
    *,
    tolerance: float = 1e-13,
) -> FastMultipliers:
    """Floquet multipliers for many periods and factors on wd, with error bounds.

    Parameters and errors as in `fast_monodromies`. Where multipliers are so close together that the quick
    bound of the kernel does not separate them (defective ones at the edges of tongues),
    `multipliers_with_bounds` decides.
    """
    flow = fast_monodromies(system, periods, damping_factors, gain_factors, tolerance=tolerance)
    parts = _in_slices(lambda part: multipliers_of(flow.matrices[part], flow.errors[part]), flow.errors.size)
    return FastMultipliers(
        np.concatenate([part.multipliers for part in parts]), np.concatenate([part.errors for part in parts])
    )


def spectral_radii(
    system: RankOneSystem, periods: npt.ArrayLike, damping_factors: npt.ArrayLike, *, tolerance: float
) -> FloatArray:
    """Largest moduli (N,) of the multipliers; from 0.9 on, where searches decide, as of `fast_multipliers`.

    To bound those of a motion that nearly dies out within a period would take a hundred times as long.
    """
    flow = fast_monodromies(system, periods, damping_factors, tolerance=tolerance)

    def largest(part: slice) -> FloatArray:
        matrices = flow.matrices[part]
        errors = flow.errors[part]
        values, _, safe = quick_multipliers(matrices, errors)
        values[~safe] = np.linalg.eigvals(matrices[~safe])
        radii = np.asarray(np.abs(values).max(axis=1))
        near = ~safe & (radii > _DIES_OUT)
        radii[near] = np.abs(multipliers_of(matrices[near], errors[near]).multipliers).max(axis=1)
        return radii

    return np.concatenate(_in_slices(largest, flow.errors.size))


def _factors(
    name: str, request: npt.ArrayLike, each: tuple[int, ...], parts: tuple[int, ...] | None = None
) -> FloatArray:
    """Factors, one per variant, or where ``parts`` is a shape, one per variant and part."""
    array = real_array(name, request)
    if np.isfinite(array).all():
        if parts is not None and array.shape == parts:
            return array
        if array.shape in ((), (1,), each):
            return np.broadcast_to(array, each)
    raise refuse(name, shown(request), f"finite, one or {each[0]}", "Give one factor per period.")


def _in_slices(run: Callable[[slice], _T], size: int) -> list[_T]:
    """Results of ``run`` on slices of range(size)."""
    chunk = max(_FEWEST, min(512, -(-size // cores())))
    return in_threads(run, [slice(first, min(first + chunk, size)) for first in range(0, size, chunk)])
