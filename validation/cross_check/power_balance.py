"""Mean powers of both models over one mesh cycle of their periodic motion, power by power.

The lumped motion is read with the radii, bearings and bodies that the multibody model works out for itself,
so a wrong lever or constant of the lumped model leaves a residual.

Sources: the power balance of rigid bodies; docs/theory/multibody.md, "Conservation".
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import multibody
from lumped.model.periodic_system import LTVSystem
from lumped.model.propagation import fastest_frequency
from lumped.model.results import response
from lumped.model.steady import PeriodicSolution
from lumped.typing import FloatArray
from multibody.contact import layout as kn
from multibody.contact.machine import Machine

#: Power -> what it is in words. Their sum is the driving power.
POWERS: Mapping[str, str] = {
    "braking": "taken by the brake",
    "friction": "sliding friction of the teeth",
    "bearings": "damping of the bearings",
    "mesh_damping": "damping of the teeth",
    "mesh_stiffness": "work of the change of stiffness and profile along the path",
}
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
#: Panels of the quadrature in a mesh cycle, at least, and largest angle of the fastest vibration in a panel
#: [rad]: Gauss's rule with four nodes then leaves some 1e-12 of a power, which swings twice as fast.
_PANELS, _PANEL_ANGLE = 160, 0.7


def quadrature(system: LTVSystem) -> tuple[FloatArray, FloatArray]:
    """Times in the mesh cycle and their weights, which sum to one; in no panel a law is two polynomials."""
    angle = fastest_frequency(system) * system.period
    even = np.linspace(0.0, system.period, max(_PANELS, int(np.ceil(angle / _PANEL_ANGLE))) + 1)
    marks = np.union1d(system.cycle.breaks, even)
    marks = marks[np.diff(marks, prepend=-np.inf) > 1e-9 * system.period]
    marks[-1] = system.period
    width = np.diff(marks)[:, None]
    times = (marks[:-1, None] + 0.5 * width * (1.0 + _NODES)).ravel()
    return times, (0.5 * width * _WEIGHTS).ravel() / system.period


def lumped_powers(motion: PeriodicSolution, machine: Machine, weights: FloatArray) -> dict[str, float]:
    """Mean powers of the lumped periodic motion at the times of ``quadrature``: "driving" and ``POWERS`` [W].

    ``machine`` has the pair's numbers as the multibody model derives them.
    """
    p = machine.parameters
    found = losses(motion.system, machine, motion.time, motion.states, weights)
    return found | {
        "driving": motion.pinion_torque * float(p[kn.OMEGA_P] + weights @ motion.states[:, 6]),
        "braking": motion.brake_torque * float(p[kn.OMEGA_G] + weights @ motion.states[:, 7]),
    }


def losses(
    system: LTVSystem, machine: Machine, times: FloatArray, states: FloatArray, weights: FloatArray
) -> dict[str, float]:
    """Mean powers of what a lumped motion loses [W], from (k,) times, (k, 12) states and (k,) weights."""
    p = machine.parameters
    values, pairs, rates = response(system, times, states), system.cycle.sample(times), states[:, 6:]
    place = values["position"]
    sliding = (p[kn.OMEGA_P] + rates[:, 0]) * place
    sliding -= (p[kn.OMEGA_G] + rates[:, 1]) * (p[kn.L_XY] - place) + rates[:, 4] - rates[:, 5]
    closing = p[kn.RADIUS_P] * rates[:, 0] - p[kn.RADIUS_G] * rates[:, 1] + rates[:, 2] - rates[:, 3]
    damping = np.sum(pairs.damping * (closing - pairs.error_rate) ** 2, axis=0)
    bearings = machine.bearing_damping.T.ravel()  # x_p, x_g, y_p, y_g
    return {
        "friction": float(weights @ np.sum(values["friction_force"] * sliding, axis=0)),
        "bearings": float(weights @ (rates[:, 2:] ** 2 @ bearings)),
        "mesh_damping": float(weights @ damping),
        "mesh_stiffness": float(weights @ (values["normal_load"].sum(axis=0) * closing - damping)),
    }


def multibody_powers(balance: multibody.PowerBalance, period: float) -> dict[str, float]:
    """The same of a multibody run over one mesh cycle; what it stored counts as driving power less [W]."""
    found = {name: float(getattr(balance, name)) / period for name in POWERS}
    return found | {"driving": (balance.driving - balance.kinetic) / period}


def residual(powers: Mapping[str, float]) -> float:
    """Driving power that is not accounted for, over the driving power."""
    return abs(powers["driving"] - sum(powers[name] for name in POWERS)) / abs(powers["driving"])
