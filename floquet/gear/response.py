"""Branches of periodic motions of a gear pair over speed, with unilateral contact.

Sources: docs/theory/orbits.md, "Branches".
"""

from __future__ import annotations

import contextlib
from collections.abc import Collection
from dataclasses import dataclass, field, fields
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from floquet.gear.axes import checked_range, depends_on_speed, operating_rpm, speed_range
from floquet.gear.motions import (
    JUMP,
    MOST_CYCLES,
    AttractorPoint,
    Basin,
    GearAttractor,
    GearOrbit,
    basins,
    end_rate,
    form_with,
    gear_attractor,
    label,
    largest_motion,
    peak_to_peak,
    start_of,
    static_deflection,
)
from floquet.gear.unilateral import ContactForm, unilateral_family
from floquet.orbits.bifurcations import Kind
from floquet.orbits.branch import Limits
from floquet.orbits.branch_search import STARTS, find_branches
from floquet.orbits.closing import closing_residual
from floquet.orbits.deadline import Deadline
from floquet.orbits.long_run import LongRun, Settled
from floquet.orbits.response import MARGINAL, Branch, Member, Response, lost_stability
from floquet.orbits.settling import settle
from lumped.arguments import real_number, whole_number
from lumped.display.progress import reported_to, shows_progress
from lumped.display.result import DisplayedResult
from lumped.errors import NumericalError
from lumped.labelling import Variable, labelled_dataset, provenance
from lumped.model.averaged import averaged_matrix
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import LTVSystem, Supports, on_springs
from lumped.ranges import warned_once
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, ProgressRequest

if TYPE_CHECKING:
    import xarray as xr

    from floquet.orbits.orbit import Orbit

#: Relative difference of speed and size within which two ends of motions are one end, and number of
#: neighbours by speed that are compared.
_SAME_END = 1e-7
_NEAR = 8
#: Part of the range that counts as a gap between stable motions.
_GAP = 5e-4


@dataclass(frozen=True, eq=False)
class GearBifurcation:
    """A bifurcation on a branch: `floquet.orbits.bifurcations.Bifurcation` at a speed.

    Attributes
    ----------
    kind : "fold", "period doubling", "Neimark-Sacker" or "grazing"
    speed_rpm : pinion speed [rpm]
    dte_rms : root mean square of the transmission error about its mean [m]
    n : mesh cycles of the motion
    sharp : whether the condition holds exactly at the point; False: a corner, where a contact begins to
        strike
    """

    kind: Kind
    speed_rpm: float
    dte_rms: float
    n: int
    sharp: bool


@dataclass(frozen=True)
class Jump:
    """A motion that ends as the speed rises or falls, and the motion just beyond the end.

    A motion of 0 mesh cycles does not repeat. The motion after is "periodic", "beats", "chaos" or "grows". A
    motion that grows is not followed: the results are NaN.
    """

    speed_rpm: float = field(metadata=label("rpm", "where a motion ends"))
    rising: bool = field(metadata=label("1", "on running up"))
    dte_rms: float = field(metadata=label("m", "dynamic transmission error before, rms"))
    dte_peak_to_peak: float = field(metadata=label("m", "dynamic transmission error before, peak to peak"))
    largest_load: float = field(metadata=label("N", "largest normal load before"))
    n: int = field(metadata=label("1", "mesh cycles before, 0 where it does not repeat"))
    dte_rms_after: float = field(metadata=label("m", "dynamic transmission error after, rms"))
    dte_peak_to_peak_after: float = field(
        metadata=label("m", "dynamic transmission error after, peak to peak")
    )
    largest_load_after: float = field(metadata=label("N", "largest normal load after"))
    after: Settled = field(metadata=label("1", "motion after"))
    n_after: int = field(metadata=label("1", "mesh cycles after, 0 where it does not repeat"))


