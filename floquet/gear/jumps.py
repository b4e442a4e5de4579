"""Where a gear pair can jump, over speed and torque, damping or tip relief, and what removes the jumps.

Sources: docs/theory/orbits.md, "Jump maps", "Fold curves".
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.interpolate import PchipInterpolator

from floquet.engine.chart import Axes, checked_axes
from floquet.gear.axes import GEAR_AXES, GearAxis, GearVariation, operating_rpm
from floquet.gear.motions import JUMP
from floquet.gear.response import ResponseBranches, member
from floquet.gear.unilateral import unilateral_family
from floquet.orbits.branch import Continuation, Family, Limits
from floquet.orbits.branch_search import find_branches, find_branches_of_stack
from floquet.orbits.folds import FoldContinuation
from floquet.orbits.orbit import Orbit
from floquet.orbits.response import MARGINAL, Branch, Member, Response, lost_stability
from lumped.arguments import one_of, real_array, whole_number
from lumped.display.progress import reported_to, shows_progress
from lumped.errors import NumericalError, refuse
from lumped.fields.units import SIValue, to_stated
from lumped.labelling import Variable, labelled_dataset, provenance
from lumped.model.periodic_system import Supports, on_springs
from lumped.ranges import warned_once
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray, IntArray, ProgressRequest

if TYPE_CHECKING:
    import xarray as xr

    from floquet.orbits.system import Run

#: Points between two motions of a branch, by the monotone cubic through all.
_BETWEEN = 6
#: Cycles for which a run settles, and cycles for which it is observed, where no stable motion is found.
_SETTLE = 40
_OBSERVE = 60
#: Cycles for which a run settles beyond a place at which a motion loses stability.
_BEHIND = 300
_LARGEST = 1_000_000
#: Rounding of a load, over the largest load.
_NO_LOAD = 1e-9
#: Part of the range by which the last fold is passed before all branches are followed again; doubled each
#: time.
_BEYOND = 1e-3
_MOST_ROUNDS = 10
#: Least value of an axis, over the lower end of the range. Steps and differences may leave the range, but not
#: the axis.
_LEAST = 1e-3

#: Variable of the map, field of a row, unit, name.
_OVER_SPEED = (
    ("motions", "motions", "1", "stable periodic motions"),
    ("contact_kept", "contact", "1", "always some tooth load"),
    ("dte_rms_smallest", "smallest", "m", "smallest dynamic transmission error, rms"),
    ("dte_rms_largest", "largest", "m", "largest dynamic transmission error, rms"),
    ("largest_load", "load", "N", "largest normal load"),
)
#: Field of a jump, unit, name.
_OF_JUMPS = (
    ("speed_rpm", "rpm", "where a stable motion ends"),
    ("rising", "1", "on running up"),
    ("dte_rms", "m", "rms before the jump"),
    ("dte_rms_after", "m", "rms behind the jump"),
    ("n", "1", "mesh cycles of the motion before"),
)


def _with_relief(variation: GearVariation, micrometres: float) -> GearVariation:
    amount = SIValue(1e-6 * micrometres, "m")
    changes = {f"{name}.tip_relief.amount": amount for name in _relieved(variation.pair)}
    return replace(variation, pair=variation.pair.with_(changes))


def _relieved(pair: GearPair) -> list[str]:
    """Gears whose tip relief acts. A pair without such a gear is refused."""
    result = [name for name in ("pinion", "gear") if getattr(pair, name).tip_relief is not None]
    if pair.mesh.relief == "ignored" or not result:
        value = "a pair whose relief is ignored" if result else "a pair without tip relief"
        action = 'Give pinion.tip_relief or gear.tip_relief, and mesh.relief = "static".'
        raise refuse("axes['tip_relief']", value, "a pair with tip relief that acts", action)
    return result


def _own_relief(pair: GearPair) -> float:
    return to_stated(max(getattr(pair, name).tip_relief.amount for name in _relieved(pair)), "um")


#: Second axes of a jump map, beside the speed. Tip relief is the amount on all gears with tip relief.
JUMP_AXES: Mapping[str, GearAxis] = {
    "torque": GEAR_AXES["torque"],
    "damping_ratio": GEAR_AXES["damping_ratio"],
    "tip_relief": GearAxis("um", "amount of tip relief", _with_relief, _own_relief, low=0.0, high=1000.0),
}


def pair_at(pair: GearPair, axis: str, value: float) -> GearPair:
    return JUMP_AXES[axis].apply(GearVariation(pair, supports="springs"), value).pair


@shows_progress("map of jumps")
@warned_once()
def jump_map(
    pair: AnyPair,
    axes: Axes,
    periods: Collection[int] = (1, 2),
    *,
    seeds: int = 0,
    supports: Supports | None = None,
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Map of motions with unilateral contact, and of jumps between motions, over speed and a second axis.

    The motions are the motions of ``periodic_orbit``: teeth are alike, and loaded contact has the tangents of
    the static load.

    For each value of the second axis all branches over speed are followed, from the motions of the linear
    model and from the motions at neighbouring values. Between the motions on a branch the results are
    interpolated (monotone cubics along the branch). Folds and other bifurcations are among these motions.

    Parameters
    ----------
    pair : the gear pair
    axes : name -> values, "speed_rpm" and one of `JUMP_AXES`: torque [N m], damping_ratio (mesh) or
        tip_relief, the amount [um] on all gears with tip relief; at most a million points
    periods : mesh cycles after which motions repeat
    seeds : speeds at which runs settle for each value, to find isolated branches
    supports : "springs": the map is computed on springs alone; needed for a pair with shafts
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    xarray.Dataset over the second axis and speed_rpm: ``motions``, the number of stable periodic motions;
    ``contact_kept``, whether in all these motions some tooth pair carries load at every moment;
    ``dte_rms_smallest``, ``dte_rms_largest`` and ``largest_load`` of these motions.
    Where ``motions`` is 0, at beats, chaos or motions of more cycles, the values are the values of a run; NaN
    where the run grows beyond twice the backlash and 30 static deflections. Over ``jump``: the places at
    which a stable motion ends and the root mean square changes at once by a tenth or more, as
    `ResponseBranches.jumps`.

    Raises
    ------
    ParameterError : unknown axis, values outside its range, too many points, a pair without tip relief,
        or shafts
    """
    progress = reported_to(progress)
    pair = on_springs(load_gear_pair(pair), supports, "jump_map")
    name, grid = _checked(pair, axes)
    wanted = sorted({whole_number("periods", n, 1, 64) for n in periods})
    seeds = whole_number("seeds", seeds, 0, 10_000)
    speeds, values = (np.sort(grid[key]) for key in ("speed_rpm", name))
    ends = float(speeds[0]), float(speeds[-1])
    members = [member(pair_at(pair, name, float(value)), *ends) for value in values]
    cycle = pair.geometry.mesh_period * operating_rpm(pair)

    def report(done: float, text: str = "", /) -> None:
        if progress is not None:
            progress(done)

    stack = find_branches_of_stack(
        members, periods=wanted, seeds=seeds, progress=lambda done, text="", /: report(0.8 * done)
    )
    rows = list[_Row]()
    jumps = list[tuple[float, ...]]()
    for j, (one, response, value) in enumerate(zip(members, stack, values, strict=True)):
        rows.append(_Row(one, response, speeds, cycle))
        jumps += [(float(value), *jump) for jump in _jumps(one, response, cycle)]
        report(0.8 + 0.2 * (j + 1) / values.size)
    dataset = _dataset(name, values, speeds, rows, jumps)
    dataset.attrs.update(
        **provenance(pair),
        supports="springs",
        title=f"jump map of {pair.name}",
        model="unilateral lumped",
        friction_law=pair.friction.law,
        operating_rpm=operating_rpm(pair),
        operating_value=JUMP_AXES[name].own(pair),
    )
    return dataset.sel({name: grid[name], "speed_rpm": grid["speed_rpm"]})


