"""One shaft with its gear, bearings and coupled inertia: modes in both planes and in twist, teeth apart.

Sources: R. R. Craig and M. C. C. Bampton, AIAA J. 6 (1968) 1313 (reduction); docs/theory/shafts.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import eigh

from lumped.errors import NumericalError
from lumped.schema.shafts import CoupledInertia, Shaft
from lumped.shafts.beam import Beam, Piece, beam
from lumped.typing import FloatArray

#: Largest phase angle of a wave of the highest frequency in an element of the first mesh [rad]; most halvings
#: of the elements; relative change of the frequencies by a halving that is accepted.
_ANGLE = 0.75
_HALVINGS = 4
_MESH_ERROR = 1e-5
#: Most nodes of a shaft: a second of work.
_MOST_NODES = 200


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of the reduced structure.

    Attributes
    ----------
    frequencies : (k,) natural, increasing [rad/s]
    shapes : (n, k) over the coordinates of the whole structure, of unit modal mass
    held : (k - 1,) natural frequencies with the boundary fixed [rad/s]
    """

    frequencies: FloatArray
    shapes: FloatArray
    held: FloatArray


def reduced_modes(
    mass: FloatArray, stiffness: FloatArray, boundary: int, highest: float, *, floating: bool = False
) -> Modes:
    """Modes of a structure that is reduced to a static shape and to modes with a fixed boundary.

    The static shape is that of a force on the boundary coordinate, so statics by such forces is exact.

    Parameters
    ----------
    mass, stiffness : (n, n)
    boundary : index of the boundary coordinate
    highest : modes with the boundary fixed are taken up to this frequency [rad/s]
    floating : whether nothing else supports the structure; its first mode is then rigid
    """
    n = mass.shape[0]
    inner = np.delete(np.arange(n), boundary)
    k = stiffness[np.ix_(inner, inner)]
    squares, vectors = eigh(k, mass[np.ix_(inner, inner)], subset_by_value=(0.0, highest**2))
    basis = np.zeros((n, 1 + squares.size))
    basis[boundary, 0] = 1.0
    basis[inner, 0] = -np.linalg.solve(k, stiffness[inner, boundary])
    basis[inner, 1:] = vectors
    reduced = basis.T @ mass @ basis, basis.T @ stiffness @ basis
    # The boundary and the modes with it held do not work on each other.
    reduced[1][0, 1:] = reduced[1][1:, 0] = 0.0
    if floating:
        reduced[1][0, 0] = 0.0
    eigenvalues, shapes = eigh(reduced[1], reduced[0])
    all_coordinates = basis @ shapes
    if floating:
        eigenvalues[0] = 0.0
    signs = np.where(all_coordinates[boundary] < 0.0, -1.0, 1.0)
    return Modes(np.sqrt(np.maximum(eigenvalues, 0.0)), all_coordinates * signs, np.sqrt(squares))


@dataclass(frozen=True)
class Disc:
    """A gear as a rigid disc on its shaft, SI.

    Attributes
    ----------
    mass : [kg]
    inertia, tilting : polar and diametral moment of inertia [kg m^2]
    twist_stiffness : of the gear's body between rim and bore [N m/rad]; infinite where it is rigid
    """

    mass: float
    inertia: float
    tilting: float
    twist_stiffness: float = math.inf


@dataclass(frozen=True, eq=False)
class SupportedShaft:
    """Modes of a shaft; gear coordinates are x, y and the rotation theta of its rim.

    Attributes
    ----------
    planes : modes in the planes of x and y, and of twist, the first of which is the rigid rotation
    gear : the row of the gear in the shapes of each
    spin : (kx, ky) polar inertia on the slopes of the modes, see ``Beam``
    bearings : rows of the bearings in the shapes of a plane
    driven : the row of the twist that takes the torque: the coupled inertia, or the gear
    coupling : damping of the coupling [N m s/rad] and (k,) its turn by each mode of twist
    """

    planes: tuple[Modes, Modes, Modes]
    gear: tuple[int, int, int]
    spin: FloatArray
    bearings: tuple[int, ...]
    driven: int
    coupling: tuple[float, FloatArray]


#: Cached, because variations of bearings, gear and coupled inertia share one beam.
_beam = lru_cache(maxsize=16)(beam)


