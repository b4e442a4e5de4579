"""Periodic motion over a range of speeds, sampled where its curves bend."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lumped.errors import NumericalError
from lumped.model.averaged import modes
from lumped.model.sweep import speed_sweep
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, Progress

if TYPE_CHECKING:
    import xarray as xr

#: Curves that are resolved: each group is drawn on one axis.
_DRAWN = (("dte_peak_to_peak",), ("normal_load_max", "normal_load_min"))
#: Largest distance of a straight line between neighbours from the curve, over the height of its axis.
_TOLERANCE = 0.003
#: Neighbours are no nearer than this share of their speed.
_FINEST = 1e-4
#: The first speeds are at least this share of their speed apart: no resonance is narrower.
_APART = 3e-3
#: Mesh orders whose meeting with a natural frequency is a first sample.
_ORDERS = 6
#: Share of the speeds that is spent before looking at the curves.
_FIRST = 0.3


def resolved_sweep(
    pair: AnyPair,
    speeds_rpm: tuple[float, float],
    *,
    most: int = 240,
    samples_per_cycle: int = 128,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Periodic motion over a range of speeds, as `speed_sweep`, at speeds that resolve its curves.

    The first speeds are the ends, the operating speed, those at which a mesh order meets a natural frequency,
    and others between, closer where the pair runs slowly. Intervals are then halved, the worst first, as long
    as the straight line between two speeds is further from the curve than can be seen in a figure; its
    distance is estimated from second differences.

    Parameters
    ----------
    pair : a validated gear pair
    speeds_rpm : lowest and highest pinion speed [rpm]
    most : number of speeds at which to stop
    samples_per_cycle, progress : as `speed_sweep`

    Raises
    ------
    ParameterError : as `speed_sweep`
    """
    import xarray as xr

    pair = load_gear_pair(pair)
    new = _first_speeds(pair, speeds_rpm, max(int(_FIRST * most), 2))[:most]
    found: xr.Dataset | None = None
    done = 0
    while new.size:
        tell = None if progress is None else _part(progress, done / most, new.size / most)
        part = speed_sweep(pair, np.sort(new), samples_per_cycle=samples_per_cycle, progress=tell)
        found = part if found is None else xr.concat([found, part], "speed").sortby("speed")
        done = found.sizes["speed"]
        new = _halved(found)[: most - done]
    assert found is not None  # two speeds at least
    if progress is not None:
        progress(1.0)
    return found


def _part(progress: Progress, first: float, share: float) -> Progress:
    return lambda fraction, stage="", /: progress(first + share * fraction, stage)


def _first_speeds(pair: GearPair, ends: tuple[float, float], count: int) -> FloatArray:
    """Return speeds to begin with, by importance: ends, operating speed, resonances, and others between."""
    low, high = ends
    try:
        resonances = [mode.resonant_speed for mode in modes(pair)]
    except NumericalError:  # an overdamped mode has no natural frequency
        resonances = []
    places = np.divide.outer(resonances, np.arange(1, _ORDERS + 1)).T.ravel()
    # Resonances are wider the faster the pair runs, so steps grow with the root of speed.
    between = np.linspace(low**0.5, high**0.5, count)[1:-1] ** 2
    own = pair.operating.pinion_speed * 30.0 / np.pi
    wanted = np.concatenate([[low, high, own], places, between])
    kept: list[float] = []
    for speed in wanted[(wanted >= low) & (wanted <= high)]:
        if all(abs(speed - other) > _APART * speed for other in kept):
            kept.append(float(speed))
    return np.array(kept)


def _halved(sweep: xr.Dataset) -> FloatArray:
    """Middles of the intervals in which a straight line is too far from a curve, the worst first."""
    speed = sweep["speed"].to_numpy()
    distance = np.zeros(speed.size - 1)
    for group in _DRAWN:
        curves = np.stack([sweep[name].to_numpy() for name in group])
        if not np.isfinite(curves).any():
            continue
        height = float(np.nanmax(curves) - min(np.nanmin(curves), 0.0))
        for curve in curves:
            distance = np.maximum(distance, _straight_line_error(speed, curve) / (height or 1.0))
    wide = np.diff(speed) > 2.0 * _FINEST * speed[1:]
    worst = np.argsort(-distance, kind="stable")
    worst = worst[(distance[worst] > _TOLERANCE) & wide[worst]]
    return np.asarray(0.5 * (speed[worst] + speed[worst + 1]))


def _straight_line_error(x: FloatArray, y: FloatArray) -> FloatArray:
    """Estimated largest error of linear interpolation in each interval, |y''| h^2/8; 0 beside a gap.

    The curve is known on one side only of the first and the last interval: there it is taken twice.
    """
    step = np.diff(x)
    slope = np.diff(y) / step
    bend = np.nan_to_num(np.abs(np.diff(slope)) / (step[1:] + step[:-1]))  # |y''|/2 at the inner points
    ends = np.concatenate([2.0 * bend[:1], bend, 2.0 * bend[-1:]])
    return np.asarray(np.maximum(ends[1:], ends[:-1]) * step**2 / 4.0)
