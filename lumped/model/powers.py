"""Mean powers of the linear motion of like teeth: sliding, tooth dampers, bearings, shafts, brake.

With prescribed contact the force N = k(xi) delta has no potential. The brake torque then balances the moments
and sliding friction, and an energy residual remains. With loaded contact the mean powers balance exactly, and
the brake torque follows from them. ``lumped.losses`` lists the definitions of all losses.

Sources: docs/theory/contact_energy.md, "Mean powers"; Oh, Grosh and Barber, J. Vib. Acoust. 127 (2005) 208.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.polynomial.polynomial import polyder, polyval

from lumped.model.steady import PeriodicSolution
from lumped.quasi_static.contacts import contact_of
from lumped.typing import FloatArray, IntArray

#: Rows of ``_powers``.
_SLIDING, _TOOTH_DAMPERS, _BEARINGS, _SHAFTS, _CORNERS = range(5)
#: Gauss nodes and weights in an interval from 0 to 1.
_NODES, _WEIGHTS = 0.5 * np.array(leggauss(3)) + np.array([[0.5], [0.0]])
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
#: Values and slopes of these at the Gauss nodes, (nodes, 6).
_QUINTIC = polyval(_NODES, _HERMITE.T).T
_RATES = polyval(_NODES, polyder(_HERMITE.T)).T


@dataclass(frozen=True)
class MeanPowers:
    """Mean powers over one mesh cycle [W].

    Attributes
    ----------
    driving : of the pinion's torque
    sliding, tooth_dampers, bearings, shafts : losses; the loss of couplings belongs to the shafts
    energy_residual : losses and work at tip corners less driving and braking power of the equations of motion
    """

    driving: float
    sliding: float
    tooth_dampers: float
    bearings: float
    shafts: float
    energy_residual: float

    @property
    def lost(self) -> float:
        """Sum of all losses [W]."""
        return self.sliding + self.tooth_dampers + self.bearings + self.shafts

    @property
    def by_place(self) -> dict[str, float]:
        """Losses by place and the energy residual, under the names of ``RevolutionMotion.powers``.

        "rolling" is the energy residual: work on the teeth as the contact rolls on, which is no loss.
        """
        places = ("sliding", "tooth_dampers", "bearings", "shafts")
        return {place: getattr(self, place) for place in places} | {"rolling": self.energy_residual}

    @property
    def efficiency(self) -> float:
        """Share of the driving power that is not lost [-], 1 - losses / input."""
        return 1.0 - self.lost / self.driving


def balance(solution: PeriodicSolution, *, conservative: bool | None = None) -> dict[str, float]:
    """Torques that hold the mean speed [N m], and the efficiency, by name.

    Parameters
    ----------
    solution : periodic motion of the "full" system
    conservative : whether the brake balances every loss, or the moments only; by default as the contact is
    """
    powers = mean_powers(solution)
    brake_torque = solution.brake_torque
    if contact_of(solution.system.pair).conservative if conservative is None else conservative:
        brake_torque -= powers.energy_residual / solution.system.pair.geometry.omega_gear
    return {
        "brake_torque": brake_torque,
        "pinion_torque": solution.pinion_torque,
        "mesh_efficiency": powers.efficiency,
    }


def power_attributes(solution: PeriodicSolution) -> dict[str, float]:
    """Attributes of a result: ``balance``, the mean losses, and the power that no torque balances [W]."""
    powers = mean_powers(solution)
    places = ("sliding", "tooth_dampers", *solution.system.supports.places)
    losses: dict[str, float] = {f"power_{place}": getattr(powers, place) for place in places}
    conservative = contact_of(solution.system.pair).conservative
    return (
        balance(solution)
        | losses
        | {"power_energy_residual": 0.0 if conservative else powers.energy_residual}
    )


@lru_cache(maxsize=4)
def mean_powers(solution: PeriodicSolution) -> MeanPowers:
    """Mean powers of a periodic motion of the "full" system, by Gauss quadrature in its intervals."""
    times, states, weights = _between(solution)
    power = _powers(solution, times, states) @ weights
    return MeanPowers(
        driving=solution.pinion_torque * solution.system.pair.geometry.omega_pinion,
        sliding=float(power[_SLIDING]),
        tooth_dampers=float(power[_TOOTH_DAMPERS]),
        bearings=float(power[_BEARINGS]),
        shafts=float(power[_SHAFTS]),
        energy_residual=solution.energy_residual + float(power[_CORNERS]),
    )


def _between(solution: PeriodicSolution) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss nodes inside the intervals of the integration [s], states at the nodes, and weights of a mean
    [-].

    Inside an interval the motion is the quintic through the displacements, rates and accelerations at both
    ends. The relative error of the losses is some 1e-7 (5e-5 at 3 rpm, where the number of intervals is
    bounded).
    """
    time = solution.cycle_time
    states = solution.cycle_states
    m = len(solution.system.coordinates)
    low = states[:-1]
    high = states[1:]
    z = slice(0, m)
    v = slice(m, 2 * m)
    h = np.diff(time)
    segment = np.searchsorted(solution.system.cycle.edges, time[:-1] + 0.5 * h) - 1
    first = _accelerations(solution, time[:-1], low, segment)
    last = _accelerations(solution, time[1:], high, segment)
    h = h[:, None]
    ends = np.stack([low[:, z], h * low[:, v], h**2 * first, high[:, z], h * high[:, v], h**2 * last])
    inside = np.einsum("nj,jkm->knm", _QUINTIC, ends), np.einsum("nj,jkm->knm", _RATES, ends) / h[:, None]
    times = (time[:-1, None] + h * _NODES).ravel()
    return times, np.concatenate(inside, axis=2).reshape(-1, 2 * m), (h * _WEIGHTS).ravel() / time[-1]


def _accelerations(
    solution: PeriodicSolution, times: FloatArray, states: FloatArray, segment: IntArray
) -> FloatArray:
    """Accelerations (k, m) at states (k, 2m) and times, as limits from inside the smooth segments."""
    system = solution.system
    m = len(solution.system.coordinates)
    gain = system.gain(times, segment)
    accelerations = states @ system.constant[m:].T + gain.error
    accelerations += gain.stiffness * (states[:, :m] @ system.deflection)[:, None]
    accelerations += gain.damping * (states[:, m:] @ system.deflection)[:, None]
    torques = solution.pinion_torque * system.torque_pinion + solution.brake_torque * system.torque_gear
    return np.asarray(accelerations + torques[m:], dtype=np.float64)


def _powers(solution: PeriodicSolution, times: FloatArray, states: FloatArray) -> FloatArray:
    """Powers at n states: rows SLIDING to CORNERS, (5, n) [W].

    Losses of sliding, tooth dampers, bearings and shafts, and the power of the force that tip corners exert
    off the line of action.
    """
    from lumped.model.results import corner_force, response

    system = solution.system
    pairs = system.cycle.sample(times)
    rates = states[:, len(system.coordinates) :]
    values = response(system, times, states, pairs=pairs)
    supports = system.supports.powers(rates)
    return np.stack(
        [
            -values["friction_power"].sum(axis=0),
            pairs.damper_powers(values["dte_dot"]).sum(axis=0),
            supports["bearings"],
            supports.get("shafts", np.zeros(times.size)),
            corner_force(values, pairs) * (values["y_g_dot"] - values["y_p_dot"]),
        ]
    )
