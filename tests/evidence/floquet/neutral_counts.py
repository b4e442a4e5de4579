"""How many systems without damping are proven neutral or unstable, and is any verdict wrong?

``python -m tests.evidence.floquet.neutral_counts`` prints the table of docs/verification/floquet.md.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat, ctx

from floquet import (
    FourierSeries,
    PeriodicMatrix,
    PiecewisePolynomial,
    from_second_order,
    gear_pair_multipliers,
    gear_pair_system,
    monodromy,
)
from floquet.engine.system import PeriodicSystem
from lumped import GearPair, load_gear_pair
from lumped.schema.files import preset_names
from lumped.typing import FloatArray
from tests.evidence.floquet.reference_systems import mathieu_unstable, meissner_trace
from tests.unlike_pairs import UNLIKE, unlike_pair

_BITS = 256
#: Nodes nearer to an edge of instability than this say nothing on a verdict.
_AT_EDGE = 1e-9
_RIGHT = {"neutral": False, "unstable": True}  # verdict -> whether the judge must say unstable
LINES = {line: [f"bearings.{g}.{line}_damping_ratio" for g in ("pinion", "gear")] for line in ("loa", "oloa")}
UNDAMPED = {
    "mesh.damping_ratio": 0.0, **dict.fromkeys(LINES["loa"] + LINES["oloa"], 0.0),
    "friction.law": "none", "friction.coefficient": None, "friction.maximum": None,
    "friction.sharpness": None, "friction.thresholds": None, "mesh.contact": "prescribed",
}  # fmt: skip


@dataclass
class Count:
    """Verdicts of a kind of system.

    Attributes
    ----------
    systems : their name
    judge : what decides whether a verdict is right
    verdicts : number of each verdict
    wrong : verdicts that the judge contradicts
    """

    systems: str
    judge: str
    verdicts: dict[str, int] = field(
        default_factory=lambda: dict.fromkeys(("neutral", "unstable", "undecided"), 0)
    )
    wrong: int = 0

    def add(self, verdict: str, unstable: bool) -> None:
        """Count one verdict, with what the judge says."""
        self.verdicts[verdict] = self.verdicts.get(verdict, 0) + 1
        self.wrong += verdict in _RIGHT and _RIGHT[verdict] != unstable
        self.wrong += verdict == "stable"


def count_mathieu(count: int, seed: int = 1) -> Count:
    """x'' + (a - 2 q cos 2t) x = 0 at random a from -1 to 20 and q to 6."""
    rng = np.random.default_rng(seed)
    result = Count("Mathieu", "characteristic values of scipy")
    while sum(result.verdicts.values()) < count:
        a, q = float(rng.uniform(-1.0, 20.0)), float(rng.uniform(0.0, 6.0))
        unstable, edges = mathieu_unstable(np.array([a]), q)
        if np.abs(edges - a).min() < _AT_EDGE:
            continue
        stiffness = PeriodicMatrix(a, (FourierSeries(np.pi, 0.0, [1.0]), -2.0 * q))
        result.add(monodromy(from_second_order(1.0, 0.0, stiffness, np.pi)).verdict, bool(unstable[0]))
    return result


def count_meissner(count: int, seed: int = 2) -> Count:
    """x'' + (delta +- epsilon) x = 0, the sign changing after half of the period 2."""
    rng = np.random.default_rng(seed)
    result = Count("Meissner", "closed form of the trace")
    for _ in range(count):
        delta, part = float(rng.uniform(0.1, 30.0)), float(rng.uniform(0.0, 1.0))
        jump = PiecewisePolynomial([0.0, 1.0, 2.0], [[part * delta], [-part * delta]])
        verdict = monodromy(from_second_order(1.0, 0.0, PeriodicMatrix(delta, (jump, 1.0)), 2.0)).verdict
        result.add(verdict, abs(meissner_trace(delta, part * delta, 2.0)) > 2.0)
    return result


class HillSystem(NamedTuple):
    """x'' + (mean +- half) x = 0, the sign changing after half of the period.

    Attributes
    ----------
    mean, half : (n, n) symmetric
    period : T
    """

    mean: FloatArray
    half: FloatArray
    period: float

    @property
    def system(self) -> PeriodicSystem:
        """The system for the program."""
        jump = PiecewisePolynomial([0.0, 0.5 * self.period, self.period], [[1.0], [-1.0]])
        n = len(self.mean)
        return from_second_order(
            np.eye(n), np.zeros((n, n)), PeriodicMatrix(self.mean, (jump, self.half)), self.period
        )

    @property
    def distance_from_circle(self) -> float:
        """Largest distance of a multiplier from the unit circle, with 77 digits, by code of Arb alone."""
        ctx.prec = _BITS
        n = len(self.mean)
        flow = arb_mat(2 * n, 2 * n)
        for a in range(2 * n):
            flow[a, a] = arb(1)
        for sign in (1, -1):
            A = arb_mat(2 * n, 2 * n)
            for a in range(n):
                A[a, n + a] = arb(1)
                for b in range(n):
                    A[n + a, b] = -(arb(float(self.mean[a, b])) + sign * arb(float(self.half[a, b])))
            flow = (A * (arb(float(self.period)) / 2)).exp() * flow
        return max(abs(float((abs(value) - 1).mid())) for value in flow.eig(multiple=True))


def hill_systems(count: int, place: str, seed: int = 3) -> Iterator[HillSystem]:
    """Three modes at a resonance of two of them, with strengths from 1e-13 to 0.03.

    ``place``: "sum", "difference", "twice one" or "anywhere"; at differences every fifth has equal modes.
    """
    rng = np.random.default_rng(seed)
    for number in range(count):
        omega = np.sort(rng.uniform(0.6, 3.0, 3))
        i, j = rng.choice(3, 2, replace=False)
        equal = place == "difference" and number % 5 == 0
        if equal:
            omega[j] = omega[i]
        coupling = rng.normal(size=(3, 3))
        frequency = {
            "sum": omega[i] + omega[j], "difference": abs(omega[i] - omega[j]), "twice one": 2.0 * omega[i],
        }.get(place, rng.uniform(1.0, 6.0))  # fmt: skip
        if equal or frequency < 0.1:
            frequency = rng.uniform(1.0, 6.0)
        half = 10.0 ** rng.uniform(-13.0, -1.5) * (coupling + coupling.T)
        yield HillSystem(np.diag(omega**2), half, float(2.0 * np.pi / frequency))


def count_hill(count: int, place: str) -> Count:
    """Verdicts of `hill_systems`; a multiplier is off the circle where 77 digits show 1e-25."""
    result = Count(f"three modes, {place}", "multipliers with 77 digits")
    for one in hill_systems(count, place):
        result.add(monodromy(one.system).verdict, one.distance_from_circle > 1e-25)
    return result


def undamped_pairs() -> dict[str, GearPair]:
    """Presets and pairs that are unlike each other, without damping and friction, on the line of action."""
    pairs = {name: load_gear_pair(name) for name in preset_names()}
    pairs |= {name: unlike_pair(name) for name in UNLIKE}
    return {name: pair.healthy.with_(UNDAMPED) for name, pair in pairs.items()}


def count_gears(speeds: int) -> Count:
    """Gear pairs on springs from 0.5 to 2 times the operating speed."""
    result = Count("gear pairs on springs", "Gauss collocation on A(t), to 1e-7")
    for pair in undamped_pairs().values():
        rpm = pair.operating.pinion_speed * 30.0 / np.pi
        for speed in np.geomspace(0.5, 2.0, speeds) * rpm:
            one = pair.at_speed(float(speed))
            verdict = gear_pair_multipliers(one, supports="springs").verdict
            estimate = monodromy(gear_pair_system(one, "mesh", supports="springs"), 1e-9)
            result.add(verdict, bool(estimate.spectral_radius - 1.0 > 1e-7))
    return result


def counts(share: float) -> Iterator[Count]:
    """All counts; ``share`` of the full numbers."""
    yield count_mathieu(round(2000 * share))
    yield count_meissner(round(2000 * share))
    for place in ("anywhere", "difference", "sum", "twice one"):
        yield count_hill(round(300 * share), place)
    yield count_gears(max(2, round(60 * share)))


def main() -> int:
    """Print the table; 1 where a verdict is wrong."""
    share = float(sys.argv[1]) if len(sys.argv) > 1 else 1.0
    print("| systems | judge | neutral | unstable | undecided | wrong |")
    print("|---|---|---|---|---|---|")
    wrong = 0
    for one in counts(share):
        v = one.verdicts
        cells = one.systems, one.judge, v["neutral"], v["unstable"], v["undecided"], one.wrong
        print(f"| {' | '.join(map(str, cells))} |", flush=True)
        wrong += one.wrong
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