def _checked(pair: GearPair, axes: Axes) -> tuple[str, dict[str, FloatArray]]:
    """Name of the second axis, and the values of both."""
    grid = checked_axes(axes)
    others = [name for name in grid if name != "speed_rpm"]
    if len(grid) != 2 or len(others) != 1 or others[0] not in JUMP_AXES:
        raise refuse(
            "axes", ", ".join(grid), f"speed_rpm and one of {', '.join(JUMP_AXES)}", "Give these two."
        )
    name = others[0]
    speeds = grid["speed_rpm"]
    checked_axis(pair, name)
    JUMP_AXES[name].check(name, grid[name])
    GEAR_AXES["speed_rpm"].check("speed_rpm", speeds)
    if speeds.size < 2:
        raise refuse("axes['speed_rpm']", "one speed", "two or more", "Branches are followed over speed.")
    points = grid[name].size * speeds.size
    if points > _LARGEST:
        raise refuse("points of the map", points, f"at most {_LARGEST}", "Give the axes smaller counts.")
    for rpm in (speeds.min(), speeds.max()):
        pair.with_({"operating.pinion_speed": float(rpm)})
    return name, grid


def checked_axis(pair: GearPair, name: str, field: str = "axis") -> None:
    """Refuse an axis that does not exist, or tip relief of a pair that has none."""
    one_of(field, name, JUMP_AXES)
    JUMP_AXES[name].own(pair)


