"""Many runs side by side until they have settled, by the fourth-order Runge-Kutta method, compiled.

It says to what a start leads, to about 1e-3; `floquet.orbits.long_run` then says exactly what that is.

Sources: docs/theory/orbits.md, "Settling".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from floquet.orbits.branch import Family, Limits
from floquet.orbits.system import ContactSystem
from lumped.compiler import compiled
from lumped.typing import BoolArray, FloatArray

#: Steps in a period of the fastest natural motion.
_STEPS = 48
#: Periods of the fastest natural motion and cycles, at least, that a run settles; cycles that are observed.
_SETTLE = 150.0
_LEAST_CYCLES = 40
_OBSERVED = 128
#: Runs side by side whose states stay in the cache of a core.
_SIDE_BY_SIDE = 64


@dataclass(frozen=True, eq=False)
class Settled:
    """Where runs have come to: a row each.

    Attributes
    ----------
    states : (L, 2m) at phase 0
    mean, rms, least, most : (L,) of the output over the last cycles; not finite where a run grows
    """

    states: FloatArray
    mean: FloatArray
    rms: FloatArray
    least: FloatArray
    most: FloatArray

    def grown(self, amplitude: float) -> BoolArray:
        """Which runs have grown beyond an amplitude about their mean."""
        return ~(np.maximum(self.most - self.mean, self.mean - self.least) <= amplitude)

    @property
    def sizes(self) -> FloatArray:
        """(L, 3) root mean square, smallest and largest value."""
        return np.stack([self.rms, self.least, self.most], axis=1)


def alike(one: FloatArray, other: FloatArray, tolerance: float = 0.1) -> bool:
    """Whether two motions have one size: root mean square, and extremes over the range."""
    room = tolerance * max(float(np.ptp(one[1:])), float(np.ptp(other[1:])))
    return bool(
        abs(one[0] - other[0]) <= tolerance * max(one[0], other[0])
        and np.abs(one[1:] - other[1:]).max() <= room
    )


def settle(
    family: Family, limits: Limits, starts: FloatArray, periods: FloatArray, parameters: FloatArray
) -> Settled:
    """Let runs from states (L, 2m) settle at periods (L,) with parameters (L,)."""
    states = np.array(starts, dtype=float)
    stats = np.empty((4, periods.size))
    order = np.argsort(periods, kind="stable")
    cuts = np.arange(_SIDE_BY_SIDE, order.size, _SIDE_BY_SIDE)
    if not family.constant:
        cuts = np.union1d(cuts, np.flatnonzero(np.diff(periods[order])) + 1)
    for runs in np.split(order, cuts):
        T = float(periods[runs].max())
        system = family.at(T)
        cycles = max(int(np.ceil(_SETTLE / (limits.frequency * T))), _LEAST_CYCLES)
        half = np.ascontiguousarray(states[runs].T)
        m = half.shape[0] // 2
        z = half[:m]
        v = half[m:]
        found = np.zeros((4, runs.size))
        arguments: tuple[Any, ...] = (
            *(z, v, np.ascontiguousarray(periods[runs]), np.ascontiguousarray(parameters[runs])),
            *(cycles, _OBSERVED, *_tables(system, max(1.0, _STEPS * limits.frequency * T)), found),
        )
        _run(*arguments)
        states[runs] = half.T
        stats[:, runs] = found
    mean, square, least, most = stats
    with np.errstate(invalid="ignore"):
        return Settled(states, mean, np.sqrt(np.maximum(square - mean**2, 0.0)), least, most)


def _tables(system: ContactSystem, steps: float) -> tuple[Any, ...]:
    """Steps (S,); contact laws at their starts, middles and ends (S, 3, ...); what time does not change."""
    phases, present, k, c, e, b, _, _, a, u, K, C, F, H, output = system._packed
    m = u.shape[1]
    counts = np.ceil(np.diff(phases) * steps).astype(int)
    piece = np.repeat(np.arange(counts.size), counts)
    h = np.repeat(np.diff(phases) / counts, counts)
    first = np.concatenate([np.arange(n) for n in counts]) * h
    at = first[:, None] + h[:, None] * [0.0, 0.5, 1.0]

    def values(rows: FloatArray) -> FloatArray:
        """(P, ..., D + 1) -> (S, 3, ...)."""
        powers = at[..., None] ** np.arange(rows.shape[-1])
        return np.ascontiguousarray(np.einsum("s...d,sjd->sj...", rows[piece], powers))

    there = present[piece][:, None, :]
    k, c = np.where(there, values(k), 0.0), np.where(there, values(c), 0.0)
    return h, k, c, values(e), values(b), values(a[:, :, :m]), u, K[:m], C[:m], F[:m], H[:m], output


@compiled(nogil=True)
def _run(
    z: FloatArray, v: FloatArray, T: FloatArray, parameter: FloatArray, cycles: int, observed: int,
    h: FloatArray, k: FloatArray, c: FloatArray, e: FloatArray, b: FloatArray, a: FloatArray,
    u: FloatArray, K: FloatArray, C: FloatArray, F: FloatArray, H: FloatArray, output: FloatArray,
    found: FloatArray,
) -> None:  # fmt: skip
    """Take states (m, L) over whole cycles, in place; found (4, L): mean, mean square, extremes at last."""
    m, runs = z.shape
    zs = np.empty_like(z)
    vs = np.empty_like(z)
    dz = np.empty_like(z)
    dv = np.empty_like(z)
    force = np.empty_like(z)
    d = np.empty(runs)
    w = np.empty(runs)
    found[2] = np.inf
    found[3] = -np.inf
    for cycle in range(cycles + observed):
        for s in range(h.size):
            if cycle >= cycles:
                for q in range(runs):
                    y = 0.0
                    for p in range(m):
                        y += output[p] * z[p, q]
                    found[0, q] += h[s] * y / observed
                    found[1, q] += h[s] * y * y / observed
                    found[2, q] = min(found[2, q], y)
                    found[3, q] = max(found[3, q], y)
            for stage in range(4):
                node = (stage + 1) // 2
                ahead = 0.0 if stage == 0 else 0.5 * h[s] if stage < 3 else h[s]
                weight = h[s] / 6.0 if stage in (0, 3) else h[s] / 3.0
                for p in range(m):
                    for q in range(runs):
                        if stage == 0:
                            zs[p, q] = z[p, q]
                            vs[p, q] = v[p, q]
                        else:
                            step = vs[p, q]
                            zs[p, q] = z[p, q] + ahead * step
                            vs[p, q] = v[p, q] + ahead * force[p, q]
                for p in range(m):
                    for q in range(runs):
                        force[p, q] = T[q] * T[q] * (F[p] + parameter[q] * H[p])
                    for r in range(m):
                        if K[p, r] != 0.0 or C[p, r] != 0.0:
                            for q in range(runs):
                                force[p, q] -= T[q] * (T[q] * K[p, r] * zs[r, q] + C[p, r] * vs[r, q])
                for i in range(u.shape[0]):
                    stiff = k[s, node, i]
                    damped = c[s, node, i]
                    if stiff == 0.0 and damped == 0.0:
                        continue
                    for q in range(runs):
                        d[q], w[q] = -e[s, node, i], -b[s, node, i]
                    for p in range(m):
                        for q in range(runs):
                            d[q] += u[i, p] * zs[p, q]
                            w[q] += u[i, p] * vs[p, q]
                    for q in range(runs):
                        load = T[q] * (T[q] * stiff * d[q] + damped * w[q])
                        d[q] = load if d[q] > 0.0 and load > 0.0 else 0.0
                    for p in range(m):
                        if a[s, node, i, p] != 0.0:
                            for q in range(runs):
                                force[p, q] += a[s, node, i, p] * d[q]
                for p in range(m):
                    for q in range(runs):
                        if stage == 0:
                            dz[p, q] = weight * vs[p, q]
                            dv[p, q] = weight * force[p, q]
                        else:
                            dz[p, q] += weight * vs[p, q]
                            dv[p, q] += weight * force[p, q]
            for p in range(m):
                for q in range(runs):
                    z[p, q] += dz[p, q]
                    v[p, q] += dv[p, q]
