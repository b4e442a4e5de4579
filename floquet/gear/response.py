"""Branches of periodic motions of a gear pair over speed, where teeth may part.

Sources: docs/theory/orbits.md, "Branches".
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from floquet.gear.axes import checked_range, operating_rpm, speed_range
from floquet.gear.friction_over_speed import depends_on_speed
from floquet.gear.orbit import (
    MOST_CYCLES,
    GearOrbit,
    form_with,
    largest_motion,
    start_of,
    static_deflection,
)
from floquet.gear.orbit import long_run as settled_run
from floquet.gear.unilateral import ContactForm, unilateral_family
from floquet.orbits.bifurcations import Bifurcation, Kind
from floquet.orbits.branch import Limits
from floquet.orbits.long_run import Settled, long_run
from floquet.orbits.response import Branch, Member, Response, find_response
from lumped.arguments import whole_number
from lumped.labelling import Variable, labelled_dataset
from lumped.quasi_static.contacts import mesh_elements
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import Progress

if TYPE_CHECKING:
    import xarray as xr

#: Part of the speed behind a bifurcation where a run shows what happens there.
_BEYOND = 1e-3
_SETTLE = 400
_CORNER = 1e-6
#: Change of the root mean square that is a jump.
JUMP = 0.1
#: A bifurcation has a multiplier of modulus one but for rounding: it belongs to the stable motions before it.
MARGINAL = 1.0 + 1e-6
#: Part of the range that counts as a gap between stable motions.
_GAP = 5e-4
_JUMP_COLUMNS = (
    ("speed_rpm", "rpm", "where a stable motion ends"),
    ("rising", "1", "on running up"),
    ("dte_rms", "m", "dynamic transmission error before, rms"),
    ("dte_rms_after", "m", "dynamic transmission error after, rms"),
    ("largest_load", "N", "largest normal load before"),
    ("largest_load_after", "N", "largest normal load after"),
    ("n", "1", "mesh cycles before"),
    ("n_after", "1", "mesh cycles after, 0 where it does not repeat"),
    ("after", "1", "motion after"),
)


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


@dataclass(frozen=True)
class Jump:
    """A stable motion that ends as the speed rises or falls, and what the pair does right behind.

    Attributes
    ----------
    speed_rpm : where the motion loses its stability [rpm]
    rising : whether on running up
    dte_rms, largest_load : before, of the motion that ends [m], [N]
    n : its mesh cycles
    dte_rms_after, largest_load_after : behind; NaN where the motion grows beyond what is followed
    after : "periodic", "beats", "chaos" or "grows"
    n_after : mesh cycles of the periodic motion behind, else 0
    """

    speed_rpm: float
    rising: bool
    dte_rms: float
    largest_load: float
    n: int
    dte_rms_after: float
    largest_load_after: float
    after: Settled
    n_after: int


@dataclass(frozen=True)
class Restless:
    """Speeds at which no stable periodic motion was found, and what a run does in the middle of them.

    Attributes
    ----------
    low_rpm, high_rpm : [rpm]
    kind : "beats", "chaos" or "grows"; "periodic" where the motion has more cycles than were looked for
    n : mesh cycles of that, else 0
    dte_rms : of the run [m]
    exponent, uncertainty : Lyapunov exponent per mesh cycle and its standard error
    """

    low_rpm: float
    high_rpm: float
    kind: Settled
    n: int
    dte_rms: float
    exponent: float
    uncertainty: float


@dataclass(frozen=True, eq=False)
class ResponseBranches:
    """Periodic motions of a gear pair over speed.

    Attributes
    ----------
    pair : the gear pair
    speeds_rpm : slowest and fastest speed [rpm]
    back_side : whether the back sides of the teeth touch
    response : what the search found, over the period
    """

    pair: GearPair
    speeds_rpm: tuple[float, float]
    back_side: bool
    response: Response = field(repr=False)

    @property
    def branches(self) -> tuple[Branch, ...]:
        """Curves of periodic motions; each has ``n``, ``orbits``, ``ends``."""
        return self.response.branches

    @property
    def contact_kept(self) -> bool:
        """Whether all motions found, and all that runs came to, are stable and always carry some load."""
        orbits = [orbit for branch in self.branches for orbit in branch.orbits]
        ends = [run.orbit for _, run in self.response.settled]
        return bool(orbits) and all(
            o is not None and o.stable and o.run.least_load > 0.0 for o in orbits + ends
        )

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
    def jumps(self) -> tuple[Jump, ...]:
        """Where the root mean square changes at once by a tenth or more, on running up and down.

        At every place where a branch loses stability a run is started from the last motion, 0.1 % of the
        speed further on.
        """
        places = (self._jump(branch, b) for branch in self.branches for b in branch.bifurcations)
        return tuple(sorted((jump for jump in places if jump is not None), key=lambda jump: jump.speed_rpm))

    def _jump(self, branch: Branch, b: Bifurcation) -> Jump | None:
        behind = period_behind(branch, b)
        if behind is None:
            return None
        rising, period = behind < b.orbit.period, behind
        run = long_run(
            branch.family.at(period), b.orbit.start, period, b.orbit.parameter,
            settle=_SETTLE, amplitude=largest_motion(self.pair),
        )  # fmt: skip
        if abs(run.rms - b.orbit.run.rms) < JUMP * b.orbit.run.rms:
            return None
        return Jump(
            speed_rpm=self._cycle_at_1_rpm / b.orbit.period,
            rising=rising,
            dte_rms=b.orbit.run.rms,
            largest_load=b.orbit.run.largest_load,
            n=branch.n,
            dte_rms_after=run.rms,
            largest_load_after=run.largest_load,
            after=run.kind,
            n_after=run.orbit.n if run.orbit else 0,
        )

    @cached_property
    def restless(self) -> tuple[Restless, ...]:
        """What a run does in ``gaps``."""
        return tuple(self._restless(*gap) for gap in self.gaps)

    @property
    def gaps(self) -> tuple[tuple[float, float], ...]:
        """Speeds without a stable periodic motion among those that were found, (low, high) [rpm]."""
        low, high = self.speeds_rpm
        calm = sorted(
            tuple(sorted(self._cycle_at_1_rpm / orbit.period for orbit in two))
            for branch in self.branches
            for two in pairwise(branch.orbits)
            if max(orbit.spectral_radius for orbit in two) < MARGINAL
        )
        found, reached = list[tuple[float, float]](), low
        for start, end in [*calm, (high, high)]:
            if start - reached > _GAP * (high - low):
                found.append((reached, start))
            reached = max(reached, end)
        return tuple(found)

    def _restless(self, low: float, high: float) -> Restless:
        there = self.pair.with_({"operating.pinion_speed": 0.5 * (low + high)})
        run = settled_run(there, back_side=self.back_side)
        return Restless(
            low, high, run.kind, run.orbit.n if run.orbit else 0, run.rms, run.exponent, run.uncertainty
        )

    @cached_property
    def dataset(self) -> xr.Dataset:
        """All orbits in a row, ``branch`` saying which belong together, and all jumps."""
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
                "stable": column([o.spectral_radius < MARGINAL for o in orbits], "1", "stable"),
                "parts": column([o.parts for o in orbits], "1", "teeth part"),
            }
            | {
                f"jump_{name}": ("jump", [getattr(jump, name) for jump in self.jumps], unit, text)
                for name, unit, text in _JUMP_COLUMNS
            },
            {
                "point": (np.arange(len(rows)), "1", "orbit"),
                "jump": (np.arange(len(self.jumps)), "1", "jump"),
            },
            {"model": "unilateral lumped", "speed_low_rpm": self.speeds_rpm[0]}
            | {"speed_high_rpm": self.speeds_rpm[1], "operating_rpm": operating_rpm(self.pair)},
        )


def response_branches(
    pair: AnyPair,
    speeds: tuple[float, float] | None = None,
    periods: Collection[int] = (1, 2, 3),
    *,
    seeds: int = 40,
    back_side: bool = False,
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
    back_side : whether the back sides of the teeth touch after the backlash; motions that need it say so
        without it (``GearOrbit.reaches_back_side``)
    progress : called with the finished fraction

    Raises
    ------
    ParameterError : speeds that are no range
    """
    pair = load_gear_pair(pair)
    low, high = speed_range(pair) if speeds is None else checked_range("speeds", speeds)
    wanted = sorted({whole_number("periods", n, 1, MOST_CYCLES) for n in periods})
    seeds = whole_number("seeds", seeds, 0, 10_000)
    found = member(pair, low, high, form_with(back_side=back_side))
    response = find_response(
        found.family, found.limits, found.start, periods=wanted, seeds=seeds, progress=progress
    )
    return ResponseBranches(pair, (low, high), back_side, response)


