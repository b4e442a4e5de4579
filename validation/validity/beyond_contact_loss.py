"""Motions of teeth that push only, at the speeds about the operating point."""

from __future__ import annotations

from floquet.gear.axes import operating_rpm, speed_range
from floquet.gear.response import ResponseBranches, response_branches
from lumped import GearPair, NumericalError, ParameterError
from lumped.typing import Progress

#: Speeds of the motions beyond contact loss, over the operating speed.
BRANCH_SPEEDS = (0.8, 1.25)


def branches_about_operation(
    pair: GearPair, factors: tuple[float, float] = BRANCH_SPEEDS, progress: Progress | None = None
) -> ResponseBranches | str:
    """Branches of periodic motions about the operating speed; why they cannot be computed.

    Parameters
    ----------
    pair : the gear pair
    factors : slowest and fastest speed over the operating speed; cut to the pair's range
    progress : called with the finished fraction
    """
    own, (slowest, fastest) = operating_rpm(pair), speed_range(pair)
    speeds = (max(factors[0] * own, slowest), min(factors[1] * own, fastest))
    try:
        return response_branches(pair, speeds, seeds=0, progress=progress)
    except (NumericalError, ParameterError) as error:
        return str(error)