class _Row:
    """Results of the map at k speeds, for one value of the second axis."""

    def __init__(self, one: Member, response: Response, speeds: FloatArray, cycle: float) -> None:
        self.motions = np.zeros(speeds.size, dtype=int)
        self.contact = np.ones(speeds.size, dtype=bool)
        self.smallest, self.largest, self.load = np.full((3, speeds.size), [[np.inf], [-np.inf], [-np.inf]])
        for branch in response.branches:
            _add(self, branch, speeds, cycle)
        empty = np.flatnonzero(self.motions == 0)
        if empty.size:
            for group in np.split(empty, np.flatnonzero(np.diff(empty) > 1) + 1):
                _run_through(self, group, one, response, speeds, cycle)


def _add(row: _Row, branch: Branch, speeds: FloatArray, cycle: float) -> None:
    """Enter the stable motions of a branch at the speeds."""
    orbits = branch.orbits
    starts = np.array([orbit.start for orbit in orbits])
    places = np.column_stack([starts / np.abs(starts).max(axis=0), cycle * branch.rates / np.ptp(speeds)])
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    apart = np.concatenate([[True], np.diff(s) > 1e-12 * s[-1]])
    table = np.array([(cycle / o.period, o.run.rms, o.run.largest_load) for o in orbits])[apart]
    s = s[apart]
    distinct = [orbit for orbit, new in zip(orbits, apart, strict=True) if new]
    if s.size < 2:
        return
    fine = np.interp(np.arange(_BETWEEN * (s.size - 1) + 1) / _BETWEEN, np.arange(s.size), s)
    speed, rms, load = PchipInterpolator(s, table)(fine).T
    radius = np.array([orbit.spectral_radius for orbit in distinct])
    stable = np.repeat(np.maximum(radius[:-1], radius[1:]) < MARGINAL, _BETWEEN)
    lost = np.repeat(_contact_lost(branch, distinct), _BETWEEN)
    direction = np.where(stable, np.sign(np.diff(speed)), 0.0)
    for piece in np.split(np.arange(direction.size), np.flatnonzero(np.diff(direction)) + 1):
        if direction[piece[0]] == 0.0:
            continue
        points = np.arange(piece[0], piece[-1] + 2)
        if direction[piece[0]] < 0.0:
            points = points[::-1]
            piece = piece[::-1]
        low, high = np.searchsorted(speeds, speed[points[[0, -1]]])
        covered = slice(low, high)
        if low == high:
            continue
        row.motions[covered] += 1
        values = np.interp(speeds[covered], speed[points], rms[points])
        loads = np.interp(speeds[covered], speed[points], load[points])
        row.smallest[covered] = np.minimum(row.smallest[covered], values)
        row.largest[covered] = np.maximum(row.largest[covered], values)
        row.load[covered] = np.maximum(row.load[covered], loads)
        between = np.searchsorted(speed[points], speeds[covered], side="right") - 1
        row.contact[covered] &= ~lost[piece][np.clip(between, 0, piece.size - 1)]


def _contact_lost(branch: Branch, orbits: list[Orbit]) -> BoolArray:
    """Whether contact is lost between each motion and the next motion.

    A motion at grazing does not count, because rounding decides there.
    """
    grazing = {id(b.orbit) for b in branch.bifurcations if b.kind == "grazing"}
    lost = np.array([_without_load(orbit.run) and id(orbit) not in grazing for orbit in orbits])
    return np.asarray(lost[:-1] | lost[1:])


def _without_load(run: Run) -> bool:
    """Whether there is a moment at which no tooth pair carries load."""
    return run.least_load <= _NO_LOAD * run.largest_load


