"""Both shafts of a pair with gears, bearings and coupled inertias as one system of matrices, without teeth.

The gear is a rigid disc at one station of the shaft. The centre (x, y) and the angle phi of the gear are
coordinates. Modes with these coordinates fixed describe the rest of bending and twist, and the coupled
inertia. Gyroscopic moments on the slopes beta of x and alpha of y are -J_p Omega alpha' and +J_p Omega beta',
Omega counter-clockwise positive.

Sources: docs/theory/shafts.md, "The machine".
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eigh, eigvals, eigvalsh

from lumped.errors import refuse
from lumped.schema.pair import GearPair
from lumped.schema.shafts import CoupledInertia, Shaft
from lumped.typing import FloatArray, IntArray
from multibody.gears.cut_teeth import root_radius
from multibody.shafts.beam import Interval, Reduced, bending, reduce_fields, torsion

#: Stations closer than this are one [m].
_SAME = 1e-7
#: A coupling is rigid if the inertia swings on the coupling so many times as fast as the highest mode.
_RIGID = 1e3
#: Most waves of the highest frequency in an interval: an order of 20 resolves them.
_WAVES = 4.0
#: Numbers of the fields of a shaft: bending in planes x and y, and twist. The coordinates of the gear, which
#: come first among the coordinates of a shaft, have the same numbers.
_PLANE_X = 0
_PLANE_Y = 1
_TWIST = 2
#: Coordinates of a gear on each shaft, and the angles of both gears among the coordinates of the train.
_GEAR = 3
_ANGLES = [2, 5]


@dataclass(frozen=True)
class Disc:
    """A gear as a rigid disc, SI: mass, polar and diametral moment of inertia.

    twist_stiffness : twist stiffness of the gear body between rim and shaft; infinite for a rigid body
    """

    mass: float
    inertia: float
    tilting: float
    twist_stiffness: float = math.inf


@dataclass(frozen=True, eq=False)
class ReducedShaft:
    """A shaft on the coordinates (x, y, phi of the gear, modal ones of plane x, plane y and twist).

    fields : the reduction of plane x, plane y and twist
    error : largest error of a frequency of a mode over the highest frequency, from the last two orders
    mass, stiffness, damping : (n, n), gyroscopic terms in ``damping``
    torque : (n,) generalised force of a unit torque of the motor or load; of a unit torque on the gear where
        the shaft has no motor or load
    bearings : (k, 2, n) rows that give the displacement of the shaft in the bearings along x and y
    bearing_stiffness, bearing_damping : (k, 2) [N/m], [N s/m]
    """

    fields: tuple[Reduced, ...]
    error: float
    mass: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    torque: FloatArray
    bearings: FloatArray
    bearing_stiffness: FloatArray
    bearing_damping: FloatArray

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.mass)


def reduced_shaft(
    shaft: Shaft,
    disc: Disc,
    coupled: CoupledInertia | None,
    *,
    speed: float,
    damping_ratio: float,
    highest: float,
) -> ReducedShaft:
    """Assemble and reduce one shaft that turns at ``speed`` [rad/s], counter-clockwise positive.

    damping_ratio : damping ratio of every mode that deforms the shaft or the bearings
    highest : highest frequency of the modes with the gear fixed [rad/s]
    """
    places = [shaft.gear_position, *(bearing.position for bearing in shaft.bearings)]
    if coupled is not None:
        places.append(coupled.position)
    intervals, stations = divided(shaft, places, highest)
    station = 0 if coupled is None else _nearest(stations, coupled.position)
    rigid = coupled is None or coupled.coupling_stiffness > (_RIGID * highest) ** 2 * coupled.inertia
    gear = _nearest(stations, shaft.gear_position)
    supported = np.array([_nearest(stations, bearing.position) for bearing in shaft.bearings])
    springs = np.array([[b.loa_stiffness, b.oloa_stiffness] for b in shaft.bearings])
    dampers = np.array([[b.loa_damping, b.oloa_damping] for b in shaft.bearings])
    tilting = np.array([b.tilt_stiffness for b in shaft.bearings])

    def plane(axis: int) -> Callable[[int], tuple[FloatArray, FloatArray, int]]:
        def matrices(order: int) -> tuple[FloatArray, FloatArray, int]:
            beam = bending(intervals, order)
            mass = beam.mass.copy()
            stiffness = beam.stiffness.copy()
            turn = beam.rotation
            mass[gear, gear] += disc.mass
            mass[turn + gear, turn + gear] += disc.tilting
            np.add.at(stiffness, (supported, supported), springs[:, axis])
            np.add.at(stiffness, (turn + supported, turn + supported), tilting)
            return mass, stiffness, gear

        return matrices

    def twisting(order: int) -> tuple[FloatArray, FloatArray, int]:
        mass, stiffness = torsion(intervals, order)
        rim = gear
        if math.isfinite(disc.twist_stiffness):
            mass, stiffness = _attached(mass, stiffness, gear, disc.inertia, disc.twist_stiffness)
            rim = mass.shape[0] - 1
        else:
            mass[gear, gear] += disc.inertia
        if coupled is not None and rigid:
            mass[station, station] += coupled.inertia
        elif coupled is not None:
            mass, stiffness = _attached(mass, stiffness, station, coupled.inertia, coupled.coupling_stiffness)
        return mass, stiffness, rim

    full_matrices = (plane(_PLANE_X), plane(_PLANE_Y), twisting)
    fields, order, error = reduce_fields(full_matrices, highest, (disc.mass, disc.mass, disc.inertia))
    columns = columns_of(fields)
    size = _GEAR + sum(field.frequencies.size for field in fields)
    mass, stiffness, damping = np.zeros((3, size, size))
    for field, matrices, coordinates in zip(fields, full_matrices, columns, strict=True):
        full_mass, full_stiffness, _ = matrices(order)
        block = np.ix_(coordinates, coordinates)
        mass[block] = field.basis.T @ full_mass @ field.basis
        stiffness[block] = field.basis.T @ full_stiffness @ field.basis
    # The shaft turns freely: the stiffness against this rotation is nothing but rounding.
    stiffness[_TWIST] = 0.0
    stiffness[:, _TWIST] = 0.0
    damping += modal_damping(mass, stiffness, damping_ratio)
    rows = np.zeros((supported.size, 2, size))
    for axis in (_PLANE_X, _PLANE_Y):
        rows[:, axis, columns[axis]] = fields[axis].basis[supported]
    damping += np.einsum("kd,kdi,kdj->ij", dampers, rows, rows)
    beam = bending(intervals, order)
    beam.spin[beam.rotation + gear, beam.rotation + gear] += disc.inertia
    spin = speed * fields[_PLANE_X].basis.T @ beam.spin @ fields[_PLANE_Y].basis
    damping[np.ix_(columns[_PLANE_X], columns[_PLANE_Y])] += spin
    damping[np.ix_(columns[_PLANE_Y], columns[_PLANE_X])] -= spin.T
    torque = np.zeros(size)
    if coupled is None:
        torque[_TWIST] = 1.0
    else:
        turn_of_inertia = fields[_TWIST].basis[station if rigid else -1]
        turn_of_station = fields[_TWIST].basis[station]
        coupling_twist = np.zeros(size)
        torque[columns[_TWIST]] = turn_of_inertia
        coupling_twist[columns[_TWIST]] = turn_of_inertia - turn_of_station
        damping += coupled.coupling_damping * np.outer(coupling_twist, coupling_twist)
    return ReducedShaft(
        fields=fields,
        error=error,
        mass=mass,
        stiffness=stiffness,
        damping=damping,
        torque=torque,
        bearings=rows,
        bearing_stiffness=springs,
        bearing_damping=dampers,
    )


def divided(shaft: Shaft, places: Sequence[float], highest: float) -> tuple[tuple[Interval, ...], FloatArray]:
    """Divide a shaft at its steps and at places [m]. Return the intervals, and the stations (n + 1,) [m].

    No interval is longer than ``_WAVES`` waves at the highest frequency [rad/s].
    """
    ends = np.cumsum([segment.length for segment in shaft.segments])
    divisions = np.sort(np.concatenate([[0.0], ends, np.minimum(places, ends[-1])]))
    stations = divisions[np.diff(divisions, prepend=-1.0) > _SAME]
    intervals: list[Interval] = []
    for start, stop in itertools.pairwise(stations):
        segment = shaft.segments[int(np.searchsorted(ends, 0.5 * (start + stop)))]
        material = shaft.youngs_modulus, shaft.poisson_ratio, shaft.density
        undivided = Interval(float(stop - start), segment.diameter, segment.bore, *material)
        count = math.ceil(undivided.length / (_WAVES * undivided.wave_length(highest)))
        intervals += [replace(undivided, length=undivided.length / count)] * count
    return tuple(intervals), np.cumsum([0.0] + [part.length for part in intervals])


def columns_of(fields: Sequence[Reduced]) -> list[IntArray]:
    """Numbers of the coordinates of each field of a reduced shaft: first the gear's, then the modal ones."""
    ends = _GEAR + np.cumsum([0] + [field.frequencies.size for field in fields])
    return [np.concatenate([[i], np.arange(ends[i], ends[i + 1])]) for i in range(len(fields))]


