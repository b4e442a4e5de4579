"""Monodromy matrices of rank-one feedback systems in extended precision, to measure the kernel's errors by.

In plain coordinates and by a Taylor series of its own from the start of each step, the results share nothing
with the compiled kernel but the polynomials. Where long double is no more than a double (it has 64 bits of
mantissa on x86) they are only as good as any other route.

Sources: docs/theory/floquet.md, "Computing M".
"""

import warnings

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from floquet.engine.system import PeriodicSystem, second_order
from floquet.gear.axes import GearVariation
from floquet.gear.multipliers import feedback_system, fitted_block
from floquet.rank_one.batch import fast_multipliers
from floquet.rank_one.system import ModalForm, RankOneSystem
from lumped import GearPair, load_gear_pair, preset_names
from lumped.errors import LawRangeWarning
from lumped.friction import LAWS
from lumped.typing import FloatArray

_LAPACK = 1e-13
LongArray = npt.NDArray[np.longdouble]

_TERMS = 30  # of steps that turn by 1 rad at most: 1/30! is far below the precision
_LD = np.longdouble


def as_periodic_system(system: RankOneSystem) -> PeriodicSystem:
    """The same system for the general engine, which checks the kernel independently."""
    gains = system.total
    G = 0.0 if system.gyroscopic is None else system.gyroscopic

    def A(t: FloatArray) -> FloatArray:
        phase = t / system.period
        piece = np.clip(np.searchsorted(system.phases, phase, side="right") - 1, 0, system.phases.size - 2)
        low = system.phases[piece]
        high = system.phases[piece + 1]
        u = ((2.0 * phase - low - high) / (high - low))[:, None]
        w, wd = (
            np.einsum("tmj,tj->tm", poly[piece], u ** np.arange(poly.shape[2]))
            for poly in (gains.w, gains.wd)
        )
        C = system.damping + G / system.period + wd[..., None] * system.v
        return second_order(system.stiffness + w[..., None] * system.v, C)

    return PeriodicSystem(A, system.period, tuple(system.phases[1:-1] * system.period), vectorized=True)


def state_matrix(form: ModalForm) -> FloatArray:
    """Matrix (2m, 2m) that turns the states of the modal form, (omega eta, eta'), into (z, z')."""
    zero = np.zeros_like(form.shapes)
    return np.block([[form.shapes / form.omega, zero], [zero, form.shapes]])


def extended_transitions(
    h: LongArray, w: LongArray, wd: LongArray, L: LongArray, D: LongArray, v: LongArray, rate: float
) -> LongArray:
    """Transition matrices (S, 2m, 2m) of z'' + D z' + L z + w (v . z) + wd (v . z') = 0 over steps h (S,)."""
    m = v.size
    z = np.zeros((h.size, _TERMS + 2, m, 2 * m), dtype=_LD)
    z[:, 0, :, :m] = np.eye(m)
    z[:, 1, :, m:] = rate * np.eye(m)
    s, sd = np.zeros((2, h.size, _TERMS + 1, 2 * m), dtype=_LD)
    for k in range(_TERMS):
        speed = (k + 1) * z[:, k + 1]
        s[:, k] = v @ z[:, k]
        sd[:, k] = v @ speed
        n = min(k + 1, w.shape[1])
        total = L @ z[:, k] + D @ speed
        for gain, signal in ((w, s), (wd, sd)):
            total += np.einsum("tir,tic->trc", gain[:, :n], signal[:, k::-1][:, :n])
        z[:, k + 2] = -total / _LD((k + 1) * (k + 2))
    power = h[:, None] ** np.arange(_TERMS + 2)
    position = np.einsum("tk,tkrc->trc", power, z)
    speed = np.einsum("tk,tkrc->trc", power[:, :-1] * np.arange(1, _TERMS + 2), z[:, 1:]) / rate
    return np.concatenate([position, speed], axis=1)


