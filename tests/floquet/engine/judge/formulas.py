"""Systems without gears for the judge: by formulas, by M, C and K, and callables with a narrow feature."""

import math
import warnings
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from balls import BITS, Piece, exact_multipliers  # type: ignore[import-not-found]
from findings import Finding, finding  # type: ignore[import-not-found]
from flint import acb, arb, arb_mat, arb_series, ctx

from floquet import (
    FourierSeries,
    KnownMatrix,
    PeriodicMatrix,
    PeriodicSystem,
    PiecewisePolynomial,
    from_second_order,
    monodromy,
)
from lumped.errors import ResolutionWarning


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


def formula(rng: np.random.Generator) -> list[Finding]:
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
    truth = exact_multipliers(lambda: exact, 2)
    findings = []
    for method in ("auto", "gauss"):
        found = monodromy(system, 1e-8, method=method)
        kind, route = "formula", "engine" if method == "auto" else "engine, sampled"
        errors = found.multiplier_errors
        findings.append(finding(kind, route, found.multipliers, errors, truth, found.certificate))
    return findings


def matrices(rng: np.random.Generator) -> list[Finding]:
    """Random M, C, K in mixed units: gyroscopic and circulatory parts, a harmonic and a step."""
    ctx.prec = BITS
    n, T = int(rng.integers(1, 3)), float(rng.uniform(0.3, 3.0))
    L, S, R, *varied = rng.normal(size=(5, n, n))
    units = np.diag(10.0 ** rng.uniform(-2.0, 2.0, n))
    M = units @ (L @ L.T + np.eye(n)) @ units
    C = units @ (float(rng.choice([0.0, 0.1, 1.0])) * np.eye(n) + 0.3 * (R - R.T)) @ units
    K = units @ (rng.uniform(3.0, 30.0) * np.eye(n) + S @ S.T) @ units
    K1, K2 = (units @ B @ units for B in varied)
    jump = float(rng.uniform(0.1, 0.9)) * T
    step = PiecewisePolynomial([0.0, jump, T], [[1.0], [-0.5]])
    stiffness = PeriodicMatrix(K, (FourierSeries(T, 0.0, [1.0]), K1), (step, K2))
    found = monodromy(from_second_order(M, C, stiffness, T), 1e-8)

    def ball(B: np.ndarray) -> arb_mat:
        return arb_mat([[arb(x) for x in row] for row in B.tolist()])

    inverse = ball(M).inv()
    wave, drag, exact = inverse * ball(K1), inverse * ball(C), []
    for start, end, level in ((0.0, jump, 1.0), (jump, T, -0.5)):
        fixed = inverse * (ball(K) + ball(K2) * arb(level))
        entries, functions = [(i, n + i, _analytic(lambda t: t * 0 + arb(1))) for i in range(n)], []
        for i in range(n):
            for j in range(n):

                def spring(t: object, i: int = i, j: int = j, fixed: arb_mat = fixed) -> object:
                    return (_cos(t, 1, T) * wave[i, j] + fixed[i, j]) * -1  # type: ignore[operator]

                def damper(t: object, i: int = i, j: int = j) -> object:
                    return t * 0 - drag[i, j]  # type: ignore[operator]

                entries += [(n + i, j, _analytic(spring)), (n + i, n + j, _analytic(damper))]
                functions += [spring, damper]
        bound = _bounded([*functions, lambda t: t * 0 + arb(1)], 4.0)
        parts = math.ceil(10.0 * (end - start) / T)
        length = (arb(end) - arb(start)) / parts
        exact += [Piece(arb(start) + i * length, length, entries, bound) for i in range(parts)]
    truth = exact_multipliers(lambda: exact, 2 * n)
    errors = found.multiplier_errors
    return [finding("matrices", "engine", found.multipliers, errors, truth, found.certificate)]


def black_box(rng: np.random.Generator) -> list[Finding]:
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
    truth = exact_multipliers(lambda: exact, 2)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = monodromy(PeriodicSystem(A, 1.0), 1e-9)
    warned = any(issubclass(w.category, ResolutionWarning) for w in caught)
    certificate = "warned" if warned else found.certificate
    errors = found.multiplier_errors
    return [finding("black box", "callable", found.multipliers, errors, truth, certificate)]
