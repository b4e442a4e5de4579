"""Beams of piecewise constant section by polynomials of any order: bending after Timoshenko, and torsion.

Deflection w and rotation of the section psi have shape functions of their own: the two linear ones that carry
the values at the ends of an interval, and integrals of Legendre polynomials, which vanish there. w has one
order more than psi, so that nothing locks. Accuracy is raised by the order, not by the mesh.

Sources: S. P. Timoshenko, Phil. Mag. 41 (1921) 744; shear coefficient G. R. Cowper, J. Appl. Mech. 33 (1966)
335, hollow circle; hierarchical functions B. Szabo and I. Babuska, Finite Element Analysis (1991), 3.1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh, solve

from lumped.errors import NumericalError
from lumped.typing import FloatArray, IntArray


@dataclass(frozen=True)
class Interval:
    """A piece of a shaft between two stations, SI."""

    length: float
    diameter: float
    bore: float
    youngs_modulus: float
    poisson_ratio: float
    density: float

    @property
    def area(self) -> float:
        """Area of the section [m^2]."""
        return math.pi / 4.0 * (self.diameter**2 - self.bore**2)

    @property
    def second_moment(self) -> float:
        """Second moment of the section about a diameter [m^4]; the polar one is twice that."""
        return math.pi / 64.0 * (self.diameter**4 - self.bore**4)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus [Pa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def shear_coefficient(self) -> float:
        """Mean shear over the shear at the axis, Cowper's for a hollow circle [-]."""
        nu = self.poisson_ratio
        square = (self.bore / self.diameter) ** 2
        both = (1.0 + square) ** 2
        return 6.0 * (1.0 + nu) * both / ((7.0 + 6.0 * nu) * both + (20.0 + 12.0 * nu) * square)

    def wave_length(self, frequency: float) -> float:
        """Length of bending waves at an angular frequency [rad/s], about: slender beam or pure shear [m]."""
        radius = math.sqrt(self.second_moment / self.area)
        slender = math.sqrt(frequency * radius * math.sqrt(self.youngs_modulus / self.density))
        shear = math.sqrt(self.shear_coefficient * self.shear_modulus / self.density)
        return 2.0 * math.pi * min(slender, shear) / frequency


@dataclass(frozen=True, eq=False)
class Bending:
    """Matrices of one plane of bending, coordinates (w at the stations, w inside, psi likewise).

    mass, stiffness : (n, n) with rotary inertia and shear
    spin : (n, n) integral of the polar moment of inertia over psi psi; times the speed, it couples the planes
    rotation : number of the first coordinate of psi; psi of station i is ``rotation + i``
    """

    mass: FloatArray
    stiffness: FloatArray
    spin: FloatArray
    rotation: int