def period_behind(branch: Branch, b: Bifurcation) -> float | None:
    """T 0.1 % of the speed behind a place where a branch loses its stability; None where it does not."""
    at = branch.orbits.index(b.orbit)
    if b.kind == "grazing" or not 0 < at < len(branch.orbits) - 1:
        return None
    sides = (branch.orbits[at - 1], branch.orbits[at + 1])
    stable = [orbit.stable for orbit in sides]
    if stable[0] == stable[1]:
        return None
    way = 1 if stable[1] else -1
    # A corner is not the extreme of the speed to the last digit.
    calm = (o.period / b.orbit.period for o in branch.orbits[at + way :: way])
    ratio = next((ratio for ratio in calm if abs(ratio - 1.0) > _CORNER), 1.0)
    if ratio == 1.0:
        return None
    rising = ratio > 1.0
    return b.orbit.period * (1.0 - _BEYOND if rising else 1.0 + _BEYOND)


def member(pair: GearPair, low: float, high: float, form: ContactForm = "mesh") -> Member:
    """What the search for branches needs of a gear pair, for speeds of a range.

    Parameters
    ----------
    pair : the gear pair
    low, high : slowest and fastest speed [rpm]
    form : as ``unilateral_system``
    """
    length, cycle = static_deflection(pair), pair.geometry.mesh_period * operating_rpm(pair)
    limits = Limits(
        slowest=low / cycle,
        fastest=high / cycle,
        length=length,
        parameter=pair.operating.pinion_torque,
        amplitude=largest_motion(pair),
    )
    elements = None if depends_on_speed(pair) else mesh_elements(pair)
    return Member(
        unilateral_family(pair, low, high, form),
        limits,
        lambda period: start_of(pair.with_({"operating.pinion_speed": cycle / period}), None, form, elements),
    )
