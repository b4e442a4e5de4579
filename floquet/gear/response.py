"""Branches of periodic motions of a gear pair over speed, with unilateral contact.

Sources: docs/theory/orbits.md, "Branches".
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field, fields
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from floquet.gear.axes import checked_range, depends_on_speed, operating_rpm, speed_range
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
from lumped.ranges import told_once
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import Progress

if TYPE_CHECKING:
    import xarray as xr

    from floquet.orbits.orbit import Orbit

#: Part of the speed behind a bifurcation where a run shows what happens there.
_BEYOND = 1e-3
_CORNER = 1e-6
#: Change of the root mean square that is a jump.
JUMP = 0.1
#: A bifurcation has a multiplier of modulus one but for rounding: it belongs to the stable motions before it.
MARGINAL = 1.0 + 1e-6
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
    sharp : whether the condition holds exactly there; False at a corner, where a contact begins to strike
    """

    kind: Kind
    speed_rpm: float
    dte_rms: float
    n: int
    sharp: bool


def _label(unit: str, text: str) -> dict[str, str]:
    """Unit and name of a field in a dataset."""
    return {"unit": unit, "text": text}


@dataclass(frozen=True)
class Jump:
    """A stable motion that ends as the speed rises or falls, and what the pair does right behind.

    What it does is "periodic", "beats", "chaos" or "grows" beyond what is followed, where numbers are NaN.
    """

    speed_rpm: float = field(metadata=_label("rpm", "where a stable motion ends"))
    rising: bool = field(metadata=_label("1", "on running up"))
    dte_rms: float = field(metadata=_label("m", "dynamic transmission error before, rms"))
    largest_load: float = field(metadata=_label("N", "largest normal load before"))
    n: int = field(metadata=_label("1", "mesh cycles before"))
    dte_rms_after: float = field(metadata=_label("m", "dynamic transmission error after, rms"))
    largest_load_after: float = field(metadata=_label("N", "largest normal load after"))
    after: Settled = field(metadata=_label("1", "motion after"))
    n_after: int = field(metadata=_label("1", "mesh cycles after, 0 where it does not repeat"))


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

    def _rpm(self, orbit: Orbit) -> float:
        return self.pair.geometry.mesh_period * operating_rpm(self.pair) / orbit.period

    @property
    def bifurcations(self) -> tuple[GearBifurcation, ...]:
        """Folds, period doublings, Neimark-Sacker points and grazing of all branches, in their order."""
        return tuple(
            GearBifurcation(b.kind, self._rpm(b.orbit), b.orbit.run.rms, branch.n, b.sharp)
            for branch in self.branches
            for b in branch.bifurcations
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
        found = []
        for branch in self.branches:
            for b, behind in lost_stability(branch):
                last, before = b.orbit, b.orbit.run
                system, limit = branch.family.at(behind), largest_motion(self.pair)
                run = long_run(system, last.start, behind, last.parameter, amplitude=limit)
                if abs(run.rms - before.rms) < JUMP * before.rms:
                    continue
                after = (run.rms, run.largest_load, run.kind, run.orbit.n if run.orbit else 0)
                rising = behind < last.period
                found.append(Jump(self._rpm(last), rising, before.rms, before.largest_load, branch.n, *after))
        return tuple(sorted(found, key=lambda jump: jump.speed_rpm))

    @cached_property
    def restless(self) -> tuple[Restless, ...]:
        """What a run does in the middle of each of ``gaps``."""
        found = []
        for low, high in self.gaps:
            there = self.pair.with_({"operating.pinion_speed": 0.5 * (low + high)})
            run = settled_run(there, back_side=self.back_side)
            n = run.orbit.n if run.orbit else 0
            found.append(Restless(low, high, run.kind, n, run.rms, run.exponent, run.uncertainty))
        return tuple(found)

    @property
    def gaps(self) -> tuple[tuple[float, float], ...]:
        """Speeds without a stable periodic motion among those that were found, (low, high) [rpm]."""
        low, high = self.speeds_rpm
        calm = sorted(
            tuple(sorted(map(self._rpm, two)))
            for branch in self.branches
            for two in pairwise(branch.orbits)
            if max(orbit.spectral_radius for orbit in two) < MARGINAL
        )
        found, reached = list[tuple[float, float]](), low
        for start, end in [*calm, (high, high)]:
            if min(start, high) - reached > _GAP * (high - low):
                found.append((reached, min(start, high)))
            reached = max(reached, end)
        return tuple(found)

    @cached_property
    def dataset(self) -> xr.Dataset:
        """All orbits in a row, ``branch`` saying which belong together, and all jumps."""
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
                ("parts", [o.parts for o in orbits], "1", "contact loss"),
            )
        }  # fmt: skip
        for f in fields(Jump):
            values = [getattr(jump, f.name) for jump in self.jumps]
            table[f"jump_{f.name}"] = "jump", values, f.metadata["unit"], f.metadata["text"]
        return labelled_dataset(
            table,
            {
                "point": (np.arange(len(rows)), "1", "orbit"),
                "jump": (np.arange(len(self.jumps)), "1", "jump"),
            },
            {"model": "unilateral lumped", "speed_low_rpm": self.speeds_rpm[0]}
            | {"speed_high_rpm": self.speeds_rpm[1], "operating_rpm": operating_rpm(self.pair)},
        )


@told_once()
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


def lost_stability(branch: Branch) -> list[tuple[Bifurcation, float]]:
    """Places where a branch loses its stability, and T 0.1 % of the speed behind each."""
    found = []
    marginal = {id(b.orbit) for b in branch.bifurcations if b.kind != "grazing"}
    for b in branch.bifurcations:
        at = branch.orbits.index(b.orbit)
        before, after = (
            next((o.stable for o in side if id(o) not in marginal), None)
            for side in (branch.orbits[:at][::-1], branch.orbits[at + 1 :])
        )
        if b.kind == "grazing" or before is None or after is None or before == after:
            continue
        way = 1 if after else -1
        # A corner is not the extreme of the speed to the last digit.
        calm = (o.period / b.orbit.period for o in branch.orbits[at + way :: way])
        ratio = next((ratio for ratio in calm if abs(ratio - 1.0) > _CORNER), 1.0)
        if ratio != 1.0:
            found.append((b, b.orbit.period * (1.0 - _BEYOND if ratio > 1.0 else 1.0 + _BEYOND)))
    return found


def member(pair: GearPair, low: float, high: float, form: ContactForm = "mesh") -> Member:
    """What the search for branches needs of a gear pair, for speeds from ``low`` to ``high`` [rpm]."""
    cycle = pair.geometry.mesh_period * operating_rpm(pair)
    limits = Limits(
        slowest=low / cycle,
        fastest=high / cycle,
        length=static_deflection(pair),
        parameter=pair.operating.pinion_torque,
        amplitude=largest_motion(pair),
    )
    elements = None if depends_on_speed(pair) else mesh_elements(pair)
    return Member(
        unilateral_family(pair, low, high, form),
        limits,
        lambda period: start_of(pair.with_({"operating.pinion_speed": cycle / period}), None, form, elements),
    )
