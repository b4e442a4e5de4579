"""Mesh efficiency without vibration: pairs share the load, friction enters the torque balance.

Sources: docs/theory/mesh_physics.md, "Losses".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lumped.gear_geometry.geometry import Geometry
from lumped.labelling import provenance
from lumped.losses.cycle import CyclePositions, quadrature, samples
from lumped.losses.loss_factor import mean_loss_factor, sliding_velocity
from lumped.losses.sharing import Sharing, Springs, springs
from lumped.model.results import labelled
from lumped.model.steady import sample_times
from lumped.path_function import PathFunction
from lumped.path_of_contact import friction_path_function
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
    """Loads, friction power and mesh efficiency over one mesh cycle at vanishing speed of vibration.

    At every instant T_p = SUM (r_bp + X_pi mu_i) N_i fixes the mesh load. Its shares are those of springs
    under the frictionless load T_p/r_bp, and T_g = SUM (r_bg + X_gi mu_i) N_i. The efficiency
    T_g Omega_g/(T_p Omega_p) equals 1 - SUM F_i v_s,i over the input power, because the normal loads do no
    work at constant speed ratio.

    Parameters
    ----------
    pair : the gear pair
    law : name of a friction law; default ``pair.friction.law``
    sharing : how pairs share the load, see ``lumped.losses.sharing``; by default with the stiffness and
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
