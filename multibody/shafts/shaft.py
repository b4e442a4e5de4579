"""One shaft with its gear, bearings and coupled inertia, on few coordinates.

The gear is a rigid disc at its station. Its centre (x, y) and its angle phi are kept as they are; the rest of
bending in both planes, of twist and the coupled inertia is left to modes with these held. An inertia behind a
coupling is reduced with its shaft rather than made a body of its own: however light, it then has no mode
above the highest frequency, which would stall an explicit integrator.

Slopes beta of x and alpha of y over z turn the axis of a spinning section by the vector (-alpha, beta). Its
moment of momentum is J_d (-alpha', beta') + J_p Omega (beta, alpha) beside J_p Omega along z, so the
gyroscopic moments on beta and alpha are -J_p Omega alpha' and +J_p Omega beta', with Omega counter-clockwise
positive: of opposite signs for pinion and gear. They do not depend on the direction in which z is counted.

Sources: docs/theory/shafts.md; the sense of the gyroscopic moment follows from Euler's law as above.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh

from lumped.schema.shafts import CoupledInertia, Shaft
from lumped.typing import FloatArray, IntArray
from multibody.shafts.beam import Interval, Reduced, bending, reading, reduce_fields, torsion

#: Stations closer than this are one [m].
_SAME = 1e-7
#: A coupling on which its inertia swings so many times as fast as the highest mode is rigid.
_RIGID = 1e3
#: Most waves of the highest frequency in an interval: an order of 20 resolves them.
_WAVES = 4.0


@dataclass(frozen=True)
class Disc:
    """A gear as a rigid disc, SI.

    Attributes
    ----------
    mass, inertia, tilting : [kg], polar and diametral moment of inertia [kg m^2]
    twist_stiffness : of its body between rim and shaft [N m/rad], infinite where it is rigid
    """

    mass: float
    inertia: float
    tilting: float
    twist_stiffness: float = math.inf


@dataclass(frozen=True, eq=False)
class ReducedShaft:
    """A shaft on the coordinates (x, y, phi of the gear, modal ones of plane x, plane y and twist).

    Attributes
    ----------
    intervals : pieces between the stations
    fields : the reduction of plane x, plane y and twist
    order : of the polynomials in every interval
    error : of a kept frequency over the highest, at most, as the last increase of the order shows
    mass, stiffness, damping : (n, n), gyroscopic terms in ``damping``
    torque : (n,) generalised force of a unit torque of the motor or load, or on the gear where there is none
    bearings : (k, 2, n) rows that read the displacement of the shaft in its bearings along x and y
    bearing_stiffness, bearing_damping : (k, 2) [N/m], [N s/m]
    """

    intervals: tuple[Interval, ...]
    fields: tuple[Reduced, ...]
    order: int
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

    def reading(self, places: FloatArray) -> FloatArray:
        """Rows (2, k, n) that read the axis' displacements x and y at places along z [m]."""
        rows = np.zeros((2, places.size, self.size))
        field = reading(self.intervals, self.order, places)
        for plane, columns in enumerate(columns_of(self.fields)[:2]):
            rows[plane][:, columns] = field @ self.fields[plane].basis[: field.shape[1]]
        return rows


