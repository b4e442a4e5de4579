"""Gear pairs for the judge: random ones of every stiffness model, and their equations in exact numbers.

The equations are those of docs/theory/equations.md, written again from the structure's masses, arms and
supports and from the piecewise polynomials k, c and mu of a tooth pair, all floats taken as exact.
"""

import bisect
from itertools import pairwise
from typing import Any

import numpy as np
from balls import Coefficients, Piece, polynomial  # type: ignore[import-not-found]
from flint import arb, arb_poly, arb_series, ctx, fmpq

from lumped import GearPair, load_gear_pair
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import periodic_system
from lumped.path_function import PathFunction

PRESETS = ("nasa_28_28", "nasa_art_25_31", "kahraman_blankenship_50_50", "fzg_c")
LAWS = ("none", "coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb", "composite")
MODELS = ("rectangular", "parabolic", "energy", "table", "wild table", "total table", "relief")


def exact(value: float) -> fmpq:
    numerator, denominator = float(value).as_integer_ratio()
    return fmpq(numerator, denominator)


def ball(value: fmpq | float) -> arb:
    q = value if isinstance(value, fmpq) else exact(value)
    return arb(q.p) / arb(q.q)


def pieces(pair: GearPair, cycle: MeshCycle | None = None, factor: float = 1.0) -> list[Piece]:
    """x' = A(t) x for x = (q, x_p, x_g, and their rates over a unit that makes both of like size).

    With a factor on the variation of the total stiffness k about its mean, every stiffness goes with
    f = (mean + factor (k - mean))/k and every damping with sqrt f.
    """
    system = periodic_system(pair, "mesh", cycle=cycle)
    cycle, s = system.cycle, system.structure
    g, laws = cycle.geometry, cycle.elements
    pitch, first, last = exact(g.base_pitch), exact(g.L_XA), exact(g.L_XD)
    period = ball(g.mesh_period)
    rows = [[ball(x) for x in (g.base_radius_pinion, -g.base_radius_gear, 0.0, 0.0)]]
    rows += [[arb(0), arb(0), arb(1), arb(0)], [arb(0), arb(0), arb(0), arb(1)]]
    mass = [ball(x) for x in s.mass[:4]]

    def reduced(force: np.ndarray) -> list[arb]:
        return [sum((r[i] * ball(force[i]) / mass[i] for i in range(4)), arb(0)) for r in rows]

    normal, arm0, arm1 = (reduced(x) for x in (s.normal, s.friction_arm[:, 0], s.friction_arm[:, 1]))
    supports = [arb(0), *(ball(s.stiffness[i]) / mass[i] for i in (2, 3))]
    dampers = [arb(0), *(ball(s.damping[i]) / mass[i] for i in (2, 3))]
    deflection = (1, 1, -1)
    largest = float(laws.stiffness(np.linspace(g.L_XA, g.L_XD, 2001)).max())
    stiffest = max(largest / float(np.abs(s.mass[2:4]).min()), float((s.stiffness[2:4] / s.mass[2:4]).max()))
    unit_rate = 2 ** round(0.5 * np.log2(stiffest))
    pairs = range(g.pairs)  # in contact at most: pair i at A - i pitch earlier
    marks = {fmpq(0), fmpq(1)}
    for function in (laws.stiffness, laws.damping, laws.friction):
        for place in (*function.breaks, g.L_XP, g.L_XD):
            phase = (exact(place) - first) / pitch
            for i in pairs:
                if 0 < phase - i < 1:
                    marks.add(phase - i)
    ordered = sorted(marks)
    mean = _mean(laws.stiffness, pitch)
    found = []
    for low, high in pairwise(ordered):
        middle = (low + high) / 2
        w, wd = ([arb_poly([0]) for _ in range(3)] for _ in range(2))
        whole = arb_poly([0])
        for i in pairs:
            if first + (middle + i) * pitch > last:
                continue
            mu = _over(laws.friction, first, pitch, i, middle)
            whole += _over(laws.stiffness, first, pitch, i, middle)
            xi = arb_poly([ball(first + i * pitch), ball(pitch)])
            for r in range(3):
                row = arb_poly([normal[r]]) + mu * (arb_poly([arm0[r]]) + xi * arb_poly([arm1[r]]))
                w[r] += _over(laws.stiffness, first, pitch, i, middle) * row
                wd[r] += _over(laws.damping, first, pitch, i, middle) * row
        if factor != 1.0:
            wanted = arb_poly([mean]) + (whole - arb_poly([mean])) * arb_poly([ball(factor)])
            moved = (arb_poly([0, 1 / period]), unit_rate, period, ball(low), ball(high))
            found += _varied(w, wd, whole, wanted, (supports, dampers, deflection), *moved)
            continue
        entries = [(r, 3 + r, polynomial(arb_poly([unit_rate]))) for r in range(3)]
        for r in range(3):
            for c in range(3):
                own = [(w[r], arb(1) / unit_rate, supports), (wd[r], arb(1), dampers)]
                for shift, (gain, unit, constant) in zip((0, 3), own, strict=True):
                    total = gain * arb_poly([deflection[c]]) - arb_poly([constant[r] if r == c else 0])
                    # The polynomials are over the phase: time over the period.
                    scaled = (total * arb_poly([unit]))(arb_poly([0, 1 / period]))
                    entries.append((3 + r, shift + c, polynomial(scaled)))
        found.append(Piece(ball(low) * period, ball(high - low) * period, entries))
    return found