@dataclass(frozen=True, eq=False, repr=False)
class ResponseBranches(DisplayedResult):
    """Periodic motions of a gear pair over speed.

    Attributes
    ----------
    pair : the gear pair, without shafts
    speeds_rpm : slowest and fastest speed [rpm]
    back_side : whether the back sides of the teeth touch
    response : motions that the search has found, over the period
    member : system, limits and starts of the search
    """

    shown: ClassVar = ("speeds_rpm", "branches", "contact_kept", "bifurcations", "back_side", "open")

    pair: GearPair
    speeds_rpm: tuple[float, float]
    back_side: bool
    response: Response = field(repr=False)
    member: Member = field(repr=False)

    @property
    def branches(self) -> tuple[Branch, ...]:
        """Curves of periodic motions; each has ``n``, ``orbits``, ``ends``."""
        return self.response.branches

    @property
    def contact_kept(self) -> bool:
        """Whether all motions, of branches and of runs, are stable and always carry some load."""
        orbits = [orbit for branch in self.branches for orbit in branch.orbits]
        ends = [run.orbit for _, run in self.response.settled]
        return bool(orbits) and all(
            o is not None and o.stable and o.run.least_load > 0.0 for o in orbits + ends
        )

    @property
    def open(self) -> tuple[tuple[float, float], ...]:
        """Speeds at which the processor time did not suffice, (low, high) [rpm]; empty without limit."""
        return within(self.response.open, self._cycle, self.speeds_rpm)

    @cached_property
    def _cycle(self) -> float:
        """Pinion speed times T [rpm s]."""
        return self.pair.geometry.mesh_period * operating_rpm(self.pair)

    def _rpm(self, orbit: Orbit) -> float:
        return self._cycle / orbit.period

    def _inside(self, rpm: float) -> bool:
        """Whether a speed is in the requested range. The search goes a little beyond this range."""
        return self.speeds_rpm[0] <= rpm <= self.speeds_rpm[1]

    @property
    def bifurcations(self) -> tuple[GearBifurcation, ...]:
        """Folds, period doublings, Neimark-Sacker points and grazing, in the order of the branches."""
        return tuple(
            GearBifurcation(b.kind, self._rpm(b.orbit), b.orbit.run.rms, branch.n, b.sharp)
            for branch in self.branches
            for b in branch.bifurcations
            if self._inside(self._rpm(b.orbit))
        )

    def at(self, speed_rpm: float) -> list[GearOrbit]:
        """All periodic motions that were found at a pinion speed [rpm], stable or not."""
        there = self.pair.with_({"operating.pinion_speed": speed_rpm})
        return [GearOrbit(there, orbit) for orbit in self.response.at(there.geometry.mesh_period)]

    @property
    def jumps(self) -> tuple[Jump, ...]:
        """Losses of stability at which the root mean square changes at once by a tenth or more."""
        return tuple(
            one for one in self.losses if not abs(one.dte_rms_after - one.dte_rms) < JUMP * one.dte_rms
        )

    @cached_property
    def losses(self) -> tuple[Jump, ...]:
        """Losses of stability and ends of motions, each with the motion beyond, with and without a jump.

        At every place at which a branch loses stability a run is started from the last motion, at a speed
        0.1 % beyond. The end of a motion that does not repeat is found within 0.1 % of the speed. A search
        with a limit of time leaves out the losses for which there was no time for a run. The speeds of these
        losses are in ``open``.
        """
        result = []
        for branch in self.branches:
            for b, behind in lost_stability(branch):
                last = b.orbit
                before = b.orbit.run
                run = self.response.behind.get(last)
                if not self._inside(self._rpm(last)) or (run is None and self.response.limited):
                    continue
                if run is None:
                    run = self.member.leads_to(last, behind)
                size = np.array([before.rms, before.least, before.most])
                rising = behind < last.period
                load = before.largest_load
                result.append(_jump(self._rpm(last), rising, size, load, branch.n, run))
        for one in self.response.attractors:
            for side, rising in enumerate((False, True)):
                end = one.ends[side]
                last_run = one.runs[-side]
                if end is not None and self._inside(self._cycle * end.rate):
                    n = last_run.orbit.n if last_run.orbit else 0
                    load = last_run.largest_load
                    result.append(_jump(self._cycle * end.rate, rising, end.size, load, n, end.after))
        result.sort(key=lambda jump: jump.speed_rpm)
        # A branch that was cut by the time may have been met again from another start.
        return tuple(
            one
            for j, one in enumerate(result)
            if not any(_same_end(one, other) for other in result[max(j - _NEAR, 0) : j])
        )

    @cached_property
    def attractors(self) -> tuple[GearAttractor, ...]:
        """Motions that do not repeat, beats and chaos, each over a range of speeds.

        Runs settle to these motions from the starts at the speeds of the search, or from a neighbouring
        speed.
        """
        losses = [
            (1.0 / b.orbit.period, b.orbit.run.rms)
            for branch in self.branches
            for b, _ in lost_stability(branch)
        ]
        result = list[GearAttractor]()
        slowest, fastest = self.speeds_rpm
        for one in self.response.attractors:
            low, high = (self._cycle * end_rate(one, side, losses) for side in (0, 1))
            if low < fastest and high > slowest:
                ends = max(low, slowest), min(high, fastest)
                result.append(gear_attractor(one, self._cycle, self.pair.geometry.normal_backlash, *ends))
        return tuple(result)

    def basins(self, speed_rpm: float | None = None, starts: int = 256, seed: int = 1) -> tuple[Basin, ...]:
        """Motions to which start states lead at a pinion speed [rpm], and the share of each motion.

        The start states differ from the linear motion at t = 0 in the transmission error and in the rate of
        the transmission error. Both differences are random and evenly distributed: the first from -8 to 5
        static deflections; the second up to 6.5 times the rate of a vibration of one static deflection at the
        fastest natural frequency.

        Parameters
        ----------
        speed_rpm : pinion speed [rpm]; None: the operating speed
        starts : number of start states, 1 to 100,000
        seed : seed of the random choice
        """
        rpm = operating_rpm(self.pair) if speed_rpm is None else speed_rpm
        self.pair.with_({"operating.pinion_speed": rpm})  # refuses what is no speed
        starts = whole_number("starts", starts, 1, 100_000)
        return basins(
            self.response, self.member, rpm / self._cycle, starts, whole_number("seed", seed, 0, 2**32)
        )

    @property
    def gaps(self) -> tuple[tuple[float, float], ...]:
        """Speeds for which no stable periodic motion was found, (low, high) [rpm]."""
        low, high = self.speeds_rpm
        stable = sorted(
            tuple(sorted(map(self._rpm, two)))
            for branch in self.branches
            for two in pairwise(branch.orbits)
            if max(orbit.spectral_radius for orbit in two) < MARGINAL
        )
        result = list[tuple[float, float]]()
        reached = low
        for start, end in [*stable, (high, high)]:
            if min(start, high) - reached > _GAP * (high - low):
                result.append((reached, min(start, high)))
            reached = max(reached, end)
        return tuple(result)

    @cached_property
    def dataset(self) -> xr.Dataset:
        """All orbits along ``point``, with the number of the branch; all jumps; all points of attractors."""
        rows = [(j, o) for j, branch in enumerate(self.branches) for o in branch.orbits]
        orbits = [o for _, o in rows]
        radius = np.array([o.spectral_radius for o in orbits])
        table: dict[str, Variable] = {
            name: ("point", np.asarray(values), unit, text)
            for name, values, unit, text in (
                ("branch", [j for j, _ in rows], "1", "branch"),
                ("n", [o.n for o in orbits], "1", "mesh cycles of the motion"),
                ("speed_rpm", [self._rpm(o) for o in orbits], "rpm", "pinion speed"),
                ("dte_rms", [o.run.rms for o in orbits], "m", "dynamic transmission error, rms"),
                ("dte_mean", [o.run.mean for o in orbits], "m", "dynamic transmission error, mean"),
                (
                    "dte_peak_to_peak", [o.run.most - o.run.least for o in orbits], "m",
                    "dynamic transmission error, peak to peak",
                ),
                ("largest_load", [o.run.largest_load for o in orbits], "N", "largest normal load"),
                ("spectral_radius", radius, "1", "spectral radius over n cycles"),
                ("stable", radius < MARGINAL, "1", "stable"),
                ("contact_lost", [o.contact_lost for o in orbits], "1", "contact loss"),
            )
        }  # fmt: skip
        for f in fields(Jump):
            values = [getattr(jump, f.name) for jump in self.jumps]
            table[f"jump_{f.name}"] = "jump", values, f.metadata["unit"], f.metadata["text"]
        points = [(j, point) for j, one in enumerate(self.attractors) for point in one.points]
        table["attractor"] = "attractor_point", [j for j, _ in points], "1", "motion that does not repeat"
        for f in fields(AttractorPoint):
            values = [getattr(point, f.name) for _, point in points]
            table[f"attractor_{f.name}"] = "attractor_point", values, f.metadata["unit"], f.metadata["text"]
        return labelled_dataset(
            table,
            {
                "attractor_point": (np.arange(len(points)), "1", "point"),
                "point": (np.arange(len(rows)), "1", "orbit"),
                "jump": (np.arange(len(self.jumps)), "1", "jump"),
            },
            provenance(self.pair)
            | {
                "model": "unilateral lumped",
                "supports": "springs",
                "speed_low_rpm": self.speeds_rpm[0],
                "speed_high_rpm": self.speeds_rpm[1],
                "operating_rpm": operating_rpm(self.pair),
            },
        )


