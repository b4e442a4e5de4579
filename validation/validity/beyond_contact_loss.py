"""Motions with unilateral contact, at the speeds and torques about the operating point."""

from __future__ import annotations

import numpy as np
import xarray as xr

from floquet.gear.axes import operating_rpm, speed_range
from floquet.gear.jump_map import jump_map
from floquet.gear.response import ResponseBranches, response_branches
from lumped import GearPair, NumericalError, ParameterError
from lumped.typing import Progress

#: Speeds of the motions beyond contact loss, over the operating speed.
BRANCH_SPEEDS = (0.8, 1.25)
#: Torques of the jump map, over the operating torque, and its size: torques, speeds.
MAP_TORQUES = (0.4, 2.5)
MAP_SIZE = (7, 61)


def branches_about_operation(
    pair: GearPair, factors: tuple[float, float] = BRANCH_SPEEDS, progress: Progress | None = None
) -> ResponseBranches | str:
    """Branches of periodic motions about the operating speed; why they cannot be computed.

    ``factors`` are the slowest and fastest speed over the operating speed, cut to the pair's range.
    """
    try:
        return response_branches(pair, _speeds(pair, factors), seeds=0, progress=progress)
    except (NumericalError, ParameterError) as error:
        return str(error)


def jumps_about_operation(
    pair: GearPair,
    factors: tuple[float, float] = BRANCH_SPEEDS,
    size: tuple[int, int] = MAP_SIZE,
    progress: Progress | None = None,
) -> xr.Dataset | str:
    """Jump map over speed and torque about the operating point; why it cannot be computed.

    Motions of one mesh cycle, without friction, which hardly moves them and triples the time. ``size`` is the
    number of torques, in equal ratios, and of speeds.
    """
    smooth = pair.with_(friction__law="none")
    axes = {
        "speed_rpm": np.linspace(*_speeds(pair, factors), size[1]),
        "torque": pair.operating.pinion_torque * np.geomspace(*MAP_TORQUES, size[0]),
    }
    try:
        return jump_map(smooth, axes, (1,), progress=progress)
    except (NumericalError, ParameterError) as error:
        return str(error)


def _speeds(pair: GearPair, factors: tuple[float, float]) -> tuple[float, float]:
    own, (slowest, fastest) = operating_rpm(pair), speed_range(pair)
    return max(factors[0] * own, slowest), min(factors[1] * own, fastest)