def _mean(stiffness: PathFunction, pitch: fmpq) -> arb:
    """Mean over a cycle of the total stiffness: the integral over the path over one pitch."""
    total = arb(0)
    for j, (low, high) in enumerate(pairwise(stiffness.breaks)):
        poly = arb_poly([ball(c) for c in stiffness.coefficients[::-1, j]])
        total += poly.integral()(ball(exact(high) - exact(low)))
    return total / ball(pitch)


def _varied(
    w: list[arb_poly],
    wd: list[arb_poly],
    whole: arb_poly,
    wanted: arb_poly,
    constant: tuple[list[arb], list[arb], tuple[int, int, int]],
    phase: arb_poly,
    unit_rate: float,
    period: arb,
    low: arb,
    high: arb,
) -> list[Piece]:
    """Pieces with the gains w wanted/whole and wd sqrt(wanted/whole), short enough for their bounds."""
    supports, dampers, deflection = constant
    polys = [poly(phase) for poly in (*w, *wd, whole, wanted)]
    reach = 4.0

    def entry(r: int, c: int, rate: bool) -> Coefficients:
        own = (dampers if rate else supports)[r] if r == c else arb(0)
        unit = arb(1) if rate else arb(1) / unit_rate

        def coefficients(start: arb, length: arb, count: int) -> list[arb]:
            kept, ctx.cap = ctx.cap, count
            move = arb_poly([start, length])
            gain, k, new = (arb_series(polys[i](move), count) for i in (r + 3 * rate, 6, 7))
            f = new / k
            out = gain * (f.sqrt() if rate else f) * deflection[c] - own
            ctx.cap = kept
            return [out[j] * unit for j in range(count)]

        return coefficients

    def bound(start: arb, length: arb) -> tuple[arb, float]:
        move = arb_poly([start, length])
        sizes, floors = [], []
        for poly in polys:
            here = poly(move)
            rest = sum((abs(here[j]) * arb(reach) ** j for j in range(1, here.degree() + 1)), arb(0))
            sizes.append((abs(here[0]) + rest).upper())
            floors.append((here[0] - rest).lower())
        if not (floors[6] > 0 and floors[7] > 0):  # both stay right of zero: the root is analytic
            return arb("inf"), reach
        f = sizes[7] / floors[6]
        stiff = (max(sizes[:3], key=float) * f + max(supports, key=float)) / unit_rate
        damp = max(sizes[3:6], key=float) * f.sqrt() + max(dampers, key=float)
        return (stiff + damp + arb(unit_rate)).upper(), reach

    entries = [(r, 3 + r, polynomial(arb_poly([unit_rate]))) for r in range(3)]
    entries += [
        (3 + r, c + 3 * rate, entry(r, c, rate)) for r in range(3) for c in range(3) for rate in (False, True)
    ]
    waiting, found = [(low * period, (high - low) * period)], []
    while waiting:
        start, length = waiting.pop()
        if bound(start, length)[0].is_finite():
            found.append(Piece(start, length, entries, bound))
        else:
            waiting += [(start + length / 2, length / 2), (start, length / 2)]
    return found


