"""Mesh efficiency and sliding power: without vibration, of a dynamic solution, and of all laws side by side.

Sources: docs/theory/mesh_physics.md, "Losses"; docs/theory/equations.md, "Periodic motion and the brake
torque"; ISO/TR 14179-2:2001.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lumped.errors import ParameterError, refuse
from lumped.friction.iso_14179 import coefficient_of
from lumped.friction.registry import laws_with_friction
from lumped.gear_geometry.geometry import Geometry
from lumped.labelling import labelled_dataset, provenance
from lumped.losses.loss_factor import (
    CyclePositions,
    Sharing,
    Springs,
    loss_factor,
    mean_loss_factor,
    quadrature,
    samples,
    sliding_velocity,
    springs,
)
from lumped.model.powers import balance
from lumped.model.results import labelled
from lumped.model.steady import periodic_cycle, sample_times
from lumped.path_function import PathFunction
from lumped.path_of_contact import contact_path, friction_path_function
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class _Loads:
    """Loads at the instants of a cycle, (pairs, k) or (k,)."""

    share: FloatArray
    normal: FloatArray
    mu: FloatArray
    friction: FloatArray
    sliding: FloatArray
    power: FloatArray  # friction power of each pair, <= 0
    brake: FloatArray


def quasi_static_losses(
    pair: AnyPair,
    law: str | None = None,
    sharing: Sharing = "elements",
    *,
    samples_per_cycle: int = 512,
) -> xr.Dataset:
    """Loads, friction power and mesh efficiency over one mesh cycle in slow motion, without vibration.

    At every instant T_p = SUM (r_bp + X_pi mu_i) N_i fixes the mesh load. Its shares are those of springs
    under the frictionless load T_p/r_bp, and T_g = SUM (r_bg + X_gi mu_i) N_i. The efficiency
    T_g Omega_g/(T_p Omega_p) equals 1 - SUM F_i v_s,i over the input power, because the normal loads do no
    work at constant speed ratio.

    Parameters
    ----------
    pair : the gear pair
    law : name of a friction law; default ``pair.friction.law``
    sharing : how pairs share the load, see ``Sharing``; by default with the stiffness and
        tooth error of the dynamic model
    samples_per_cycle : output times in [0, T_m)

    Returns
    -------
    xarray.Dataset with the names, units and grid of ``lumped.steady_state``: position, contact, mu,
    normal_load, friction_force, sliding_velocity, friction_power over (pair, time), and load_share,
    brake_torque, instantaneous_efficiency. Attributes ``mesh_efficiency``, ``power_loss`` [W],
    ``input_power`` [W], ``loss_factor`` H_v and ``mean_coefficient`` = loss/(H_v input power) come from an
    exact quadrature between the switches, not from the samples.
    """
    pair = load_gear_pair(pair)
    g = pair.geometry
    time = sample_times(g.mesh_period, samples_per_cycle)
    mu = friction_path_function(pair, law)
    teeth = springs(pair, sharing)
    torque = pair.operating.pinion_torque
    power_in = torque * g.omega_pinion
    nodes = quadrature(g, [mu, *teeth.functions])
    exact = _loads(g, torque, mu, teeth, nodes)
    loss = -nodes.mean(exact.power.sum(axis=0))
    factor = mean_loss_factor(g, nodes, exact.share)
    at = samples(g, samples_per_cycle)
    loads = _loads(g, torque, mu, teeth, at)
    touching = at.contact
    efficiency = 1.0 + loads.power.sum(axis=0) / power_in
    return labelled(
        time,
        {
            "position": at.position,
            "contact": touching.astype(np.float64),
            "mu": loads.mu,
            "normal_load": loads.normal,
            "friction_force": loads.friction,
            "sliding_velocity": np.where(touching, loads.sliding, 0.0),
            "friction_power": loads.power,
        },
        provenance(pair, samples_per_cycle=samples_per_cycle)
        | {
            "model": "quasi-static",
            "law": pair.friction.law if law is None else law,
            "mesh_efficiency": 1.0 - loss / power_in,
            "power_loss": loss,
            "input_power": power_in,
            "loss_factor": factor,
            "mean_coefficient": loss / (factor * power_in),
        },
        {
            "load_share": (("pair", "time"), loads.share, "1", "share of the load"),
            "brake_torque": ("time", loads.brake, "N*m", "torque on the gear"),
            "instantaneous_efficiency": ("time", efficiency, "1", "instantaneous mesh efficiency"),
        },
    )


def _loads(g: Geometry, torque: float, mu: PathFunction, teeth: Springs, at: CyclePositions) -> _Loads:
    share = teeth.share(at)
    coefficient = np.where(at.contact, mu(at.position), 0.0)
    arm = g.base_radius_pinion + at.position * coefficient
    normal = torque / (share * arm).sum(axis=0) * share
    friction = coefficient * normal
    sliding = sliding_velocity(g, at.position)
    brake = (g.base_radius_gear * normal + (g.L_XY - at.position) * friction).sum(axis=0)
    return _Loads(share, normal, coefficient, friction, sliding, -friction * sliding, brake)


def dynamic_losses(pair: AnyPair, solution: xr.Dataset) -> xr.Dataset:
    """Sliding loss and efficiency over time of a lumped or multibody solution.

    The loss is -SUM F_i v_s,i with the nominal sliding velocity: by the mean moment balance of both gears it
    is, over whole mesh cycles, exactly the input power less the power at the brake. Power at the vibrating
    velocity differs by what friction exchanges with the vibration.

    Parameters
    ----------
    pair : the gear pair of the solution
    solution : dataset of ``lumped.simulate``, ``lumped.steady_state`` or the multibody model

    Returns
    -------
    xarray.Dataset over ``time``: sliding_loss [W], instantaneous_efficiency = 1 - loss/(T_p Omega_p) [-];
    attributes ``input_power`` [W], ``power_loss`` [W] (mean of the samples) and ``mesh_efficiency`` (the
    solution's own from its balanced brake torque where it has one, else from the mean of the samples)

    Raises
    ------
    ParameterError : the dataset has no friction power
    """
    pair = load_gear_pair(pair)
    if "friction_power_nominal" not in solution:
        raise refuse(
            "solution",
            ", ".join(map(str, solution.data_vars)) or "no variables",
            "a dataset with friction_power_nominal",
            "Pass the result of simulate or steady_state.",
        )
    torque = float(solution.attrs.get("pinion_torque", pair.operating.pinion_torque))
    power_in = torque * pair.geometry.omega_pinion
    loss = -solution["friction_power_nominal"].sum("pair").to_numpy()
    mean = float(loss.mean())
    kept = {key: solution.attrs[key] for key in ("gear_pair", "parameters_sha256") if key in solution.attrs}
    return labelled_dataset(
        {
            "sliding_loss": ("time", loss, "W", "sliding loss of the mesh"),
            "instantaneous_efficiency": ("time", 1.0 - loss / power_in, "1", "instantaneous mesh efficiency"),
        },
        {"time": (solution["time"].to_numpy(), "s", "time")},
        kept
        | {
            "input_power": power_in,
            "power_loss": mean,
            "mesh_efficiency": float(solution.attrs.get("mesh_efficiency", 1.0 - mean / power_in)),
        },
    )


def losses_of_laws(pair: AnyPair, *, dynamic: bool = True) -> xr.Dataset:
    """Mesh efficiency of every law with friction at the operating point.

    Parameters
    ----------
    pair : the gear pair
    dynamic : whether to add the efficiency of the periodic motion

    Returns
    -------
    xarray.Dataset over ``law``: mesh_efficiency, power_loss [W], mean_coefficient (quasi-static), and
    mesh_efficiency_dynamic; attribute ``left_out``, laws that the pair does not allow and why
    """
    pair = load_gear_pair(pair)
    rows: dict[str, dict[str, float]] = {}
    left_out: list[str] = []
    laws = laws_with_friction(pair.friction)
    for name in laws:
        try:
            static = quasi_static_losses(pair, name, samples_per_cycle=8).attrs
            rows[name] = {key: static[key] for key in ("mesh_efficiency", "power_loss", "mean_coefficient")}
            if dynamic:
                run = periodic_cycle(pair.with_(friction__law=name), 8)
                rows[name]["mesh_efficiency_dynamic"] = balance(run)["mesh_efficiency"]
        except ParameterError as error:
            left_out.append(f"{laws[name].title}: {error}")
    units = {"power_loss": "W"}
    texts = {
        "mesh_efficiency": "mesh efficiency, quasi-static",
        "mesh_efficiency_dynamic": "mesh efficiency of the periodic motion",
        "power_loss": "mean sliding loss, quasi-static",
        "mean_coefficient": "loss over loss factor and power",
    }
    columns = next(iter(rows.values()), {})
    result = labelled_dataset(
        {
            key: ("law", np.array([row[key] for row in rows.values()]), units.get(key, "1"), texts[key])
            for key in columns
        },
        {"law": (list(rows), "1", "friction law")},
        {"left_out": left_out},
    )
    return result.assign_coords(law_title=("law", [laws[name].title for name in rows]))


def iso_14179_of(pair: AnyPair) -> float:
    """Mean coefficient of ISO/TR 14179-2 of a pair at its operating point, with mineral oil [-]."""
    pair = load_gear_pair(pair)
    return coefficient_of(contact_path(pair))


def iso_14179_mesh_loss(pair: AnyPair) -> float:
    """Load-dependent loss of the mesh with mineral oil after ISO/TR 14179-2, P_VZP = P mu_mz H_v [W].

    With the exact loss factor of equal load sharing, which is Ohlendorf's wherever his closed form holds.
    """
    pair = load_gear_pair(pair)
    power = pair.operating.pinion_torque * pair.operating.pinion_speed
    return power * iso_14179_of(pair) * loss_factor(pair, "uniform")