def reduced_shaft(
    shaft: Shaft,
    disc: Disc,
    coupled: CoupledInertia | None,
    *,
    speed: float,
    damping_ratio: float,
    highest: float,
) -> ReducedShaft:
    """Assemble and reduce one shaft.

    Parameters
    ----------
    shaft, coupled : of the schema
    disc : the gear
    speed : of rotation, counter-clockwise in (x, y) positive [rad/s]
    damping_ratio : of every mode that deforms, teeth apart
    highest : modes with the gear held are kept up to this [rad/s]

    Raises
    ------
    NumericalError : see ``reduction.reduce_fields``
    """
    places = [shaft.gear_position, *(bearing.position for bearing in shaft.bearings)]
    if coupled is not None:
        places.append(coupled.position)
    intervals, stations = divided(shaft, places, highest)
    station = 0 if coupled is None else _nearest(stations, coupled.position)
    rigid = coupled is None or coupled.coupling_stiffness > (_RIGID * highest) ** 2 * coupled.inertia
    gear = _nearest(stations, shaft.gear_position)
    at = np.array([_nearest(stations, bearing.position) for bearing in shaft.bearings])
    springs = np.array([[b.loa_stiffness, b.oloa_stiffness] for b in shaft.bearings])
    dampers = np.array([[b.loa_damping, b.oloa_damping] for b in shaft.bearings])
    tilting = np.array([b.tilt_stiffness for b in shaft.bearings])

    def plane(which: int) -> Callable[[int], tuple[FloatArray, FloatArray, int]]:
        def matrices(order: int) -> tuple[FloatArray, FloatArray, int]:
            beam = bending(intervals, order)
            mass, stiffness, turn = beam.mass.copy(), beam.stiffness.copy(), beam.rotation
            mass[gear, gear] += disc.mass
            mass[turn + gear, turn + gear] += disc.tilting
            np.add.at(stiffness, (at, at), springs[:, which])
            np.add.at(stiffness, (turn + at, turn + at), tilting)
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

    fields, order, error = reduce_fields(
        (plane(0), plane(1), twisting), highest, (disc.mass, disc.mass, disc.inertia)
    )
    columns = columns_of(fields)
    size = 3 + sum(field.frequencies.size for field in fields)
    mass, stiffness, damping = np.zeros((3, size, size))
    for field, matrices, own in zip(fields, (plane(0), plane(1), twisting), columns, strict=True):
        full_mass, full_stiffness, _ = matrices(order)
        mass[np.ix_(own, own)] = field.basis.T @ full_mass @ field.basis
        stiffness[np.ix_(own, own)] = field.basis.T @ full_stiffness @ field.basis
    stiffness[2], stiffness[:, 2] = 0.0, 0.0  # the shaft turns freely: what is left there is rounding
    damping += modal_damping(mass, stiffness, damping_ratio)
    rows = np.zeros((at.size, 2, size))
    for which in range(2):
        rows[:, which, columns[which]] = fields[which].basis[at]
    damping += np.einsum("kd,kdi,kdj->ij", dampers, rows, rows)
    beam = bending(intervals, order)
    beam.spin[beam.rotation + gear, beam.rotation + gear] += disc.inertia
    spin = speed * fields[0].basis.T @ beam.spin @ fields[1].basis
    damping[np.ix_(columns[0], columns[1])] += spin
    damping[np.ix_(columns[1], columns[0])] -= spin.T
    torque = np.zeros(size)
    if coupled is None:
        torque[2] = 1.0
    else:
        at_inertia, at_station = fields[2].basis[station if rigid else -1], fields[2].basis[station]
        along = np.zeros(size)
        torque[columns[2]], along[columns[2]] = at_inertia, at_inertia - at_station
        damping += coupled.coupling_damping * np.outer(along, along)
    return ReducedShaft(
        intervals=intervals,
        fields=fields,
        order=order,
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
    """Pieces of a shaft between its steps and the given places [m], and their ends (n + 1,) [m].

    None is longer than some waves at the highest frequency [rad/s].
    """
    ends = np.cumsum([segment.length for segment in shaft.segments])
    found = np.sort(np.concatenate([[0.0], ends, np.minimum(places, ends[-1])]))
    stations = found[np.diff(found, prepend=-1.0) > _SAME]
    intervals: list[Interval] = []
    for start, stop in itertools.pairwise(stations):
        segment = shaft.segments[int(np.searchsorted(ends, 0.5 * (start + stop)))]
        material = shaft.youngs_modulus, shaft.poisson_ratio, shaft.density
        whole = Interval(float(stop - start), segment.diameter, segment.bore, *material)
        count = math.ceil(whole.length / (_WAVES * whole.wave_length(highest)))
        intervals += [replace(whole, length=whole.length / count)] * count
    return tuple(intervals), np.cumsum([0.0] + [part.length for part in intervals])


def columns_of(fields: Sequence[Reduced]) -> list[IntArray]:
    """Coordinates of a reduced shaft that belong to each of its fields: the kept one, then modal ones."""
    ends = 3 + np.cumsum([0] + [field.frequencies.size for field in fields])
    return [np.concatenate([[i], np.arange(ends[i], ends[i + 1])]) for i in range(len(fields))]


def modes_of(mass: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Natural frequencies [rad/s] and modes of unit modal mass, in columns; the first is the free turn."""
    squares, modes = eigh(stiffness, mass)
    squares[0] = 0.0
    return np.sqrt(squares), modes


def modal_damping(mass: FloatArray, stiffness: FloatArray, ratio: float) -> FloatArray:
    """Damping matrix that gives every mode but the free rotation the same damping ratio."""
    frequencies, modes = modes_of(mass, stiffness)
    moved = mass @ modes
    return np.asarray((moved * (2.0 * ratio * frequencies)) @ moved.T)


def _nearest(stations: FloatArray, place: float) -> int:
    return int(np.abs(stations - place).argmin())


def _attached(
    mass: FloatArray, stiffness: FloatArray, where: int, inertia: float, spring: float
) -> tuple[FloatArray, FloatArray]:
    """Matrices with an inertia behind a spring at a coordinate, as the last one."""
    mass, stiffness = np.pad(mass, (0, 1)), np.pad(stiffness, (0, 1))
    mass[-1, -1] = inertia
    ends = np.array([where, -1])
    stiffness[np.ix_(ends, ends)] += spring * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return mass, stiffness