def shape_functions(order: int, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values and slopes of the functions of one interval at places in [-1, 1], each (order + 1, n).

    The first two are the linear functions of the left and the right end.
    """
    values = np.empty((order + 1, places.size))
    slopes = np.empty((order + 1, places.size))
    values[0] = 0.5 * (1.0 - places)
    values[1] = 0.5 * (1.0 + places)
    slopes[0] = -0.5
    slopes[1] = 0.5
    polynomials = legendre.legvander(places, order).T
    for k in range(2, order + 1):
        values[k] = (polynomials[k] - polynomials[k - 2]) / math.sqrt(4.0 * k - 2.0)
        slopes[k] = math.sqrt(k - 0.5) * polynomials[k - 1]
    return values, slopes


def places_of(order: int, interval: int, count: int) -> IntArray:
    """Numbers of the coordinates of one field on an interval: first both ends, then the inner ones."""
    inside = count + 1 + interval * (order - 1) + np.arange(order - 1)
    return np.concatenate([[interval, interval + 1], inside])


def field_size(order: int, count: int) -> int:
    """Number of coordinates of one field over so many intervals."""
    return count + 1 + count * (order - 1)


def bending(intervals: Sequence[Interval], order: int) -> Bending:
    """Assemble one plane of bending, with polynomials of an order of at least 2 for w; psi has one less."""
    count = len(intervals)
    rotation = field_size(order, count)
    size = rotation + field_size(order - 1, count)
    mass, stiffness, spin = np.zeros((3, size, size))
    nodes, weights = legendre.leggauss(order + 1)
    w, w_slope = shape_functions(order, nodes)
    psi, psi_slope = shape_functions(order - 1, nodes)
    for i, part in enumerate(intervals):
        at_w = places_of(order, i, count)
        at_psi = rotation + places_of(order - 1, i, count)
        both = np.ix_(np.concatenate([at_w, at_psi]), np.concatenate([at_w, at_psi]))
        measure = 0.5 * part.length * weights
        shear = np.vstack([2.0 / part.length * w_slope, -psi])
        bend = np.vstack([np.zeros_like(w), 2.0 / part.length * psi_slope])
        turn = np.vstack([np.zeros_like(w), psi])
        move = np.vstack([w, np.zeros_like(psi)])
        rigidity = part.shear_coefficient * part.shear_modulus * part.area
        stiffness[both] += rigidity * (shear * measure) @ shear.T
        stiffness[both] += part.youngs_modulus * part.second_moment * (bend * measure) @ bend.T
        turning = part.density * part.second_moment * (turn * measure) @ turn.T
        mass[both] += part.density * part.area * (move * measure) @ move.T + turning
        spin[both] += 2.0 * turning
    return Bending(mass, stiffness, spin, rotation)


def torsion(intervals: Sequence[Interval], order: int) -> tuple[FloatArray, FloatArray]:
    """Mass [kg m^2] and stiffness [N m/rad] of twist, arguments as ``bending``; stations come first."""
    count = len(intervals)
    size = field_size(order, count)
    mass, stiffness = np.zeros((2, size, size))
    nodes, weights = legendre.leggauss(order + 1)
    twist, slope = shape_functions(order, nodes)
    for i, part in enumerate(intervals):
        coordinates = places_of(order, i, count)
        both = np.ix_(coordinates, coordinates)
        polar = 2.0 * part.second_moment
        mass[both] += part.density * polar * 0.5 * part.length * (twist * weights) @ twist.T
        stiffness[both] += part.shear_modulus * polar * 2.0 / part.length * (slope * weights) @ slope.T
    return mass, stiffness


#: Largest change of a frequency from one order to the next but one, over the highest frequency.
FREQUENCY_ERROR = 1e-6
#: Orders that are tried. Beyond the last, a shaft is too long beside the waves of its highest mode.
_FIRST_ORDER = 4
_LAST_ORDER = 24


@dataclass(frozen=True, eq=False)
class Reduced:
    """One field of a shaft on few coordinates: the physical coordinate of the gear, and modal coordinates.

    basis : (n, 1 + m) coordinates of the field from the physical coordinate and m modal coordinates
    frequencies : (m,) frequencies of the modes with the physical coordinate fixed [rad/s]
    """

    basis: FloatArray
    frequencies: FloatArray


#: Order -> mass, stiffness and the number of the physical coordinate that is retained.
Matrices = Callable[[int], tuple[FloatArray, FloatArray, int]]


def reduce_fields(
    fields: Sequence[Matrices], highest: float, modal_masses: Sequence[float]
) -> tuple[tuple[Reduced, ...], int, float]:
    """Raise the order of all fields of a shaft until the modes up to ``highest`` [rad/s] no longer change.

    modal_masses : give the modal coordinates of each field the size of the physical coordinate

    Returns
    -------
    The reduced fields, the order of the polynomials, and the largest change of a frequency by the last
    increase of the order, over the highest frequency.
    """
    before = [_clamped(matrices(_FIRST_ORDER), highest)[0] for matrices in fields]
    for order in range(_FIRST_ORDER + 2, _LAST_ORDER + 1, 2):
        numbers = [matrices(order) for matrices in fields]
        modes_of_fields = [_clamped(one, highest) for one in numbers]
        change = [
            float(np.abs(old - new).max(initial=0.0)) / highest if old.size == new.size else np.inf
            for old, (new, _) in zip(before, modes_of_fields, strict=True)
        ]
        if max(change) < FREQUENCY_ERROR:
            reduced = (
                _reduced(one, frequencies, modes * math.sqrt(size))
                for one, (frequencies, modes), size in zip(
                    numbers, modes_of_fields, modal_masses, strict=True
                )
            )
            return tuple(reduced), order, max(change)
        before = [frequencies for frequencies, _ in modes_of_fields]
    raise NumericalError(
        f"The modes of a shaft up to {highest / (2.0 * np.pi):.4g} Hz do not stand at order {_LAST_ORDER}: "
        "it is very long or thin. Shorten it, or make it thicker."
    )


def _clamped(numbers: tuple[FloatArray, FloatArray, int], highest: float) -> tuple[FloatArray, FloatArray]:
    """Frequencies up to the highest, and modes (n - 1, m), with the physical coordinate fixed."""
    mass, stiffness, physical = numbers
    inside = np.delete(np.arange(mass.shape[0]), physical)
    both = np.ix_(inside, inside)
    # In the inverse problem the wanted modes have the largest eigenvalues. The smallest intervals, in which
    # vibration would be fastest, then bring rounding into the other modes alone.
    inverse, modes = eigh(mass[both], stiffness[both], subset_by_value=(highest**-2, np.inf))
    frequencies = 1.0 / np.sqrt(inverse[::-1])
    return frequencies, modes[:, ::-1] * frequencies


def _reduced(
    numbers: tuple[FloatArray, FloatArray, int], frequencies: FloatArray, modes: FloatArray
) -> Reduced:
    """Add the static deflection under a unit displacement of the physical coordinate to the modes."""
    _, stiffness, physical = numbers
    inside = np.delete(np.arange(stiffness.shape[0]), physical)
    basis = np.zeros((stiffness.shape[0], 1 + frequencies.size))
    basis[physical, 0] = 1.0
    basis[inside, 0] = -solve(stiffness[np.ix_(inside, inside)], stiffness[inside, physical], assume_a="pos")
    basis[inside, 1:] = modes
    return Reduced(basis, frequencies)
