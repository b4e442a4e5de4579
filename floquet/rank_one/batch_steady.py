"""Periodic motion of rank-one feedback systems under forcing, for many points at once (compiled).

Sources: docs/theory/floquet.md, "Forced motion from the same matrix".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from floquet.engine.multipliers import radii_with_bounds, verdicts
from floquet.engine.spectrum import Certificate
from floquet.rank_one.batch import Points, in_threads, multipliers_of
from floquet.rank_one.kernels.steady import Balance as KernelBalance
from floquet.rank_one.kernels.steady import periodic_points
from floquet.rank_one.system import RankOneSystem, padded
from lumped.arguments import whole_number
from lumped.errors import NumericalError
from lumped.typing import FloatArray


@dataclass(frozen=True, eq=False)
class FastPeriodicMotion:
    """Periodic motion of N variants of one system.

    Attributes
    ----------
    initial : (N, 2m) state (z, z') at t = 0, in the units of the system, for a gear pair [m, m/s]
    errors : (N,) estimate of the norm of the error of ``initial`` in energy coordinates (`ModalForm`)
    amplitude : (N,) of the input of `Balance`; 0 where the system has none
    amplitude_errors : (N,) estimate of its error
    energy_norm : (N,) norm of ``initial`` in energy coordinates, to judge ``errors`` by
    deflection : (N, S) v . z at the phases j/S of the period
    spectral_radius, radius_errors : (N,) largest |multiplier|, with a bound on its error
    certificate : of ``radius_errors`` and so of ``verdict``
    """

    initial: FloatArray
    errors: FloatArray
    amplitude: FloatArray
    amplitude_errors: FloatArray
    energy_norm: FloatArray
    deflection: FloatArray
    spectral_radius: FloatArray
    radius_errors: FloatArray
    certificate: Certificate = "proven"

    @property
    def verdict(self) -> npt.NDArray[np.int8]:
        """(N,) 1 stable, 0 undecided, -1 unstable: the motion exists, but nothing stays near it."""
        return verdicts(self.spectral_radius, self.radius_errors)


def fast_periodic_motions(
    system: RankOneSystem,
    periods: npt.ArrayLike | None = None,
    damping_factors: npt.ArrayLike = 1.0,
    gain_factors: npt.ArrayLike = 1.0,
    *,
    samples: int = 64,
    tolerance: float = 1e-12,
    threads: int | None = None,
    max_steps: int = 20_000,
) -> FastPeriodicMotion:
    """Periodic motions for many periods T and factors on wd and on the varied gains.

    Stable or not: ``verdict`` of the result says which. Nothing settles: x(0) solves (I - M) x(0) =
    x_rest(T), x_rest being the motion from rest.

    Parameters
    ----------
    system : the system with its forcing
    periods, damping_factors, gain_factors, tolerance, threads, max_steps : as in `fast_monodromies`
    samples : S, how often per period v . z is returned; 0 to 65536

    Raises
    ------
    NumericalError
        Too many steps or terms, or a period at which a multiplier is so close to +1 that no periodic motion
        can be told.
    """
    S = whole_number("samples", samples, 0, 65536)
    points = Points.of(system, periods, damping_factors, gain_factors, tolerance, threads, max_steps)
    n, N = 2 * system.v.size, points.periods.size
    start, bound, amplitude, deflection = np.zeros((N, n)), np.zeros((N, 2)), np.zeros(N), np.zeros((N, S))
    radius, radius_error = np.empty(N), np.empty(N)
    balance = _kernel_balance(system)

    def run(part: slice) -> int:
        M, delta = np.full((part.stop - part.start, n, n), np.nan), np.zeros(part.stop - part.start)
        failed = int(periodic_points(
            *points.row_arguments(part), balance,
            start[part], bound[part], amplitude[part], deflection[part], M, delta,
        ))  # fmt: skip
        if failed >= 0:
            return int(part.start) + failed
        found = multipliers_of(M, delta)
        radius[part], radius_error[part] = radii_with_bounds(found.multipliers, found.errors)
        return -1

    points.refuse_failures(in_threads(run, N, threads))
    singular = np.flatnonzero(~np.isfinite(bound[:, 0]))
    if singular.size:
        raise NumericalError(
            f"no periodic motion can be told at period {points.periods[singular[0]]:g} s: a multiplier is "
            "at +1 within the error. Change the period slightly, add damping or tighten the tolerance."
        )
    initial = start @ system.modal().state_matrix().T
    size = np.linalg.norm(start, axis=1)
    return FastPeriodicMotion(
        initial, bound[:, 0], amplitude, bound[:, 1], size, deflection, radius, radius_error
    )


def _kernel_balance(system: RankOneSystem) -> KernelBalance:
    balance = system.balance
    if balance is None:
        return KernelBalance(np.zeros((len(system.parts), system.phases.size - 1, 4, 1)), 0.0, 0.0)
    rows = [[part.w, part.wd, part.f, part.fr] for part in balance.gains]
    count = max(poly.shape[2] for row in rows for poly in row)
    psi = np.stack([np.stack([padded(poly[:, 0], count) for poly in row], axis=1) for row in rows])
    return KernelBalance(psi, float(balance.known), float(balance.own))
