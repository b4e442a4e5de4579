"""What the mesh physics says about one gear pair: stiffness, load sharing, transmission error, losses.

Computed for the report and for whoever wants the same numbers without a page around them.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import xarray as xr

from lumped import GearPair, LawRangeWarning, NumericalError, ParameterError
from lumped.losses import (
    anderson_loewenthal_sliding_loss,
    dynamic_losses,
    iso_14179_mesh_loss,
    iso_14179_of,
    loss_factor,
    losses_of_laws,
    ohlendorf_of,
    quasi_static_losses,
    sliding_power_along_path,
)
from lumped.path_of_contact.iso_comparison import iso_comparison
from lumped.path_of_contact.stiffness import mesh_stiffness, stiffness_components
from lumped.quasi_static import (
    OptimalRelief,
    optimal_relief,
    relief_map,
    static_transmission_error,
    with_tip_relief,
)

#: Torques of the static transmission error curves, over the operating torque.
CURVES = (0.1, 0.5, 1.0, 1.5, 2.0)
_HARRIS_POINTS = 121
_MAP_POINTS = 41

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class LossNumbers:
    """Single numbers of the losses at the operating point.

    Attributes
    ----------
    ohlendorf : loss factor H_v in closed form [-]
    uniform, stiffness, loaded : H_v by integration with equal shares, with the pair's stiffness, and with its
        relief under load; None where it cannot be computed [-]
    iso_coefficient : mean friction coefficient of ISO/TR 14179-2 [-]
    iso_loss : P mu_mz H_v [W]
    anderson_loewenthal : mean sliding loss [W]
    input_power : T_p Omega_p [W]
    """

    ohlendorf: float
    uniform: float
    stiffness: float
    loaded: float | None
    iso_coefficient: float
    iso_loss: float
    anderson_loewenthal: float
    input_power: float


@dataclass(frozen=True, eq=False)
class MeshPhysics:
    """Mesh physics of one gear pair; None where a method does not apply, with the reason in ``refused``.

    Attributes
    ----------
    components, iso, energy_mesh : potential-energy stiffness of the pair, whatever its own model:
        ``stiffness_components``, ``iso_comparison`` and ``mesh_stiffness``
    curves : ``static_transmission_error`` at ``CURVES`` times the operating torque, with the pair's model
    harris : peak to peak static transmission error over ``torque`` [N m] and ``flank``
    optimum, relief : best linear tip relief at the operating torque, and the map around it; None when quick
    losses : efficiencies over ``law``: in closed form, quasi-static, and of the periodic motion (own law only
        when quick)
    numbers : of the losses
    quasi_static, periodic : local sliding power over xi, without and with vibration
    instants : instantaneous efficiency over the mesh cycle, quasi-static
    instants_periodic : the same of the periodic motion
    refused : reasons of what is missing
    """

    components: xr.Dataset | None
    iso: xr.Dataset | None
    energy_mesh: xr.Dataset | None
    curves: xr.Dataset | None
    harris: xr.Dataset | None
    optimum: OptimalRelief | None
    relief: xr.Dataset | None
    losses: xr.Dataset
    numbers: LossNumbers
    quasi_static: xr.Dataset
    periodic: xr.Dataset
    instants: xr.Dataset
    instants_periodic: xr.Dataset
    refused: tuple[str, ...]


def mesh_physics(
    pair: GearPair, motion: xr.Dataset, profile: xr.Dataset, *, quick: bool = False
) -> MeshPhysics:
    """Compute the mesh physics of a gear pair.

    Parameters
    ----------
    pair : a validated gear pair
    motion : its periodic motion, of ``lumped.steady_state``
    profile : its friction laws along the path, of ``lumped.path_of_contact.friction_profile``
    quick : without the relief optimum and the periodic motion of the laws that are not the pair's own

    Notes
    -----
    Laws are compared outside their ranges too; ``profile`` lists what they leave, so nothing is warned here.
    """
    refused: list[str] = []

    def attempt(what: str, compute: Callable[[], T]) -> T | None:
        try:
            return compute()
        except (ParameterError, NumericalError) as error:
            refused.append(f"{what}: {error}")
            return None

    energy = pair.with_(mesh__stiffness={"model": "energy"})
    optimum = None if quick else attempt("Tip relief", lambda: optimal_relief(pair))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        still = quasi_static_losses(pair)
        return MeshPhysics(
            components=attempt("Potential-energy stiffness", lambda: stiffness_components(pair)),
            iso=attempt("Comparison with ISO 6336-1", lambda: iso_comparison(pair)),
            energy_mesh=attempt("Potential-energy mesh stiffness", lambda: mesh_stiffness(energy)),
            curves=attempt("Static transmission error", lambda: _curves(pair)),
            harris=attempt("Harris map", lambda: _harris(pair, energy, optimum)),
            optimum=optimum,
            relief=None if optimum is None else attempt("Relief map", lambda: _map(pair, optimum)),
            losses=_losses(pair, motion, profile, quick=quick),
            numbers=_numbers(pair, attempt("Loss factor under load", lambda: loss_factor(pair, "loaded"))),
            quasi_static=sliding_power_along_path(still),
            periodic=sliding_power_along_path(motion),
            instants=still[["instantaneous_efficiency"]],
            instants_periodic=dynamic_losses(pair, motion),
            refused=tuple(refused),
        )


def _curves(pair: GearPair) -> xr.Dataset:
    return static_transmission_error(pair, np.array(CURVES) * pair.operating.pinion_torque)


def _harris(pair: GearPair, energy: GearPair, optimum: OptimalRelief | None) -> xr.Dataset:
    """Peak to peak over torque: own flanks, involutes, best relief, own flanks with energy stiffness."""
    torque = np.linspace(0.02, 2.0, _HARRIS_POINTS) * pair.operating.pinion_torque
    flanks = {"flanks as given": pair}
    if any((gear.tip_relief, gear.root_relief) != (None, None) for gear in (pair.pinion, pair.gear)):
        bare: dict[str, None] = {
            f"{gear}__{which}_relief": None for gear in ("pinion", "gear") for which in ("tip", "root")
        }
        flanks["perfect involutes"] = pair.with_(**bare)
    if optimum is not None:
        flanks["best linear tip relief"] = with_tip_relief(pair, optimum)
    if pair.mesh.stiffness.model != "energy":
        flanks["as given, energy stiffness"] = energy
    rows = [static_transmission_error(one, torque)["peak_to_peak"].to_numpy() for one in flanks.values()]
    return xr.Dataset(
        {
            "peak_to_peak": (
                ("flank", "torque"),
                np.array(rows),
                {"units": "m", "long_name": "peak to peak static transmission error"},
            )
        },
        coords={
            "flank": ("flank", list(flanks), {"long_name": "flanks"}),
            "torque": ("torque", torque, {"units": "N*m", "long_name": "pinion torque"}),
        },
        attrs={"operating_torque": pair.operating.pinion_torque},
    )


def _map(pair: GearPair, optimum: OptimalRelief) -> xr.Dataset:
    share = np.linspace(0.0, 2.0, _MAP_POINTS)
    return relief_map(pair, share * optimum.amount, np.linspace(0.3, 1.7, _MAP_POINTS) * optimum.length)


def _losses(pair: GearPair, motion: xr.Dataset, profile: xr.Dataset, *, quick: bool) -> xr.Dataset:
    table = losses_of_laws(pair, dynamic=not quick)
    own = pair.friction.law
    if quick:
        dynamic = [
            float(motion.attrs["mesh_efficiency"]) if law == own else np.nan for law in table["law"].values
        ]
        table["mesh_efficiency_dynamic"] = (
            "law",
            np.array(dynamic),
            {"units": "1", "long_name": "mesh efficiency of the periodic motion"},
        )
    mean = profile["mean_mu"].sel(law=table["law"])
    table["path_coefficient"] = ("law", mean.to_numpy(), mean.attrs)
    table["mesh_efficiency_closed_form"] = (
        "law",
        1.0 - mean.to_numpy() * ohlendorf_of(pair),
        {"units": "1", "long_name": "1 - mean |mu| times Ohlendorf's loss factor"},
    )
    return table


def _numbers(pair: GearPair, loaded: float | None) -> LossNumbers:
    return LossNumbers(
        ohlendorf=ohlendorf_of(pair),
        uniform=loss_factor(pair, "uniform"),
        stiffness=loss_factor(pair, "stiffness"),
        loaded=loaded,
        iso_coefficient=iso_14179_of(pair),
        iso_loss=iso_14179_mesh_loss(pair),
        anderson_loewenthal=anderson_loewenthal_sliding_loss(pair),
        input_power=pair.operating.pinion_torque * pair.operating.pinion_speed,
    )
