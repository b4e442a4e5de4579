"""Floquet modes x(t) = p(t) exp(s t), p periodic: branches of exponents, multipliers however small.

Sources: docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.linalg import eig

from floquet.engine.monodromy import checked_effort
from floquet.engine.propagation import Propagation, error_of_product, propagate
from floquet.engine.propagators.base import Propagator
from floquet.engine.propagators.registry import propagator
from floquet.engine.system import PeriodicSystem
from lumped.arguments import whole_number
from lumped.errors import NumericalError, refuse
from lumped.typing import ComplexArray, FloatArray

_EPS = float(np.finfo(np.float64).eps)
_LARGEST = 400  # rows of the cyclic matrix; its eigenvalues take about 0.3 s
_DECAY = 1e2  # ratio of the singular values of one factor above which it is worth splitting
_TIE = 1e-6


@dataclass(frozen=True, eq=False)
class FloquetModes:
    """The modes of a periodic system, slowest decay first.

    Attributes
    ----------
    exponents : (n,) s [1/s], Im s on the branch in which the largest harmonic of p is its mean: then Im s is
        the frequency at which the mode is mostly seen, near a natural frequency of the mean system
    multipliers : (n,) exp(s T); may underflow to 0 where ``exponents`` still say what it is
    relative_errors : (n,) bound on |error of multiplier / multiplier|, first order; inf where multipliers
        cannot be told apart (defective ones: use `monodromy`, whose bounds know clusters)
    harmonics : (n,) how many 2 pi/T the branch is away from the principal one
    times : (k,) even over the period, the end left out [s]
    modes : (n, k, n) p at ``times``; modes[i, :, j] is coordinate j of mode i; mean square of its balanced
        states over the period 1
    scaling : (n,) the balancing scales
    residuals : (n,) largest jump of p at the ends of the factors, a check on the whole calculation
    period : T [s]
    """

    exponents: ComplexArray
    multipliers: ComplexArray
    relative_errors: FloatArray
    harmonics: npt.NDArray[np.int64]
    times: FloatArray
    modes: ComplexArray
    scaling: FloatArray
    residuals: FloatArray
    period: float

    @property
    def frequencies(self) -> FloatArray:
        """|Im s| [rad/s]."""
        return np.abs(self.exponents.imag)


def floquet_modes(
    system: PeriodicSystem,
    rtol: float = 1e-10,
    *,
    samples: int | None = None,
    method: str | Propagator = "gauss",
    max_substeps: int = 200_000,
) -> FloquetModes:
    """Floquet modes, exponents and multipliers without forming the monodromy matrix.

    M = P_m ... P_1 loses every multiplier below 1e-16 of its norm. The block-cyclic matrix with the factors
    P_k below its diagonal (and P_m in the corner) has the m-th roots of all multipliers as eigenvalues, which
    lie close together however small the multipliers are, and the modes at the ends of the factors as
    eigenvectors. LAPACK finds them with a small backward error in that matrix, that is in each factor.

    Parameters
    ----------
    system : the periodic system; its forcing plays no part
    rtol : accuracy of each factor, 1e-14 to 1e-1
    samples : times per period at which modes are returned, a power of two >= 8; default enough for the
        fastest motion
    method, max_substeps : as in `monodromy`

    Raises
    ------
    ParameterError
        rtol or samples out of range.
    NumericalError
        As in `monodromy`; also when the eigenvalues do not come in complete sets of roots.
    """
    rtol, max_substeps = checked_effort(rtol, max_substeps)
    d = system.balancing()
    if samples is None:
        middle = 0.5 * (system.edges[:-1] + system.edges[1:])
        A = system.evaluate(middle) * (d[None, :] / d[:, None])
        turns = system.period * float(np.abs(np.linalg.eigvals(A)).max()) / (2.0 * np.pi)
        samples = 2 ** math.ceil(math.log2(max(16.0, 8.0 * turns)))
    samples = whole_number("samples", samples, 8, 65536)
    if samples & (samples - 1):
        raise refuse("samples", samples, "a power of two from 8 to 65536", "Leave it at its default.")
    times = system.period * np.arange(samples) / samples
    fine = PeriodicSystem(
        system.A, system.period, [*system.edges[1:-1], *times[1:]], vectorized=system.vectorized
    )
    flow = propagate(fine, propagator(method), rtol, max_substeps, d)
    cuts = _factors(flow)
    products = [_factor(flow, first, last) for first, last in pairwise(cuts)]
    factors, errors = np.array([p for p, _ in products]), np.array([e for _, e in products])
    roots, right, bounds = _cyclic_eigen(factors, errors)
    at = np.searchsorted(flow.times, times - 1e-12 * system.period)
    states, powers, residuals = _along(flow, cuts, right, roots)
    logs = len(factors) * np.log(roots)
    principal = logs.real + 1j * np.angle(np.exp(1j * logs.imag))
    p = states[:, at] * np.exp(powers[:, at] - principal[:, None] * times / system.period)[:, :, None]
    return _record(system.period, d, times, p, principal, bounds, residuals)


def _factors(flow: Propagation) -> list[int]:
    """Indices of steps at which the product is cut, so that no factor mixes very different decays."""
    n = flow.steps.shape[1]
    largest = max(1, _LARGEST // n)
    decay = _DECAY
    while True:
        cuts, product = [0], np.eye(n)
        for k, step in enumerate(flow.steps):
            product = step @ product
            s = np.linalg.svd(product, compute_uv=False)
            if s[-1] * decay < s[0] or k == len(flow.steps) - 1:
                cuts.append(k + 1)
                product = np.eye(n)
        if len(cuts) - 1 <= largest:
            return cuts
        decay *= 10.0
        if decay > 1e12:
            raise NumericalError(
                f"the decay within one period is too strong for {largest} factors. Shorten the period (raise "
                "the speed), or take out states that decay at once."
            )


def _factor(flow: Propagation, first: int, last: int) -> tuple[FloatArray, float]:
    part = slice(first, last)
    product, delta, _ = error_of_product(
        Propagation(flow.times[first : last + 1], flow.steps[part], flow.truncation[part],
                    flow.rounding[part], flow.scaling, 0)
    )  # fmt: skip
    return product, delta


def _cyclic_eigen(factors: FloatArray, errors: FloatArray) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """One m-th root of every multiplier, its vectors (n, m, n) at the starts of the factors, error bounds."""
    m, n, _ = factors.shape
    C = np.zeros((m * n, m * n))
    for k in range(m):
        row = (k + 1) % m
        C[row * n : (row + 1) * n, k * n : (k + 1) * n] = factors[k]
    values, left, right = (np.asarray(part, dtype=complex) for part in eig(C, left=True, right=True)[:3])
    # Each multiplier owns m eigenvalues, turned by 2 pi/m against each other: keep those in one sector whose
    # edge lies in the widest gap, so that none sits on it.
    if (values == 0.0).any():
        raise NumericalError("a factor is singular, so A is not finite or decays beyond floating point.")
    sector = 2.0 * np.pi / m
    phase = np.mod(np.angle(values), sector)
    ordered = np.sort(phase)
    gaps = np.diff(np.append(ordered, ordered[0] + sector))
    widest = int(np.argmax(gaps))
    edge = ordered[widest] + 0.5 * gaps[widest]
    kept = np.flatnonzero(np.mod(np.angle(values) - edge, 2.0 * np.pi) < sector)
    if kept.size != n:
        raise NumericalError(
            f"{kept.size} roots in a sector that should hold {n}: multipliers are too ill-conditioned for "
            "the factors. Ask for a smaller rtol, or use monodromy for the large ones."
        )
    kept = kept[np.argsort(-np.abs(values[kept]), kind="stable")]
    x = right[:, kept].T.reshape(n, m, n)
    y = left[:, kept].T.reshape(n, m, n)
    inner = np.abs((y.conj() * x).sum(axis=(1, 2)))
    # |y^H dC x|: factor k leads from x_k to y_(k+1); and the backward error of the QR algorithm, of |C|.
    x_size, y_size = np.linalg.norm(x, axis=2), np.linalg.norm(np.roll(y, -1, axis=1), axis=2)
    backward = 4.0 * n * _EPS * np.linalg.norm(factors, axis=(1, 2)).max()
    with np.errstate(divide="ignore"):
        change = ((x_size * errors * y_size).sum(axis=1) + backward) / inner
    mu = values[kept]
    distance = np.abs(mu[:, None] - values[None, :])
    distance[np.arange(n), kept] = np.inf
    bounds = np.where(4.0 * change < distance.min(axis=1), m * change / np.abs(mu), np.inf)
    return mu, x, bounds


def _along(
    flow: Propagation, cuts: list[int], vectors: ComplexArray, roots: ComplexArray
) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """x(t) of every mode at all times as exp(logs) times states, (n, steps+1), (n, steps+1, n); and jumps.

    The cyclic vectors satisfy P_k x_k = mu x_(k+1), so that the motion is mu^k x_k. The powers are kept
    apart: they under- or overflow where the mode itself, x(t) exp(-s t), does not.
    """
    n, m, _ = vectors.shape
    states = np.zeros((n, flow.times.size, n), dtype=complex)
    logs = np.zeros((n, flow.times.size), dtype=complex)
    residuals = np.zeros(n)
    for k in range(m):
        current = vectors[:, k]
        for index in range(cuts[k], cuts[k + 1]):
            states[:, index] = current
            logs[:, index] = k * np.log(roots)
            current = current @ flow.steps[index].T
        following = vectors[:, (k + 1) % m] * roots[:, None]
        jump = np.linalg.norm(current - following, axis=1) / np.linalg.norm(following, axis=1)
        residuals = np.maximum(residuals, jump)
    return states, logs, residuals


def _record(
    period: float,
    d: FloatArray,
    times: FloatArray,
    p: ComplexArray,
    principal: ComplexArray,
    bounds: FloatArray,
    residuals: FloatArray,
) -> FloquetModes:
    """Put the exponents on the branch of the largest harmonic of p, scale and sort the modes."""
    n, samples = p.shape[0], times.size
    spectrum = np.fft.fft(p, axis=1) / samples
    energy = np.square(np.abs(spectrum)).sum(axis=2)
    turns = np.fft.fftfreq(samples, 1.0 / samples)
    shifts = np.empty(n, dtype=np.int64)
    for i in range(n):
        best = energy[i] >= (1.0 - _TIE) * energy[i].max()
        # A real mode has +-k alike: take the frequency that is not negative, the lower of two such.
        frequency = principal[i].imag + 2.0 * np.pi * turns
        candidates = np.flatnonzero(best)
        candidates = candidates[np.argsort(np.abs(frequency[candidates]), kind="stable")]
        rising = candidates[frequency[candidates] >= -1e-12]
        shifts[i] = round(turns[rising[0] if rising.size else candidates[0]])
    exponents: ComplexArray = np.asarray((principal + 2j * np.pi * shifts) / period, dtype=complex)
    p = p * np.exp(-2j * np.pi * shifts[:, None] * times / period)[:, :, None]
    p /= np.sqrt(np.square(np.abs(p)).sum(axis=2).mean(axis=1))[:, None, None]
    with np.errstate(under="ignore"):
        multipliers = np.exp(exponents * period)
    order = np.lexsort((-exponents.imag, np.round(-exponents.real * period, 9)))
    return FloquetModes(
        exponents=exponents[order],
        multipliers=multipliers[order],
        relative_errors=bounds[order],
        harmonics=shifts[order],
        times=times,
        modes=p[order] * d,
        scaling=d,
        residuals=residuals[order],
        period=period,
    )
