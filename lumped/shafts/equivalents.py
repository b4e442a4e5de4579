"""Natural frequencies of a pair on its shafts, and springs that replace the shafts at one frequency.

``condensed_bearings``: at its gear, a shaft has one dynamic stiffness D in each direction. A spring and a
mass replace the shaft. At the chosen frequency they have the same D and the same slope of D over the square
of the frequency: mass m = -dD/d(omega^2), stiffness k = D + omega^2 m. At zero this is static condensation.

Sources: R. J. Guyan, AIAA J. 3 (1965) 380 (static condensation); docs/theory/shafts.md.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import real_number
from lumped.errors import refuse
from lumped.labelling import labelled_dataset, provenance
from lumped.quasi_static.contacts import contact_of
from lumped.quasi_static.elements import mean_of_pairs
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.shafts.pair import ShaftedPair, shafted_pair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr

#: Frequencies are from zero to this [Hz].
_HIGHEST = 1e7
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
_TORSION = 4
_MESH = 5
_BEARINGS = 6
#: Share of the elastic energy above which a mode is named after the mesh; share of the kinetic energy above
#: which it is named after one shaft or plane.
_MUCH = 0.3
_MOST = 0.75


def condensed_bearings(pair: AnyPair, frequency: float = 0.0) -> GearPair:
    """Return the pair with bearings, masses and inertias that replace the shafts at one frequency.

    Parameters
    ----------
    pair : a gear pair with shafts
    frequency : at which centres and rims of the gears have the dynamic stiffness of their shafts [Hz]. At 0
        all inertia that turns with a gear is its own; at a mesh frequency far above the couplings, that of
        motor and load is not

    Returns
    -------
    GearPair without ``shafts``; a gear has one mass, that along the line of action, and off it a stiffness
    that gives the dynamic stiffness there. Dampers are those that take the same power at the frequency.

    Raises
    ------
    ParameterError : no shafts, a frequency out of range, or one between a natural frequency of a shaft and
        the node above it, where no positive spring and inertia resist as the shaft does
    """
    pair = load_gear_pair(pair)
    frequency = real_number("frequency", frequency, 0.0, _HIGHEST)
    shafted = shafted_pair(pair)
    omega = 2.0 * math.pi * frequency
    changes: dict[str, float | None] = {"shafts": None}
    for gear, name in enumerate(("pinion", "gear")):
        inertia = _inertia_at_rim(shafted, gear, omega)
        along, mass, damping = _dynamic_spring(shafted, 2 + gear, omega)
        across, across_mass, across_damping = _dynamic_spring(shafted, 4 + gear, omega)
        across += omega**2 * (mass - across_mass)
        values = {"along": along, "off": across, "inertia": inertia}
        wrong = [f"{key} {value:.3g}" for key, value in values.items() if not value > 0.0]
        if wrong:
            allowed = f"a frequency at which the {name}'s shaft resists like a spring and an inertia"
            action = f"There, {', '.join(wrong)}: choose another one, or take supports='shafts'."
            raise refuse("frequency", f"{frequency:g} Hz", allowed, action)
        changes |= {
            f"{name}.mass": mass,
            f"{name}.inertia": inertia,
            f"bearings.{name}.loa_stiffness": along,
            f"bearings.{name}.oloa_stiffness": across,
            f"bearings.{name}.loa_damping_ratio": min(damping / (2.0 * math.sqrt(along * mass)), 2.0),
            f"bearings.{name}.oloa_damping_ratio": min(
                across_damping / (2.0 * math.sqrt(across * mass)), 2.0
            ),
        }
    return pair.with_(changes)


def _dynamic_spring(shafted: ShaftedPair, row: int, omega: float) -> tuple[float, float, float]:
    """Stiffness [N/m], mass [kg], damping [N s/m] that replace a shaft at a gear's centre, teeth apart."""
    shape = shafted.gears[row]
    acting = np.flatnonzero(shape)
    shape = shape[acting]
    squares = shafted.frequencies[acting] ** 2
    receptance = float(np.sum(shape**2 / (squares - omega**2)))
    stiffness = 1.0 / receptance
    mass = stiffness**2 * float(np.sum((shape / (squares - omega**2)) ** 2))
    response = stiffness * shape / (squares - omega**2)
    damping = float(response @ shafted.damping[np.ix_(acting, acting)] @ response)
    return stiffness + omega**2 * mass, mass, damping


def _inertia_at_rim(shafted: ShaftedPair, gear: int, omega: float) -> float:
    """Inertia with the dynamic stiffness of twist at the rim of a gear, from all modes of twist [kg m^2]."""
    shape = shafted.gears[gear]
    squares = shafted.frequencies**2
    elastic = squares > 0.0
    rigid = float(np.sum(shape[~elastic] ** 2))
    if omega == 0.0:
        return 1.0 / rigid
    return 1.0 / (rigid - omega**2 * float(np.sum(shape[elastic] ** 2 / (squares[elastic] - omega**2))))