def modes_of(mass: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Natural frequencies [rad/s] and modes of unit modal mass, in columns; the first is the free turn."""
    squares, modes = eigh(stiffness, mass)
    squares[0] = 0.0
    return np.sqrt(squares), modes


def modal_damping(mass: FloatArray, stiffness: FloatArray, ratio: float) -> FloatArray:
    """Damping matrix that gives every mode but the free rotation the same damping ratio."""
    frequencies, modes = modes_of(mass, stiffness)
    momenta = mass @ modes
    return np.asarray((momenta * (2.0 * ratio * frequencies)) @ momenta.T)


def _nearest(stations: FloatArray, place: float) -> int:
    return int(np.abs(stations - place).argmin())


def _attached(
    mass: FloatArray, stiffness: FloatArray, where: int, inertia: float, spring: float
) -> tuple[FloatArray, FloatArray]:
    """Add an inertia behind a spring to the coordinate ``where``. The inertia is the last coordinate."""
    mass = np.pad(mass, (0, 1))
    stiffness = np.pad(stiffness, (0, 1))
    mass[-1, -1] = inertia
    ends = np.array([where, -1])
    stiffness[np.ix_(ends, ends)] += spring * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return mass, stiffness


@dataclass(frozen=True, eq=False)
class Train:
    """Two shafts; coordinates (x_p, y_p, phi_p, x_g, y_g, phi_g, modal of the pinion's, of the gear's shaft).

    shafts : of pinion and gear
    ratio : angle of the pinion over that of the gear
    places : numbers of each shaft's coordinates among all
    damping_ratio : damping ratio of the modes of each shaft without teeth
    highest : highest frequency of the modes with the gears fixed [Hz]
    """

    shafts: tuple[ReducedShaft, ReducedShaft]
    ratio: float
    places: tuple[IntArray, IntArray]
    damping_ratio: float
    highest: float

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return sum(shaft.size for shaft in self.shafts)

    @cached_property
    def angles(self) -> tuple[IntArray, IntArray]:
        """Coordinates that are angles, on the pinion's and on the gear's shaft."""
        pinion, gear = (
            places[columns_of(shaft.fields)[_TWIST]]
            for shaft, places in zip(self.shafts, self.places, strict=True)
        )
        return pinion, gear

    @cached_property
    def mass(self) -> FloatArray:
        """Mass matrix (n, n)."""
        return self._assembled("mass")

    @cached_property
    def stiffness(self) -> FloatArray:
        """Stiffness matrix (n, n) of shafts, bearings and couplings."""
        return self._assembled("stiffness")

    @cached_property
    def damping(self) -> FloatArray:
        """Damping matrix (n, n) with gyroscopic terms."""
        return self._assembled("damping")

    @cached_property
    def inverse(self) -> FloatArray:
        """Inverse of the mass matrix."""
        return np.asarray(cho_solve(cho_factor(self.mass), np.eye(self.size)))

    @cached_property
    def free_turn(self) -> FloatArray:
        """Rotation (n,) of both shafts at the ratio of the gears, which does not change the overlap."""
        turn = np.zeros(self.size)
        turn[_ANGLES] = -self.ratio, 1.0
        return turn

    @cached_property
    def torques(self) -> FloatArray:
        """Generalised forces (2, n) of counter-clockwise unit torques on motor and load, or on the gears."""
        forces = np.zeros((2, self.size))
        for force, shaft, places in zip(forces, self.shafts, self.places, strict=True):
            force[places] = shaft.torque
        return forces

    @cached_property
    def bearings(self) -> FloatArray:
        """Rows (k, 2, n) that give the displacements x, y in all bearings; the pinion's bearings first."""
        of_shafts = []
        for shaft, places in zip(self.shafts, self.places, strict=True):
            rows = np.zeros((len(shaft.bearings), 2, self.size))
            rows[:, :, places] = shaft.bearings
            of_shafts.append(rows)
        return np.concatenate(of_shafts)

    @cached_property
    def bearing_names(self) -> tuple[str, ...]:
        """Names of the bearings: "pinion 1", "pinion 2", ..., "gear 1", ..."""
        return tuple(
            f"{name} {i + 1}"
            for name, shaft in zip(("pinion", "gear"), self.shafts, strict=True)
            for i in range(len(shaft.bearings))
        )

    def bearing_force(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Forces of all bearings on the shafts, (k, 2, m) [N], at m states (m, n)."""
        stiffness = np.concatenate([shaft.bearing_stiffness for shaft in self.shafts])[:, :, None]
        damping = np.concatenate([shaft.bearing_damping for shaft in self.shafts])[:, :, None]
        return np.asarray(-(stiffness * (self.bearings @ q.T) + damping * (self.bearings @ v.T)))

    def fastest(self, mesh_stiffness: FloatArray) -> tuple[float, float]:
        """Largest natural frequency with the mesh (6, 6), and largest rate of a root with dampers [rad/s]."""
        n = self.size
        stiffness = self.stiffness.copy()
        stiffness[:6, :6] += mesh_stiffness
        state = np.zeros((2 * n, 2 * n))
        state[:n, n:] = np.eye(n)
        state[n:, :n] = -self.inverse @ stiffness
        state[n:, n:] = -self.inverse @ self.damping
        natural = float(np.sqrt(eigvalsh(stiffness, self.mass)[-1]))
        return natural, max(natural, float(np.abs(eigvals(state)).max()))

    def static(self, force: FloatArray, overlap: FloatArray, mesh_stiffness: float) -> FloatArray:
        """Deflection (n,) under a force (n,), with a spring along the row ``overlap`` (6,) between the gears.

        The train turns freely. The deflection is the one that has no part along the free turn.
        """
        n = self.size
        stiffness = self.stiffness.copy()
        stiffness[:6, :6] += mesh_stiffness * np.outer(overlap, overlap)
        condition = self.mass @ self.free_turn
        bordered = np.block([[stiffness, condition[:, None]], [condition[None], np.zeros((1, 1))]])
        scale = np.append(np.sqrt(np.diag(self.mass)), 1.0 / np.linalg.norm(condition))
        unit = float(np.abs(np.diag(stiffness) / scale[:n] ** 2).max())
        scaled = bordered / np.outer(scale, scale)
        scaled[:n, :n] /= unit
        solution = np.linalg.solve(scaled, np.append(force / scale[:n] / unit, 0.0))
        return np.asarray(solution[:n] / scale[:n])

    def _assembled(self, name: str) -> FloatArray:
        """Matrix (n, n) of the train from the matrices ``name`` of both shafts."""
        matrix = np.zeros((self.size, self.size))
        for shaft, places in zip(self.shafts, self.places, strict=True):
            matrix[np.ix_(places, places)] = getattr(shaft, name)
        return matrix


def train(
    pair: GearPair, mass: FloatArray, inertia: FloatArray, speeds: tuple[float, float], enough: float
) -> Train:
    """Both shafts of a pair.

    mass, inertia : (2,) of pinion and gear
    speeds : positive speeds of pinion and gear [rad/s]; the pinion turns clockwise
    enough : highest frequency of the modes with the gears fixed, for a pair without ``max_frequency`` [Hz]
    """
    if pair.shafts is None:
        raise refuse(
            "supports", "'shafts'", "'springs' for a pair without [shafts]", "Add [shafts] to the parameters."
        )
    stated = pair.shafts.max_frequency
    highest = enough if stated is None else stated
    shafts = []
    sides = (
        (pair.shafts.pinion, pair.shafts.motor, -speeds[0]),
        (pair.shafts.gear, pair.shafts.load, speeds[1]),
    )
    for i, (shaft, coupled, speed) in enumerate(sides):
        shafts.append(
            reduced_shaft(
                shaft,
                disc(pair, i, float(mass[i]), float(inertia[i])),
                coupled,
                speed=speed,
                damping_ratio=pair.shafts.damping_ratio,
                highest=2.0 * math.pi * highest,
            )
        )
    on_pinion, on_gear = shafts
    both_gears = 2 * _GEAR
    modes_of_pinion = on_pinion.size - _GEAR
    modes_of_gear = on_gear.size - _GEAR
    pinion = np.concatenate([np.arange(_GEAR), both_gears + np.arange(modes_of_pinion)])
    first_of_gear = both_gears + modes_of_pinion
    gear = np.concatenate([np.arange(_GEAR, both_gears), first_of_gear + np.arange(modes_of_gear)])
    return Train(
        shafts=(on_pinion, on_gear),
        ratio=speeds[0] / speeds[1],
        places=(pinion, gear),
        damping_ratio=pair.shafts.damping_ratio,
        highest=highest,
    )


def disc(pair: GearPair, number: int, mass: float, inertia: float) -> Disc:
    """Pinion (0) or gear (1) as a rigid disc. A bored gear body twists between shaft and rim (Lame)."""
    twist = math.inf
    gear = (pair.pinion, pair.gear)[number]
    if gear.bore > 0.0:
        root = root_radius(pair, number)
        shear = gear.youngs_modulus / (2.0 * (1.0 + gear.poisson_ratio))
        twist = 4.0 * math.pi * shear * gear.face_width / ((2.0 / gear.bore) ** 2 - 1.0 / root**2)
    return Disc(mass, inertia, 0.5 * inertia + mass * gear.face_width**2 / 12.0, twist)
