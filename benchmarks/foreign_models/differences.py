"""How far a record is from the sound one of the same user."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from benchmarks.foreign_models.recipe import Recipe

#: Shares of a mesh cycle by which the sound record is shifted to fit.
SHIFTS = 256
#: Orders of the mesh frequency that count.
ORDERS = 40


class Difference(NamedTuple):
    """Of a channel, over the swing (rms without mean) of the sound record: as it is, and the shape alone.

    The shape: complex mesh orders from 1 up, after the shift in time that fits all channels best.
    """

    as_written: float
    shape: float


def orders_of(times: np.ndarray, values: np.ndarray, period: float) -> np.ndarray:
    """Complex mesh orders 0 to ``ORDERS`` by least squares, of shape (..., orders)."""
    angle = 2.0 * np.pi * np.outer(times - times[0], np.arange(1, ORDERS + 1)) / period
    basis = np.hstack([np.ones((times.size, 1)), np.cos(angle), np.sin(angle)])
    # The least norm where samples do not tell orders apart, as of a time in another unit.
    fit = np.linalg.lstsq(basis.T @ basis, basis.T @ np.atleast_2d(values).T, rcond=1e-12)[0]
    return np.vstack([fit[:1].astype(complex), fit[1 : ORDERS + 1] - 1j * fit[ORDERS + 1 :]]).T


def differences(record: Mapping[str, np.ndarray], recipe: Recipe) -> dict[str, Difference]:
    """Differences of the channels of a record from the sound, fine run of the same recipe."""
    twin = recipe.sound
    sound = twin()
    period = twin.user_model.period
    names = [name for name in recipe.settings.channels if name in record and name in sound]
    same = record["time"].size == sound["time"].size
    mine = {name: orders_of(record["time"], record[name], period) for name in names}
    theirs = {name: orders_of(sound["time"], sound[name], period) for name in names}
    size = {name: max(float(np.linalg.norm(theirs[name][:, 1:])), 1e-300) for name in names}
    turns = np.exp(2j * np.pi * np.outer(np.arange(SHIFTS) / SHIFTS, np.arange(1, ORDERS + 1)))
    off = {
        name: np.array([np.linalg.norm(mine[name][:, 1:] - theirs[name][:, 1:] * turn) for turn in turns])
        / size[name]
        for name in names
    }
    best = int(np.argmin(sum(values**2 for values in off.values())))
    result: dict[str, Difference] = {}
    for name in names:
        swing = max(float(np.std(sound[name], axis=-1).max()), 1e-300)
        written = float(np.sqrt(np.mean((record[name] - sound[name]) ** 2))) / swing if same else np.nan
        result[name] = Difference(written, float(off[name][best]))
    return result