def _run_through(
    row: _Row, group: IntArray, one: Member, response: Response, speeds: FloatArray, cycle: float
) -> None:
    """Enter the results of a run that continues from speed to speed, where no stable motion is found."""
    first = cycle / float(speeds[group[0]])
    stable = [o for b in response.branches for o in b.orbits if o.spectral_radius < MARGINAL]
    if stable:
        nearest = min(stable, key=lambda orbit: abs(orbit.period - first))
        state = nearest.start
        parameter = nearest.parameter
    else:
        state, parameter = one.start(first)
    settle = _BEHIND
    for j in group:
        run = _observed(one, state, cycle / float(speeds[j]), parameter, settle)
        if run is None:
            row.smallest[j] = row.largest[j] = row.load[j] = np.nan
            row.contact[j] = False
            continue
        row.smallest[j] = row.largest[j] = run.rms
        row.load[j] = run.largest_load
        row.contact[j] = not _without_load(run)
        state = run.end
        settle = _SETTLE


def _observed(one: Member, start: FloatArray, period: float, parameter: float, settle: int) -> Run | None:
    """The settled run; None where the run grows beyond the largest motion that is followed."""
    system = one.family.at(period)
    try:
        settled = system.run(start, period, settle, parameter)
        run = system.run(settled.end, period, _OBSERVE, parameter)
    except NumericalError:
        return None
    return None if max(run.most - run.mean, run.mean - run.least) > one.limits.amplitude else run


def _jumps(one: Member, response: Response, cycle: float) -> list[tuple[float, ...]]:
    """Where the root mean square changes at once on running up or down: rows of `_OF_JUMPS`."""
    result = []
    for branch in response.branches:
        for b, behind in lost_stability(branch):
            before = b.orbit.run.rms
            run = _observed(one, b.orbit.start, behind, b.orbit.parameter, _BEHIND)
            after = np.nan if run is None else run.rms
            if run is None or abs(after - before) >= JUMP * before:
                rising = behind < b.orbit.period
                result.append((cycle / b.orbit.period, rising, before, after, branch.n))
    return sorted(result)


def _dataset(
    name: str, values: FloatArray, speeds: FloatArray, rows: list[_Row], jumps: list[tuple[float, ...]]
) -> xr.Dataset:
    axis = JUMP_AXES[name]
    both = (name, "speed_rpm")
    table: dict[str, Variable] = {
        label: (both, np.array([getattr(row, field) for row in rows]), unit, text)
        for label, field, unit, text in _OVER_SPEED
    }
    for k, (field, unit, text) in enumerate(((name, axis.units, axis.long_name), *_OF_JUMPS)):
        table[f"jump_{field}"] = "jump", [jump[k] for jump in jumps], unit, text
    return labelled_dataset(
        table,
        {
            name: (values, axis.units, axis.long_name),
            "speed_rpm": (speeds, "rpm", "pinion speed"),
            "jump": (np.arange(len(jumps)), "1", "jump"),
        },
    )


@dataclass(frozen=True)
class JumpRemoval:
    """The value of a parameter, nearest to the pair's value, at which stable motions have no folds.

    Attributes
    ----------
    axis : name out of `JUMP_AXES`
    direction : "larger" or "smaller" values than the pair's value
    own : value of the pair, in the units of the axis
    limit : end of the range that was searched
    value : the value; NaN: there are folds up to the limit
    error : half the width of an interval with folds at one end and without folds at the other end
    speed_rpm : speed at which the last folds meet or leave the range of speeds [rpm]; NaN where ``value`` is
    """

    axis: str
    direction: Literal["larger", "smaller"]
    own: float
    limit: float
    value: float
    error: float
    speed_rpm: float

    @property
    def found(self) -> bool:
        """Whether there is such a value within the range."""
        return bool(np.isfinite(self.value))


def jumps_removed_by(
    branches: ResponseBranches, axis: str, within: tuple[float, float] | None = None
) -> tuple[JumpRemoval, ...]:
    """Values of a parameter above and below the pair's value, beyond which stable motions have no folds.

    The curve of each fold over the parameter is followed until two folds meet (a cusp, or an island that
    shrinks to a point) or leave the range of speeds. Beyond the last fold all branches are followed again,
    and so are the folds on these branches.

    Parameters
    ----------
    branches : motions of the pair over a range of speeds
    axis : name out of `JUMP_AXES`
    within : range to search, with the pair's value v; None: v/4 to 4 v for torque, v to 4 v, at least to 0.2,
        for damping, 0 to 3 v for tip relief

    Returns
    -------
    One result for larger values and one for smaller values, if the range has such values; empty where the
    pair has no folds.

    Raises
    ------
    ParameterError : unknown axis, a pair without tip relief, or a range without the pair's value
    """
    checked_axis(branches.pair, axis)
    pair_value = float(JUMP_AXES[axis].own(branches.pair))
    low, high = search_range(axis, pair_value, within)
    if not _folds(branches.response):
        return ()
    search = _Removal(branches, axis, low, high)
    limits: list[tuple[Literal["larger", "smaller"], float]] = [("larger", high), ("smaller", low)]
    return tuple(
        JumpRemoval(axis, direction, pair_value, limit, *search.beyond(pair_value, limit))
        for direction, limit in limits
        if limit != pair_value
    )


