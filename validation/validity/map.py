"""Where over speed and torque the lumped model is valid: contact, sliding, stability, film regime."""

from __future__ import annotations

import warnings

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

import lumped
from lumped import GearPair, LawRangeWarning
from lumped.arguments import real_numbers
from lumped.labelling import labelled_dataset, provenance
from lumped.lubrication.film import REGIMES, regime
from lumped.model.steady import UNSTABLE
from lumped.path_of_contact import contact_path
from lumped.typing import BoolArray, FloatArray, Progress
from validation.validity.flags import LOAD_NOISE, REVERSAL_LIMITS

#: Values of ``state``: the worst of contact, sliding and stability.
STATES = ("valid", "warning", "violated", "no periodic motion")
_SAMPLES = 96  # per mesh cycle
_NAMES = {
    "lowest_load": "smallest normal load of a pair in contact over the static load",
    "reversal": "largest distance of reversed sliding from the pitch point over the base pitch",
    "spectral_radius": "largest Floquet multiplier of the periodic motion",
    "film_parameter": "smallest film parameter along the path of contact",
}


def validity_map(
    pair: GearPair, speeds_rpm: ArrayLike, torques: ArrayLike, *, progress: Progress | None = None
) -> xr.Dataset:
    """Check the assumptions of the lumped model on its periodic motion over speed and torque.

    Parameters
    ----------
    pair : the gear pair
    speeds_rpm : pinion speeds [rpm], increasing
    torques : pinion torques [N m], increasing
    progress : called with the finished fraction

    Returns
    -------
    Dataset over ``torque`` and ``speed``: lowest_load, smallest normal load of a pair in contact over the
    static load; reversal, largest distance from the pitch point at which sliding is reversed, over the base
    pitch; spectral_radius, largest Floquet multiplier; film_parameter, its smallest value over the path of
    contact; regime, index into ``REGIMES`` of ``lumped.lubrication.film``; state, index
    into ``STATES``. Points without a periodic motion are NaN with state 3

    Raises
    ------
    ParameterError : speeds or torques are not positive and increasing
    """
    speed = real_numbers("speeds_rpm", speeds_rpm, 0.0, above=True, increasing=True, unit="rpm")
    torque = real_numbers("torques", torques, 0.0, above=True, increasing=True, unit="N m")
    shape = (torque.size, speed.size)
    found: dict[str, FloatArray] = {name: np.full(shape, np.nan) for name in _NAMES}
    g = pair.geometry
    with warnings.catch_warnings():
        # The map itself shows the regime; one warning per point would say less.
        warnings.simplefilter("ignore", LawRangeWarning)
        for row, value in enumerate(torque):
            at = pair.with_({"operating.pinion_torque": float(value), "operating.brake_torque": "balanced"})
            sweep = lumped.speed_sweep(at, speed, samples_per_cycle=_SAMPLES)
            static = float(value) / g.base_radius_pinion
            found["lowest_load"][row] = sweep["normal_load_min"].to_numpy() / static
            found["reversal"][row] = sweep["sliding_reversal"].to_numpy() / g.base_pitch
            found["spectral_radius"][row] = sweep["spectral_radius"].to_numpy()
            for column, rpm in enumerate(speed):
                path = contact_path(at.with_({"operating.pinion_speed": float(rpm)}))
                film = path.film_parameter(np.linspace(path.L_XA, path.L_XD, 65))
                found["film_parameter"][row, column] = film.min()
            if progress is not None:
                progress((row + 1) / torque.size)
    state = validity_state(found["lowest_load"], found["reversal"], found["spectral_radius"])
    dims = ("torque", "speed")
    film_regime = regime(found["film_parameter"], pair.friction.thresholds)
    return labelled_dataset(
        {name: (dims, found[name], "1", text) for name, text in _NAMES.items()}
        | {
            "regime": (dims, film_regime, "1", "0 to 3: " + ", ".join(REGIMES)),
            "state": (dims, state, "1", "0 to 3: " + ", ".join(STATES)),
        },
        {"speed": (speed, "rpm", "pinion speed"), "torque": (torque, "N m", "pinion torque")},
        provenance(pair) | {"model": "lumped"},
    )


def validity_state(
    lowest_load: FloatArray, reversal: FloatArray, spectral_radius: FloatArray | None = None
) -> NDArray[np.int64]:
    """Index into ``STATES``: the worst of contact, sliding and, where it counts, stability.

    ``lowest_load`` is over the static load, NaN without a periodic motion; ``reversal`` over the base pitch.
    """
    state = np.zeros(lowest_load.shape, dtype=np.int64)
    state[reversal > REVERSAL_LIMITS[0]] = 1
    state[(reversal > REVERSAL_LIMITS[1]) | (lowest_load < -LOAD_NOISE)] = 2
    if spectral_radius is not None:
        state[spectral_radius > UNSTABLE] = 2
    state[np.isnan(lowest_load)] = 3
    return state


def speed_spans(speed: FloatArray, chosen: BoolArray) -> list[str]:
    """Runs of neighbouring chosen speeds in words, without their unit: "1200 to 3400", or "1200" for one."""
    edges = np.flatnonzero(np.diff(chosen.astype(int), prepend=0, append=0))
    return [
        f"{speed[first]:.5g}" if end - first == 1 else f"{speed[first]:.5g} to {speed[end - 1]:.5g}"
        for first, end in zip(edges[::2], edges[1::2], strict=True)
    ]
