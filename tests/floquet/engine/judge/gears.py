"""Gear pairs for the judge: random ones of every stiffness model, and their equations in exact numbers.

The equations are those of docs/theory/equations.md, written again from the structure's masses, arms and
supports and from the piecewise polynomials k, c and mu of a tooth pair, all floats taken as exact.
"""

import bisect
from itertools import pairwise
from typing import Any

import numpy as np
from balls import Piece, polynomial  # type: ignore[import-not-found]
from flint import arb, arb_poly, fmpq

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


def pieces(pair: GearPair, cycle: MeshCycle | None = None) -> list[Piece]:
    """x' = A(t) x for x = (q, x_p, x_g, and their rates over a unit that makes both of like size)."""
    system = periodic_system(pair, "mesh", cycle=cycle)
    cycle = system.cycle
    s = system.structure
    g = cycle.geometry
    laws = cycle.elements
    pitch = exact(g.base_pitch)
    first = exact(g.L_XA)
    last = exact(g.L_XD)
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
    pieces_of_cycle = []
    for low, high in pairwise(ordered):
        middle = (low + high) / 2
        w, wd = ([arb_poly([0]) for _ in range(3)] for _ in range(2))
        for i in pairs:
            if first + (middle + i) * pitch > last:
                continue
            mu = _over(laws.friction, first, pitch, i, middle)
            xi = arb_poly([ball(first + i * pitch), ball(pitch)])
            for r in range(3):
                row = arb_poly([normal[r]]) + mu * (arb_poly([arm0[r]]) + xi * arb_poly([arm1[r]]))
                w[r] += _over(laws.stiffness, first, pitch, i, middle) * row
                wd[r] += _over(laws.damping, first, pitch, i, middle) * row
        entries = [(r, 3 + r, polynomial(arb_poly([unit_rate]))) for r in range(3)]
        for r in range(3):
            for c in range(3):
                terms = [(w[r], arb(1) / unit_rate, supports), (wd[r], arb(1), dampers)]
                for shift, (gain, unit, constant) in zip((0, 3), terms, strict=True):
                    total = gain * arb_poly([deflection[c]]) - arb_poly([constant[r] if r == c else 0])
                    # The polynomials are over the phase: time over the period.
                    scaled = (total * arb_poly([unit]))(arb_poly([0, 1 / period]))
                    entries.append((3 + r, shift + c, polynomial(scaled)))
        pieces_of_cycle.append(Piece(ball(low) * period, ball(high - low) * period, entries))
    return pieces_of_cycle


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
