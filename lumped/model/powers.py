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

from lumped.model.periodic_system import LTVSystem
from lumped.model.propagation import step_edges
from lumped.model.steady import PeriodicSolution, periodic_solution
from lumped.typing import FloatArray

#: Gauss nodes per step; a step turns the fastest mode by half a radian.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(3)


@dataclass(frozen=True)
class MeanPowers:
    """Mean powers over one mesh cycle [W].

    Attributes
    ----------
    driving : of the pinion's torque
    sliding : taken by sliding friction at the actual sliding velocities
    tooth_dampers, bearings : taken by the dampers of the teeth and of the bearings
    unpaid : what the losses exceed the difference of driving and braking power of the equations of motion by
    """

    driving: float
    sliding: float
    tooth_dampers: float
    bearings: float
    unpaid: float

    @property
    def lost(self) -> float:
        """All losses together [W]."""
        return self.sliding + self.tooth_dampers + self.bearings

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
    powers, g = mean_powers(solution), solution.system.pair.geometry
    return {
        "brake_torque": solution.brake_torque - powers.unpaid / g.omega_gear,
        "pinion_torque": solution.pinion_torque,
        "mesh_efficiency": powers.efficiency,
    }


def pays(solution: PeriodicSolution) -> bool:
    """Whether the contact has an energy, so that the brake pays for every loss."""
    return solution.system.pair.mesh.contact == "loaded"


def power_attributes(solution: PeriodicSolution) -> dict[str, float]:
    """Mean losses by place, and what of them nobody pays [W], as attributes of a result."""
    powers = mean_powers(solution)
    return {
        "power_sliding": powers.sliding,
        "power_tooth_dampers": powers.tooth_dampers,
        "power_bearings": powers.bearings,
        "power_unpaid": 0.0 if pays(solution) else powers.unpaid,
    }


@lru_cache(maxsize=4)
def mean_powers(solution: PeriodicSolution) -> MeanPowers:
    """Mean powers of a periodic motion, by Gauss quadrature on the steps of its integration.

    Parameters
    ----------
    solution : periodic motion of the "absolute" system
    """
    times, weights = quadrature(solution.system)
    return powers_at(periodic_solution(solution.system, times, estimate_error=False), weights)


def quadrature(system: LTVSystem) -> tuple[FloatArray, FloatArray]:
    """Gauss nodes in all steps of the integration over a mesh cycle [s], and their weights of a mean [-]."""
    edges = step_edges(system)
    h = np.diff(edges)[:, None]
    times = (edges[:-1, None] + 0.5 * h * (1.0 + _NODES)).ravel()
    return times, (0.5 * h * _WEIGHTS).ravel() / system.period


def powers_at(solution: PeriodicSolution, weights: FloatArray) -> MeanPowers:
    """Mean powers of a periodic motion at the nodes of ``quadrature``.

    Parameters
    ----------
    solution : at those times
    weights : of the nodes
    """
    power = _powers(solution, solution.time, solution.states) @ weights
    g = solution.system.pair.geometry
    driving = solution.pinion_torque * g.omega_pinion
    moments = driving - solution.brake_torque * g.omega_gear
    return MeanPowers(
        driving=driving,
        sliding=float(power[0]),
        tooth_dampers=float(power[1]),
        bearings=float(power[2]),
        unpaid=float(power.sum() - moments),
    )


def _powers(solution: PeriodicSolution, times: FloatArray, states: FloatArray) -> FloatArray:
    """Powers taken by sliding, tooth dampers and bearings at n states, (3, n) [W]."""
    from lumped.model.results import response

    system = solution.system
    values = response(system, times, states)
    pairs, rates = system.cycle.sample(times), states[:, 6:]
    closing = values["dte_dot"] - pairs.error_rate
    return np.stack(
        [
            -values["friction_power"].sum(axis=0),
            (pairs.damping * closing**2).sum(axis=0),
            rates**2 @ system.structure.damping,
        ]
    )