def search_range(
    axis: str, pair_value: float, within: tuple[float, float] | None = None
) -> tuple[float, float]:
    """Default range of an axis for searches and maps, in units of the axis.

    ``within`` replaces the default.
    """
    if within is None:
        return {
            "torque": (0.25 * pair_value, 4.0 * pair_value),
            "damping_ratio": (pair_value, min(1.0, max(0.2, 4.0 * pair_value))),
            "tip_relief": (0.0, 3.0 * pair_value),
        }[axis]
    request = np.atleast_1d(real_array("within", within))
    if request.size != 2 or not request[0] <= pair_value <= request[1] or request[0] == request[1]:
        allowed = f"a range around the pair's own value, {pair_value:g}"
        raise refuse("within", within, allowed, "Give (low, high).")
    JUMP_AXES[axis].check(axis, request)
    return float(request[0]), float(request[1])


def _folds(response: Response) -> list[tuple[int, Orbit]]:
    """Number of cycles and motion of each fold at which a stable motion ends."""
    ends = [(branch.n, b) for branch in response.branches for b, _ in lost_stability(branch)]
    return [(n, b.orbit) for n, b in ends if b.kind == "fold"]


class _Removal:
    """The search along one axis."""

    def __init__(self, branches: ResponseBranches, axis: str, low: float, high: float) -> None:
        self.branches = branches
        self.axis = axis
        self.low = low
        self.high = high
        self.cycle = branches.pair.geometry.mesh_period * operating_rpm(branches.pair)
        self.periods = {branch.n for branch in branches.branches}
        self.limits = member(branches.pair, *branches.speeds_rpm).limits
        self.at = lru_cache(maxsize=32)(self._at)

    def varied(self, value: float) -> GearPair:
        """The pair at a value, or at the end of the axis next to it."""
        axis = JUMP_AXES[self.axis]
        inside = float(np.clip(value, max(axis.low, _LEAST * self.low), axis.high))
        return pair_at(self.branches.pair, self.axis, inside)

    def _at(self, value: float) -> tuple[Family, Limits]:
        varied = self.varied(value)
        limits = self.limits
        ratio = varied.operating.pinion_torque / self.branches.pair.operating.pinion_torque
        scaled = replace(limits, length=limits.length * ratio, parameter=limits.parameter * ratio)
        return unilateral_family(varied, *self.branches.speeds_rpm), scaled

    def beyond(self, pair_value: float, limit: float) -> tuple[float, float, float]:
        """Value, error and speed [rpm] of a `JumpRemoval` between the pair's value and a limit."""
        sign = float(np.sign(limit - pair_value))
        margin = _BEYOND * (self.high - self.low)
        value = pair_value
        folds = _folds(self.branches.response)
        for _ in range(_MOST_ROUNDS):
            last, speed = max((self._end(*fold, value, sign) for fold in folds), key=lambda x: x[0] * sign)
            value = last + sign * margin
            if (limit - value) * sign <= 0.0:
                break
            varied = member(self.varied(value), *self.branches.speeds_rpm)
            folds = _folds(find_branches(varied, periods=self.periods, seeds=0))
            if not folds:
                return value - 0.5 * sign * margin, 0.5 * margin, speed
            margin *= 2.0
        return float("nan"), float("nan"), float("nan")

    def _end(self, n: int, orbit: Orbit, value: float, sign: float) -> tuple[float, float]:
        """Value and speed [rpm] at the end of a fold's curve."""

        def along(value: float) -> Continuation:
            family, limits = self.at(value)
            return Continuation(family, n, limits)

        try:
            curve = FoldContinuation(along, self.low, self.high).follow(value, orbit, sign)
        except NumericalError:
            return value, self.cycle / orbit.period
        fold = max(curve.points, key=lambda point: point.value * sign)
        return fold.value, self.cycle / fold.orbit.period
