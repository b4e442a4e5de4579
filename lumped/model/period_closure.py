"""Where a period is closed: the state at the start of a period for which nothing is left at the end.

The lumped model has three ways to a periodic motion:

- ``balanced_start``, here, solves the linear equations of a linear motion. The motion of like teeth
  (``lumped.model.steady``) and of teeth that differ (``lumped.model.cycle_maps``) start from its result.
- ``close_period``, here, is Broyden's method. ``lumped.model.unilateral_motion`` closes the motion of like
  teeth by momentary load with it, ``multibody.run.flow_map`` the motion of the multibody model.
- ``settled_motion`` in ``lumped.model.unilateral_motion`` does not solve for the start: teeth that differ run
  until their start has faded.

The other packages close periods of their own: ``close_orbit`` in ``floquet.orbits.closing``,
``floquet.orbits.branch`` and ``floquet.orbits.folds`` by Newton's method, ``multibody.run.linear_motion`` by
one linear solve. The table of all of them is in docs/contributing/decisions.md, decision 4.

Source: C. G. Broyden, A class of methods for solving nonlinear simultaneous equations, Math. Comp. 19 (1965)
577-593.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from lumped.errors import NumericalError
from lumped.typing import FloatArray

if TYPE_CHECKING:
    from lumped.model.periodic_system import LTVSystem

#: Forcings of a linear motion: the forcing of the system, one N m of T_p beyond the torque of the file, and
#: one N m of T_g.
OWN_FORCING, MORE_PINION_TORQUE, BRAKE_TORQUE = range(3)
#: Condition number of the equations above which a multiplier counts as +1.
_SINGULAR = 1e13
#: What a run over the period gives beside the mismatch at its end.
Passed = TypeVar("Passed")


def balanced_start(system: LTVSystem, phi: FloatArray, forced: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Initial state and weights of the forcings for which a linear motion is periodic.

    Both gears may turn together by any angle, and any difference of the torques makes them turn faster: the
    map over the period has a double multiplier +1, and its equations alone have no single solution. So one
    torque is an unknown: the brake torque or, where the file gives the brake torque, the mean driving torque.
    With this unknown, and with the angle of the common rotation prescribed, the solution is unique.

    Parameters
    ----------
    system : the "full" system
    phi, forced : map over the period, (n, n), and (n, 3) of its forcing and of one more N m of T_p and T_g

    Returns
    -------
    (n,) state at the start, and (3,) weights: 1, T_p beyond the torque of the file and T_g [N m]

    Raises
    ------
    NumericalError : a further multiplier is at +1
    """
    operating = system.pair.operating
    n = system.size
    brake = operating.brake_torque
    unknown = BRAKE_TORQUE if brake == "balanced" else MORE_PINION_TORQUE
    weights = np.array([1.0, 0.0, 0.0 if brake == "balanced" else brake])
    matrix = np.zeros((n + 1, n + 1))
    matrix[:n, :n] = np.eye(n) - phi
    matrix[:n, n] = -forced[:, unknown]
    unit = system.supports.units
    common = system.supports.common_weights
    matrix[n, : common.size] = common
    right = np.append(forced @ weights, 0.0)
    # Angles, lengths and their rates differ by many decades; equilibrate before judging the rank.
    rate = 1.0 / system.period
    columns = np.concatenate([unit, unit * rate, [0.0]])
    columns[n] = system.pinion_torque / _static_deflection(system)
    rows = np.append(columns[:n], common[0] * unit[0])
    scaled = matrix * columns / rows[:, None]
    condition = float(np.linalg.cond(scaled))
    if not condition < _SINGULAR:
        raise NumericalError(
            f"No periodic motion at {operating.pinion_speed * 30 / np.pi:.6g} rpm "
            f"(condition {condition:.1e}): a multiplier is at +1. Change the speed slightly or add damping."
        )
    solution = np.linalg.solve(scaled, right / rows) * columns
    weights[unknown] = solution[n]
    return solution[:n], weights


def _static_deflection(system: LTVSystem) -> float:
    """Order of magnitude of the static deflection [m], for scaling only."""
    load = system.pinion_torque / abs(float(system.structure.deflection[0]))
    return load / system.cycle.stiffness_scale


@dataclass(frozen=True, eq=False)
class Closed(Generic[Passed]):
    """The best unknowns that ``close_period`` has found.

    Attributes
    ----------
    unknowns : (n,)
    mismatch : largest entry of the mismatch at the end of the period, over its scale
    passed : what the run from these unknowns gave beside the mismatch
    derivatives : (n, n) derivatives of the mismatch by the unknowns, both over their scales, as corrected by
        the steps
    """

    unknowns: FloatArray
    mismatch: float
    passed: Passed
    derivatives: FloatArray


def close_period(
    over_period: Callable[[FloatArray], tuple[FloatArray, Passed]],
    unknowns: FloatArray,
    scale: FloatArray,
    derivatives: FloatArray,
    *,
    closed: float,
    most: int = 40,
    patience: int = 8,
) -> Closed[Passed]:
    """Find unknowns without a mismatch at the end of the period, by Broyden's method.

    Each step runs over the period once and corrects the derivatives along the step. The result does not
    depend on the first derivatives. The caller judges whether the mismatch of the result is small enough.

    Parameters
    ----------
    over_period : runs over the period from unknowns (n,); returns the mismatch (n,) over its scale, and
        anything else
    unknowns : (n,) of the first run
    scale : (n,) of the unknowns
    derivatives : (n, n) of the mismatch by the unknowns, both over their scales; may be rough
    closed : largest entry of the mismatch that ends the steps
    most : most steps
    patience : most steps in a row that do not make the mismatch smaller
    """
    mismatch, passed = over_period(unknowns)
    best = Closed(unknowns, float(np.abs(mismatch).max()), passed, derivatives)
    steps_without_gain = 0
    for _ in range(most):
        if best.mismatch <= closed or steps_without_gain > patience or not np.isfinite(mismatch).all():
            break
        try:
            change = np.linalg.solve(derivatives, -mismatch)
        except np.linalg.LinAlgError:
            break
        unknowns = unknowns + change * scale
        mismatch, passed = over_period(unknowns)
        # Along this change the derivatives must explain the whole mismatch that remains.
        derivatives = derivatives + np.outer(mismatch, change) / (change @ change)
        steps_without_gain += 1
        if (largest := float(np.abs(mismatch).max())) < best.mismatch:
            best = Closed(unknowns, largest, passed, derivatives)
            steps_without_gain = 0
    return best
