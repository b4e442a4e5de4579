"""The swing of the common rotation under eccentric gears and ripples of the torques. The contacts follow it.

Sources: docs/theory/teeth.md, "Eccentricity".
"""

from __future__ import annotations

import math

import numpy as np

from lumped.errors import refuse
from lumped.mesh.tables import RIPPLES, MeshTables
from lumped.model.periodic_system import LTVSystem
from lumped.typing import FloatArray

#: Largest swing over the base pitch, because the contact follows the swing to first order only.
_MOST_SWING = 0.25


def moments(system: LTVSystem) -> FloatArray:
    """Accelerations (2, m) of z per unit moment on pinion and gear."""
    return np.asarray((system.reduction[:, :2] / system.structure.mass[:2]).T, dtype=np.float64)


def swinging(tables: MeshTables, system: LTVSystem) -> MeshTables:
    """Return tables with the swing of the common rotation per amplitude of each TURNING.

    The gears are free in the common rotation: a moment -F eps sin(omega t) turns them by + sin/omega^2, a
    torque A cos(omega t) by -cos/omega^2. ``system`` is the "full" one.
    """
    g = system.pair.geometry
    support = system.supports
    theta = system.gears[:2] @ support.common / float(support.common_weights @ support.common)
    on_base_circles = 0.5 * float(np.array([g.base_radius_pinion, g.base_radius_gear]) @ theta)
    turning = tables.turning.copy()
    omega = 2.0 * math.pi / (turning["cycles"] * tables.duration)
    by_moment = tables.law.force * (moments(system) @ support.common_weights)
    torques = np.stack([system.torque_pinion, system.torque_gear])[:, support.common_weights.size :]
    by_torque = (torques @ support.common_weights)[turning["shaft"][RIPPLES:].astype(np.int64)]
    turning["swing"] = on_base_circles * np.append(by_moment, by_torque) / omega**2
    swing = float(np.abs(turning["swing"] * turning["amplitude"]).sum())
    most = _MOST_SWING * g.base_pitch
    if swing > most:
        raise refuse(
            "operating.pinion_speed",
            f"{g.omega_pinion * 30.0 / math.pi:.4g} rpm",
            "one at which eccentric gears and torque ripples swing the train by at most a quarter of a base "
            f"pitch, {most * 1e3:.3g} mm",
            f"Here it is {swing * 1e3:.3g} mm. Add the inertia of motor and load to pinion.inertia and "
            "gear.inertia.",
        )
    return tables._replace(turning=turning)


def swing(tables: MeshTables, time: FloatArray) -> FloatArray:
    """Swing of the contacts over xi, at times (k,) [m]; ``tables`` are those of ``swinging``."""
    rotation = np.zeros(time.size)
    for shaft in tables.turning:
        turn = 2.0 * np.pi * time / (tables.duration * shaft["cycles"]) + shaft["start"]
        rotation += shaft["amplitude"] * shaft["swing"] * np.sin(turn)
    return rotation
