"""Modes of a pair on its shafts with the mean mesh stiffness: frequencies, damping, where their energy is.

Sources: docs/theory/shafts.md.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from lumped.labelling import labelled_dataset
from lumped.model.periodic_system import LTVSystem, periodic_system
from lumped.model.results import provenance
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr

#: Parts of the machine that hold energy; the last two have no mass.
PARTS = (
    "pinion shaft bending x",
    "pinion shaft bending y",
    "gear shaft bending x",
    "gear shaft bending y",
    "torsion",
    "mesh",
    "bearings",
)
_MESH, _BEARINGS = 5, 6
#: From which share of the elastic energy a mode is the mesh's, and of the moving mass, of one shaft or plane.
_MUCH, _MOST = 0.3, 0.75


def shaft_modes(pair: AnyPair) -> xr.Dataset:
    """Natural frequencies of a pair on its shafts, by increasing frequency.

    The mesh has its mean stiffness and damping over the cycle and no friction; gyroscopic moments are those
    of the operating speed.

    Parameters
    ----------
    pair : a gear pair with shafts

    Returns
    -------
    xarray.Dataset over ``mode`` and ``part``: ``natural_frequency`` [Hz], ``damping_ratio``,
    ``elastic_share`` and ``kinetic_share`` of the mode's mean energies, and the coordinate ``name``, such as
    "pinion shaft bending along x". Overdamped motions are left out.

    Raises
    ------
    ParameterError : the pair has no shafts
    """
    pair = load_gear_pair(pair)
    system = periodic_system(pair, "elastic", supports="shafts")
    m, u = len(system.coordinates), system.deflection
    cycle = system.cycle
    share = (cycle.end - cycle.start) / pair.geometry.base_pitch
    by_mesh = np.zeros((2 * m, 2 * m))
    by_mesh[m:, :m] = cycle.mean_stiffness * np.multiply.outer(u, u)
    by_mesh[m:, m:] = cycle.elements.damping.mean() * share * np.multiply.outer(u, u)
    values, vectors = np.linalg.eig(system.constant - by_mesh)
    kept = np.flatnonzero(values.imag > 0.0)
    kept = kept[np.argsort(np.abs(values[kept]), kind="stable")]
    elastic, kinetic = _shares(system, vectors[:m, kept])
    names = [_name(*parts) for parts in zip(elastic, kinetic, strict=True)]
    order = ("mode", "part")
    return labelled_dataset(
        {
            "natural_frequency": ("mode", np.abs(values[kept]) / (2.0 * math.pi), "Hz", "natural frequency"),
            "damping_ratio": ("mode", -values[kept].real / np.abs(values[kept]), "1", "damping ratio"),
            "elastic_share": (order, elastic, "1", "share of the elastic energy"),
            "kinetic_share": (order, kinetic, "1", "share of the kinetic energy"),
        },
        {"mode": (np.arange(1, kept.size + 1), "1", "mode")},
        provenance(pair) | {"model": "lumped", "supports": "shafts"},
    ).assign_coords(part=list(PARTS), name=("mode", names))


def _name(elastic: FloatArray, kinetic: FloatArray) -> str:
    """Plain name of a mode from its shares of energy."""
    if elastic[_MESH] >= _MUCH:
        return "tooth mesh"
    if kinetic[4] > 0.5:
        return "torsion"
    bending = kinetic[:4].reshape(2, 2) / kinetic[:4].sum()
    shafts, planes = bending.sum(axis=1), bending.sum(axis=0)
    owner = ("pinion shaft", "gear shaft")[int(shafts.argmax())] if shafts.max() > _MOST else "both shafts"
    if planes.max() <= _MOST:
        return f"{owner} whirling"
    motion = "in bearings" if elastic[_BEARINGS] > 0.5 else "bending"
    return f"{owner} {motion} along {'xy'[int(planes.argmax())]}"


def _shares(system: LTVSystem, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shares of elastic and of kinetic energy, (modes, parts), of shapes (m, modes)."""
    shafted = system.shafts
    assert shafted is not None
    size = np.abs(shapes) ** 2
    bearings = np.einsum("bdm,mj->bdj", shafted.bearings[:, :, 1:], shapes)
    springs = shafted.bearing_stiffness[:, :, None] * np.abs(bearings) ** 2
    of_gear = np.array([name.startswith("gear") for name in shafted.bearing_names])
    elastic, kinetic = np.zeros((2, len(PARTS), shapes.shape[1]))
    owner, kind = shafted.shaft[1:], shafted.kind[1:]
    squares = shafted.frequencies[1:, None] ** 2
    for shaft in (0, 1):
        for plane in (0, 1):
            own, part = (owner == shaft) & (kind == plane), 2 * shaft + plane
            kinetic[part] = size[own].sum(axis=0)
            in_bearings = springs[of_gear == bool(shaft), plane].sum(axis=0)
            elastic[part] = np.maximum((squares[own] * size[own]).sum(axis=0) - in_bearings, 0.0)
    twist = kind == 2
    kinetic[4], elastic[4] = size[twist].sum(axis=0), (squares[twist] * size[twist]).sum(axis=0)
    elastic[_MESH] = system.cycle.mean_stiffness * np.abs(system.deflection @ shapes) ** 2
    elastic[_BEARINGS] = springs.sum(axis=(0, 1))
    return (elastic / elastic.sum(axis=0)).T, (kinetic / kinetic.sum(axis=0)).T
