"""Timoshenko beams of revolution by two-node elements whose stiffness is exact.

Coordinates of one plane are (w, psi) of each node in turn: deflection and slope of the section, which shear
lets lag behind w'; then those of shapes inside the elements. Between its nodes an element has the deflection
and slope of static bending by its ends, and beside them bubbles, polynomials of w and of psi that vanish at
the ends. No static bending works on a bubble, so the stiffness between nodes stays exact, while the mass of
translation and rotation and the gyroscopic matrix are consistent with all shapes. Static shapes alone err by
the square of the element wherever shear rules, which is where an element is shorter than the shaft is thick.
Twist is treated alike, with one angle a node.

Sources: J. S. Przemieniecki, Theory of Matrix Structural Analysis (1968), sec. 5.6 (stiffness), 11.5 (mass);
G. R. Cowper, J. Appl. Mech. 33 (1966) 335 (shear coefficient); docs/theory/shafts.md.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lumped.typing import FloatArray

_NODES, _WEIGHTS = 0.5 * np.array(np.polynomial.legendre.leggauss(4)) + np.array([[0.5], [0.0]])
#: Bubbles s (1 - s) and s (1 - s) (1 - 2 s) and their slopes over s at the Gauss nodes.
_BUBBLES = np.stack([_NODES * (1.0 - _NODES), _NODES * (1.0 - _NODES) * (1.0 - 2.0 * _NODES)])
_RATES = np.stack([1.0 - 2.0 * _NODES, 1.0 - 6.0 * _NODES + 6.0 * _NODES**2])


@dataclass(frozen=True)
class Piece:
    """A piece of a shaft of constant section, SI.

    Attributes
    ----------
    length, diameter, bore : [m]
    youngs_modulus : [Pa]
    poisson_ratio : [-]
    density : [kg/m^3]
    """

    length: float
    diameter: float
    bore: float
    youngs_modulus: float
    poisson_ratio: float
    density: float

    @property
    def area(self) -> float:
        """Of the section [m^2]."""
        return 0.25 * math.pi * (self.diameter**2 - self.bore**2)

    @property
    def second_moment(self) -> float:
        """Of the section about a diameter [m^4]; half the polar one."""
        return math.pi / 64.0 * (self.diameter**4 - self.bore**4)

    @property
    def shear_modulus(self) -> float:
        """G [Pa]."""
        return 0.5 * self.youngs_modulus / (1.0 + self.poisson_ratio)

    @property
    def _flexural(self) -> float:
        return self.youngs_modulus * self.second_moment

    @property
    def shear_rigidity(self) -> float:
        """Kappa G A [N], with Cowper's coefficient of a hollow circle."""
        nu = self.poisson_ratio
        ratio = self.bore / self.diameter
        square = (1.0 + ratio**2) ** 2
        kappa = 6.0 * (1.0 + nu) * square / ((7.0 + 6.0 * nu) * square + (20.0 + 12.0 * nu) * ratio**2)
        return kappa * self.shear_modulus * self.area

    def wave_number(self, omega: float) -> float:
        """Largest wave number of bending, shear and twist at an angular frequency [1/m]."""
        bending = math.sqrt(omega * math.sqrt(self.density * self.area / self._flexural))
        shear = omega * math.sqrt(self.density * self.area / self.shear_rigidity)
        return max(bending, shear)


@dataclass(frozen=True, eq=False)
class Beam:
    """Matrices of a free shaft.

    Attributes
    ----------
    stations : (n,) places of the nodes [m]
    mass, stiffness : of a plane, the first 2n coordinates those of the nodes
    spin : polar inertia on the slopes: times the speed of rotation, it couples the planes
    twist_mass, twist_stiffness : the first n coordinates those of the nodes
    """

    stations: FloatArray
    mass: FloatArray
    stiffness: FloatArray
    spin: FloatArray
    twist_mass: FloatArray
    twist_stiffness: FloatArray

    def node(self, place: float) -> int:
        """Number of the node nearest to a place [m]."""
        return int(np.argmin(np.abs(self.stations - place)))