@lru_cache(maxsize=64)
def supported_shaft(
    shaft: Shaft, disc: Disc, coupled: CoupledInertia | None, highest: float
) -> SupportedShaft:
    """Modes of a shaft in its bearings, on elements halved until its frequencies have settled.

    Modes with the gear's centre and rim fixed are kept up to ``highest`` [rad/s].
    """
    pieces = tuple(
        Piece(s.length, s.diameter, s.bore, shaft.youngs_modulus, shaft.poisson_ratio, shaft.density)
        for s in shaft.segments
    )
    places = [shaft.gear_position, *(b.position for b in shaft.bearings)]
    places += [] if coupled is None else [coupled.position]
    waves = sum(piece.wave_number(highest) * piece.length for piece in pieces)
    if waves / _ANGLE > _MOST_NODES:
        raise NumericalError(
            f"A shaft has {waves / (2.0 * np.pi):.3g} waves at {highest / (2.0 * np.pi):.3g} Hz, more than "
            f"{_MOST_NODES * _ANGLE / (2.0 * np.pi):.3g}: lower shafts.max_frequency."
        )
    coarser: SupportedShaft | None = None
    change = math.inf
    for halving in range(_HALVINGS + 1):
        mesh = _beam(pieces, tuple(places), highest, _ANGLE / 2**halving)
        finer = _on_mesh(mesh, shaft, disc, coupled, highest)
        if coarser is not None:
            change = _change(coarser, finer)
            if change < _MESH_ERROR:
                return finer
        coarser = finer
    raise NumericalError(
        f"Frequencies of a shaft change by {change:.1e} when its elements are halved: check its segments."
    )


def _change(coarse: SupportedShaft, fine: SupportedShaft) -> float:
    """Largest relative change of a frequency with the gear held."""
    largest = 0.0
    for before, after in zip(coarse.planes, fine.planes, strict=True):
        count = min(before.held.size, after.held.size)
        if count:
            largest = max(largest, float(np.abs(before.held[:count] / after.held[:count] - 1.0).max()))
    return largest


def _on_mesh(
    mesh: Beam, shaft: Shaft, disc: Disc, coupled: CoupledInertia | None, highest: float
) -> SupportedShaft:
    gear = mesh.node(shaft.gear_position)
    bearings = tuple(2 * mesh.node(b.position) for b in shaft.bearings)
    planes = []
    for direction in ("loa", "oloa"):
        mass = mesh.mass.copy()
        stiffness = mesh.stiffness.copy()
        mass[2 * gear, 2 * gear] += disc.mass
        mass[2 * gear + 1, 2 * gear + 1] += disc.tilting
        for row, bearing in zip(bearings, shaft.bearings, strict=True):
            stiffness[row, row] += getattr(bearing, f"{direction}_stiffness")
            stiffness[row + 1, row + 1] += bearing.tilt_stiffness
        planes.append(reduced_modes(mass, stiffness, 2 * gear, highest))
    spin = mesh.spin.copy()
    spin[2 * gear + 1, 2 * gear + 1] += disc.inertia
    mass, stiffness, rim, driven, coupling = _twist(mesh, gear, disc, coupled)
    twist = reduced_modes(mass, stiffness, rim, highest, floating=True)
    return SupportedShaft(
        planes=(planes[0], planes[1], twist),
        gear=(2 * gear, 2 * gear, rim),
        spin=planes[0].shapes.T @ spin @ planes[1].shapes,
        bearings=bearings,
        driven=driven,
        coupling=(0.0 if coupled is None else coupled.coupling_damping, coupling @ twist.shapes),
    )


def _twist(
    mesh: Beam, gear: int, disc: Disc, coupled: CoupledInertia | None
) -> tuple[FloatArray, FloatArray, int, int, FloatArray]:
    """Mass and stiffness of the twist, rows of the rim and of the driven inertia, turn of the coupling."""
    n = mesh.twist_mass.shape[0]
    elastic_body = math.isfinite(disc.twist_stiffness)
    rim = gear
    size = n + elastic_body + (coupled is not None)
    mass, stiffness = np.zeros((2, size, size))
    mass[:n, :n] = mesh.twist_mass
    stiffness[:n, :n] = mesh.twist_stiffness
    coupling = np.zeros(size)
    if elastic_body:
        rim = n
        _spring(stiffness, gear, rim, disc.twist_stiffness)
    mass[rim, rim] += disc.inertia
    driven = rim
    if coupled is not None:
        driven = size - 1
        node = mesh.node(coupled.position)
        mass[driven, driven] = coupled.inertia
        _spring(stiffness, node, driven, coupled.coupling_stiffness)
        coupling[[node, driven]] = 1.0, -1.0
    return mass, stiffness, rim, driven, coupling


def _spring(stiffness: FloatArray, first: int, second: int, value: float) -> None:
    both = [first, second]
    stiffness[np.ix_(both, both)] += value * np.array([[1.0, -1.0], [-1.0, 1.0]])
