"""Every bound and verdict against ball arithmetic.

    python tests/floquet/engine/judge/court.py [--count 40] [--seed 1] [--jobs 2]     prints the table

`tests/floquet/engine/judge/test_judge.py` runs a sample of it with the suite.
"""

from __future__ import annotations

import argparse
import math
import sys
import warnings
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from flint import acb, arb, arb_series, ctx
from joblib import Parallel, delayed

from floquet import (
    FourierSeries,
    KnownMatrix,
    PeriodicSystem,
    PiecewisePolynomial,
    coarsened,
    fast_multipliers,
    gear_block,
    gear_pair_multipliers,
    monodromy,
    stability_chart,
)
from lumped import GearPair
from lumped.errors import LawRangeWarning, NumericalError, ParameterError, ResolutionWarning

sys.path.insert(0, str(Path(__file__).parent))

from balls import BITS, Piece, multipliers, worst_ratio
from balls import monodromy as exact_monodromy
from gears import MODELS, pieces, random_pair

SPECIAL = ("tongue edge", "collision", "low speed")
KINDS = (*MODELS, *SPECIAL, "formula", "black box")


class Finding(NamedTuple):
    """One bound against the truth.

    Attributes
    ----------
    kind, route : what was tried, and by which route
    ratio : error over bound, the multipliers matched best
    wrong : whether the verdict says the opposite of the truth
    undecided : whether there is none
    certificate : "proven", "estimate", or "warned" for an estimate with a warning
    """

    kind: str
    route: str
    ratio: float
    wrong: bool
    undecided: bool
    certificate: str


