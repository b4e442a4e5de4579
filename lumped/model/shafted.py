"""A gear pair on its shafts in modal coordinates of the shafts, teeth apart.

Every mode belongs to one shaft and to one plane or to twist. The two rigid rotations are exchanged for the
common one, which no tooth feels, and the relative one. The mesh then couples all modes by one number, the
dynamic transmission error; bearing dashpots, couplings and gyroscopic moments couple those of a shaft.

Sources: docs/theory/shafts.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lumped.errors import refuse
from lumped.model.bodies import bodies
from lumped.schema.pair import GearPair
from lumped.shafts.supported import Disc, SupportedShaft, supported_shaft
from lumped.stiffness.foundation import body_twist
from lumped.typing import FloatArray, IntArray

#: Tooth stiffness of steel over face width [Pa], for the default of ``max_frequency``; ISO 6336-1, sec. 5.3.
_TOOTH = 2e10
#: Modes are kept up to this multiple of the frequency of the gears on such teeth.
_ABOVE = 3.0
#: Most coordinates of a pair on shafts: seconds of work for a periodic motion.
_MOST = 80
_GEARS = ("pinion", "gear")


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
    mesh_error : relative error of the frequencies by the elements
    highest : up to which modes with the gears held are kept [rad/s]
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
    mesh_error: float
    highest: float

    @property
    def damping(self) -> FloatArray:
        """All dissipation (m, m)."""
        return self.modal_damping + self.bearing_damping + self.coupling_damping


def highest_frequency(pair: GearPair) -> float:
    """Up to which modes of the shafts with the gears held are kept [rad/s]."""
    assert pair.shafts is not None
    if pair.shafts.max_frequency is not None:
        return 2.0 * math.pi * pair.shafts.max_frequency
    stiffness = _TOOTH * min(pair.pinion.face_width, pair.gear.face_width)
    return _ABOVE * math.sqrt(stiffness / bodies(pair).effective_mass)


def discs(pair: GearPair) -> tuple[Disc, Disc]:
    """Both gears as rigid discs: mass and polar inertia as without shafts, J/2 + m b^2/12 against tilting."""
    b = bodies(pair)
    pinion, gear = (
        Disc(float(mass), float(inertia), float(0.5 * inertia + mass * width**2 / 12.0), float(twist))
        for mass, inertia, width, twist in zip(
            (b.mass_pinion, b.mass_gear),
            (b.inertia_pinion, b.inertia_gear),
            (pair.pinion.face_width, pair.gear.face_width),
            body_twist(pair),
            strict=True,
        )
    )
    return pinion, gear


def supported_shafts(pair: GearPair) -> tuple[SupportedShaft, SupportedShaft]:
    """Modes of the pinion's and of the gear's shaft.

    Raises
    ------
    ParameterError : the pair has no shafts
    """
    shafts = pair.shafts
    if shafts is None:
        action = "Describe the shafts in the parameter file, or take supports='springs'."
        raise refuse("supports", "'shafts'", "a gear pair with a section [shafts]", action)
    highest = highest_frequency(pair)
    pinion, gear = discs(pair)
    return (
        supported_shaft(shafts.pinion, pinion, shafts.motor, highest),
        supported_shaft(shafts.gear, gear, shafts.load, highest),
    )


def shafted_pair(pair: GearPair) -> ShaftedPair:
    """Return the modal data of a pair on its shafts.

    Raises
    ------
    ParameterError : no shafts, or so many modes that a periodic motion would take minutes
    """
    both = supported_shafts(pair)
    shafts, g = pair.shafts, pair.geometry
    assert shafts is not None
    counts = [[modes.frequencies.size for modes in shaft.planes] for shaft in both]
    m = int(np.sum(counts))
    if m > _MOST:
        action = "Lower it: modes far above the mesh frequency follow statically."
        given = f"{highest_frequency(pair) / (2.0 * math.pi):.4g} Hz"
        raise refuse("shafts.max_frequency", given, f"at most {_MOST} modes, not {m}", action)
    names, owner, kind, frequencies = [], [], [], []
    gears = np.zeros((6, m))
    bearings = np.zeros((sum(len(shaft.bearings) for shaft in both), 2, m))
    coupling, gyroscopic = np.zeros((2, m, m))
    torques = np.zeros((2, m))
    first, row = 0, 0
    # The pinion turns clockwise in (x, y), the gear counter-clockwise, z_p/z_g as fast.
    for which, (shaft, turn) in enumerate(zip(both, (-1.0, g.omega_gear / g.omega_pinion), strict=True)):
        at = []
        for number, (modes, label) in enumerate(zip(shaft.planes, ("x", "y", "twist"), strict=True)):
            columns = slice(first, first + modes.frequencies.size)
            at.append(columns)
            first = columns.stop
            gear_row = (2 + which, 4 + which, which)[number]
            gears[gear_row, columns] = modes.shapes[shaft.gear[number]]
            start = 1 if number < 2 else 0
            names += [f"{_GEARS[which]} {label} {j + start}" for j in range(modes.frequencies.size)]
            owner += [which] * modes.frequencies.size
            kind += [number] * modes.frequencies.size
            frequencies += modes.frequencies.tolist()
            if number < 2:
                bearings[row : row + len(shaft.bearings), number, columns] = modes.shapes[
                    list(shaft.bearings)
                ]
        row += len(shaft.bearings)
        gyroscopic[at[0], at[1]] = turn * shaft.spin
        gyroscopic[at[1], at[0]] = -turn * shaft.spin.T
        damper, turned = shaft.coupling
        coupling[at[2], at[2]] = damper * np.multiply.outer(turned, turned)
        torques[which, at[2]] = (1.0, -1.0)[which] * shaft.planes[2].shapes[shaft.driven]
    omega = np.array(frequencies)
    springs = [*shafts.pinion.bearings, *shafts.gear.bearings]
    dampers = np.array([[b.loa_damping, b.oloa_damping] for b in springs])
    dashpots = np.einsum("bdi,bd,bdj->ij", bearings, dampers, bearings)
    found = ShaftedPair(
        names=tuple(names),
        shaft=np.array(owner),
        kind=np.array(kind),
        frequencies=omega,
        gears=gears,
        modal_damping=np.diag(2.0 * shafts.damping_ratio * omega),
        bearing_damping=dashpots,
        coupling_damping=coupling,
        gyroscopic=gyroscopic,
        torque_pinion=torques[0],
        torque_gear=torques[1],
        bearing_names=tuple(
            f"{name} {j + 1}"
            for name, shaft in zip(_GEARS, both, strict=True)
            for j in range(len(shaft.bearings))
        ),
        bearings=bearings,
        bearing_stiffness=np.array([[b.loa_stiffness, b.oloa_stiffness] for b in springs]),
        bearing_dampers=dampers,
        mesh_error=max(shaft.mesh_error for shaft in both),
        highest=highest_frequency(pair),
    )
    return _rotations_first(found, (counts[0][0] + counts[0][1], m - counts[1][2]), pair)


def _rotations_first(found: ShaftedPair, rigid: tuple[int, int], pair: GearPair) -> ShaftedPair:
    """The same with the common and the relative rotation, in this order, instead of the rigid ones."""
    g, m = pair.geometry, found.frequencies.size
    felt = np.array(
        [g.base_radius_pinion * found.gears[0, rigid[0]], -g.base_radius_gear * found.gears[1, rigid[1]]]
    )
    felt /= np.linalg.norm(felt)
    to = np.zeros((m, m))  # new coordinates as columns over the old ones
    to[list(rigid), 0] = felt[1], -felt[0]
    to[list(rigid), 1] = felt
    rest = np.delete(np.arange(m), rigid)
    to[rest, np.arange(2, m)] = 1.0
    names = ("common rotation", "relative rotation", *(found.names[j] for j in rest))
    two = np.array([-1, -1])
    return ShaftedPair(
        names=names,
        shaft=np.concatenate([two, found.shaft[rest]]),
        kind=np.concatenate([[2, 2], found.kind[rest]]),
        frequencies=np.concatenate([[0.0, 0.0], found.frequencies[rest]]),
        gears=found.gears @ to,
        modal_damping=to.T @ found.modal_damping @ to,
        bearing_damping=to.T @ found.bearing_damping @ to,
        coupling_damping=to.T @ found.coupling_damping @ to,
        gyroscopic=to.T @ found.gyroscopic @ to,
        torque_pinion=found.torque_pinion @ to,
        torque_gear=found.torque_gear @ to,
        bearing_names=found.bearing_names,
        bearings=found.bearings @ to,
        bearing_stiffness=found.bearing_stiffness,
        bearing_dampers=found.bearing_dampers,
        mesh_error=found.mesh_error,
        highest=found.highest,
    )
