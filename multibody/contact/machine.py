"""A gear pair turned into the plain numbers that a multibody model needs.

Only the drawing (teeth, module, pressure angle, tip radii, centre distance), the element laws and the loads
are taken from ``lumped``. Base circles, line of action, path of contact and tooth thickness are derived
here again, so that agreement of the two models is evidence for both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lumped.model.bodies import bodies
from lumped.model.mesh_elements import mesh_elements
from lumped.path_function import PathFunction
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, IntArray
from multibody.contact import kernels as kn
from multibody.contact.events import event_table
from multibody.contact.kinematics import DRIVE, line_of_action, mesh_phase, wrap


@dataclass(frozen=True, eq=False)
class Machine:
    """Two gears in bearings, SI.

    Attributes
    ----------
    parameters : (kernels.N_PARAMETERS,) geometry and nominal motion, in the order of ``kernels``
    table, offsets : element laws as ``kernels.law`` reads them
    mass, inertia : (2,) pinion, gear [kg], [kg m^2]
    bearing_stiffness, bearing_damping : (2, 2) rows pinion, gear; columns x, y [N/m], [N s/m]
    torque_pinion, torque_gear : driving and braking torque, both positive [N m]
    pairs : slots of tooth pairs, floor(contact ratio) + 1
    period : mesh cycle [s]
    switches : phases of the mesh cycle in [0, 1) at which the nominal element laws jump or have a kink
    events : (n, 2) what makes the contact force jump or bend in finite motion, see ``events.event_table``
    """

    parameters: FloatArray
    table: FloatArray
    offsets: IntArray
    mass: FloatArray
    inertia: FloatArray
    bearing_stiffness: FloatArray
    bearing_damping: FloatArray
    torque_pinion: float
    torque_gear: float
    pairs: int
    period: float
    switches: FloatArray
    events: FloatArray

    @cached_property
    def bodies(self) -> FloatArray:
        """Constant coefficients of the bodies' equations of motion, (4, 6).

        Rows: inertia, bearing stiffness, bearing damping, constant load of the coordinates (x_p, y_p, phi_p,
        x_g, y_g, phi_g). The pinion turns clockwise, so its driving torque is negative; the brake's acts
        against the gear.
        """
        rows = np.zeros((4, 2, 3))
        rows[0, :, :2], rows[0, :, 2] = self.mass[:, None], self.inertia
        rows[1, :, :2], rows[2, :, :2] = self.bearing_stiffness, self.bearing_damping
        rows[3, :, 2] = -self.torque_pinion, -self.torque_gear
        return rows.reshape(4, 6)

    @cached_property
    def vibrations_per_cycle(self) -> float:
        """Swings of the fastest natural mode in one mesh cycle, with every pair at its largest stiffness.

        The mesh acts along the nominal line of action, without friction and damping.
        """
        inertia, bearings, _, _ = self.bodies
        rows = self.table[self.offsets[kn.STIFFNESS] : self.offsets[kn.STIFFNESS + 1]]
        middle = 0.5 * (rows[:, 0] + rows[:, 1])
        places = np.concatenate([rows[:, 0], middle, rows[:, 1]])
        largest = max(abs(kn.law(self.table, self.offsets, kn.STIFFNESS, xi)[0]) for xi in places)
        p = self.parameters
        mesh = np.array([1.0, 0.0, -p[kn.RADIUS_P], -1.0, 0.0, -p[kn.RADIUS_G]])
        stiffness = self.pairs * largest * np.outer(mesh, mesh) + np.diag(bearings)
        squares = np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(inertia, inertia)))
        return float(np.sqrt(squares[-1]) * self.period / (2.0 * np.pi))


def machine(pair: GearPair) -> Machine:
    """Describe a gear pair for the multibody model, both torques being that of the pinion.

    Parameters
    ----------
    pair : validated gear pair
    """
    drawing, body, elements = pair.geometry, bodies(pair), mesh_elements(pair)
    alpha, module = pair.basic_rack.pressure_angle, pair.basic_rack.module
    r_p = 0.5 * module * pair.pinion.teeth * math.cos(alpha)
    r_g = 0.5 * module * pair.gear.teeth * math.cos(alpha)
    pitch = math.pi * module * math.cos(alpha)
    l_xy = math.sqrt(drawing.centre_distance**2 - (r_p + r_g) ** 2)
    tip_p = math.sqrt(drawing.tip_radius_pinion**2 - r_p**2)
    tip_g = math.sqrt(drawing.tip_radius_gear**2 - r_g**2)
    l_xa, l_xp = l_xy - tip_g, l_xy * r_p / (r_p + r_g)
    omega_p = pair.operating.pinion_speed
    p = np.zeros(kn.N_PARAMETERS)
    p[kn.RADIUS_P], p[kn.RADIUS_G], p[kn.PITCH] = r_p, r_g, pitch
    p[kn.TIP_P], p[kn.TIP_G] = tip_p, tip_g
    # At t = 0 the line of action is the x axis and one pair touches at A: rho_p = L_XA, rho_g = L_XY - L_XA.
    p[kn.CHI_P], p[kn.CHI_G] = -l_xa / r_p, math.pi - tip_g / r_g
    for place, drive, radius, gear in (
        (kn.CHI_P_BACK, kn.CHI_P, r_p, pair.pinion),
        (kn.CHI_G_BACK, kn.CHI_G, r_g, pair.gear),
    ):
        # The other flank of the same tooth starts one base tooth thickness further on (see kinematics).
        inv = math.tan(alpha) - alpha
        thickness = module * math.cos(alpha) * (0.5 * math.pi + 2 * gear.profile_shift * math.tan(alpha))
        thickness += 2.0 * radius * inv - 0.5 * pair.mesh.backlash
        p[place] = p[drive] + math.pi + thickness / radius
    p[kn.CENTRE_PY], p[kn.CENTRE_GX], p[kn.CENTRE_GY] = -r_p, l_xy, r_g
    p[kn.L_XA], p[kn.L_XP], p[kn.L_XD], p[kn.L_XY] = l_xa, l_xp, tip_p, l_xy
    p[kn.OMEGA_P], p[kn.OMEGA_G] = omega_p, omega_p * r_p / r_g
    p[kn.T_LOW], p[kn.T_HIGH] = -math.inf, math.inf
    mass = np.array([body.mass_pinion, body.mass_gear])
    bearings = (pair.bearings.pinion, pair.bearings.gear)
    stiffness = np.array([[b.loa_stiffness, b.oloa_stiffness] for b in bearings])
    ratio = np.array([[b.loa_damping_ratio, b.oloa_damping_ratio] for b in bearings])
    laws = (elements.stiffness, elements.damping, elements.friction, elements.error)
    table, offsets = pack_laws(laws)
    return Machine(
        parameters=p,
        table=table,
        offsets=offsets,
        mass=mass,
        inertia=np.array([body.inertia_pinion, body.inertia_gear]),
        bearing_stiffness=stiffness,
        bearing_damping=2.0 * ratio * np.sqrt(stiffness * mass[:, None]),
        torque_pinion=pair.operating.pinion_torque,
        torque_gear=pair.operating.pinion_torque,
        pairs=math.floor((tip_p - l_xa) / pitch) + 1,
        period=pitch / (omega_p * r_p),
        switches=switch_phases(laws, l_xa, tip_p, pitch),
        events=event_table(*laws, pitch),
    )


def loaded_phase(machine: Machine, flags: int, q: FloatArray) -> Machine:
    """Turn the unloaded gears so that it is the loaded pair that stands at A at t = 0.

    Wind-up and bearing deflection move the contact along the path, by a constant in the mean. The rigid
    rotation of a free gear train is arbitrary, so that constant is no difference between models but a
    choice of the time origin; it is taken out.

    Parameters
    ----------
    machine : numbers whose flanks touch at A when unloaded
    flags : effect switches of the contact core: without moving contacts nothing is turned
    q : (6,) static state
    """
    p = machine.parameters.copy()
    px, py, gx, gy = p[kn.CENTRE_PX], p[kn.CENTRE_PY], p[kn.CENTRE_GX], p[kn.CENTRE_GY]
    if flags & kn.MOVING_LINE:
        px, py, gx, gy = px + q[0], py + q[1], gx + q[3], gy + q[4]
    phi_p, phi_g = (q[2], q[5]) if flags & kn.ROTATION_PHASE else (0.0, 0.0)
    _, _, length, psi = line_of_action(px, py, gx, gy, p[kn.RADIUS_P] + p[kn.RADIUS_G], DRIVE)
    radii = (p[kn.RADIUS_P], p[kn.RADIUS_G])
    first, beyond = mesh_phase(
        psi, length, phi_p, phi_g, *radii, p[kn.PITCH], p[kn.CHI_P], p[kn.CHI_G], DRIVE
    )
    moved = wrap(first + 0.5 * (p[kn.L_XY] - length - beyond) - p[kn.L_XA], p[kn.PITCH])
    # rho_p falls and rho_g grows by what the contact has moved; the overlap stays.
    p[[kn.CHI_P, kn.CHI_P_BACK]] += moved / radii[0]
    p[[kn.CHI_G, kn.CHI_G_BACK]] -= moved / radii[1]
    return replace(machine, parameters=p)


def pack_laws(laws: tuple[PathFunction, ...]) -> tuple[FloatArray, IntArray]:
    """Stack piecewise polynomials into one table for ``kernels.law``: rows of (left, right, coefficients)."""
    order = max(law.coefficients.shape[0] for law in laws)
    blocks, offsets = [], [0]
    for law in laws:
        pieces = law.coefficients.shape[1]
        block = np.zeros((pieces, 2 + order))
        block[:, 0], block[:, 1] = law.breaks[:-1], law.breaks[1:]
        block[:, 2 + order - law.coefficients.shape[0] :] = law.coefficients.T
        blocks.append(block)
        offsets.append(offsets[-1] + pieces)
    return np.ascontiguousarray(np.vstack(blocks)), np.array(offsets, dtype=np.int64)


def switch_phases(laws: tuple[PathFunction, ...], l_xa: float, l_xd: float, pitch: float) -> FloatArray:
    """Phases of the nominal mesh cycle in [0, 1) where a pair meets a jump or a kink; 0 is always one."""
    places = np.concatenate([[l_xa, l_xd], *(law.switches for law in laws)])
    phases = np.sort(np.mod((places - l_xa) / pitch, 1.0))
    # Places that differ by rounding (or by a whole pitch) are one event.
    keep = np.diff(phases, prepend=-1.0) > 1e-11
    phases = phases[keep]
    return phases[phases < 1.0 - 1e-11]