@shows_progress("response branches")
@warned_once()
def response_branches(
    pair: AnyPair,
    speeds: tuple[float, float] | None = None,
    periods: Collection[int] = (1, 2, 3),
    *,
    seeds: int = 20,
    back_side: bool = False,
    supports: Supports | None = None,
    seconds: float | None = None,
    progress: ProgressRequest = None,
) -> ResponseBranches:
    """Branches of periodic motions over speed, stable and unstable, with their bifurcations.

    Teeth are alike, and loaded contact has the tangents of the static load, as in ``periodic_orbit``. The
    prediction is another motion, because the contact of the prediction follows the momentary load.

    The search finds branches through the motion of the linear model, branches of period doublings, branches
    to which runs settle, and motions that do not repeat. An isolated motion that attracts no run is not
    found. The speeds of the search depend on the pair's natural frequency, not on the range.

    Parameters
    ----------
    pair : the gear pair
    speeds : slowest and fastest pinion speed [rpm]; None: ``operating.speed_range``
    periods : mesh cycles after which motions repeat
    seeds : speeds an octave at which 32 runs settle, to find isolated branches and motions that do not
        repeat; 0: none
    back_side : whether the back sides of the teeth touch after the backlash; False:
        ``GearOrbit.reaches_back_side`` says for which motions the back sides would touch
    supports : "springs": branches are computed on springs alone; needed for a pair with shafts
    seconds : processor time that the search may use [s]; ``ResponseBranches.open`` has the speeds for which
        the time did not suffice; None: no limit
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Raises
    ------
    ParameterError : speeds that are no range, a time that is not positive, or shafts
    """
    progress = reported_to(progress)
    pair = on_springs(load_gear_pair(pair), supports, "response_branches")
    low, high = speed_range(pair) if speeds is None else checked_range("speeds", speeds)
    wanted = sorted({whole_number("periods", n, 1, MOST_CYCLES) for n in periods})
    seeds = whole_number("seeds", seeds, 0, 10_000)
    result = member(pair, low, high, form_with(back_side=back_side))
    limit = None if seconds is None else real_number("seconds", seconds, 0.0, above=True, unit="s")
    if limit is not None:
        compile_kernels(result)
    response = find_branches(result, periods=wanted, seeds=seeds, progress=progress, deadline=Deadline(limit))
    return ResponseBranches(pair, (low, high), back_side, response, result)


