"""Both shafts of a pair with their gears as one system of numbers, teeth apart.

Sources: docs/theory/shafts.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eigvals, eigvalsh

from lumped.errors import refuse
from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, IntArray
from multibody.shafts.shaft import Disc, ReducedShaft, columns_of, reduced_shaft


@dataclass(frozen=True, eq=False)
class Train:
    """Two shafts; coordinates (x_p, y_p, phi_p, x_g, y_g, phi_g, modal of the pinion's, of the gear's shaft).

    Attributes
    ----------
    shafts : of pinion and gear
    ratio : angle of the pinion over that of the gear
    places : numbers of each shaft's coordinates among all
    damping_ratio : of the modes of each shaft, teeth apart
    highest : modes with the gears held are kept up to this [Hz]
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
            own[columns_of(shaft.fields)[2]] for shaft, own in zip(self.shafts, self.places, strict=True)
        )
        return pinion, gear

    @cached_property
    def mass(self) -> FloatArray:
        """(n, n)."""
        return self._joined("mass")

    @cached_property
    def stiffness(self) -> FloatArray:
        """(n, n) of shafts, bearings and couplings."""
        return self._joined("stiffness")

    @cached_property
    def damping(self) -> FloatArray:
        """(n, n) with gyroscopic terms."""
        return self._joined("damping")

    @cached_property
    def inverse(self) -> FloatArray:
        """Inverse of the mass matrix."""
        return np.asarray(cho_solve(cho_factor(self.mass), np.eye(self.size)))

    @cached_property
    def free_turn(self) -> FloatArray:
        """(n,) turn of both shafts at the ratio of the gears, which leaves the overlap as it is."""
        turn = np.zeros(self.size)
        turn[[2, 5]] = -self.ratio, 1.0
        return turn

    @cached_property
    def torques(self) -> FloatArray:
        """(2, n) generalised forces of counter-clockwise unit torques on motor and load, or on the gears."""
        found = np.zeros((2, self.size))
        for row, shaft, own in zip(found, self.shafts, self.places, strict=True):
            row[own] = shaft.torque
        return found

    @cached_property
    def bearings(self) -> FloatArray:
        """(k, 2, n) rows that read the displacements x, y in all bearings, those of the pinion first."""
        found = []
        for shaft, own in zip(self.shafts, self.places, strict=True):
            rows = np.zeros((len(shaft.bearings), 2, self.size))
            rows[:, :, own] = shaft.bearings
            found.append(rows)
        return np.concatenate(found)

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
        """Largest natural frequency, and largest rate of a root with all dampers [rad/s].

        Parameters
        ----------
        mesh_stiffness : (6, 6) between the gears [N/m] and so on
        """
        n, stiffness = self.size, self.stiffness.copy()
        stiffness[:6, :6] += mesh_stiffness
        state = np.zeros((2 * n, 2 * n))
        state[:n, n:] = np.eye(n)
        state[n:, :n], state[n:, n:] = -self.inverse @ stiffness, -self.inverse @ self.damping
        natural = float(np.sqrt(eigvalsh(stiffness, self.mass)[-1]))
        return natural, max(natural, float(np.abs(eigvals(state)).max()))

    def static(self, force: FloatArray, overlap: FloatArray, mesh_stiffness: float) -> FloatArray:
        """Deflection (n,) under a force (n,), with a spring along the row ``overlap`` (6,) between the gears.

        The train turns freely; its turn is the one at which the free turn has no part in the deflection.
        """
        n = self.size
        stiffness = self.stiffness.copy()
        stiffness[:6, :6] += mesh_stiffness * np.outer(overlap, overlap)
        held = self.mass @ self.free_turn
        bordered = np.block([[stiffness, held[:, None]], [held[None], np.zeros((1, 1))]])
        scale = np.append(np.sqrt(np.diag(self.mass)), 1.0 / np.linalg.norm(held))
        unit = float(np.abs(np.diag(stiffness) / scale[:n] ** 2).max())
        scaled = bordered / np.outer(scale, scale)
        scaled[:n, :n] /= unit
        found = np.linalg.solve(scaled, np.append(force / scale[:n] / unit, 0.0))
        return np.asarray(found[:n] / scale[:n])

    def _joined(self, name: str) -> FloatArray:
        matrix = np.zeros((self.size, self.size))
        for shaft, own in zip(self.shafts, self.places, strict=True):
            matrix[np.ix_(own, own)] = getattr(shaft, name)
        return matrix


def train(
    pair: GearPair,
    mass: FloatArray,
    inertia: FloatArray,
    speeds: tuple[float, float],
    enough: float,
) -> Train:
    """Both shafts of a pair.

    Parameters
    ----------
    pair : a validated gear pair with shafts
    mass, inertia : (2,) of pinion and gear, polar [kg], [kg m^2]
    speeds : of pinion and gear, both positive [rad/s]; the pinion turns clockwise
    enough : modes with the gears held are kept up to this where the pair does not say it [Hz]

    Raises
    ------
    ParameterError : the pair has no shafts
    NumericalError : see ``shaft.reduced_shaft``
    """
    if pair.shafts is None:
        raise refuse(
            "supports", "'shafts'", "'springs' for a pair without [shafts]", "Add [shafts] to the parameters."
        )
    given = pair.shafts.max_frequency
    highest = enough if given is None else given
    found = []
    sides = (
        (pair.pinion, pair.shafts.pinion, pair.shafts.motor, -speeds[0]),
        (pair.gear, pair.shafts.gear, pair.shafts.load, speeds[1]),
    )
    for i, (gear, shaft, coupled, speed) in enumerate(sides):
        found.append(
            reduced_shaft(
                shaft,
                disc(pair, gear, float(mass[i]), float(inertia[i])),
                coupled,
                speed=speed,
                damping_ratio=pair.shafts.damping_ratio,
                highest=2.0 * math.pi * highest,
            )
        )
    first = found[0].size - 3
    pinion = np.concatenate([np.arange(3), 6 + np.arange(first)])
    behind = np.concatenate([np.arange(3, 6), 6 + first + np.arange(found[1].size - 3)])
    return Train(
        (found[0], found[1]), speeds[0] / speeds[1], (pinion, behind), pair.shafts.damping_ratio, highest
    )


def disc(pair: GearPair, gear: Gear, mass: float, inertia: float) -> Disc:
    """A gear as a rigid disc whose rim is tied to the shaft by the twist of its bored body (Lame).

    Parameters
    ----------
    pair, gear : the pair and which of its gears
    mass, inertia : [kg], [kg m^2]
    """
    twist = math.inf
    if gear.bore > 0.0:
        rack = pair.basic_rack
        root = rack.module * (0.5 * gear.teeth + gear.profile_shift - rack.dedendum_coefficient)
        shear = gear.youngs_modulus / (2.0 * (1.0 + gear.poisson_ratio))
        twist = 4.0 * math.pi * shear * gear.face_width / ((2.0 / gear.bore) ** 2 - 1.0 / root**2)
    return Disc(mass, inertia, 0.5 * inertia + mass * gear.face_width**2 / 12.0, twist)
