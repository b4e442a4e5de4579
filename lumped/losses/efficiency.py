"""Mesh efficiency and sliding loss without vibration, for one friction law or for all laws side by side.

Sources: docs/theory/mesh_physics.md, "Losses"; docs/theory/equations.md, "Periodic motion and the brake
torque"; ISO/TR 14179-2:2001.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lumped.errors import ParameterError
from lumped.friction.iso_14179 import coefficient_of
from lumped.friction.registry import laws_with_friction
from lumped.labelling import labelled_dataset, provenance
from lumped.losses.loss_factor import (
    Sharing,
    loss_factor,
    mean_loss_factor,
    quadrature,
    sliding_velocity,
    springs,
)
from lumped.path_of_contact import contact_path, friction_path_function
from lumped.schema.files import AnyPair, load_gear_pair

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class QuasiStaticLosses:
    """Losses of the mesh in slow motion, without vibration: mean values over the cycle.

    Attributes
    ----------
    mesh_efficiency : T_g Omega_g/(T_p Omega_p) [-]
    power_loss, input_power : [W]
    loss_factor : H_v, with the loads under friction [-]
    mean_coefficient : loss over loss factor and input power [-]
    """

    mesh_efficiency: float
    power_loss: float
    input_power: float
    loss_factor: float
    mean_coefficient: float


def quasi_static_losses(
    pair: AnyPair, law: str | None = None, sharing: Sharing = "elements"
) -> QuasiStaticLosses:
    """Return the losses of the mesh in slow motion, without vibration, by exact quadrature.

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

    Raises
    ------
    ParameterError : an unknown law or sharing, or a law that the pair does not allow
    """
    pair = load_gear_pair(pair)
    g = pair.geometry
    torque = pair.operating.pinion_torque
    mu = friction_path_function(pair, law)
    teeth = springs(pair, sharing)
    power_in = torque * g.omega_pinion
    positions = quadrature(g, [mu, *teeth.functions])
    share = teeth.share(positions)
    coefficient = np.where(positions.contact, mu(positions.position), 0.0)
    arm = g.base_radius_pinion + positions.position * coefficient
    normal = torque / (share * arm).sum(axis=0) * share
    loss = positions.mean((coefficient * normal * sliding_velocity(g, positions.position)).sum(axis=0))
    factor = mean_loss_factor(g, positions, share)
    return QuasiStaticLosses(1.0 - loss / power_in, loss, power_in, factor, loss / (factor * power_in))


def losses_of_laws(pair: AnyPair) -> xr.Dataset:
    """Mesh efficiency of every law with friction at the operating point, without vibration.

    Parameters
    ----------
    pair : the gear pair

    Returns
    -------
    xarray.Dataset over ``law``: mesh_efficiency, power_loss [W], mean_coefficient; attribute ``left_out``,
    laws that the pair does not allow and why
    """
    pair = load_gear_pair(pair)
    rows: dict[str, QuasiStaticLosses] = {}
    left_out: list[str] = []
    laws = laws_with_friction(pair.friction)
    for name in laws:
        try:
            rows[name] = quasi_static_losses(pair, name)
        except ParameterError as error:
            left_out.append(f"{laws[name].title}: {error}")
    columns = {
        "mesh_efficiency": ("1", "mesh efficiency, quasi-static"),
        "power_loss": ("W", "mean sliding loss, quasi-static"),
        "mean_coefficient": ("1", "loss over loss factor and power"),
    }
    result = labelled_dataset(
        {
            key: ("law", np.array([getattr(row, key) for row in rows.values()]), unit, text)
            for key, (unit, text) in columns.items()
        },
        {"law": (list(rows), "1", "friction law")},
        provenance(pair) | {"left_out": left_out},
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
