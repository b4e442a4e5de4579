"""Labelled results: one table of variables with units, shared by the lumped and the multibody model."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Mapping
from functools import cache
from importlib import metadata
from typing import TYPE_CHECKING, Any

import numpy as np

from lumped.labelling import Variable, labelled_dataset
from lumped.model.equations import COORDINATES
from lumped.model.periodic_system import LTVSystem
from lumped.model.shafted import ShaftedPair
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray

if TYPE_CHECKING:
    import xarray as xr

#: Variable -> (dimensions, unit, plain name). Every model of the pair returns these.
VARIABLES: dict[str, tuple[tuple[str, ...], str, str]] = {
    "theta_p": (("time",), "rad", "pinion rotation, deviation from nominal"),
    "theta_g": (("time",), "rad", "gear rotation, deviation from nominal"),
    "x_p": (("time",), "m", "pinion displacement along the line of action"),
    "x_g": (("time",), "m", "gear displacement along the line of action"),
    "y_p": (("time",), "m", "pinion displacement off the line of action"),
    "y_g": (("time",), "m", "gear displacement off the line of action"),
    "theta_p_dot": (("time",), "rad/s", "pinion speed, deviation from nominal"),
    "theta_g_dot": (("time",), "rad/s", "gear speed, deviation from nominal"),
    "x_p_dot": (("time",), "m/s", "pinion velocity along the line of action"),
    "x_g_dot": (("time",), "m/s", "gear velocity along the line of action"),
    "y_p_dot": (("time",), "m/s", "pinion velocity off the line of action"),
    "y_g_dot": (("time",), "m/s", "gear velocity off the line of action"),
    "dte": (("time",), "m", "dynamic transmission error"),
    "dte_dot": (("time",), "m/s", "rate of the dynamic transmission error"),
    "mesh_stiffness": (("time",), "N/m", "mesh stiffness of all tooth pairs"),
    "position": (("pair", "time"), "m", "contact position from the pinion's tangent point"),
    "contact": (("pair", "time"), "1", "whether the tooth pair is in contact"),
    "mu": (("pair", "time"), "1", "friction coefficient, signed"),
    "normal_load": (("pair", "time"), "N", "normal load"),
    "friction_force": (("pair", "time"), "N", "friction force on the pinion, off the line of action"),
    "sliding_velocity": (("pair", "time"), "m/s", "sliding velocity, vibration included"),
    "friction_power": (("pair", "time"), "W", "friction power, vibration included"),
    "friction_power_nominal": (("pair", "time"), "W", "friction power at the nominal sliding velocity"),
    "bearing_force_x_p": (("time",), "N", "pinion bearing force on the pinion, along the line of action"),
    "bearing_force_x_g": (("time",), "N", "gear bearing force on the gear, along the line of action"),
    "bearing_force_y_p": (("time",), "N", "pinion bearing force on the pinion, off the line of action"),
    "bearing_force_y_g": (("time",), "N", "gear bearing force on the gear, off the line of action"),
}


def provenance(pair: GearPair, **settings: Any) -> dict[str, Any]:
    """Attributes that say what a result was made from: parameters, hash, versions, settings."""
    text = pair.to_toml()
    return {
        "gear_pair": pair.name,
        "parameters": text,
        "parameters_sha256": _sha256(text),
        "versions": _versions(),
        "settings": ", ".join(f"{key}={value}" for key, value in sorted(settings.items())),
    }


@cache
def _versions() -> str:
    names = ("spurcheck", "numpy", "scipy", "exudyn")
    versions = [f"{name} {metadata.version(name)}" for name in names]
    return ", ".join([f"python {platform.python_version()}", *versions])


def parameters_hash(pair: GearPair) -> str:
    """SHA-256 of the pair's TOML text: the same parameters give the same hash everywhere."""
    return _sha256(pair.to_toml())


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def labelled(
    time: FloatArray,
    values: Mapping[str, FloatArray],
    attributes: Mapping[str, Any],
    further: Mapping[str, Variable] | None = None,
) -> xr.Dataset:
    """Put arrays under their names, units and dimensions.

    Parameters
    ----------
    time : (k,) [s]
    values : variable name -> array of the dimensions in ``VARIABLES``; pair 0 is the one ahead
    attributes : of the dataset
    further : variables that only this result has
    """
    variables: dict[str, Variable] = {
        name: (dims, values[name], unit, text)
        for name, (dims, unit, text) in VARIABLES.items()
        if name in values
    }
    pairs = next((v.shape[0] for n, v in values.items() if VARIABLES[n][0][0] == "pair"), 0)
    coordinates = {"time": (time, "s", "time"), "pair": (np.arange(pairs), "1", "tooth pair, 0 is ahead")}
    return labelled_dataset(variables | dict(further or {}), coordinates, attributes)


def dataset(
    system: LTVSystem, time: FloatArray, states: FloatArray, attributes: Mapping[str, Any]
) -> xr.Dataset:
    """Return states of the "full" system with all loads and velocities that follow from them.

    Parameters
    ----------
    system : the "full" system of a gear pair
    time : (k,) [s]
    states : (k, n)
    attributes : of the dataset
    """
    found = labelled(time, response(system, time, states), dict(attributes) | {"supports": system.supports})
    if system.shafts is None:
        return found
    return with_bearings(found, bearing_forces(system.shafts, states), system.shafts.bearing_names)