def _jump(rpm: float, rising: bool, size: FloatArray, load: float, n: int, after: LongRun) -> Jump:
    """A jump from a motion of a size (root mean square, least, most) to the motion ``after``."""
    rms, least, most = map(float, size)
    return Jump(
        speed_rpm=rpm,
        rising=rising,
        dte_rms=rms,
        dte_peak_to_peak=most - least,
        largest_load=load,
        n=n,
        dte_rms_after=after.rms,
        dte_peak_to_peak_after=peak_to_peak(after),
        largest_load_after=after.largest_load,
        after=after.kind,
        n_after=after.orbit.n if after.orbit else 0,
    )


def _same_end(one: Jump, other: Jump) -> bool:
    """Whether two losses of stability are the same loss."""
    pairs = (one.speed_rpm, other.speed_rpm), (one.dte_rms, other.dte_rms)
    return (one.rising, one.n) == (other.rising, other.n) and all(
        abs(a - b) <= _SAME_END * a for a, b in pairs
    )


def within(
    rates: tuple[tuple[float, float], ...], cycle: float, speeds_rpm: tuple[float, float]
) -> tuple[tuple[float, float], ...]:
    """Ranges of 1/T as ranges of the pinion speed [rpm], cut to the requested speeds."""
    low, high = speeds_rpm
    ranges = [(max(cycle * one, low), min(cycle * two, high)) for one, two in rates]
    return tuple((one, two) for one, two in ranges if one < two)


def compile_kernels(one: Member) -> None:
    """Compile all kernels by one call of each. Compilation then does not count as time of a search."""
    rate = one.limits.fastest
    state, parameter = one.start(1.0 / rate)
    with contextlib.suppress(NumericalError):
        closing_residual(one.family.at(1.0 / rate), state, 1.0 / rate, 1, parameter)
    settle(one.family, one.limits, state[None], np.array([1.0 / rate]), np.array([parameter]))


def member(pair: GearPair, low: float, high: float, form: ContactForm = "mesh") -> Member:
    """System, limits and starts of a gear pair for the search for branches from ``low`` to ``high`` [rpm].

    The range is extended to speeds of the grid. The motions found at a speed then hardly depend on the range.
    """
    cycle = pair.geometry.mesh_period * operating_rpm(pair)
    frequency = _natural_frequency(pair)
    steps = STARTS * np.log2(np.array([low, high]) / (cycle * frequency))
    slowest, fastest = frequency * 2.0 ** (np.array([np.floor(steps[0]), np.ceil(steps[1])]) / STARTS)
    limits = Limits(
        slowest=float(slowest),
        fastest=float(fastest),
        length=static_deflection(pair),
        parameter=pair.operating.pinion_torque,
        amplitude=largest_motion(pair),
        frequency=frequency,
    )
    elements = None if depends_on_speed(pair) else MeshCycle.of(pair).elements
    return Member(
        unilateral_family(pair, float(slowest * cycle), float(fastest * cycle), form),
        limits,
        lambda period: start_of(pair.with_({"operating.pinion_speed": cycle / period}), None, form, elements),
    )


def _natural_frequency(pair: GearPair) -> float:
    """The fastest natural frequency of the averaged pair while contact holds [Hz]."""
    matrix = averaged_matrix(LTVSystem.of(pair, "mesh", supports="springs"))
    return float(np.abs(np.linalg.eigvals(matrix)).max() / (2.0 * np.pi))
