"""Motions of a gear pair that do not repeat, over speed, and shares of start states that lead to a motion.

Sources: docs/theory/orbits.md, "Motions that do not repeat".
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.special import betaincinv, stdtrit

from floquet.orbits.attractors import Attractor, AttractorEnd
from floquet.orbits.long_run import BLOCKS, LongRun, Settled
from floquet.orbits.response import Member, Response

#: Change of the root mean square that is a jump.
JUMP = 0.1
_SURE = 0.95


def label(unit: str, text: str) -> dict[str, str]:
    """Unit and name of a field in a dataset."""
    return {"unit": unit, "text": text}


@dataclass(frozen=True)
class AttractorPoint:
    """A motion that does not repeat, at one speed.

    It is "beats", "chaos", or "periodic" where it repeats after more cycles than were looked for.
    """

    speed_rpm: float = field(metadata=label("rpm", "pinion speed"))
    kind: Settled = field(metadata=label("1", "motion"))
    dte_rms: float = field(metadata=label("m", "dynamic transmission error, rms"))
    dte_peak_to_peak: float = field(metadata=label("m", "dynamic transmission error, peak to peak"))
    largest_load: float = field(metadata=label("N", "largest normal load"))
    exponent: float = field(metadata=label("1", "largest Lyapunov exponent per mesh cycle"))
    uncertainty: float = field(metadata=label("1", "standard error of the exponent"))


@dataclass(frozen=True)
class GearAttractor:
    """A motion that does not repeat, over speed: runs come to it and stay on it.

    Attributes
    ----------
    low_rpm, high_rpm : speeds between which it was found [rpm]
    kind : "chaos" where the exponent is positive at some speed, else "beats", or "periodic" where it repeats
        everywhere, after more cycles than were looked for
    rms : smallest and largest root mean square of the transmission error about its mean [m]
    dte_largest : largest transmission error, of either sign [m]
    exponent : largest Lyapunov exponent per mesh cycle, of all speeds; NaN where it repeats everywhere
    exponent_interval : its interval of 95 %, from blocks of cycles
    reaches_back_side : whether it exceeds the backlash at some speed
    points : what it is at each speed that was looked at
    """

    low_rpm: float
    high_rpm: float
    kind: Settled
    rms: tuple[float, float]
    dte_largest: float
    exponent: float
    exponent_interval: tuple[float, float]
    reaches_back_side: bool
    points: tuple[AttractorPoint, ...] = field(repr=False)

    @property
    def text(self) -> str:
        """Speeds, kind and size in words."""
        kind = {"periodic": "a motion of many mesh cycles"}.get(self.kind, self.kind)
        size = " to ".join(dict.fromkeys(f"{1e6 * rms:.3g}" for rms in self.rms))
        low, high = (f"{end:.2g}" for end in self.exponent_interval)
        grows = f", Lyapunov exponent at most {self.exponent:.2g} ({low} to {high}) per mesh cycle"
        back = "; it exceeds the backlash" if self.reaches_back_side else ""
        return (
            f"From {self.low_rpm:.5g} to {self.high_rpm:.5g} rpm runs can stay on {kind}: transmission error "
            f"{size} µm rms, at most {1e6 * self.dte_largest:.3g} µm"
            f"{grows if np.isfinite(self.exponent) else ''}{back}"
        )


@dataclass(frozen=True)
class Basin:
    """A motion at one speed, and the share of start states that lead to it.

    Attributes
    ----------
    kind : "periodic", "beats", "chaos", or "grows" beyond what is followed, where numbers are NaN
    n : mesh cycles after which it repeats, 0 where it does not
    dte_rms, dte_peak_to_peak : of the transmission error [m]
    largest_load : largest normal load [N]
    starts : how many start states lead to it
    share : their share of all
    share_interval : interval of 95 % of that share (Clopper and Pearson)
    """

    kind: Settled
    n: int
    dte_rms: float
    dte_peak_to_peak: float
    largest_load: float
    starts: int
    share: float
    share_interval: tuple[float, float]


def end_rate(one: Attractor, side: int, losses: list[tuple[float, float]]) -> float:
    """1/T at which an attractor ends at low (side 0) or high speed (1); without limit where the range ends.

    Where its size does not jump it goes over into a motion that repeats: ``losses`` are the places, 1/T and
    root mean square, at which one of these loses its stability.
    """
    end = one.ends[side]
    if end is None:
        return (0.0, np.inf)[side]
    if jumps(end):
        return end.rate
    low, high = sorted((float(one.rates[-side]), 1.0 / end.behind))
    near = [(abs(rms - end.size[0]), rate) for rate, rms in losses if low <= rate <= high]
    near = [(apart, rate) for apart, rate in near if apart < 2.0 * JUMP * end.size[0]]
    return min(near)[1] if near else float(one.rates[-side])


def jumps(end: AttractorEnd) -> bool:
    """Whether the root mean square changes at once at an end, or grows without bound."""
    return not abs(end.after.rms - end.size[0]) < JUMP * end.size[0]


def gear_attractor(
    one: Attractor, cycle: float, backlash: float, low_rpm: float, high_rpm: float
) -> GearAttractor:
    """An attractor in speeds [rpm], which are ``cycle`` times 1/T."""
    inside = [
        (float(rate) * cycle, run)
        for rate, run in zip(one.rates, one.runs, strict=True)
        if low_rpm <= cycle * rate <= high_rpm
    ] or [(float(one.rates[0]) * cycle, one.runs[0])]
    points = tuple(
        AttractorPoint(
            rpm, run.kind, run.rms, peak_to_peak(run), run.largest_load, run.exponent, run.uncertainty
        )
        for rpm, run in inside
    )
    measured = [point for point in points if np.isfinite(point.exponent)]
    largest = max(measured, key=lambda point: point.exponent, default=points[0])
    half = float(stdtrit(BLOCKS - 2, 0.5 + 0.5 * _SURE)) * largest.uncertainty
    kinds: list[Settled] = [point.kind for point in points]
    extremes = [(run.run.least, run.run.most) for _, run in inside if run.run is not None]
    return GearAttractor(
        low_rpm=low_rpm,
        high_rpm=high_rpm,
        kind="chaos" if "chaos" in kinds else "beats" if "beats" in kinds else "periodic",
        rms=(min(point.dte_rms for point in points), max(point.dte_rms for point in points)),
        dte_largest=max(max(-least, most) for least, most in extremes),
        exponent=largest.exponent,
        exponent_interval=(largest.exponent - half, largest.exponent + half),
        reaches_back_side=any(least < -backlash for least, _ in extremes),
        points=points,
    )


def basins(response: Response, member: Member, rate: float, starts: int, seed: int) -> tuple[Basin, ...]:
    """Motions at 1/T = rate to which seeded start states lead, the most frequent first."""
    places = np.random.default_rng(seed).uniform(size=(starts, 2))
    result = []
    for run, count in response.basins(member, rate, places):
        cycles, sizes = run.orbit.n if run.orbit else 0, (run.rms, peak_to_peak(run), run.largest_load)
        shares = count, count / starts, binomial_interval(count, starts)
        result.append(Basin(run.kind, cycles, *sizes, *shares))
    return tuple(result)


def binomial_interval(count: int, of: int) -> tuple[float, float]:
    """Interval of 95 % of a share (Clopper and Pearson, Biometrika 26 (1934) 404)."""
    tail = 0.5 * (1.0 - _SURE)
    low = 0.0 if count == 0 else float(betaincinv(count, of - count + 1, tail))
    return low, 1.0 if count == of else float(betaincinv(count + 1, of - count, 1.0 - tail))


def peak_to_peak(run: LongRun) -> float:
    """Of the output; NaN where the motion grows."""
    return float("nan") if run.run is None else run.run.most - run.run.least