def judge(kind: str, seed: int) -> list[Finding]:
    """Findings on one random system."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        if kind == "formula":
            return _formula(rng)
        if kind == "black box":
            return _black_box(rng)
        pair = _pair(rng, kind)
        truth = multipliers(exact_monodromy(pieces(pair), 6))
        return _routes(kind, pair, truth)


def _pair(rng: np.random.Generator, kind: str) -> GearPair:
    while True:
        try:
            pair = random_pair(rng, kind if kind in MODELS else str(rng.choice(MODELS)))
            if kind == "low speed":
                return pair.with_({"operating.pinion_speed": float(rng.uniform(100.0, 500.0))})
            return _special(rng, kind, pair) if kind in SPECIAL else _checked(pair)
        except (ParameterError, NumericalError):  # a law refuses the operating point, or no tongue is near
            continue


def _checked(pair: GearPair) -> GearPair:
    gear_block(pair)
    return pair


def _special(rng: np.random.Generator, kind: str, pair: GearPair) -> GearPair:
    """Speed at which rho = 1 to rounding, or two multipliers nearly meet."""
    changes: dict[str, object] = {"mesh.damping_ratio": 0.0 if kind == "collision" else 0.002}
    for gear in ("pinion", "gear"):
        changes[f"bearings.{gear}.loa_damping_ratio"] = 0.0 if kind == "collision" else 0.002
    if kind == "collision":
        changes["friction.law"] = "none"
    pair = pair.with_(changes)
    block = gear_block(pair)
    own = pair.operating.pinion_speed
    speeds = own * np.exp(np.linspace(-0.7, 0.7, 400))

    def measure(speed: np.ndarray) -> np.ndarray:
        found = fast_multipliers(block, block.period * own / speed).multipliers
        return np.asarray(np.abs(found).max(axis=1) - 1.0 - (1e-6 if kind == "collision" else 0.0))

    values = measure(speeds)
    changes_at = np.flatnonzero(values[1:] * values[:-1] < 0.0)
    if changes_at.size == 0:
        raise NumericalError("no tongue is near")
    at = int(rng.choice(changes_at))
    low, high = speeds[at], speeds[at + 1]
    for _ in range(int(rng.choice([15, 30, 45]))):
        middle = 0.5 * (low + high)
        if measure(np.array([middle]))[0] * values[at] > 0.0:
            low = middle
        else:
            high = middle
    return pair.with_({"operating.pinion_speed": float(low)})


def _routes(kind: str, pair: GearPair, truth: Sequence[tuple[complex, float]]) -> list[Finding]:
    findings = []
    fine = gear_block(pair)
    joined = coarsened(gear_block(pair, rtol=1e-9), fine.period, 1.0, [], 1e-7)
    for route, block in (("kernel", fine), ("joined pieces", joined)):
        found = fast_multipliers(block)
        findings.append(
            _finding(kind, route, found.multipliers[0], found.errors[0], truth, found.certificate)
        )
    chart = stability_chart(pair, {"speed_rpm": [pair.operating.pinion_speed * 30.0 / np.pi]}, rtol=1e-8)
    own = gear_pair_multipliers(pair, 1e-9)
    for route, values, errors, certificate in (
        ("chart", chart.multipliers.values[0], chart.multiplier_errors.values[0], chart.attrs["certificate"]),
        ("pair", own.multipliers, own.multiplier_errors, own.certificate),
    ):
        # All ten: the bearings off the line of action are judged by their closed form elsewhere.
        feedback = np.abs(values[:, None] - own.oloa).min(axis=1) > 1e-12 * (1.0 + np.abs(values))
        if feedback.sum() == 6:
            findings.append(_finding(kind, route, values[feedback], errors[feedback], truth, certificate))
    return findings


def _finding(
    kind: str,
    route: str,
    values: np.ndarray,
    errors: np.ndarray,
    truth: Sequence[tuple[complex, float]],
    certificate: str,
) -> Finding:
    ratio, _ = worst_ratio(values, errors, truth)
    modulus = np.abs(values)
    radius, error = float(modulus.max()), float((modulus + errors).max() - modulus.max())
    low, high = (max(abs(c) + s * r for c, r in truth) for s in (-1.0, 1.0))
    wrong = (radius + error < 1.0 and low > 1.0) or (radius - error > 1.0 and high < 1.0)
    undecided = not (radius + error < 1.0 or radius - error > 1.0)
    return Finding(kind, route, ratio, wrong, undecided, certificate)


Entry = Callable[[arb_series], arb_series]


def _analytic(entry: Callable[..., object]) -> Callable[[arb, arb, int], list[arb]]:
    """Taylor coefficients of an entire function of the time, by arithmetic of power series."""

    def coefficients(start: arb, length: arb, count: int) -> list[arb]:
        kept, ctx.cap = ctx.cap, count
        series = entry(arb_series([start, length], count))
        ctx.cap = kept
        return [series[k] for k in range(count)]  # type: ignore[index]

    return coefficients


def _bounded(
    entries: Sequence[Callable[..., object]], radius: float
) -> Callable[[arb, arb], tuple[arb, float]]:
    """Bound on entries over the disk |s| <= radius about the start of a step."""

    def bound(start: arb, length: arb) -> tuple[arb, float]:
        reach = radius * length.upper()
        place = acb(start + arb(0, reach), arb(0, reach))
        largest = max((abs(acb(entry(place))).upper() for entry in entries), key=float)  # type: ignore[call-overload]
        return arb(largest), radius

    return bound


def _cos(t: object, order: int, period: float) -> object:
    angle = t * (arb.pi() * 2 * order / arb(period))  # type: ignore[operator]
    return angle.cos()


def _sin(t: object, order: int, period: float) -> object:
    angle = t * (arb.pi() * 2 * order / arb(period))  # type: ignore[operator]
    return angle.sin()


def _formula(rng: np.random.Generator) -> list[Finding]:
    """Random A(t) of piecewise polynomials times Fourier series, damped or not."""
    ctx.prec = BITS
    T = float(rng.uniform(0.3, 6.0))
    inner = np.sort(rng.uniform(0.0, T, int(rng.integers(0, 4))))
    ends = np.array([0.0, *inner, T])
    rows = rng.normal(size=(ends.size - 1, int(rng.integers(1, 5))))
    count = int(rng.integers(1, 4))
    mean, a, b = float(rng.uniform(0.5, 20.0)), rng.normal(size=count), rng.normal(size=count)
    damping = float(rng.choice([0.0, 0.05, rng.uniform(0.0, 2.0)]))
    wave = FourierSeries(T, mean, a.tolist(), b.tolist())
    ripple = PiecewisePolynomial(ends, rows)
    entry = -(wave + ripple * FourierSeries(T, 0.3, [0.5]))
    system = PeriodicSystem(KnownMatrix([[0.0, 1.0], [entry, -damping]]), T)
    exact = []
    for j in range(ends.size - 1):

        def stiffness(t: object, j: int = j) -> object:
            total = t * 0 + arb(mean)  # type: ignore[operator]
            for k in range(count):
                total = total + _cos(t, k + 1, T) * arb(a[k]) + _sin(t, k + 1, T) * arb(b[k])
            poly = t * 0  # type: ignore[operator]
            for c in rows[j, ::-1]:
                poly = poly * (t - arb(ends[j])) + arb(c)  # type: ignore[operator]
            return (total + poly * (arb(0.3) + _cos(t, 1, T) * arb(0.5))) * -1

        start = arb(ends[j])
        one = _analytic(lambda t: t * 0 + arb(1))
        fixed = _analytic(lambda t: t * 0 - arb(damping))
        bound = _bounded([stiffness, lambda t: t * 0 + arb(1 + damping)], 4.0)
        entries = [(0, 1, one), (1, 0, _analytic(stiffness)), (1, 1, fixed)]
        parts = math.ceil(40.0 * (ends[j + 1] - ends[j]) / T)
        length = (arb(ends[j + 1]) - start) / parts
        exact += [Piece(start + i * length, length, entries, bound) for i in range(parts)]
    truth = multipliers(exact_monodromy(exact, 2))
    findings = []
    for method in ("auto", "gauss"):
        found = monodromy(system, 1e-8, method=method)
        kind, route = "formula", "engine" if method == "auto" else "engine, sampled"
        errors = found.multiplier_errors
        findings.append(_finding(kind, route, found.multipliers, errors, truth, found.certificate))
    return findings


def _black_box(rng: np.random.Generator) -> list[Finding]:
    """An oscillator with a narrow bump of its stiffness at a random time, as a callable."""
    ctx.prec = BITS
    width, centre = float(10.0 ** rng.uniform(-4.2, -1.0)), float(rng.uniform(0.2, 0.8))
    mean, wave, push = (
        float(rng.uniform(5.0, 60.0)),
        float(rng.uniform(0.0, 5.0)),
        float(rng.uniform(-3.0, 3.0)),
    )

    # Beyond 12 widths the bump is 1e-31 of its height: nothing there makes the pieces of the judge finite.
    def A(t: float) -> np.ndarray:
        x = (t - centre) / width
        bump = push / width * math.exp(-0.5 * x * x) if abs(x) < 12.0 else 0.0
        return np.array([[0.0, 1.0], [-(mean + wave * math.cos(2.0 * math.pi * t) + bump), -0.04]])

    def calm(t: object) -> object:
        return (_cos(t, 1, 1.0) * arb(wave) + arb(mean)) * -1  # type: ignore[operator]

    def stiffness(t: object) -> object:
        x = (t - arb(centre)) / arb(width)  # type: ignore[operator]
        return calm(t) - (x * x * arb(-0.5)).exp() * (arb(push) / arb(width))  # type: ignore[operator]

    low, high = max(centre - 12.0 * width, 0.0), min(centre + 12.0 * width, 1.0)
    inner = np.linspace(low, high, 1 + math.ceil(4.0 * (high - low) / width))
    ends = sorted({*np.linspace(0.0, low, 17), *inner, *np.linspace(high, 1.0, 17)})
    exact = []
    for start, end in pairwise(ends):
        entry = stiffness if low <= 0.5 * (start + end) <= high else calm
        entries = [
            (0, 1, _analytic(lambda t: t * 0 + arb(1))),
            (1, 0, _analytic(entry)),
            (1, 1, _analytic(lambda t: t * 0 - arb(0.04))),
        ]
        bound = _bounded([entry, lambda t: t * 0 + arb(2)], 4.0)
        exact.append(Piece(arb(start), arb(end) - arb(start), entries, bound))
    truth = multipliers(exact_monodromy(exact, 2))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = monodromy(PeriodicSystem(A, 1.0), 1e-9)
    warned = any(issubclass(w.category, ResolutionWarning) for w in caught)
    certificate = "warned" if warned else found.certificate
    errors = found.multiplier_errors
    return [_finding("black box", "callable", found.multipliers, errors, truth, certificate)]


def table(findings: Sequence[Finding]) -> str:
    """Markdown table of all findings, one row for each kind and route."""
    lines = [
        "| system | route | certificate | count | worst error/bound | false | wrong verdicts | undecided |",
        "|---|---|---|---|---|---|---|---|",
    ]
    keys = dict.fromkeys((f.kind, f.route, f.certificate) for f in findings)
    for kind, route, certificate in sorted(keys, key=lambda k: (KINDS.index(k[0]), k[1], k[2])):
        here = [f for f in findings if (f.kind, f.route, f.certificate) == (kind, route, certificate)]
        false = sum(f.ratio > 1.0 for f in here)
        wrong, undecided = sum(f.wrong for f in here), sum(f.undecided for f in here)
        worst = max(f.ratio for f in here)
        cells = (kind, route, certificate, len(here), f"{worst:.1e}", false, wrong, undecided)
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=40, help="random systems of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    tasks = [(kind, given.seed * 100_000 + i) for kind in KINDS for i in range(given.count)]
    results = Parallel(n_jobs=given.jobs)(delayed(judge)(*task) for task in tasks)
    print(table([finding for result in results for finding in result]))


if __name__ == "__main__":
    main()
