"""Monodromy matrix of a gear pair in extended precision, to measure the errors of the other routes by.

It integrates the piecewise polynomials k(xi), c(xi) and mu(xi) themselves, not what has been fitted to them.

Sources: docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

import warnings
from itertools import pairwise

import numpy as np
import xarray as xr
from scipy.optimize import linear_sum_assignment

from floquet.gear.block import gear_block
from floquet.rank_one.batch import fast_multipliers
from floquet.rank_one.coarsening import coarsened
from floquet.rank_one.extended import LongArray, extended_transitions
from lumped import preset_names
from lumped.arguments import whole_number
from lumped.errors import LawRangeWarning
from lumped.friction import LAWS
from lumped.labelling import labelled_dataset
from lumped.model.periodic_system import LTVSystem, periodic_system
from lumped.path_function import PathFunction, shifted
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

RATE = 1e4
"""Rates are in units of this [1/s], so that positions and rates are of like size."""
_LD = np.longdouble
_LAPACK = 1e-13


def extended_monodromy(pair: AnyPair) -> FloatArray:
    """Monodromy matrix (6, 6) of (q, x_p, x_g) and their rates over ``RATE``, all in units of m."""
    pair = load_gear_pair(pair)
    system = periodic_system(pair, "mesh")
    lengths, w, wd = _steps(system)
    L, D = (-system.constant[3:, part].astype(_LD) for part in (slice(3), slice(3, 6)))
    flows = extended_transitions(lengths, w, wd, L, D, system.deflection.astype(_LD), RATE)
    M = np.eye(6, dtype=_LD)
    for flow in flows:
        M = flow @ M
    return np.asarray(M, dtype=float)


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


def _steps(system: LTVSystem) -> tuple[LongArray, LongArray, LongArray]:
    """Cut the period at all breaks and into steps that turn by 1 rad at most.

    Returns lengths (S,) [s], and w, wd (S, d+1, 3) in powers of the time since the start.
    """
    cycle, s = system.cycle, system.structure
    e, g = cycle.elements, cycle.geometry
    speed = _LD(g.omega_pinion * g.base_radius_pinion)
    normal = ((s.normal / s.mass) @ system.reduction.T).astype(_LD)
    arm = [((s.friction_arm[:, i] / s.mass) @ system.reduction.T).astype(_LD) for i in (0, 1)]
    stiffest = float(np.abs(system.constant[3:, :3]).max())
    lengths, gains, offsets = [], [], []
    for low, high in pairwise(cycle.breaks):
        if high - low < 1e-13 * cycle.period:
            continue
        both = [np.zeros((30, 3), dtype=_LD) for _ in range(2)]
        for offset in cycle.offsets:
            start, middle = offset + float(speed) * low, offset + float(speed) * 0.5 * (low + high)
            if not cycle.start <= middle <= cycle.end:
                continue
            mu = _about(e.friction, start, middle)
            moved = np.append(mu, _LD(0)) * _LD(start)
            moved[1:] += mu
            row = np.zeros((mu.size + 1, 3), dtype=_LD)
            row[0] = normal
            row[: mu.size] += mu[:, None] * arm[0]
            row += moved[:, None] * arm[1]
            for target, function in zip(both, (e.stiffness, e.damping), strict=True):
                load = _about(function, start, middle)
                for r in range(3):
                    product = np.convolve(load, row[:, r])
                    target[: product.size, r] -= product
        w, wd = (poly * (speed ** np.arange(30))[:, None] for poly in both)
        rate = np.sqrt(stiffest + 3.0 * float(np.abs(w[0]).max())) + 3.0 * float(np.abs(wd[0]).max())
        count = max(1, int(np.ceil((high - low) * rate)))
        h = (_LD(high) - _LD(low)) / count
        for k in range(count):
            lengths.append(h)
            offsets.append(h * k)
            gains.append((w, wd))
    degree = 1 + max(
        int(np.flatnonzero(np.abs(x).max(axis=1)).max(initial=0)) for pair in gains for x in pair
    )
    per_segment: list[LongArray] = [
        np.stack([pair[j][degree - 1 :: -1] for pair in gains], axis=1) for j in range(2)
    ]
    w, wd = (
        shifted(poly, np.array(offsets, dtype=_LD)[:, None])[::-1].swapaxes(0, 1) for poly in per_segment
    )
    return np.array(lengths), w, wd


def _about(function: PathFunction, start: float, middle: float) -> LongArray:
    """Coefficients in powers of (xi - start), lowest first, of the piece that holds ``middle``."""
    j = int(np.clip(np.searchsorted(function.breaks, middle) - 1, 0, function.breaks.size - 2))
    return shifted(function.coefficients[:, j].astype(_LD), _LD(start) - _LD(function.breaks[j]))[::-1]


def stress_test(count: int, seed: int) -> xr.Dataset:
    """Errors of the compiled route on random gear pairs, measured by `extended_monodromy`.

    Each computed multiplier is matched with one of the reference so that the sum of the distances is least.

    Parameters
    ----------
    count : number of pairs
    seed : of the random numbers

    Returns
    -------
    Dataset over ``route`` and ``pair``: ``error``, the largest distance; ``bound``, the largest bound that
    was reported; ``excess``, the largest ratio of a distance to its bound. Routes: "fine", one fit as single
    points use it; "joined", with pieces joined as in dense charts.
    """
    count = whole_number("count", count, 1, 1_000_000)
    rng = np.random.default_rng(whole_number("seed", seed, 0, 2**63 - 1))
    result = np.empty((3, 2, count))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)  # random pairs leave the ranges of the laws
        for index in range(count):
            pair = random_pair(rng)
            exact = np.linalg.eigvals(extended_monodromy(pair))
            fine = gear_block(pair, rtol=1e-11, friction_apart=True)
            joined = coarsened(fine, fine.period, 1.0, [1.0], 5e-10)
            for route, block in enumerate((fine, joined)):
                found = fast_multipliers(block)
                distance = np.abs(found.multipliers[0][:, None] - exact)
                rows, columns = linear_sum_assignment(distance)
                error = distance[rows, columns]
                # LAPACK's own error in the eigenvalues of the reference is no error of ours.
                ratio = np.maximum(error - _LAPACK, 0.0) / found.errors[0]
                result[:, route, index] = error.max(), found.errors[0].max(), ratio.max()
    dims = ("route", "pair")
    return labelled_dataset(
        {
            "error": (dims, result[0], "1", "largest error of a multiplier"),
            "bound": (dims, result[1], "1", "largest bound reported"),
            "excess": (dims, result[2], "1", "largest error over its bound"),
        },
        {"route": (["fine", "joined"], "1", "pieces of the compiled route")},
        {"seed": seed, "mantissa_bits": np.finfo(np.longdouble).nmant + 1},
    )
