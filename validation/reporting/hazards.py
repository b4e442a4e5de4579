"""Hazards: speeds at which the pair must not run, and the hazard nearest to the operating speed."""

from __future__ import annotations

import math
from dataclasses import dataclass

from floquet import GearPairMultipliers
from floquet.gear.jump_search import JumpSearch

#: Kind of a hazard -> the hazard with its article.
_NOUNS = {
    "jump": "a jump",
    "unstable speed": "an unstable speed",
    "periodic": "a motion of many mesh cycles",
    "runs": "a speed where runs do not settle",
}


@dataclass(frozen=True)
class Hazard:
    """A speed at which the pair must not run.

    Attributes
    ----------
    speed_rpm : pinion speed [rpm]
    kind : "unstable speed", "jump", "beats", "chaos", "periodic", a motion of many mesh cycles, or "runs",
        which do not settle at the operating speed
    how : how it happens
    """

    speed_rpm: float
    kind: str
    how: str = ""

    @property
    def noun(self) -> str:
        """The hazard with its article."""
        return _NOUNS.get(self.kind, self.kind)

    @property
    def words(self) -> str:
        """The hazard and how it happens."""
        kind = "motion of many mesh cycles" if self.kind == "periodic" else self.kind
        return f"{kind}{',' if self.kind == 'jump' else ''} {self.how}".strip()


def nearest_of(
    unstable_rpm: float,
    multipliers: GearPairMultipliers,
    search: JumpSearch,
    operating_rpm: float,
    *,
    roams: bool,
) -> Hazard | None:
    """Return the unstable speed, jump, beats or chaos nearest to the operating speed; None: there is none.

    ``unstable_rpm``: the nearest unstable speed [rpm], NaN: none is known; ``multipliers``: of the linear
    motion at the operating speed; ``roams``: whether runs at the operating speed come to no motion that
    repeats, as in ``Prediction.roams``.
    """
    if roams:
        return Hazard(operating_rpm, "runs", "come to no motion that repeats")
    hazards = [] if math.isnan(unstable_rpm) else [Hazard(unstable_rpm, "unstable speed")]
    if multipliers.verdict == "unstable":
        hazards = [Hazard(operating_rpm, "unstable speed")]
    hazards += [
        Hazard(jump.speed_rpm, "jump", f"running {'up' if jump.rising else 'down'}") for jump in search.jumps
    ]
    hazards += beats_and_chaos(search, operating_rpm)
    return min(hazards, key=lambda hazard: abs(hazard.speed_rpm - operating_rpm), default=None)


def beats_and_chaos(search: JumpSearch, operating_rpm: float) -> tuple[Hazard, ...]:
    """Return the speeds of beats and chaos.

    Beats and chaos appear in settled runs, over a range of speeds, and at a loss of stability of a motion.
    From a range of speeds the speed nearest to the operating speed is taken.
    """
    settled = [
        Hazard(
            min(max(operating_rpm, attractor.low_rpm), attractor.high_rpm), str(attractor.kind), "possible"
        )
        for attractor in search.attractors
    ]
    behind_a_loss = [
        Hazard(loss.speed_rpm, str(loss.after), "possible")
        for loss in search.losses
        if loss.after in ("beats", "chaos")
    ]
    return (*settled, *behind_a_loss)
