"""A gear mesh of ROSS beside the same pair here: where its numbers agree and where they do not.

Sources: attributes of ``Mesh`` and ``GearElementTVMS`` of ROSS 2.3 (github.com/petrobras/ross); its stiffness
is the potential-energy method with a linear contact, as ``hertz = "linear"`` of docs/theory/mesh_physics.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import lumped
from lumped.errors import refuse
from lumped.labelling import labelled_dataset
from lumped.schema.pair import GearPair
from validation.exchange.new_pair_file import new_pair

if TYPE_CHECKING:
    import xarray as xr

#: Relative differences up to which numbers agree: of exact geometry, and of stiffness and what follows from
#: it, where variants of the method differ by some per cent.
_GEOMETRY, _STIFFNESS = 1e-6, 0.05


def compare_ross(mesh: Any, speed: float | str, torque: float | str) -> xr.Dataset:
    """Compare a mesh of two ``GearElementTVMS`` of ROSS with the same pair here.

    Parameters
    ----------
    mesh : ``ross.Mesh`` of two ``GearElementTVMS``, or anything with their attributes; spur gears
    speed : of the driving gear [rpm]
    torque : on the driving gear [N m]

    Returns
    -------
    xarray.Dataset over ``quantity``: ``ross`` and ``spurcheck`` in the unit ``units``, ``difference``, theirs
    over ours less 1, ``limit`` and ``agrees``. The transmission error is that of the lumped model with
    stiffness from ROSS and with ours. The attribute ``parameters`` is the pair as a parameter file.

    Raises
    ------
    ParameterError : no such mesh, helical gears, or a pair that cannot exist
    """
    pair = _pair(mesh, speed, torque)
    g, gears = pair.geometry, (mesh.driving_gear, mesh.driven_gear)
    # The last point of a mesh cycle is the first of the next one.
    theirs = np.asarray(mesh.stiffness_range, dtype=float)[:-1]
    phase = np.arange(theirs.size) / theirs.size
    ours = lumped.mesh_stiffness(pair)["mesh_stiffness"].to_numpy()
    with_theirs = pair.with_(stiffness={"phase": phase, "stiffness [N/m]": theirs})
    motions = [lumped.steady_state(one)["dte"].to_numpy() for one in (with_theirs, pair)]
    bodies = lumped.bodies(pair)
    rows: list[tuple[str, str, float, float, float]] = [
        ("base radius, driving gear", "m", gears[0].base_radius, g.base_radius_pinion, _GEOMETRY),
        ("base radius, driven gear", "m", gears[1].base_radius, g.base_radius_gear, _GEOMETRY),
        ("contact ratio", "1", mesh.contact_ratio, g.contact_ratio, _GEOMETRY),
        ("mass, driving gear", "kg", gears[0].m, bodies.mass_pinion, _STIFFNESS),
        ("moment of inertia, driving gear", "kg m^2", gears[0].Ip, bodies.inertia_pinion, _STIFFNESS),
        ("mesh stiffness, mean", "N/m", theirs.mean(), ours.mean(), _STIFFNESS),
        ("mesh stiffness, largest", "N/m", theirs.max(), ours.max(), _STIFFNESS),
        ("mesh stiffness, smallest", "N/m", theirs.min(), ours.min(), _STIFFNESS),
        ("transmission error, peak to peak", "m", *map(np.ptp, motions), _STIFFNESS),
    ]
    names, units, a, b, limits = zip(*rows, strict=True)
    difference = np.array(a, dtype=float) / np.array(b, dtype=float) - 1.0
    columns = {
        "ross": (np.array(a, dtype=float), "value of ROSS"),
        "spurcheck": (np.array(b, dtype=float), "value here"),
        "difference": (difference, "value of ROSS over that here, less 1"),
        "limit": (np.array(limits), "largest difference that agrees"),
        "agrees": (np.abs(difference) <= np.array(limits), "whether it agrees"),
    }
    result = labelled_dataset(
        {name: ("quantity", values, "1", words) for name, (values, words) in columns.items()},
        {"quantity": (list(names), "1", "quantity")},
        {"parameters": pair.to_toml()},
    )
    return result.assign_coords(units=("quantity", list(units)))


def _pair(mesh: Any, speed: float | str, torque: float | str) -> GearPair:
    """The pair of a mesh, with stiffness by the method of ROSS."""
    try:
        if mesh.helix_angle != 0.0:
            raise refuse("mesh", f"helix angle {mesh.helix_angle:g} rad", "spur gears", "Compare spur gears.")
        gears = {"pinion": mesh.driving_gear, "gear": mesh.driven_gear}
        first = mesh.driving_gear
        changes: dict[str, Any] = {
            "basic_rack.pressure_angle": f"{float(first.pr_angle)!r} rad",
            "basic_rack.addendum_coefficient": first.addendum_coeff,
            "basic_rack.dedendum_coefficient": first.addendum_coeff + first.tip_clearance_coeff,
            "basic_rack.fillet_radius_coefficient": first.tip_clearance_coeff
            / (1.0 - np.sin(first.pr_angle)),
            "mesh.stiffness": {"model": "energy", "hertz": "linear"},
            "mesh.contact": "prescribed",
            "mesh.relief": "ignored",
        }
        for name, one in gears.items():
            changes |= {
                f"{name}.face_width": f"{float(one.width)!r} m",
                f"{name}.bore": f"{float(one.bore_diameter)!r} m",
                f"{name}.youngs_modulus": f"{float(one.material.E)!r} Pa",
                f"{name}.poisson_ratio": float(one.material.Poisson),
                f"{name}.density": float(one.material.rho),
            }
        teeth = f"{first.n_teeth}/{mesh.driven_gear.n_teeth}"
        pair = new_pair(teeth, f"{float(first.module)!r} m", f"{float(first.width)!r} m", speed, torque)
    except AttributeError as error:
        needed = "ross.Mesh of two GearElementTVMS"
        raise refuse("mesh", f"{type(mesh).__name__}: {error}", needed, "Give such a mesh.") from None
    return pair.with_(changes)