def shaft_modes(pair: AnyPair) -> xr.Dataset:
    """Natural frequencies of a pair on its shafts, in increasing order.

    The mesh has the mean stiffness and the mean damping of a mesh cycle, and no friction. Gyroscopic moments
    are taken at the operating speed.

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
    shafts = shafted_pair(pair)
    elements = contact_of(pair).elements(pair)
    g = pair.geometry
    k, c = (mean_of_pairs(law, g.base_pitch) for law in (elements.stiffness, elements.damping))
    # without the common rotation
    m = shafts.frequencies.size - 1
    squares = shafts.frequencies[1:] ** 2
    damping = (shafts.damping + g.omega_pinion * shafts.gyroscopic)[1:, 1:]
    u = shafts.deflection[1:]
    a = np.zeros((2 * m, 2 * m))
    a[:m, m:] = np.eye(m)
    a[m:, :m] = -np.diag(squares) - k * np.multiply.outer(u, u)
    a[m:, m:] = -damping - c * np.multiply.outer(u, u)
    values, vectors = np.linalg.eig(a)
    modes = np.flatnonzero(values.imag > 0.0)
    modes = modes[np.argsort(np.abs(values[modes]), kind="stable")]
    elastic, kinetic = _shares(shafts, k * np.abs(u @ vectors[:m, modes]) ** 2, vectors[:m, modes])
    names = [_name(*parts) for parts in zip(elastic, kinetic, strict=True)]
    order = ("mode", "part")
    return labelled_dataset(
        {
            "natural_frequency": ("mode", np.abs(values[modes]) / (2.0 * math.pi), "Hz", "natural frequency"),
            "damping_ratio": ("mode", -values[modes].real / np.abs(values[modes]), "1", "damping ratio"),
            "elastic_share": (order, elastic, "1", "share of the elastic energy"),
            "kinetic_share": (order, kinetic, "1", "share of the kinetic energy"),
        },
        {"mode": (np.arange(1, modes.size + 1), "1", "mode")},
        provenance(pair) | {"model": "lumped", "supports": "shafts"},
    ).assign_coords(part=list(PARTS), name=("mode", names))


def _name(elastic: FloatArray, kinetic: FloatArray) -> str:
    """Plain name of a mode from its shares of energy."""
    if elastic[_MESH] >= _MUCH:
        return "tooth mesh"
    if kinetic[_TORSION] > 0.5:
        return "torsion"
    bending = kinetic[:4].reshape(2, 2) / kinetic[:4].sum()
    shafts = bending.sum(axis=1)
    planes = bending.sum(axis=0)
    owner = ("pinion shaft", "gear shaft")[int(shafts.argmax())] if shafts.max() > _MOST else "both shafts"
    if planes.max() <= _MOST:
        return f"{owner} whirling"
    motion = "in bearings" if elastic[_BEARINGS] > 0.5 else "bending"
    return f"{owner} {motion} along {'xy'[int(planes.argmax())]}"


def _shares(shafted: ShaftedPair, in_mesh: FloatArray, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shares of elastic and of kinetic energy, (modes, parts), of shapes (m, modes)."""
    size = np.abs(shapes) ** 2
    bearings = np.einsum("bdm,mj->bdj", shafted.bearings[:, :, 1:], shapes)
    springs = shafted.bearing_stiffness[:, :, None] * np.abs(bearings) ** 2
    of_gear = np.array([name.startswith("gear") for name in shafted.bearing_names])
    elastic, kinetic = np.zeros((2, len(PARTS), shapes.shape[1]))
    owner = shafted.shaft[1:]
    kind = shafted.kind[1:]
    squares = shafted.frequencies[1:, None] ** 2
    for shaft in (0, 1):
        for plane in (0, 1):
            of_plane = (owner == shaft) & (kind == plane)
            part = 2 * shaft + plane
            kinetic[part] = size[of_plane].sum(axis=0)
            in_bearings = springs[of_gear == bool(shaft), plane].sum(axis=0)
            elastic[part] = np.maximum((squares[of_plane] * size[of_plane]).sum(axis=0) - in_bearings, 0.0)
    twist = kind == 2
    kinetic[_TORSION] = size[twist].sum(axis=0)
    elastic[_TORSION] = (squares[twist] * size[twist]).sum(axis=0)
    elastic[_MESH] = in_mesh
    elastic[_BEARINGS] = springs.sum(axis=(0, 1))
    return (elastic / elastic.sum(axis=0)).T, (kinetic / kinetic.sum(axis=0)).T
