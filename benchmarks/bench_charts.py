"""Charts that refine themselves against the full grid and against closed forms.

    python -m benchmarks.bench_charts [PAIRS]

prints the tables of docs/verification/charts.md; processor seconds.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import ndimage

from floquet import stability_chart
from floquet.engine.multipliers import radii_with_bounds, verdicts
from floquet.engine.refinement import NodeValues, gaps, refine
from floquet.gear.axes import speed_range
from lumped import load_gear_pair, preset_names
from lumped.errors import ParameterError, SpurcheckError
from tests.evidence.floquet.reference_systems import mathieu_many, mathieu_unstable, meissner_trace
from tests.unlike_pairs import UNLIKE, unlike_pair

SIZES = (500, 1000, 2000)
COULOMB = {"friction.law": "coulomb", "friction.coefficient": 0.05}
PAIRS = {
    "28/28 Coulomb": load_gear_pair("nasa_28_28").with_(COULOMB),
    "28/28 own law": load_gear_pair("nasa_28_28"),
    "fzg_c": load_gear_pair("fzg_c"),
    "50/50": load_gear_pair("kahraman_blankenship_50_50"),
}
#: Pairs and laws of friction with breaks that move along the path at some speeds.
MOVING_FRICTION = (
    ("fzg_c", "benedict_kelley"),
    ("fzg_c", "smoothed_coulomb"),
    ("fzg_c", "composite"),
    ("heavily_relieved_under_load", "coulomb"),
    ("heavily_relieved_under_load", "composite"),
    ("nasa_art_25_31", "composite"),
    ("contact_ratio_1_1_large_shifts", "composite"),
)
WITHOUT_NUMBERS = dict.fromkeys(
    f"friction.{name}" for name in ("coefficient", "maximum", "sharpness", "thresholds")
)
LAWS = ("none", "coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb", "composite")


def cpu(call: Callable[[], Any]) -> tuple[Any, float]:
    """Result and processor seconds of a call."""
    start = time.process_time()
    result = call()
    return result, time.process_time() - start


def compared(got: Any, full: Any) -> tuple[int, int, int]:
    """Unstable regions of the full grid, those of which the refined chart has no node, wrong verdicts."""
    unstable = np.asarray(full.verdict) < 0
    numbered, count = ndimage.label(unstable, structure=np.ones((3, 3)))
    seen = np.unique(numbered[np.asarray(got.verdict) < 0])
    return (
        count,
        count - np.count_nonzero(seen),
        int((np.asarray(got.verdict) != np.asarray(full.verdict)).sum()),
    )


def by_size() -> None:
    print("| pair | N | evaluated | s | proven of them | largest bound | full grid: s, differences |")
    print("|---|---|---|---|---|---|---|")
    for name, pair in PAIRS.items():
        stability_chart(pair, {"speed_rpm": [3000.0, 4000.0]})
        for n in SIZES:
            axes = {"speed_rpm": np.linspace(500.0, 20000.0, n), "damping_ratio": np.linspace(0.001, 0.1, n)}
            got, seconds = cpu(lambda pair=pair, axes=axes: stability_chart(pair, axes))
            is_known = got.known.values
            words_of_full_grid = ""
            if n == SIZES[0]:
                full, each = cpu(lambda pair=pair, axes=axes: stability_chart(pair, axes, refine=False))
                regions, lost, wrong = compared(got, full)
                error_elsewhere = np.abs(got.spectral_radius - full.spectral_radius).values[~is_known]
                rms = np.sqrt(np.mean(error_elsewhere**2))
                words_of_full_grid = f"{each:.1f}; {regions} regions, {lost} lost, {wrong} wrong; "
                words_of_full_grid += f"ρ elsewhere {error_elsewhere.max():.1e}, rms {rms:.0e}"
            print(
                f"| {name} | {n} | {is_known.mean():.2%} | {seconds:.1f} | "
                f"{got.proven.values[is_known].mean():.0%} | {got.error.values[is_known].max():.0e} | "
                f"{words_of_full_grid} |",
                flush=True,
            )


def proofs() -> None:
    """Proven share of charts, from 500 to 20000 rpm and over the speed range of the pair; random points."""
    print("| pair | rpm | damping | s | stable | unstable | not proven | contradicted |")
    print("|---|---|---|---|---|---|---|---|")
    names = ("nasa_28_28", "fzg_c", "kahraman_blankenship_50_50", "nasa_art_25_31")
    rng = np.random.default_rng(7)
    for pair in map(load_gear_pair, names):
        for ends in (speed_range(pair), (500.0, 20000.0)):
            for low in (0.01, 0.001):
                axes = {"speed_rpm": np.linspace(*ends, 801), "damping_ratio": np.linspace(low, 0.1, 201)}
                chart, seconds = cpu(lambda axes=axes, pair=pair: stability_chart(pair, axes, prove=True))
                cells = chart.cell_verdict.values
                cell_indices = rng.integers(0, [[800], [200]], (2, 500))
                random_points = {
                    n: v[k] + rng.uniform(size=k.size) * np.diff(v)[k]
                    for (n, v), k in zip(axes.items(), cell_indices, strict=True)
                }
                wrong = 0
                for part in np.array_split(np.arange(cell_indices.shape[1]), 50):
                    # A chart of some speeds by some damping ratios has all of their pairs.
                    axes_of_part = {n: np.unique(v[part]) for n, v in random_points.items()}
                    full = stability_chart(pair, axes_of_part, refine=False, rtol=1e-9).verdict.values
                    i, j = (np.searchsorted(axes[n], axes_of_part[n]) - 1 for n in axes)
                    verdicts_of_cells = cells[np.ix_(i, j)]
                    wrong += int(((full != verdicts_of_cells) & (verdicts_of_cells != 0)).sum())
                shares = " | ".join(f"{np.mean(cells == k):.3%}" for k in (1, -1, 0))
                rpm = f"{ends[0]:.0f} to {ends[1]:.0f}"
                print(
                    f"| {pair.name} | {rpm} | {low} to 0.1 | {seconds:.1f} | {shares} | {wrong} |", flush=True
                )


def moving_friction(points: int = 600, parts: int = 30) -> None:
    """Proven share where breaks of friction move with the speed; random points in the proven cells."""
    print("| pair | law | proven | s | points in proven cells | contradicted |")
    print("|---|---|---|---|---|---|")
    rng = np.random.default_rng(11)
    for name, law in MOVING_FRICTION:
        pair = (unlike_pair(name) if name in UNLIKE else load_gear_pair(name)).healthy
        pair = pair.with_({**WITHOUT_NUMBERS, "friction.law": law})
        axes = {"speed_rpm": np.linspace(500.0, 20000.0, 201), "damping_ratio": np.linspace(0.005, 0.1, 61)}
        chart, seconds = cpu(lambda pair=pair, axes=axes: stability_chart(pair, axes, prove=True))
        cells = chart.cell_verdict.values
        places = rng.integers(0, [[200], [60]], (2, points))
        random_points = {
            n: v[k] + rng.uniform(size=k.size) * np.diff(v)[k]
            for (n, v), k in zip(axes.items(), places, strict=True)
        }
        seen = wrong = 0
        for part in np.array_split(np.arange(points), parts):
            of_part = {n: np.unique(v[part]) for n, v in random_points.items()}
            full = stability_chart(pair, of_part, refine=False, rtol=1e-9).verdict.values
            i, j = (np.searchsorted(axes[n], of_part[n]) - 1 for n in axes)
            of_cells = cells[np.ix_(i, j)]
            seen += int((of_cells != 0).sum())
            wrong += int(((full != of_cells) & (of_cells != 0)).sum())
        row = f"{pair.name} | {law} | {chart.proven_share:.1%} | {seconds:.1f} | {seen} | {wrong}"
        print(f"| {row} |", flush=True)


def random_chart(rng: np.random.Generator) -> tuple[Any, dict[str, Any]]:
    """A preset with changed damping, friction, torque and bearings, and two axes of it."""
    name = rng.choice(preset_names())
    law = str(rng.choice(LAWS))
    pair = load_gear_pair(str(name))
    changes: dict[str, Any] = {
        "friction.law": law,
        "mesh.contact": str(rng.choice(["prescribed", "loaded"])),
        "mesh.damping_ratio": float(10.0 ** rng.uniform(-3.0, -1.3)),
    }
    changes["operating.pinion_torque"] = pair.operating.pinion_torque * float(rng.uniform(0.5, 1.5))
    if law in ("coulomb", "smoothed_coulomb"):
        changes["friction.coefficient"] = float(rng.uniform(0.0, 0.3))
    damping = float(rng.choice([0.0, 0.005, 0.02, 0.05]))
    changes |= {
        f"bearings.{g}.{d}_damping_ratio": damping for g in ("pinion", "gear") for d in ("loa", "oloa")
    }
    pair = pair.with_(changes)
    low, high = speed_range(pair)
    axes: dict[str, Any] = {"speed_rpm": np.linspace(low, high * float(rng.uniform(1.0, 2.0)), 201)}
    others = (
        "damping_ratio",
        "geometric",
        "friction_coefficient",
        "stiffness_variation",
        "bearing_stiffness",
    )
    other = str(rng.choice((*others, "torque"), p=(0.3, 0.2, 0.2, 0.1, 0.1, 0.1)))
    if law in ("benedict_kelley", "composite") and other not in others[:3]:
        other = "damping_ratio"  # a fit at every node of other axes, each of 0.03 s, would take hours
    k = pair.bearings.pinion.loa_stiffness
    torque = pair.operating.pinion_torque
    values = {
        "damping_ratio": np.linspace(float(rng.choice([0.0, 0.001])), 0.1, 65),
        "geometric": np.geomspace(1e-4, 0.1, 65),
        "friction_coefficient": np.linspace(0.0, 0.3, 65),
        "torque": np.linspace(0.3 * torque, 1.5 * torque, 65),
        "stiffness_variation": np.linspace(0.0, 1.5, 65),
        "bearing_stiffness": np.geomspace(0.3 * k, 3.0 * k, 65),
    }
    axes["damping_ratio" if other == "geometric" else other] = values[other]
    return pair, axes


def at_random(count: int, seed: int, *, damping: bool) -> None:
    rng = np.random.default_rng(seed)
    rows = []
    while len(rows) < count:
        try:
            pair, axes = random_chart(rng)
            if "damping_ratio" in axes and not damping:
                continue
            got, seconds = cpu(lambda pair=pair, axes=axes: stability_chart(pair, axes, rtol=1e-9))
            full, full_seconds = cpu(
                lambda pair=pair, axes=axes: stability_chart(pair, axes, rtol=1e-9, refine=False)
            )
        except (SpurcheckError, ParameterError):  # what cannot exist, as a law outside its formula
            continue
        is_known = got.known.values
        rows.append(
            (*compared(got, full), is_known.mean(), got.proven.values[is_known].mean(), seconds, full_seconds)
        )
        regions, lost, wrong, *_ = rows[-1]
        if lost or wrong:
            print(
                f"{(regions, lost, wrong)} of {pair.name}, {pair.friction.law}, over {list(axes)[1]}",
                flush=True,
            )
    regions, lost, wrong, shares, proven, seconds, full_seconds = np.array(rows).T
    print(
        f"{count} random pairs and axes{'' if damping else ' other than damping'}: "
        f"{regions.sum():.0f} regions, {lost.sum():.0f} lost, "
        f"{wrong.sum():.0f} wrong verdicts; evaluated {shares.min():.1%} to {shares.max():.1%}, "
        f"median {np.median(shares):.1%}; all evaluated nodes proven in {np.mean(proven == 1.0):.0%} "
        f"of the charts; {seconds.sum():.0f} s against {full_seconds.sum():.0f} s"
    )


def closed_forms(n: int) -> None:
    """Mathieu to m = 6 and Meissner; parts of tongues that are at most two steps wide are left out."""
    a = np.linspace(0.5, 42.0, n)
    q = np.linspace(0.0, 12.0, n)

    def ask(flat_index: Any) -> Any:
        i, j = np.unravel_index(flat_index, (n, n))
        values, errors = mathieu_many(a[i], q[j])
        radius, error = radii_with_bounds(values, errors)
        return NodeValues(radius, verdicts(radius, error), gaps(values))

    got, seconds = cpu(lambda: refine((n, n), np.ones(n), ask, rows=(0, n // 2, -1)))
    wrong = thin = 0
    for j in range(1, n):
        unstable, edges = mathieu_unstable(a, float(q[j]))
        width = np.diff(edges, prepend=-np.inf, append=np.inf)[np.searchsorted(edges, a)]
        narrow = unstable & (width <= 2.0 * (a[1] - a[0]))
        wrong_verdict = ((got.verdict[:, j] < 0) != unstable) & (
            np.abs(a[:, None] - edges).min(axis=1) > 1e-6
        )
        wrong = wrong + int((wrong_verdict & ~narrow).sum())
        thin = thin + int((wrong_verdict & narrow).sum())
    share = f"{got.known.mean():.2%} evaluated, {seconds:.1f} s"
    print(f"Mathieu {n} x {n}: {share}, {wrong} wrong verdicts, {thin} in thin parts")
    delta = np.linspace(0.5, 9.0, n)
    epsilon = np.linspace(0.0, 0.45, n)

    def trace(d: Any, e: Any) -> Any:
        w1 = np.sqrt(d + e)
        w2 = np.sqrt(d - e)
        p1 = np.pi * w1
        p2 = np.pi * w2
        return 2.0 * np.cos(p1) * np.cos(p2) - (w1 / w2 + w2 / w1) * np.sin(p1) * np.sin(p2)

    def meissner(flat_index: Any) -> Any:
        i, j = np.unravel_index(flat_index, (n, n))
        half = 0.5 * np.abs(trace(delta[i], epsilon[j]))
        radius = np.where(half > 1.0, half + np.sqrt(np.maximum(half**2 - 1.0, 0.0)), 1.0)
        angle = np.arccos(np.clip(0.5 * trace(delta[i], epsilon[j]), -1.0, 1.0))
        values = np.exp(1j * np.stack([angle, -angle], axis=1)) * np.stack([radius, 1.0 / radius], axis=1)
        return NodeValues(radius, verdicts(radius, np.full(radius.size, 1e-9)), gaps(values))

    assert abs(trace(3.0, 0.2) - meissner_trace(3.0, 0.2)) < 1e-12
    got, seconds = cpu(lambda: refine((n, n), np.ones(n), meissner, rows=(0, n // 2, -1)))
    exact = np.abs(trace(delta[:, None], epsilon))
    wrong_verdict = ((got.verdict < 0) != (exact > 2.0)) & (np.abs(exact - 2.0) > 1e-8)
    share = f"{got.known.mean():.2%} evaluated, {seconds:.1f} s"
    print(f"Meissner {n} x {n}: {share}, {int(wrong_verdict.sum())} wrong verdicts")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    by_size()
    proofs()
    moving_friction()
    for seed, damping in ((34, True), (35, False), (36, False)):
        at_random(int(sys.argv[1]) if len(sys.argv) > 1 else 40, seed, damping=damping)
    closed_forms(2000)
