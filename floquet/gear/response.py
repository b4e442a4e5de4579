"""Branches of periodic motions of a gear pair over speed, where teeth may part.

Sources: docs/theory/orbits.md, "Branches".
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from floquet.gear.axes import operating_rpm, speed_range
from floquet.gear.orbit import MOST_CYCLES, GearOrbit, largest_motion, start_of, static_deflection
from floquet.gear.unilateral import unilateral_family
from floquet.orbits.bifurcations import Bifurcation, Kind
from floquet.orbits.branch import Limits
from floquet.orbits.response import Branch, Response, find_response
from lumped.arguments import real_array, whole_number
from lumped.errors import refuse
from lumped.labelling import Variable, labelled_dataset
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import Progress

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class GearBifurcation:
    """A bifurcation on a branch: `floquet.orbits.bifurcations.Bifurcation` at a speed.

    Attributes
    ----------
    kind : "fold", "period doubling", "Neimark-Sacker" or "grazing"
    speed_rpm : pinion speed [rpm]
    dte_rms : root mean square of the transmission error about its mean [m]
    n : mesh cycles of the motion
    sharp : whether the condition holds exactly there; False at a corner, where a contact begins to strike
    """

    kind: Kind
    speed_rpm: float
    dte_rms: float
    n: int
    sharp: bool


@dataclass(frozen=True, eq=False)
class ResponseBranches:
    """Periodic motions of a gear pair over speed.

    Attributes
    ----------
    pair : the gear pair
    response : what the search found, over the period
    """

    pair: GearPair
    response: Response = field(repr=False)

    @property
    def branches(self) -> tuple[Branch, ...]:
        """Curves of periodic motions; each has ``n``, ``orbits``, ``ends``."""
        return self.response.branches

    @cached_property
    def _cycle_at_1_rpm(self) -> float:
        return self.pair.geometry.mesh_period * operating_rpm(self.pair)

    @property
    def bifurcations(self) -> tuple[GearBifurcation, ...]:
        """Folds, period doublings, Neimark-Sacker points and grazing of all branches, in their order."""
        return tuple(self._labelled(branch, b) for branch in self.branches for b in branch.bifurcations)

    def _labelled(self, branch: Branch, b: Bifurcation) -> GearBifurcation:
        return GearBifurcation(
            b.kind, self._cycle_at_1_rpm / b.orbit.period, b.orbit.run.rms, branch.n, b.sharp
        )

    def at(self, speed_rpm: float) -> list[GearOrbit]:
        """All periodic motions that were found at a pinion speed [rpm], stable or not."""
        there = self.pair.with_({"operating.pinion_speed": speed_rpm})
        return [GearOrbit(there, orbit) for orbit in self.response.at(there.geometry.mesh_period)]

    @cached_property
    def dataset(self) -> xr.Dataset:
        """All orbits in a row, ``branch`` saying which belong together."""
        rows = [(j, o) for j, branch in enumerate(self.branches) for o in branch.orbits]
        orbits = [o for _, o in rows]

        def column(values: list[float] | list[int] | list[bool], unit: str, text: str) -> Variable:
            return ("point", np.array(values), unit, text)

        return labelled_dataset(
            {
                "branch": column([j for j, _ in rows], "1", "branch"),
                "n": column([o.n for o in orbits], "1", "mesh cycles of the motion"),
                "speed_rpm": column([self._cycle_at_1_rpm / o.period for o in orbits], "rpm", "pinion speed"),
                "dte_rms": column([o.run.rms for o in orbits], "m", "dynamic transmission error, rms"),
                "dte_mean": column([o.run.mean for o in orbits], "m", "dynamic transmission error, mean"),
                "dte_peak_to_peak": column(
                    [o.run.most - o.run.least for o in orbits],
                    "m",
                    "dynamic transmission error, peak to peak",
                ),
                "largest_load": column([o.run.largest_load for o in orbits], "N", "largest normal load"),
                "spectral_radius": column(
                    [o.spectral_radius for o in orbits], "1", "spectral radius over n cycles"
                ),
                "stable": column([o.stable for o in orbits], "1", "stable"),
                "parts": column([o.parts for o in orbits], "1", "teeth part"),
            },
            {"point": (np.arange(len(rows)), "1", "orbit")},
            {"model": "unilateral lumped"},
        )


def response_branches(
    pair: AnyPair,
    speeds: tuple[float, float] | None = None,
    periods: Collection[int] = (1, 2, 3),
    *,
    seeds: int = 40,
    progress: Progress | None = None,
) -> ResponseBranches:
    """Branches of periodic motions over speed, stable and unstable, with their bifurcations.

    Found are the branches through the motion of the linear model, those that double their period, and those
    to which runs settle that are started at ``seeds`` speeds. An isolated branch that no run comes to is not
    found.

    Parameters
    ----------
    pair : the gear pair
    speeds : slowest and fastest pinion speed [rpm]; None: ``operating.speed_range``
    periods : mesh cycles after which motions repeat
    seeds : speeds at which runs settle, to find isolated branches
    progress : called with the finished fraction

    Raises
    ------
    ParameterError : speeds that are no range
    """
    pair = load_gear_pair(pair)
    low, high = _speeds(pair, speeds)
    wanted = sorted({whole_number("periods", n, 1, MOST_CYCLES) for n in periods})
    seeds = whole_number("seeds", seeds, 0, 10_000)
    response = find_response(
        unilateral_family(pair, low, high),
        _limits(pair, low, high),
        lambda period: start_of(pair.with_({"operating.pinion_speed": _rpm(pair, period)}), None),
        periods=wanted,
        seeds=seeds,
        progress=progress,
    )
    return ResponseBranches(pair, response)


def _rpm(pair: GearPair, period: float) -> float:
    return pair.geometry.mesh_period * operating_rpm(pair) / period


def _speeds(pair: GearPair, speeds: tuple[float, float] | None) -> tuple[float, float]:
    given = np.atleast_1d(real_array("speeds", speed_range(pair) if speeds is None else speeds))
    if given.size != 2 or not 0.0 < given[0] < given[1]:
        raise refuse(
            "speeds", speeds, "slowest and fastest speed in rpm", "Give (low, high), 0 < low < high."
        )
    for rpm in given:
        pair.with_({"operating.pinion_speed": float(rpm)})
    return float(given[0]), float(given[1])


def _limits(pair: GearPair, low: float, high: float) -> Limits:
    length, cycle = static_deflection(pair), pair.geometry.mesh_period * operating_rpm(pair)
    return Limits(
        slowest=low / cycle,
        fastest=high / cycle,
        length=length,
        parameter=pair.operating.pinion_torque,
        amplitude=largest_motion(pair),
    )
