"""Where over speed and torque the lumped model is valid: contact loss, sliding reversal, film regime."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

import lumped
from lumped import GearPair, LawRangeWarning, NumericalError, geometry
from lumped.errors import refuse
from lumped.film import regime
from lumped.friction import contact_path
from lumped.results import provenance
from validation.validity import LOAD_NOISE, REVERSAL_LIMITS

FloatArray = NDArray[np.float64]
Progress = Callable[[float], None]

#: Values of ``state``: the worst of contact and sliding.
STATES = ("valid", "warning", "violated", "no periodic motion")
#: Names of ``regime``.
REGIMES = ("boundary", "mixed", "elastohydrodynamic", "full film")


def validity_map(
    pair: GearPair,
    speeds_rpm: ArrayLike,
    torques: ArrayLike,
    *,
    samples: int = 96,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Check the assumptions of the lumped model on its periodic motion over speed and torque.

    Parameters
    ----------
    pair : the gear pair
    speeds_rpm : pinion speeds [rpm], increasing
    torques : pinion torques [N m], increasing
    samples : per mesh cycle
    progress : called with the finished fraction

    Returns
    -------
    Dataset over ``torque`` and ``speed``: lowest_load, smallest normal load of a pair in contact over the
    static load; reversal, largest distance from the pitch point at which sliding is reversed, over the base
    pitch; film_parameter, its smallest value over the path of contact; regime, index into ``REGIMES``;
    state, index into ``STATES``. Points without a periodic motion are NaN with state 3

    Raises
    ------
    ParameterError : speeds or torques are not positive and increasing
    """
    axes = {}
    for name, values in (("speeds_rpm", speeds_rpm), ("torques", torques)):
        axis = np.atleast_1d(np.asarray(values, dtype=float))
        if axis.ndim != 1 or not (np.isfinite(axis).all() and axis[0] > 0 and (np.diff(axis) > 0).all()):
            raise refuse(name, values, "positive numbers, increasing", "Correct the list.")
        axes[name] = axis
    speed, torque = axes["speeds_rpm"], axes["torques"]
    shape = (torque.size, speed.size)
    found: dict[str, FloatArray] = {
        name: np.full(shape, np.nan) for name in ("lowest_load", "reversal", "film_parameter")
    }
    with warnings.catch_warnings():
        # The map itself shows the regime; one warning per point would say less.
        warnings.simplefilter("ignore", LawRangeWarning)
        for place in np.ndindex(shape):
            at = pair.with_(
                {
                    "operating.pinion_torque": float(torque[place[0]]),
                    "operating.pinion_speed": float(speed[place[1]]),
                    "operating.brake_torque": "balanced",
                }
            )
            path = contact_path(at)
            film = path.film_parameter(np.linspace(path.L_XA, path.L_XD, 65))
            found["film_parameter"][place] = float(film.min())
            try:
                motion = lumped.steady_state(at, samples_per_cycle=samples)
                found["lowest_load"][place], found["reversal"][place] = _motion(at, motion)
            except NumericalError:
                pass  # no periodic motion: the point says so
            if progress is not None:
                progress((np.ravel_multi_index(place, shape) + 1) / (shape[0] * shape[1]))
    return _dataset(pair, speed, torque, found)


def _motion(pair: GearPair, motion: xr.Dataset) -> tuple[float, float]:
    """Smallest load over the static load, and largest distance of reversed sliding over the base pitch."""
    g = geometry(pair)
    contact = motion["contact"].to_numpy() > 0
    load, position = motion["normal_load"].to_numpy(), motion["position"].to_numpy()
    sliding = motion["sliding_velocity"].to_numpy()
    reversed_ = contact & (load > 0) & (sliding * np.sign(position - g.L_XP) < 0.0)
    distance = float(np.where(reversed_, np.abs(position - g.L_XP), 0.0).max())
    static = pair.operating.pinion_torque / g.base_radius_pinion
    return float(load[contact].min()) / static, distance / g.base_pitch


def validity_state(lowest_load: FloatArray, reversal: FloatArray) -> NDArray[np.int64]:
    """Index into ``STATES`` from the smallest load over the static load and the reversal over the base pitch.

    NaN stands for a point without a periodic motion.
    """
    state = np.zeros(lowest_load.shape, dtype=np.int64)
    state[reversal > REVERSAL_LIMITS[0]] = 1
    state[(reversal > REVERSAL_LIMITS[1]) | (lowest_load < -LOAD_NOISE)] = 2
    state[np.isnan(lowest_load)] = 3
    return state


def _dataset(
    pair: GearPair, speed: FloatArray, torque: FloatArray, found: dict[str, FloatArray]
) -> xr.Dataset:
    state = validity_state(found["lowest_load"], found["reversal"])
    dims = ("torque", "speed")
    names = {
        "lowest_load": "smallest normal load of a pair in contact over the static load",
        "reversal": "largest distance of reversed sliding from the pitch point over the base pitch",
        "film_parameter": "smallest film parameter along the path of contact",
    }
    data = {name: (dims, values, {"units": "1", "long_name": names[name]}) for name, values in found.items()}
    film = regime(found["film_parameter"], pair.friction.thresholds)
    result = xr.Dataset(data, attrs=provenance(pair) | {"model": "lumped"})
    result["regime"] = (dims, film, {"units": "1", "long_name": "0 to 3: " + ", ".join(REGIMES)})
    result["state"] = (dims, state, {"units": "1", "long_name": "0 to 3: " + ", ".join(STATES)})
    return result.assign_coords(
        speed=("speed", speed, {"units": "rpm", "long_name": "pinion speed"}),
        torque=("torque", torque, {"units": "N m", "long_name": "pinion torque"}),
    )