def extended_matrix(system: RankOneSystem) -> LongArray:
    """Monodromy matrix (2m, 2m) in the energy coordinates of ``system.modal()``."""
    form = system.modal()
    total = system.total
    T = _LD(system.period)
    m = system.v.size
    rate = float(form.omega.max())
    count = max(total.w.shape[2], total.wd.shape[2])
    lengths = []
    starts = []
    gains = []
    for i, (low, high) in enumerate(zip(system.phases[:-1], system.phases[1:], strict=True)):
        parts = int(np.ceil(1.5 * rate * system.period * (high - low))) + 1
        both = np.zeros((2, count, m), dtype=_LD)
        for poly, given in zip(both, (total.w, total.wd), strict=True):
            poly[: given.shape[2]] = given[i].T
        for part in range(parts):
            lengths.append((_LD(high) - _LD(low)) * T / parts)
            starts.append(_LD(2 * part) / parts - _LD(1))
            # u = start + 2 t/((high - low) T)
            gains.append(_moved(both, starts[-1], _LD(2) / ((_LD(high) - _LD(low)) * T)))
    w, wd = np.stack(gains, axis=1)
    G = np.zeros((m, m)) if system.gyroscopic is None else system.gyroscopic
    D = system.damping.astype(_LD) + G.astype(_LD) / T
    M = np.eye(2 * m, dtype=_LD)
    L = system.stiffness.astype(_LD)
    v = system.v.astype(_LD)
    for flow in extended_transitions(np.array(lengths), w, wd, L, D, v, rate):
        M = flow @ M
    S = state_matrix(form).astype(_LD)
    S[m:] /= rate
    inverse = np.linalg.inv(S.astype(float)).astype(_LD)
    for _ in range(2):  # Newton
        inverse = inverse + inverse @ (np.eye(2 * m) - S @ inverse)
    return np.asarray(inverse @ M @ S)


def _moved(poly: LongArray, start: np.longdouble, slope: np.longdouble) -> LongArray:
    """Coefficients (..., d+1, m) in powers of u -> in powers of t, u = start + slope t."""
    out = np.zeros_like(poly)
    for j in range(poly.shape[-2] - 1, -1, -1):
        moved = start * out
        moved[..., 1:, :] += slope * out[..., :-1, :]
        out = moved
        out[..., 0, :] += poly[..., j, :]
    return out


def random_pair(rng: np.random.Generator) -> GearPair:
    """A random gear pair: preset, friction law, speed, torque, mesh damping and bearings."""
    changes: dict[str, object] = {
        "operating.pinion_speed": float(np.exp(rng.uniform(np.log(500), np.log(20000)))),
        "operating.pinion_torque": float(rng.uniform(20, 200)),
        "mesh.damping_ratio": float(rng.choice([0.0, rng.uniform(0, 0.1)])),
        "friction.law": str(rng.choice(list(LAWS))),
    }
    for gear in ("pinion", "gear"):
        changes[f"bearings.{gear}.loa_stiffness"] = float(10 ** rng.uniform(7.3, 9))
        changes[f"bearings.{gear}.loa_damping_ratio"] = float(rng.uniform(0, 0.1))
    return load_gear_pair(str(rng.choice(preset_names()))).with_(changes)


def stress_test(count: int, seed: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Largest error, bound and ratio of error to bound of the multipliers of random gear pairs.

    Computed multipliers are matched with the reference multipliers so that the sum of the distances is least.
    """
    rng = np.random.default_rng(seed)
    results = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)  # random pairs leave the ranges of the laws
        for _ in range(count):
            pair = random_pair(rng)
            block = fitted_block(feedback_system(GearVariation(pair, supports="springs")), 1.0, 1e-11, [0.0])
            exact = np.linalg.eigvals(extended_matrix(block).astype(float))
            ours = fast_multipliers(block)
            distance = np.abs(ours.multipliers[0][:, None] - exact)
            error = distance[linear_sum_assignment(distance)]
            # LAPACK's own error in the eigenvalues of the reference is no error of ours.
            ratio = np.maximum(error - _LAPACK, 0.0) / ours.errors[0]
            results.append((error.max(), ours.errors[0].max(), ratio.max()))
    error, bound, excess = np.array(results).T
    return error, bound, excess