def _over(function: PathFunction, first: fmpq, pitch: fmpq, i: int, middle: fmpq) -> arb_poly:
    """The polynomial of a law over the phase, pair i being at first + (phase + i) pitch."""
    place = first + (middle + i) * pitch
    breaks = [exact(b) for b in function.breaks]
    j = min(max(bisect.bisect_right(breaks, place) - 1, 0), len(breaks) - 2)
    local = arb_poly([ball(first + i * pitch - breaks[j]), ball(pitch)])
    return arb_poly([ball(c) for c in function.coefficients[::-1, j]])(local)


def random_pair(rng: np.random.Generator, model: str) -> GearPair:
    """A random gear pair with a stiffness model out of `MODELS`."""
    pair = load_gear_pair(str(rng.choice(PRESETS))).with_(mesh__contact="prescribed")
    changes: dict[str, Any] = {
        "operating.pinion_speed": float(np.exp(rng.uniform(np.log(800), np.log(20000)))),
        "operating.pinion_torque": float(rng.uniform(20, 200)),
        "mesh.damping_ratio": float(rng.choice([0.0, rng.uniform(0, 0.02), rng.uniform(0, 0.1)])),
        "friction.law": str(rng.choice(LAWS)),
    }
    for gear in ("pinion", "gear"):
        changes[f"bearings.{gear}.loa_stiffness"] = float(10 ** rng.uniform(7.3, 9))
        changes[f"bearings.{gear}.loa_damping_ratio"] = float(rng.choice([0.0, rng.uniform(0, 0.1)]))
    pair = pair.with_(changes)
    if model == "relief":
        relieved = load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed").with_(changes)
        return relieved.with_(
            {"mesh.relief": "static", "mesh.stiffness": {"model": str(rng.choice(MODELS[:3]))}}
        )
    return pair.with_({"mesh.stiffness": stiffness(rng, model, pair)})


def stiffness(rng: np.random.Generator, model: str, pair: GearPair) -> dict[str, Any]:
    """Parameters of a stiffness model."""
    ramp = float(rng.choice([0.0, 0.3]))
    if model == "rectangular":
        return {"model": "rectangular", "pair_stiffness": float(10 ** rng.uniform(8, 8.9))}
    if model in ("parabolic", "energy"):
        return {"model": model, "ramp_length": ramp}
    g = pair.geometry
    count = int(rng.choice([12, 60, 200]))
    total = model == "total table"
    x = np.linspace(0.0, 1.0 if total else g.contact_ratio, count)
    y = 3e8 * (1.0 - 0.3 * (2.0 * x / x[-1] - 1.0) ** 2) * (1.0 + 0.02 * rng.normal(size=count))
    if model == "wild table":
        y[rng.integers(1, count - 1)] *= float(rng.choice([1.2, 3.0, 300.0]))
    if total:
        y = 5e8 * (1.0 + 0.2 * np.sin(2 * np.pi * x)) * (1.0 + 0.02 * rng.normal(size=count))
        y[-1] = y[0]
    return {
        "model": "table", "axis": "phase", "points": x.tolist(), "stiffness": y.tolist(),
        "kind": "total" if total else "pair", "ramp_length": ramp,
        "interpolation": "monotone" if model == "wild table" else str(rng.choice(["monotone", "cubic"])),
    }  # fmt: skip
