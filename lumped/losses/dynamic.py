"""Mesh efficiency and sliding power of a dynamic solution, and of all friction laws side by side.

Sources: power balance of docs/theory/equations.md, "Periodic motion and the brake torque".
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lumped.errors import ParameterError, refuse
from lumped.friction import FRICTIONAL, LAWS
from lumped.labelling import labelled_dataset
from lumped.losses.quasi_static import quasi_static_losses
from lumped.model.powers import balance
from lumped.model.steady import periodic_cycle
from lumped.schema.files import AnyPair, load_gear_pair

if TYPE_CHECKING:
    import xarray as xr


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


def sliding_power_along_path(solution: xr.Dataset) -> xr.Dataset:
    """Local sliding power of one tooth pair over the path of contact.

    Every pair in contact at every time of a solution is one point of the path; over one mesh cycle of a
    periodic solution the pairs together cover it once.

    Parameters
    ----------
    solution : dataset with position, contact, normal_load and a friction power over (pair, time)

    Returns
    -------
    xarray.Dataset over ``xi`` [m], increasing: sliding_power [W] (>= 0 where friction opposes sliding) and
    normal_load [N]
    """
    name = "friction_power_nominal" if "friction_power_nominal" in solution else "friction_power"
    touching = solution["contact"].to_numpy().ravel() > 0.0
    xi = solution["position"].to_numpy().ravel()[touching]
    order = np.argsort(xi, kind="stable")
    along = {
        "sliding_power": (-solution[name], "W", "sliding power of one tooth pair"),
        "normal_load": (solution["normal_load"], "N", "normal load of one tooth pair"),
    }
    return labelled_dataset(
        {
            key: ("xi", array.to_numpy().ravel()[touching][order], unit, text)
            for key, (array, unit, text) in along.items()
        },
        {"xi": (xi[order], "m", "distance of the contact point from X")},
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
    for name in FRICTIONAL:
        try:
            static = quasi_static_losses(pair, name, samples_per_cycle=8).attrs
            rows[name] = {key: static[key] for key in ("mesh_efficiency", "power_loss", "mean_coefficient")}
            if dynamic:
                run = periodic_cycle(pair.with_(friction__law=name), 8)
                rows[name]["mesh_efficiency_dynamic"] = balance(run)["mesh_efficiency"]
        except ParameterError as error:
            left_out.append(f"{LAWS[name].title}: {error}")
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
    return result.assign_coords(law_title=("law", [LAWS[name].title for name in rows]))