def _bending(piece: Piece, length: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Stiffness, mass and spin of an element: (w, psi) of both ends, bubbles of w, bubbles of psi."""
    flexural = piece.youngs_modulus * piece.second_moment
    phi = 12.0 * flexural / (piece.shear_rigidity * length**2)
    ll = length**2
    stiffness = np.array(
        [
            [12.0, 6.0 * length, -12.0, 6.0 * length],
            [6.0 * length, (4.0 + phi) * ll, -6.0 * length, (2.0 - phi) * ll],
            [-12.0, -6.0 * length, 12.0, -6.0 * length],
            [6.0 * length, (2.0 - phi) * ll, -6.0 * length, (4.0 + phi) * ll],
        ]
    )
    s = _NODES
    none = np.zeros_like(_BUBBLES)
    share = 1.0 / (1.0 + phi)
    deflection = np.stack(
        [
            share * (1.0 - 3.0 * s**2 + 2.0 * s**3 + phi * (1.0 - s)),
            share * length * (s - 2.0 * s**2 + s**3 + 0.5 * phi * (s - s**2)),
            share * (3.0 * s**2 - 2.0 * s**3 + phi * s),
            share * length * (-(s**2) + s**3 - 0.5 * phi * (s - s**2)),
            *(length * _BUBBLES),
            *none,
        ]
    )
    slope = np.stack(
        [
            share * 6.0 / length * (s**2 - s),
            share * (1.0 - 4.0 * s + 3.0 * s**2 + phi * (1.0 - s)),
            share * 6.0 / length * (s - s**2),
            share * (-2.0 * s + 3.0 * s**2 + phi * s),
            *none,
            *_BUBBLES,
        ]
    )
    element_stiffness = np.zeros((deflection.shape[0],) * 2)
    element_stiffness[:4, :4] = flexural / (length**3 * (1.0 + phi)) * stiffness
    weight = _WEIGHTS * length
    curvature = np.vstack([none, _RATES]) / length
    shear = np.vstack([_RATES, -_BUBBLES])
    element_stiffness[4:, 4:] = flexural * (curvature * weight) @ curvature.T
    element_stiffness[4:, 4:] += piece.shear_rigidity * (shear * weight) @ shear.T
    weight = weight * piece.density
    rotation = piece.second_moment * (slope * weight) @ slope.T
    mass = piece.area * (deflection * weight) @ deflection.T + rotation
    return element_stiffness, mass, 2.0 * rotation


def _twist(piece: Piece, length: float) -> tuple[FloatArray, FloatArray]:
    """Stiffness and mass (2 + bubbles) of an element in twist."""
    polar = 2.0 * piece.second_moment
    shapes = np.vstack([1.0 - _NODES, _NODES, _BUBBLES])
    rates = np.vstack([-np.ones(_NODES.size), np.ones(_NODES.size), _RATES]) / length
    weight = _WEIGHTS * length
    stiffness = piece.shear_modulus * polar * (rates * weight) @ rates.T
    return stiffness, piece.density * polar * (shapes * weight) @ shapes.T


def beam(pieces: Sequence[Piece], places: Sequence[float], omega: float, angle: float) -> Beam:
    """Assemble a free shaft of pieces one after the other from z = 0 on, with nodes at ``places`` too [m].

    A wave of the highest frequency of interest, ``omega`` [rad/s], may turn by ``angle`` [rad] in an element.
    """
    ends = np.cumsum([0.0, *(piece.length for piece in pieces)])
    marks = np.union1d(ends, np.clip(places, 0.0, ends[-1]))
    # Places that differ by rounding are one.
    marks = marks[np.append(True, np.diff(marks) > 1e-9 * ends[-1])]
    stations = [marks[:1]]
    elements: list[tuple[tuple[FloatArray, ...], tuple[FloatArray, ...]]] = []
    for low, high in itertools.pairwise(marks):
        piece = pieces[min(int(np.searchsorted(ends, 0.5 * (low + high))) - 1, len(pieces) - 1)]
        count = max(1, math.ceil(piece.wave_number(omega) * (high - low) / angle))
        stations.append(np.linspace(low, high, count + 1)[1:])
        length = float(high - low) / count
        elements += [(_bending(piece, length), _twist(piece, length))] * count
    z = np.concatenate(stations)
    n = z.size
    inside = len(_BUBBLES)
    size = 2 * n + 2 * inside * (n - 1)
    twist_size = n + inside * (n - 1)
    stiffness, mass, spin = np.zeros((3, size, size))
    twist_stiffness, twist_mass = np.zeros((2, twist_size, twist_size))
    for j, ((k, m, g), twist) in enumerate(elements):
        bubbles = 2 * n + 2 * inside * j + np.arange(2 * inside)
        index = np.ix_(*[np.append(np.arange(2 * j, 2 * j + 4), bubbles)] * 2)
        stiffness[index] += k
        mass[index] += m
        spin[index] += g
        index = np.ix_(*[np.append([j, j + 1], n + inside * j + np.arange(inside))] * 2)
        twist_stiffness[index] += twist[0]
        twist_mass[index] += twist[1]
    return Beam(z, mass, stiffness, spin, twist_mass, twist_stiffness)
