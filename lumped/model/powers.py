"""Where the power of the periodic motion goes: sliding, tooth dampers, bearings, brake; and what nobody pays.

The dampers and bearings of the model take power from the shafts. A force N = k(xi) delta has no potential,
so the paper's brake torque, which balances moments, leaves the shafts to pay for sliding friction alone.
Where the elastic energy of the teeth is conserved the mean powers balance exactly, and the brake torque
follows from them.

Sources: docs/theory/contact_energy.md, "Mean powers"; Oh, Grosh and Barber, J. Vib. Acoust. 127 (2005) 208.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from lumped.model.mesh_cycle import PairState
from lumped.model.results import sliding_velocity
from lumped.model.steady import PeriodicSolution
from lumped.typing import FloatArray

#: Lobatto's nodes and weights in an interval from 0 to 1: its ends are among them, the order is 6.
_NODES = np.array([0.0, 0.5 - np.sqrt(0.05), 0.5 + np.sqrt(0.05), 1.0])
_WEIGHTS = np.array([1.0, 5.0, 5.0, 1.0]) / 12.0
#: Hermite's quintics of values, first and second derivatives at 0, then at 1; powers of s, lowest first.
_HERMITE = np.array(
    [
        [1.0, 0.0, 0.0, -10.0, 15.0, -6.0],
        [0.0, 1.0, 0.0, -6.0, 8.0, -3.0],
        [0.0, 0.0, 0.5, -1.5, 1.5, -0.5],
        [0.0, 0.0, 0.0, 10.0, -15.0, 6.0],
        [0.0, 0.0, 0.0, -4.0, 7.0, -3.0],
        [0.0, 0.0, 0.0, 0.5, -1.0, 0.5],
    ]
)
#: Values and slopes of these at the nodes, (2, nodes, 6).
_QUINTIC = np.stack([polyval(_NODES, _HERMITE.T).T, polyval(_NODES, polyder(_HERMITE.T)).T])


@dataclass(frozen=True)
class MeanPowers:
    """Mean powers over one mesh cycle [W].

    Attributes
    ----------
    driving : of the pinion's torque
    sliding : taken by sliding friction at the actual sliding velocities
    tooth_dampers, bearings, shafts : taken by the dampers of the teeth, of the bearings, and of the elastic
        shafts with their couplings
    unpaid : what the losses exceed the difference of driving and braking power of the equations of motion by
    """

    driving: float
    sliding: float
    tooth_dampers: float
    bearings: float
    shafts: float
    unpaid: float

    @property
    def lost(self) -> float:
        """All losses together [W]."""
        return self.sliding + self.tooth_dampers + self.bearings + self.shafts

    @property
    def efficiency(self) -> float:
        """Share of the driving power that reaches the brake when all losses are paid [-]."""
        return 1.0 - self.lost / self.driving


def balance(solution: PeriodicSolution, *, paid: bool | None = None) -> dict[str, float]:
    """Torques that hold the mean speed [N m] and efficiency, by name.

    The paper's form balances moments: its brake torque and efficiency count sliding friction alone. The
    loaded form pays for every loss.

    Parameters
    ----------
    solution : periodic motion of the "absolute" system
    paid : whether every loss is paid; default in the loaded form
    """
    if not (pays(solution) if paid is None else paid):
        return solution.balance
    g = solution.system.pair.geometry
    brake = solution.brake_torque - unpaid_power(solution) / g.omega_gear
    return {
        "brake_torque": brake,
        "pinion_torque": solution.pinion_torque,
        "mesh_efficiency": brake * g.omega_gear / (solution.pinion_torque * g.omega_pinion),
    }


def pays(solution: PeriodicSolution) -> bool:
    """Whether the contact has an energy, so that the brake pays for every loss."""
    return solution.system.pair.mesh.contact == "loaded"


def power_attributes(solution: PeriodicSolution) -> dict[str, float]:
    """Mean losses by place, and what of them nobody pays [W], as attributes of a result."""
    powers = mean_powers(solution)
    found = {
        "power_sliding": powers.sliding,
        "power_tooth_dampers": powers.tooth_dampers,
        "power_bearings": powers.bearings,
        "power_unpaid": 0.0 if pays(solution) else powers.unpaid,
    }
    return found if solution.system.shafts is None else found | {"power_shafts": powers.shafts}


@lru_cache(maxsize=4)
def mean_powers(solution: PeriodicSolution) -> MeanPowers:
    """Mean powers of a periodic motion, by quadrature in the intervals of its integration.

    Parameters
    ----------
    solution : periodic motion of the "absolute" system
    """
    system = solution.system
    at = _inside(solution, np.eye(len(system.coordinates)))
    z, rates = system.gear_motion(np.concatenate([at.values, at.rates], axis=1))
    dte, dte_dot = z @ system.structure.deflection, rates @ system.structure.deflection
    pairs = at.pairs
    closing = dte_dot - pairs.error_rate
    normal = pairs.stiffness * (dte - pairs.error) + pairs.damping * closing
    shafts = system.shafts
    if shafts is None:
        bearings, inside = at.rates**2 @ system.structure.damping, np.zeros(dte.size)
    else:
        dampers = shafts.bearing_damping, shafts.modal_damping + shafts.coupling_damping
        bearings, inside = (np.sum((at.rates @ c) * at.rates, axis=1) for c in dampers)
    g = system.pair.geometry
    return MeanPowers(
        driving=solution.pinion_torque * g.omega_pinion,
        sliding=float(
            (pairs.friction * normal * sliding_velocity(g, pairs.position, rates)).sum(axis=0) @ at.weights
        ),
        tooth_dampers=float((pairs.damping * closing**2).sum(axis=0) @ at.weights),
        bearings=float(bearings @ at.weights),
        shafts=float(inside @ at.weights),
        unpaid=unpaid_power(solution),
    )


def unpaid_power(solution: PeriodicSolution) -> float:
    """Mean power that the losses take beyond what the torques of the equations of motion bring [W].

    The forces N_i do the work N_i delta' on the bodies, with both gears' rigid rotation none; the dampers
    take c_i (delta' - e_i')^2. What is left over, -k_i (delta - e_i) delta' - c_i (delta' - e_i') e_i', comes
    from no energy: in the mean all other losses cancel against the torques.

    Parameters
    ----------
    solution : periodic motion of the "absolute" system
    """
    at = _inside(solution, solution.system.deflection[None])
    dte, dte_dot, pairs = at.values[:, 0], at.rates[:, 0], at.pairs
    work = (pairs.stiffness * (dte - pairs.error)).sum(axis=0) * dte_dot
    work += (pairs.damping * (dte_dot - pairs.error_rate) * pairs.error_rate).sum(axis=0)
    return -float(work @ at.weights)


@dataclass(frozen=True, eq=False)
class _Inside:
    """Tooth pairs, motions (k, q) and their rates at the nodes, and weights (k,) of a mean [-]."""

    pairs: PairState
    values: FloatArray
    rates: FloatArray
    weights: FloatArray


def _inside(solution: PeriodicSolution, motions: FloatArray) -> _Inside:
    """Nodes of a quadrature in the intervals of the integration, ends as limits from inside.

    Inside an interval, in which the fastest vibration turns by half a radian, a motion is the quintic that
    has its values, rates and accelerations at both ends: the losses err by some
    1e-7 of themselves (5e-5 at 3 rpm, where the number of intervals is bounded).

    Parameters
    ----------
    solution : periodic motion of the "absolute" system
    motions : (q, m) rows that make the wanted motions of the coordinates
    """
    system, time, states = solution.system, solution.cycle_time, solution.cycle_states
    m, h = len(system.coordinates), np.diff(time)
    segment = np.searchsorted(system.cycle.edges, time[:-1] + 0.5 * h) - 1
    times = time[:-1] + _NODES[:, None] * h
    pairs = system.cycle.sample(times.ravel(), np.tile(segment, _NODES.size))
    values, rates = states[:, :m] @ motions.T, states[:, m:] @ motions.T
    torques = solution.pinion_torque * system.torque_pinion + solution.brake_torque * system.torque_gear
    without_teeth = (states @ system.constant[m:].T + torques[m:]) @ motions.T
    by_teeth = _loads_at_ends(solution, pairs) @ (system.per_load @ motions.T)
    ends, h = np.empty((6, h.size, len(motions))), h[:, None]
    for side, at in enumerate((slice(None, -1), slice(1, None))):
        ends[3 * side] = values[at]
        ends[3 * side + 1] = h * rates[at]
        ends[3 * side + 2] = h**2 * (without_teeth[at] + by_teeth[side])
    inside = np.tensordot(_QUINTIC, ends, axes=1)  # (2, nodes, n, q)
    return _Inside(
        pairs=pairs,
        values=inside[0].reshape(-1, len(motions)),
        rates=(inside[1] / h).reshape(-1, len(motions)),
        weights=(_WEIGHTS[:, None] * h[:, 0]).ravel() / time[-1],
    )


def _loads_at_ends(solution: PeriodicSolution, pairs: PairState) -> FloatArray:
    """Sums over the pairs of N, F and F xi at both ends of n intervals, (2, n, 3)."""
    system, m = solution.system, len(solution.system.coordinates)
    dte, dte_dot = (
        x @ system.deflection for x in (solution.cycle_states[:, :m], solution.cycle_states[:, m:])
    )

    def ends(values: FloatArray) -> FloatArray:
        return values.reshape(len(values), _NODES.size, -1)[:, :: _NODES.size - 1]

    normal = ends(pairs.stiffness) * (np.stack([dte[:-1], dte[1:]]) - ends(pairs.error))
    normal += ends(pairs.damping) * (np.stack([dte_dot[:-1], dte_dot[1:]]) - ends(pairs.error_rate))
    friction = ends(pairs.friction) * normal
    return np.stack([v.sum(axis=0) for v in (normal, friction, friction * ends(pairs.position))], axis=-1)
