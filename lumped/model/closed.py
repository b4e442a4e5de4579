"""Periodic motion of like teeth with unilateral contact that follows the momentary load.

Sources: docs/theory/teeth.md, "Motion"; docs/theory/validity.md, "Prediction".
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from lumped.errors import NumericalError
from lumped.mesh.motion import Run
from lumped.mesh.tables import MeshTables
from lumped.model.momentary_load import mean_powers, run, steps_of, without_drift
from lumped.model.periodic_system import LTVSystem
from lumped.model.revolution_motion import RevolutionMotion, Touch, labelled_motion
from lumped.model.tooth_laws import ToothLaws, mesh_tables
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: Least steps in the cycle: where a pair touches inside a step, 256 cost 0.1 % of a motion with contact loss.
_LEAST = 512
#: Steps of Newton's method at most; the change, over the size of the unknowns, that ends them.
_STEPS, _CLOSED = 12, 1e-9
#: Differences for its derivatives, over the size of each unknown.
_DIFFERENCE = 1e-4
#: Size of the change of the torque over the torque.
_OF_TORQUE = 1e-3
#: A disturbance of which less is left after a cycle has no derivatives of its own: the torque alone has.
_FADED = 1e-3


def closed_motion(
    pair: GearPair, samples: int, start: FloatArray, torque: float, radius: float = 1.0
) -> xr.Dataset:
    """Periodic motion over one mesh cycle on springs, the one near a motion that is known.

    Stiffness, place of contact and how far the damper of a tooth pair has taken hold follow the momentary
    load, which only pushes. Newton's method closes the cycle, so a start need not fade.

    Parameters
    ----------
    pair : a validated gear pair, teeth alike, contact "loaded"
    samples : outputs in the cycle, even
    start : (10,) q, x_p, x_g, y_p, y_g at the start of the cycle and their rates, to begin with
    torque : of the brake, or of the drive where the brake torque is given, to begin with [N m]
    radius : spectral radius of the motion that is known; a small one saves derivatives

    Returns
    -------
    xarray.Dataset as of ``lumped.steady_state``; ``error_estimate`` is the change of the transmission error
    with steps twice as long, over its largest value

    Raises
    ------
    NumericalError : no periodic motion near the start
    """
    system, laws, given = LTVSystem.of(pair, "full"), ToothLaws(pair), pair.operating.brake_torque
    support, step = system.supports, 1.0 / max(_LEAST, steps_of(system))
    weights, m = support.common_weights, support.common_weights.size
    relative, back = (np.kron(np.eye(2), one) for one in (support.relative, support.back))
    tables, coarse = (mesh_tables(laws, n * step, samples // n, (0.0, 0.5, 1.0)) for n in (1, 2))

    def torques_of(unknown: FloatArray) -> tuple[float, float]:
        if given == "balanced":
            return pair.operating.pinion_torque, float(unknown[-1])
        return float(unknown[-1]), float(given)

    def cycle(unknown: FloatArray, of: MeshTables = tables, rate: float = 0.0) -> tuple[FloatArray, Run]:
        """What is left after a cycle from a common rate, that of this rate last, and the motion."""
        driving, brake = torques_of(unknown)
        torques = driving * system.torque_pinion + brake * system.torque_gear
        state = back @ unknown[:-1] + np.append(np.zeros(m), rate * support.common)
        found = run(pair, of, system, 0, 1, 1, state, torques)
        moved = found.end - state
        return np.append(relative @ moved, weights @ moved[m:]), found

    unknown = np.append(start, torque)
    sizes = np.append(np.abs(unknown[:-1]).reshape(2, -1).max(axis=1).repeat(m - 1), _OF_TORQUE * torque)
    # Derivatives by steps twice as long: the motion that Newton's method then finds is the same.
    left, about = cycle(unknown)[0], cycle(unknown, coarse)[0]
    slopes = -np.eye(unknown.size)
    for j in range(unknown.size - 1 if radius < _FADED else 0, unknown.size):
        moved = unknown + _DIFFERENCE * sizes * (np.arange(unknown.size) == j)
        slopes[:, j] = (cycle(moved, coarse)[0] - about) / (moved[j] - unknown[j])
    for _ in range(_STEPS):
        change = np.linalg.solve(slopes, left)
        unknown = unknown - change
        left, found = cycle(unknown)
        if np.abs(change / sizes).max() < _CLOSED:
            break
    else:
        if radius < _FADED:
            return closed_motion(pair, samples, start, torque)
        raise NumericalError("No periodic motion that follows the momentary load is near this one.")
    # Powers are those of the mean speed: from a common rate whose mean vanishes.
    rates = found.states[:, m:] @ weights / (weights @ support.common)
    found = cycle(unknown, rate=-float(rates.mean()))[1]
    states = found.states
    dte = states[:, :m] @ system.deflection
    other = cycle(unknown, coarse)[1].states[:, :m] @ system.deflection
    time = np.arange(samples) / samples * system.period
    motion = RevolutionMotion(
        *(pair, system, tables, Touch.MOMENTARY, time, without_drift(system, time, states, 0.0), found.loads),
        *torques_of(unknown),
        mean_powers(found, system.period),
        closure=float(np.abs(relative @ (found.end - states[0])).max() / np.abs(relative @ found.end).max()),
        error=float(np.abs(other - dte[::2]).max() / np.abs(dte).max()),
        spectral_radius=max(
            float(np.abs(np.linalg.eigvals(slopes[:-1, :-1] + np.eye(2 * m - 2))).max()),
            radius if radius < _FADED else 0.0,
        ),
    )
    result = labelled_motion(motion, {}).drop_vars(["pinion_tooth", "gear_tooth"])
    return result.assign_attrs(teeth="alike")
