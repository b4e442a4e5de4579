"""A gear pair on its shafts in modal coordinates of the shafts, with the teeth apart.

Every mode belongs to one shaft, and to one plane or to twist. The rigid rotations of both shafts are replaced
by the common rotation, which moves no tooth against its mate, and the relative rotation. The mesh then
couples all modes by one number, the dynamic transmission error. Bearing dashpots, couplings and gyroscopic
moments couple the modes of one shaft.

Sources: docs/theory/shafts.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lumped.errors import refuse
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.shafts.supported import Disc, SupportedShaft, supported_shaft
from lumped.stiffness.foundation import body_twist
from lumped.typing import FloatArray, IntArray

#: Tooth stiffness of steel over face width [Pa], for the default of ``max_frequency``; ISO 6336-1, sec. 5.3.
_TOOTH = 2e10
#: Modes are taken up to this multiple of the natural frequency of the gears on such teeth.
_ABOVE = 3.0
#: Most coordinates of a pair on shafts; a periodic motion then takes seconds.
_MOST = 80
_GEARS = ("pinion", "gear")
#: Planes of a shaft: bending along x, bending along y, twist.
_X, _Y, _TWIST = range(3)


@dataclass(frozen=True, eq=False)
class ShaftedPair:
    """Data of q'' + (damping + Omega_p gyroscopic) q' + omega^2 q = gears^T f, SI.

    Attributes
    ----------
    names : (m,) of the coordinates; the first is the common rotation, the second the relative one
    shaft : (m,) 0 for modes of the pinion's shaft, 1 for the gear's; -1 for the two rotations
    kind : (m,) 0 bending along x, 1 along y, 2 twist
    frequencies : (m,) omega, teeth apart [rad/s]
    gears : (6, m) rows that make theta_p, theta_g, x_p, x_g, y_p, y_g
    modal_damping : (m, m) diagonal, of the shafts' damping ratio
    bearing_damping : (m, m) of the bearings' dashpots
    coupling_damping : (m, m)
    gyroscopic : (m, m) antimetric, over the speed of the pinion
    torque_pinion, torque_gear : (m,) forces by a unit of driving and of braking torque
    bearing_names : (b,) "pinion 1", ...
    bearings : (b, 2, m) rows that make the displacement of the shaft in each bearing along x and y
    bearing_stiffness, bearing_dampers : (b, 2) [N/m], [N s/m]
    deflection : (m,) makes the dynamic transmission error; zero for the common rotation
    """

    names: tuple[str, ...]
    shaft: IntArray
    kind: IntArray
    frequencies: FloatArray
    gears: FloatArray
    modal_damping: FloatArray
    bearing_damping: FloatArray
    coupling_damping: FloatArray
    gyroscopic: FloatArray
    torque_pinion: FloatArray
    torque_gear: FloatArray
    bearing_names: tuple[str, ...]
    bearings: FloatArray
    bearing_stiffness: FloatArray
    bearing_dampers: FloatArray
    deflection: FloatArray

    @property
    def damping(self) -> FloatArray:
        """Damping matrix of all parts together (m, m)."""
        return self.modal_damping + self.bearing_damping + self.coupling_damping


def highest_frequency(pair: GearPair) -> float:
    """Frequency up to which modes of the shafts with fixed gears are taken [rad/s]."""
    assert pair.shafts is not None
    if pair.shafts.max_frequency is not None:
        return 2.0 * math.pi * pair.shafts.max_frequency
    stiffness = _TOOTH * min(pair.pinion.face_width, pair.gear.face_width)
    return _ABOVE * math.sqrt(stiffness / bodies_of(pair).effective_mass)


def discs(pair: GearPair) -> tuple[Disc, Disc]:
    """Both gears as rigid discs: mass and polar inertia as without shafts, J/2 + m b^2/12 against tilting."""
    b = bodies_of(pair)
    twist = body_twist(pair)

    def disc(mass: float, inertia: float, width: float, stiffness: float) -> Disc:
        return Disc(mass, inertia, 0.5 * inertia + mass * width**2 / 12.0, float(stiffness))

    pinion = disc(b.mass_pinion, b.inertia_pinion, pair.pinion.face_width, twist[0])
    return pinion, disc(b.mass_gear, b.inertia_gear, pair.gear.face_width, twist[1])


def supported_shafts(pair: GearPair) -> tuple[SupportedShaft, SupportedShaft]:
    """Modes of the pinion's and of the gear's shaft."""
    shafts = pair.shafts
    if shafts is None:
        action = "Describe its shafts in the parameter file, or take the springs of 'bearings'."
        raise refuse("supports", "shafts", "springs for a pair without [shafts]", action)
    highest = highest_frequency(pair)
    pinion, gear = discs(pair)
    return (
        supported_shaft(shafts.pinion, pinion, shafts.motor, highest),
        supported_shaft(shafts.gear, gear, shafts.load, highest),
    )


def shafted_pair(pair: GearPair) -> ShaftedPair:
    """Return the modal data of a pair on its shafts."""
    both = supported_shafts(pair)
    shafts = pair.shafts
    g = pair.geometry
    assert shafts is not None
    counts = [[modes.frequencies.size for modes in shaft.planes] for shaft in both]
    m = int(np.sum(counts))
    if m > _MOST:
        action = "Lower it: modes far above the mesh frequency follow statically."
        frequency = f"{highest_frequency(pair) / (2.0 * math.pi):.4g} Hz"
        raise refuse("shafts.max_frequency", frequency, f"at most {_MOST} modes, not {m}", action)
    names = []
    owner = []
    kind = []
    frequencies = []
    bearing_names: list[str] = []
    gears = np.zeros((6, m))
    bearings = np.zeros((sum(len(shaft.bearings) for shaft in both), 2, m))
    coupling, gyroscopic = np.zeros((2, m, m))
    torques = np.zeros((2, m))
    first = 0
    # The pinion turns clockwise in (x, y), the gear counter-clockwise, z_p/z_g as fast.
    for gear, (shaft, turn) in enumerate(zip(both, (-1.0, g.omega_gear / g.omega_pinion), strict=True)):
        columns_of_plane = []
        row = len(bearing_names)
        bearing_names += [f"{_GEARS[gear]} {j + 1}" for j in range(len(shaft.bearings))]
        for number, (modes, label) in enumerate(zip(shaft.planes, ("x", "y", "twist"), strict=True)):
            count = modes.frequencies.size
            columns = slice(first, first + count)
            columns_of_plane.append(columns)
            first = columns.stop
            gears[(2 + gear, 4 + gear, gear)[number], columns] = modes.shapes[shaft.gear[number]]
            names += [f"{_GEARS[gear]} {label} {j + (number < 2)}" for j in range(count)]
            owner += [gear] * count
            kind += [number] * count
            frequencies += modes.frequencies.tolist()
            if number < 2:
                bearings[row : len(bearing_names), number, columns] = modes.shapes[list(shaft.bearings)]
        gyroscopic[columns_of_plane[_X], columns_of_plane[_Y]] = turn * shaft.spin
        gyroscopic[columns_of_plane[_Y], columns_of_plane[_X]] = -turn * shaft.spin.T
        damper, turn_of_modes = shaft.coupling
        coupling[columns_of_plane[_TWIST], columns_of_plane[_TWIST]] = damper * np.multiply.outer(
            turn_of_modes, turn_of_modes
        )
        torques[gear, columns_of_plane[_TWIST]] = (1.0, -1.0)[gear] * shaft.planes[_TWIST].shapes[
            shaft.driven
        ]
    omega = np.array(frequencies)
    springs = [*shafts.pinion.bearings, *shafts.gear.bearings]
    dampers = np.array([[b.loa_damping, b.oloa_damping] for b in springs])
    dashpots = np.einsum("bdi,bd,bdj->ij", bearings, dampers, bearings)
    # The common and the relative rotation, in this order, instead of the rigid ones of both shafts.
    rigid = [counts[0][0] + counts[0][1], m - counts[1][_TWIST]]
    relative = np.array([g.base_radius_pinion, -g.base_radius_gear]) * gears[[0, 1], rigid]
    relative /= np.linalg.norm(relative)
    to = np.zeros((m, m))  # new coordinates as columns over the old ones
    to[rigid, 0] = relative[1], -relative[0]
    to[rigid, 1] = relative
    rest = np.delete(np.arange(m), rigid)
    to[rest, np.arange(2, m)] = 1.0
    gears = gears @ to
    deflection = np.array([g.base_radius_pinion, -g.base_radius_gear, 1.0, -1.0, 0.0, 0.0]) @ gears
    deflection[0] = 0.0  # but for rounding
    return ShaftedPair(
        names=("common rotation", "relative rotation", *(names[j] for j in rest)),
        shaft=np.array([-1, -1, *np.array(owner)[rest]]),
        kind=np.array([2, 2, *np.array(kind)[rest]]),
        frequencies=np.array([0.0, 0.0, *omega[rest]]),
        gears=gears,
        modal_damping=to.T @ np.diag(2.0 * shafts.damping_ratio * omega) @ to,
        bearing_damping=to.T @ dashpots @ to,
        coupling_damping=to.T @ coupling @ to,
        gyroscopic=to.T @ gyroscopic @ to,
        torque_pinion=torques[0] @ to,
        torque_gear=torques[1] @ to,
        bearing_names=tuple(bearing_names),
        bearings=bearings @ to,
        bearing_stiffness=np.array([[b.loa_stiffness, b.oloa_stiffness] for b in springs]),
        bearing_dampers=dampers,
        deflection=deflection,
    )