def with_bearings(run: xr.Dataset, forces: FloatArray, names: tuple[str, ...]) -> xr.Dataset:
    """The result of a pair on shafts with the force of every bearing on its shaft.

    Parameters
    ----------
    run : over ``time``
    forces : (bearings, 2, k) along x and y [N]
    names : of the bearings
    """
    variable = ("bearing", "direction", "time"), forces, {"units": "N", "long_name": "force on the shaft"}
    return run.assign(bearing_force=variable).assign_coords(bearing=list(names), direction=["loa", "oloa"])


def bearing_forces(shafts: ShaftedPair, states: FloatArray) -> FloatArray:
    """Forces of the bearings on their shafts, (bearings, 2, k) [N], of states (k, 2m)."""
    m = len(shafts.names)
    spring = np.einsum("bd,bdm,km->bdk", shafts.bearing_stiffness, shafts.bearings, states[:, :m])
    dashpot = np.einsum("bd,bdm,km->bdk", shafts.bearing_dampers, shafts.bearings, states[:, m:])
    return np.asarray(-(spring + dashpot), dtype=np.float64)


def _sums_of_bearings(shafts: ShaftedPair, forces: FloatArray) -> FloatArray:
    """Sum over the bearings of each shaft, (k, 6) in the order of the coordinates."""
    found = np.zeros((forces.shape[2], len(COORDINATES)))
    for which, name in enumerate(("pinion", "gear")):
        own = [bearing.startswith(name) for bearing in shafts.bearing_names]
        found[:, [2 + which, 4 + which]] = forces[own].sum(axis=0).T
    return found


def load_range(contact_form: str, load: FloatArray, contact: FloatArray) -> tuple[float, float]:
    """Largest load of a tooth pair, and smallest load: negative where the teeth would separate [N].

    With prescribed contact every pair in contact must press. With loaded contact, where pairs begin and end
    their contact gradually, all pairs together must.

    Parameters
    ----------
    contact_form : ``mesh.contact`` of the pair
    load, contact : (pairs, k) normal load [N], and whether the pair can touch
    """
    touching = load[contact > 0]
    least = load.sum(axis=0) if contact_form == "loaded" else touching
    return float(touching.max()), float(least.min())


def farthest_reversal(distance: FloatArray, sliding: FloatArray, loaded: BoolArray) -> float:
    """Largest distance from the pitch point at which a loaded pair slides backwards [m]; 0 if none does.

    Between two samples of which one slides backwards the velocity is a straight line.

    Parameters
    ----------
    distance : (pairs, k) from the pitch point, signed [m]
    sliding : (pairs, k) sliding velocity [m/s], nominally of the sign of ``distance``
    loaded : (pairs, k) whether the pair carries load
    """
    forwards = sliding * np.sign(distance)
    farthest = float(np.where(loaded & (forwards < 0.0), np.abs(distance), 0.0).max())
    before, after = np.s_[:, :-1], np.s_[:, 1:]
    turns = (forwards[before] * forwards[after] < 0.0) & (distance[before] * distance[after] > 0.0)
    turns &= loaded[before] & loaded[after]
    v0, v1 = forwards[before][turns], forwards[after][turns]
    d0, d1 = distance[before][turns], distance[after][turns]
    return float(np.abs(d0 + v0 / (v0 - v1) * (d1 - d0)).max(initial=farthest))


def response(
    system: LTVSystem, time: FloatArray, states: FloatArray, normal_load: FloatArray | None = None
) -> dict[str, FloatArray]:
    """Return the arrays of ``dataset`` by name, without labels; arguments as there.

    ``normal_load`` (pairs, k) [N] replaces what the linear model's teeth carry, where they may part.
    """
    g, s = system.pair.geometry, system.structure
    z, rates = system.gear_motion(states)
    dte, dte_dot = z @ s.deflection, rates @ s.deflection
    pairs = system.cycle.sample(time)
    normal = normal_load
    if normal is None:
        normal = pairs.stiffness * (dte - pairs.error) + pairs.damping * (dte_dot - pairs.error_rate)
    friction = pairs.friction * normal
    arm_g = g.L_XY - pairs.position
    sliding = (
        (g.omega_pinion + rates[:, 0]) * pairs.position
        - (g.omega_gear + rates[:, 1]) * arm_g
        - (rates[:, 4] - rates[:, 5])
    )
    if system.shafts is None:
        bearing = -(s.stiffness * z + s.damping * rates)
    else:
        bearing = _sums_of_bearings(system.shafts, bearing_forces(system.shafts, states))
    values: dict[str, FloatArray] = {name: z[:, j] for j, name in enumerate(COORDINATES)}
    values |= {f"{name}_dot": rates[:, j] for j, name in enumerate(COORDINATES)}
    values |= {f"bearing_force_{name}": bearing[:, j] for j, name in enumerate(COORDINATES) if j > 1}
    values |= {
        "dte": dte,
        "dte_dot": dte_dot,
        "mesh_stiffness": pairs.stiffness.sum(0),
        "position": pairs.position,
        "contact": pairs.contact.astype(np.float64),
        "mu": pairs.friction,
        "normal_load": normal,
        "friction_force": friction,
        "sliding_velocity": np.where(pairs.contact, sliding, 0.0),
        "friction_power": np.where(pairs.contact, -friction * sliding, 0.0),
        "friction_power_nominal": -friction * (g.omega_pinion * pairs.position - g.omega_gear * arm_g),
    }
    return values
