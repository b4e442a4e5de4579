"""Systems without gears for the judge, by formulas."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from balls import BITS, Piece, exact_multipliers  # type: ignore[import-not-found]
from findings import Finding, finding  # type: ignore[import-not-found]
from flint import acb, arb, arb_series, ctx

from floquet import FourierSeries, PeriodicMatrix, PeriodicSystem, PiecewisePolynomial, monodromy


def _analytic(entry: Callable[..., object]) -> Callable[[arb, arb, int], list[arb]]:
    """Taylor coefficients of an entire function of the time, by arithmetic of power series."""

    def coefficients(start: arb, length: arb, count: int) -> list[arb]:
        cap_before = ctx.cap
        ctx.cap = count
        series = entry(arb_series([start, length], count))
        ctx.cap = cap_before
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


def formula(rng: np.random.Generator) -> list[Finding]:
    """Random A(t) of piecewise polynomials times Fourier series, damped or not."""
    ctx.prec = BITS
    T = float(rng.uniform(0.3, 6.0))
    inner = np.sort(rng.uniform(0.0, T, int(rng.integers(0, 4))))
    ends = np.array([0.0, *inner, T])
    rows = rng.normal(size=(ends.size - 1, int(rng.integers(1, 5))))
    count = int(rng.integers(1, 4))
    mean = float(rng.uniform(0.5, 20.0))
    a = rng.normal(size=count)
    b = rng.normal(size=count)
    damping = float(rng.choice([0.0, 0.05, rng.uniform(0.0, 2.0)]))
    wave = FourierSeries(T, mean, a.tolist(), b.tolist())
    ripple = PiecewisePolynomial(ends, rows)
    entry = -(wave + ripple * FourierSeries(T, 0.3, [0.5]))
    system = PeriodicSystem(
        PeriodicMatrix([[0.0, 1.0], [0.0, -damping]], (entry, [[0.0, 0.0], [1.0, 0.0]])), T
    )
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
    truth = exact_multipliers(lambda: exact, 2)
    findings = []
    for method in ("auto", "gauss"):
        result = monodromy(system, 1e-8, method=method)
        kind = "formula"
        route = "engine" if method == "auto" else "engine, sampled"
        errors = result.multiplier_errors
        findings.append(finding(kind, route, result.multipliers, errors, truth, result.certificate))
    return findings
