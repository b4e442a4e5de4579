"""The repaired equations of motion of the model with six degrees of freedom, as forces.

The printed signs of eqs. 1, 2, 7 and 9 can be put back one at a time, to show the effect of each sign.

Source: docs/theory/equations.md, eqs. 1 to 9.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from lumped.arguments import some_of
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: Order of the coordinates; states are coordinates followed by their rates.
COORDINATES = ("theta_p", "theta_g", "x_p", "x_g", "y_p", "y_g")
#: Equations of the paper whose printed sign differs from the repaired sign.
PRINTED_EQUATIONS = (1, 2, 7, 9)
#: Indices of the coordinates.
THETA_P, THETA_G, X_P, X_G, Y_P, Y_G = range(6)


@dataclass(frozen=True, eq=False)
class Structure:
    """Constant data of the equations of motion, SI, in the order of ``COORDINATES``.

    Attributes
    ----------
    mass : (6,) J_p, J_g, m_p, m_g, m_p, m_g
    damping, stiffness : (6,) damping and stiffness of the bearings; zero for the rotations
    deflection : (6,) u with delta = u . z, the dynamic transmission error
    normal : (6,) generalised force on each coordinate per unit normal load of a pair
    friction_arm : (6, 2) generalised force per unit friction force, a[:, 0] + a[:, 1] * xi
    apart : (6,) generalised force per unit of the force by which a tip corner pushes the gears apart
    """

    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    deflection: FloatArray
    normal: FloatArray
    friction_arm: FloatArray
    apart: FloatArray

    def friction(self, position: FloatArray) -> FloatArray:
        """Generalised force per unit friction force at positions xi (...,) -> (..., 6)."""
        return self.friction_arm[:, 0] + np.multiply.outer(position, self.friction_arm[:, 1])


def structure(pair: GearPair, as_printed: Collection[int] = ()) -> Structure:
    """Return the constant part of the equations of motion.

    Each column of forces reads like the paper: per unit N_i the pinion gets -r_bp (1), the gear +r_bg (2),
    x_p -1 (6), x_g +1 (7); per unit F_i the pinion gets -X_pi (1), the gear +X_gi = L_XY - X_pi (2),
    y_p +1 (8), y_g -1 (9). The paper has no tip corners. The moment of a tip corner is left out: it works on
    the path of the contact, which the linear form does not have.
    """
    g = pair.geometry
    b = bodies_of(pair)
    printed = some_of("as_printed", as_printed, PRINTED_EQUATIONS, "Name equations whose sign was repaired.")
    # Friction moment of eq. 1, mesh moment of 2, mesh force of 7, friction force of 9.
    s1, s2, s7, s9 = (-1.0 if number in printed else 1.0 for number in PRINTED_EQUATIONS)
    r_bp = g.base_radius_pinion
    r_bg = g.base_radius_gear
    mass = np.array(
        [b.inertia_pinion, b.inertia_gear, b.mass_pinion, b.mass_gear, b.mass_pinion, b.mass_gear]
    )
    pinion = pair.bearings.pinion
    gear = pair.bearings.gear
    bearing = np.array(
        [0.0, 0.0, pinion.loa_stiffness, gear.loa_stiffness, pinion.oloa_stiffness, gear.oloa_stiffness]
    )
    ratio = [0.0, 0.0, pinion.loa_damping_ratio, gear.loa_damping_ratio]
    ratio += [pinion.oloa_damping_ratio, gear.oloa_damping_ratio]
    arm = np.zeros((6, 2))
    arm[THETA_P] = 0.0, -s1
    arm[THETA_G] = g.L_XY, -1.0
    arm[Y_P:, 0] = 1.0, -s9
    return Structure(
        mass=mass,
        damping=2.0 * np.array(ratio) * np.sqrt(bearing * mass),
        stiffness=bearing,
        deflection=np.array([r_bp, -r_bg, 1.0, -1.0, 0.0, 0.0]),
        normal=np.array([-r_bp, s2 * r_bg, -1.0, s7, 0.0, 0.0]),
        friction_arm=arm,
        apart=np.array([0.0, 0.0, 0.0, 0.0, -1.0, 1.0]),
    )
