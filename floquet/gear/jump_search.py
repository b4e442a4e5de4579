"""Jumps, beats and chaos of a gear pair where it can lose contact, within a limit of processor time.

Sources: docs/theory/orbits.md, "Jumps within a time".
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from floquet.gear.axes import checked_range, operating_rpm, speed_range
from floquet.gear.motions import MOST_CYCLES, GearAttractor, GearOrbit
from floquet.gear.response import Jump, ResponseBranches, compile_kernels, member, within
from floquet.orbits.branch_search import Agenda, find_branches, merged
from floquet.orbits.deadline import Deadline
from floquet.orbits.orbit import Orbit, state_scale
from floquet.orbits.response import Member, Response
from lumped.arguments import real_number, whole_number
from lumped.display.progress import reported_to, shows_progress
from lumped.errors import refuse
from lumped.model.periodic_system import Supports, on_springs
from lumped.ranges import warned_once
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import LARGEST_SPEED, GearPair
from lumped.typing import ProgressRequest

if TYPE_CHECKING:
    import xarray as xr

Range = tuple[float, float]

#: Large motions of a resonance reach down to this part of the speed of the resonance at most. The lowest fold
#: of eight pairs that differ is at 0.24 (docs/theory/orbits.md).
_REACH = 0.2
#: Speed, over that at which the mesh frequency is the fastest natural one, beyond which the motion of the
#: linear model starts no large motion of one cycle.
_BEYOND_RESONANCE = 1.5
#: Distance from the motion of the linear model, over the size of that motion, within which both are one
#: motion.
_LINEAR = 0.05


@dataclass(frozen=True, eq=False)
class JumpSearch:
    """Results of a search for jumps, beats and chaos.

    Attributes
    ----------
    pair : the gear pair, without shafts
    speeds_rpm : slowest and fastest speed of interest [rpm]
    windows : speeds that were searched, (low, high) [rpm]: requested windows, and speeds to which branches
        led
    branches : motions of each window with motions, by speed
    open : speeds [rpm] at which the processor time did not suffice, or to which a branch that was not
        followed may lead: the motions found there are right, but there may be more
    seconds : processor time that was used [s]
    """

    pair: GearPair
    speeds_rpm: Range
    windows: tuple[Range, ...]
    branches: tuple[ResponseBranches, ...] = field(repr=False)
    open: tuple[Range, ...]
    seconds: float

    @cached_property
    def jumps(self) -> tuple[Jump, ...]:
        """Jumps of all windows by speed, see ``ResponseBranches.jumps``."""
        return tuple(sorted((j for one in self.branches for j in one.jumps), key=lambda j: j.speed_rpm))

    @cached_property
    def losses(self) -> tuple[Jump, ...]:
        """Losses of stability of all windows by speed, see ``ResponseBranches.losses``.

        Losses beyond which beats or chaos begin smoothly are included.
        """
        return tuple(sorted((j for one in self.branches for j in one.losses), key=lambda j: j.speed_rpm))

    @cached_property
    def attractors(self) -> tuple[GearAttractor, ...]:
        """Beats and chaos by speed, to which runs from other starts settled; empty without ``seeds``.

        See ``ResponseBranches.attractors``. ``losses`` has the beats and chaos after a loss of stability.
        """
        attractors = (attractor for one in self.branches for attractor in one.attractors)
        return tuple(sorted(attractors, key=lambda attractor: attractor.low_rpm))

    def at(self, speed_rpm: float) -> list[GearOrbit]:
        """All periodic motions that were found at a pinion speed [rpm], stable or not.

        The list is empty outside the windows: there the motion of the linear model keeps contact, and no
        other motion was found.
        """
        low, high = self.speeds_rpm
        if not low <= speed_rpm <= high:
            raise refuse("speed_rpm", speed_rpm, f"{low:g} to {high:g} rpm", "Search other speeds.")
        for one in self.branches:
            if one.speeds_rpm[0] <= speed_rpm <= one.speeds_rpm[1]:
                return one.at(speed_rpm)
        return []


def contact_loss_windows(sweep: xr.Dataset, speeds: Range) -> tuple[Range, ...]:
    """Speeds at which the motion of the linear model loses contact or is unstable, (low, high) [rpm].

    A window ends at the next speed of the sweep at which contact is kept. Between two speeds with contact the
    curve of the least load may still dip below zero. The slopes before and after the two speeds, extended
    between the speeds, show such a dip.

    Parameters
    ----------
    sweep : motion of the linear model over speed, from ``lumped.speed_sweep``
    speeds : slowest and fastest pinion speed [rpm], both covered by the sweep

    Raises
    ------
    ParameterError : speeds that are no range, or that the sweep does not cover
    """
    low, high = checked_range("speeds", speeds)
    order = np.argsort(sweep["speed"].to_numpy(), kind="stable")
    x, y, radius = (
        sweep[name].to_numpy()[order].astype(float)
        for name in ("speed", "normal_load_min", "spectral_radius")
    )
    if x.size < 2 or x[0] > low * (1.0 + 1e-9) or x[-1] < high * (1.0 - 1e-9):
        covered = f"{x[0]:g} to {x[-1]:g} rpm" if x.size else "no speed"
        raise refuse("speeds", f"{low:g} to {high:g} rpm", f"within the sweep: {covered}", "Sweep them all.")
    good = (y > 0.0) & (radius < 1.0)
    lost = ~(good[:-1] & good[1:])
    slope = np.diff(y) / np.diff(x)
    for j in map(int, np.flatnonzero(~lost[1:-1]) + 1):
        before = slope[j - 1]
        behind = slope[j + 1]
        if before < 0.0 < behind:
            # Where both lines meet.
            place = (y[j + 1] - y[j] + before * x[j] - behind * x[j + 1]) / (before - behind)
            lost[j] = x[j] < place < x[j + 1] and y[j] + before * (place - x[j]) <= 0.0
    return merged([(float(x[j]), float(x[j + 1])) for j in map(int, np.flatnonzero(lost))], (low, high))


@shows_progress("search for jumps")
@warned_once()
def search_jumps(
    pair: AnyPair,
    windows: Sequence[Range],
    *,
    seconds: float,
    seeds: int = 8,
    periods: Collection[int] = (1, 2, 3),
    speeds: Range | None = None,
    first: float | None = None,
    supports: Supports | None = None,
    progress: ProgressRequest = None,
) -> JumpSearch:
    """Search for jumps, beats and chaos where contact can be lost, within a limit of processor time.

    The most useful step comes first. The order is:

    - the window with ``first``, or the nearest window: the branch through the motion of the linear model, and
      runs from the places at which this branch loses stability
    - the other windows, and large motions of a resonance above the range, which reach down into the range
    - period doublings
    - motions of n cycles near large motions at 1/n of the speed
    - runs from other starts

    A branch that leads out of a window is followed until the motion is stable, keeps contact and is the
    linear motion again. The window grows by these speeds.

    The motions are as right as the motions of ``response_branches``. Outside the windows the search finds
    only motions of n cycles and motions to which branches lead. Two kinds of motions are not found: motions
    that attract no run, and isolated motions at speeds at which the linear motion keeps contact. The claim is
    "none found".

    Parameters
    ----------
    pair : the gear pair; teeth are alike, and loaded contact has the tangents of the static load
    windows : pinion speeds at which contact can be lost, (low, high) [rpm], see ``contact_loss_windows``
    seconds : processor time [s]; the first compilation of the search does not count
    seeds : speeds an octave at which 32 runs settle, for isolated motions, beats and chaos; 0: none
    periods : mesh cycles after which motions repeat
    speeds : slowest and fastest pinion speed of interest [rpm]; None: ``operating.speed_range``
    first : the pinion speed of most interest [rpm]; None: the operating speed
    supports : "springs": jumps are computed on springs alone; needed for a pair with shafts
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Raises
    ------
    ParameterError : windows or speeds that are no range, a time that is not positive, or shafts
    """
    progress = reported_to(progress)
    pair = on_springs(load_gear_pair(pair), supports, "search_jumps")
    low, high = speed_range(pair) if speeds is None else checked_range("speeds", speeds)
    requested = [checked_range(f"windows[{j}]", window) for j, window in enumerate(windows)]
    cycles = sorted({whole_number("periods", n, 1, MOST_CYCLES) for n in periods})
    seeds = whole_number("seeds", seeds, 0, 10_000)
    seconds = real_number("seconds", seconds, 0.0, above=True, unit="s")
    first_rpm = (
        operating_rpm(pair) if first is None else real_number("first", first, 0.0, above=True, unit="rpm")
    )
    cycle = pair.geometry.mesh_period * operating_rpm(pair)
    one = member(pair, low, high)
    above = min(high / _REACH, _BEYOND_RESONANCE * cycle * one.limits.frequency, LARGEST_SPEED)
    if above > high:
        one = member(pair, low, above)
    inside = tuple((max(a, low) / cycle, min(b, high) / cycle) for a, b in requested if a < high and b > low)
    one = replace(one, limits=replace(one.limits, calm=_as_linear(one, inside)))
    compile_kernels(one)
    deadline = Deadline(seconds)
    response = find_branches(
        one,
        periods=cycles,
        seeds=seeds,
        progress=progress,
        agenda=Agenda((low / cycle, high / cycle), inside, above / cycle, _REACH, first_rpm / cycle),
        deadline=deadline,
    )
    used = deadline.used
    range_rpm = (low, high)
    by_window = (
        ResponseBranches(pair, (a * cycle, b * cycle), False, _part(response, (a, b)), one)
        for a, b in response.windows
    )
    return JumpSearch(
        pair=pair,
        speeds_rpm=range_rpm,
        windows=within(response.windows, cycle, range_rpm),
        branches=tuple(one for one in by_window if one.branches),
        open=within(response.open, cycle, range_rpm),
        seconds=used,
    )


def _as_linear(one: Member, windows: tuple[Range, ...]) -> Callable[[Orbit], bool]:
    """Return the test whether a motion outside windows of 1/T is stable, always carries load, and is linear.

    A linear motion may differ a little from the motion of the linear model: a single tooth pair may lose
    contact while its load begins or ends gradually.
    """
    linear_orbits = dict[Orbit, bool]()

    def is_linear(orbit: Orbit) -> bool:
        start = one.start(orbit.period)[0]
        return bool((np.abs(orbit.start - start) <= _LINEAR * state_scale(start)).all())

    def calm(orbit: Orbit) -> bool:
        rate = 1.0 / orbit.period
        if any(a <= rate <= b for a, b in windows) or orbit.run.least_load <= 0.0 or not orbit.stable:
            return False
        if orbit not in linear_orbits:
            linear_orbits[orbit] = is_linear(orbit)
        return linear_orbits[orbit]

    return calm


def _part(response: Response, window: Range) -> Response:
    """The part of a response within a window of 1/T."""
    low, high = window
    return replace(
        response,
        branches=tuple(b for b in response.branches if b.rates.min() <= high and b.rates.max() >= low),
        settled=tuple((period, run) for period, run in response.settled if low <= 1.0 / period <= high),
        attractors=tuple(a for a in response.attractors if a.rates[0] <= high and a.rates[-1] >= low),
        windows=(window,),
        open=tuple(one for one in response.open if one[0] < high and one[1] > low),
    )
