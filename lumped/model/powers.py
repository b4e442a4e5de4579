"""Where the power of the periodic motion goes: sliding, tooth dampers, bearings, brake.

A force N = k(xi) delta has no potential, so with prescribed contact the brake torque, which balances moments,
balances sliding friction alone, and an energy residual is left. Where the contact is conservative the mean
powers balance exactly, and the brake torque follows from them.

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
    sliding, tooth_dampers, bearings, shafts : losses by place; couplings belong to the shafts
    energy_residual : losses less driving and braking power of the equations of motion
    """

    driving: float
    sliding: float
    tooth_dampers: float
    bearings: float
    shafts: float
    energy_residual: float

    @property
    def lost(self) -> float:
        """All losses together [W]."""
        return self.sliding + self.tooth_dampers + self.bearings + self.shafts

    @property
    def by_place(self) -> dict[str, float]:
        """Losses by place and the energy residual, under the names of ``RevolutionMotion.powers``."""
        places = ("sliding", "tooth_dampers", "bearings", "shafts")
        return {place: getattr(self, place) for place in places} | {"rolling": self.energy_residual}

    @property
    def efficiency(self) -> float:
        """Share of the driving power that is not lost [-], 1 - losses / input."""
        return 1.0 - self.lost / self.driving


def balance(solution: PeriodicSolution, *, conservative: bool | None = None) -> dict[str, float]:
    """Torques that hold the mean speed [N m] and efficiency, by name.

    Parameters
    ----------
    solution : periodic motion of the "full" system
    conservative : whether the brake balances every loss, and not only moments; default that of the contact
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
    """``balance``, mean losses by place, and those that no torque balances [W], as attributes of a result."""
    powers = mean_powers(solution)
    places = ("sliding", "tooth_dampers", *solution.system.supports.places)
    found: dict[str, float] = {f"power_{place}": getattr(powers, place) for place in places}
    conservative = contact_of(solution.system.pair).conservative
    return (
        balance(solution) | found | {"power_energy_residual": 0.0 if conservative else powers.energy_residual}
    )


@lru_cache(maxsize=4)
def mean_powers(solution: PeriodicSolution) -> MeanPowers:
    """Mean powers of a periodic motion of the "full" system, by Gauss quadrature in its intervals."""
    times, states, weights = _between(solution)
    power = _powers(solution, times, states) @ weights
    return MeanPowers(
        driving=solution.pinion_torque * solution.system.pair.geometry.omega_pinion,
        sliding=float(power[0]),
        tooth_dampers=float(power[1]),
        bearings=float(power[2]),
        shafts=float(power[3]),
        energy_residual=solution.energy_residual + float(power[4]),
    )


def _between(solution: PeriodicSolution) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss nodes inside the intervals of the integration [s], states there, and weights of a mean [-].

    Inside an interval the motion is the quintic that has its displacements, rates and accelerations at both
    ends: the losses err by some 1e-7 of themselves (5e-5 at 3 rpm, where intervals are bounded in number).
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
    """Accelerations (k, m) at states (k, 2m), as limits from inside the smooth segments."""
    system = solution.system
    m = len(solution.system.coordinates)
    gain = system.gain(times, segment)
    found = states @ system.constant[m:].T + gain.error
    found += gain.stiffness * (states[:, :m] @ system.deflection)[:, None]
    found += gain.damping * (states[:, m:] @ system.deflection)[:, None]
    torques = solution.pinion_torque * system.torque_pinion + solution.brake_torque * system.torque_gear
    return np.asarray(found + torques[m:], dtype=np.float64)


def _powers(solution: PeriodicSolution, times: FloatArray, states: FloatArray) -> FloatArray:
    """Powers taken by sliding, tooth dampers, bearings, shafts; work of corners at n states, (5, n) [W]."""
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
