"""Development table of the ladder of explanations: wrong models, each with its true cause.

    python -m benchmarks.bench_check [number of a case ...]

The wrong models are those of `ForeignModel`, a small model with code of its own: constant coefficients in
each step, matrix exponentials, prescribed contact, Coulomb friction. Wrong models of
other authors are in ``benchmarks/foreign_models``.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import expm

import lumped
from lumped.path_of_contact import pair_stiffness
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.curves import Channel, Curves
from validation.check.ladder import Ladder, climb
from validation.check.problem import Problem
from validation.check.reference import lumped_motion

#: Steps in a mesh cycle of the foreign model, mesh cycles and samples in a mesh cycle of its curves.
STEPS = 1024
#: Parts of a step over which the coefficients are averaged, so that jumps inside a step count right.
PARTS = 16
CYCLES = 4
SAMPLES = 512
LIMIT = 0.05
UNLIKE = Path(__file__).parents[1] / "tests/unlike_pairs"
PAIRS = (
    "nasa_28_28",
    "fzg_c",
    "high_contact_ratio_29_47",
    "kahraman_blankenship_50_50",
    str(UNLIKE / "contact_ratio_1_1_large_shifts.toml"),
    str(UNLIKE / "rack_25_degrees_always_pushing.toml"),
)
CHANNELS = ("dte", "x_p", "x_g", "y_p", "y_g", "mesh_force", "bearing_force_x_p", "bearing_force_y_g")


def baseline(name: str) -> GearPair:
    """Return a pair with prescribed contact and Coulomb friction, which the foreign model has too."""
    pair = lumped.load_gear_pair(name).healthy
    changes = {
        "mesh.contact": "prescribed",
        "mesh.relief": "ignored",
        "friction.law": "coulomb",
        "friction.coefficient": 0.06,
    }
    return pair.with_(changes)


@dataclass(frozen=True)
class ForeignModel:
    """A linear model of the pair with six degrees of freedom, with mistakes.

    Attributes
    ----------
    stiffness : change of k(xi) [N/m] of a pair, given the positions and the values
    damping, mu, torque, speed : factors
    inertia, mass : factors of pinion and gear
    bearing, bearing_damping : factors of x_p, x_g, y_p, y_g
    moment, force : factors of the friction moments on both gears, and of the friction forces
    radius : factor of the base radii
    damper : "pair", "constant", "proportional"
    total : change of the total stiffness over the mesh cycle, given its samples
    scale, delay : factor and delay of channels
    swap : channels that change places
    """

    stiffness: Callable[[FloatArray, FloatArray], FloatArray] = lambda xi, k: k
    damping: float = 1.0
    mu: float = 1.0
    torque: float = 1.0
    speed: float = 1.0
    inertia: tuple[float, float] = (1.0, 1.0)
    mass: tuple[float, float] = (1.0, 1.0)
    bearing: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    bearing_damping: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    moment: tuple[float, float] = (1.0, 1.0)
    force: float = 1.0
    radius: float = 1.0
    damper: str = "pair"
    total: Callable[[FloatArray], FloatArray] | None = None
    scale: dict[str, float] = field(default_factory=dict)
    delay: dict[str, float] = field(default_factory=dict)
    swap: tuple[tuple[str, str], ...] = ()

    def curves(self, pair: GearPair, channels: tuple[str, ...] = CHANNELS, noise: float = 0.0) -> Curves:
        """Return the curves of the model; times are those of its own speed."""
        values, period = self._cycle(pair)
        index = (np.arange(CYCLES * SAMPLES) * (STEPS // SAMPLES) + 222) % STEPS
        random = np.random.default_rng(1)
        names = {one: other for pairs in self.swap for one, other in (pairs, pairs[::-1])}
        rows = []
        for name in channels:
            row = values[names.get(name, name)]
            row = np.roll(row, round(self.delay.get(name, 0.0) * STEPS))[index] * self.scale.get(name, 1.0)
            row = row + noise * np.std(row) * random.standard_normal(row.size)
            rows.append(Channel(name, name, row))
        return Curves("foreign", "time", np.arange(index.size) * period / SAMPLES, tuple(rows))

    def _cycle(self, pair: GearPair) -> tuple[dict[str, FloatArray], float]:
        """Return the channels over a mesh cycle of STEPS steps, and the period."""
        g = pair.geometry
        bodies = bodies_of(pair)
        k_of = pair_stiffness(pair)
        period = g.mesh_period / self.speed
        phase = (np.arange(STEPS * PARTS) + 0.5) / (STEPS * PARTS)
        number = int(np.ceil(g.contact_ratio))
        xi = g.L_XA + (phase[:, None] + np.arange(number)) * g.base_pitch
        inside = xi <= g.L_XD
        k = np.where(inside, self.stiffness(xi, k_of(np.minimum(xi, g.L_XD - 1e-12))), 0.0)
        if self.total is not None:
            whole = k.sum(axis=1)
            k = k * (self.total(whole) / whole)[:, None]
        whole = k.sum(axis=1)
        effective = bodies.effective_mass
        c = 2.0 * pair.mesh.damping_ratio * self.damping * np.sqrt(k * effective)
        if self.damper != "pair":
            mean = whole.mean()
            of_mesh = (
                2.0
                * pair.mesh.damping_ratio
                * np.sqrt(effective / mean)
                * (mean if self.damper == "constant" else whole)
            )
            c = k / whole[:, None] * np.broadcast_to(of_mesh, whole.shape)[:, None]
        mu = self.mu * float(pair.friction.coefficient or 0.0) * np.sign(xi - g.L_XP)
        radii = np.array([g.base_radius_pinion, g.base_radius_gear]) * self.radius
        inertia = np.array([bodies.inertia_pinion, bodies.inertia_gear]) * self.inertia
        mass = np.array([bodies.mass_pinion, bodies.mass_gear]) * self.mass
        mass4 = np.tile(mass, 2)
        b = pair.bearings
        kb = np.array(
            [b.pinion.loa_stiffness, b.gear.loa_stiffness, b.pinion.oloa_stiffness, b.gear.oloa_stiffness]
        )
        zb = np.array(
            [
                b.pinion.loa_damping_ratio,
                b.gear.loa_damping_ratio,
                b.pinion.oloa_damping_ratio,
                b.gear.oloa_damping_ratio,
            ]
        )
        kb = kb * self.bearing
        cb = 2.0 * zb * self.bearing_damping * np.sqrt(kb * mass4)
        # Coordinates q = r_p theta_p - r_g theta_g, x_p, x_g, y_p, y_g. A load N acts with friction mu N.
        shape = np.array([1.0, 1.0, -1.0, 0.0, 0.0])
        arms = np.stack([xi * self.moment[0], (g.L_XY - xi) * self.moment[1]])
        q_force = -(radii**2 / inertia).sum() - mu * (
            radii[0] * arms[0] / inertia[0] + radii[1] * arms[1] / inertia[1]
        )
        per_load = np.stack(
            [
                q_force,
                np.full(xi.shape, -1.0 / mass[0]),
                np.full(xi.shape, 1.0 / mass[1]),
                self.force * mu / mass[0],
                -self.force * mu / mass[1],
            ],
            axis=-1,
        )
        a = np.zeros((STEPS, 11, 11))
        a[:, :5, 5:10] = np.eye(5)
        a[:, 5:10, :5] = _averaged((per_load * k[..., None]).sum(axis=1))[:, :, None] * shape
        a[:, 5:10, 5:10] = _averaged((per_load * c[..., None]).sum(axis=1))[:, :, None] * shape
        places = np.arange(1, 5)
        a[:, 5 + places, places] -= kb / mass4
        a[:, 5 + places, 5 + places] -= cb / mass4
        torque = pair.operating.pinion_torque * self.torque
        drive = torque * radii[0] / inertia[0]
        brake = radii[1] / inertia[1]
        maps = []
        for forcing in (drive, brake):
            a[:, 5, 10] = forcing
            maps.append(expm(a * (period / STEPS)))
        # The brake torque holds the mean speed: friction moments and mesh torques of the gear balance.
        # Moments on the pinion, friction forces and normal loads for each unit of approach and of its rate.
        lever = radii[0] + mu * arms[0]
        moments = np.stack([_averaged((part * lever).sum(axis=1)) for part in (k, c)])
        start, brake_torque = self._closed(maps, torque * radii[1] / radii[0], moments, torque, shape)
        states = np.empty((STEPS, 10))
        z = start
        for number_of_step in range(STEPS):
            states[number_of_step] = z
            z = _stepped(maps, number_of_step, z, brake_torque)
        approach = states[:, :5] @ shape
        rate = states[:, 5:] @ shape
        # A channel at the start of a step has the coefficients there.
        first = np.s_[::PARTS]
        load = k[first] * approach[:, None] + c[first] * rate[:, None]
        friction = (mu[first] * load).sum(axis=1)
        bearing = -(kb * states[:, 1:5] + cb * states[:, 6:10])
        names = ("x_p", "x_g", "y_p", "y_g")
        result = {"dte": approach, "mesh_force": load.sum(axis=1), "friction": friction}
        result |= {name: states[:, 1 + j] for j, name in enumerate(names)}
        result |= {f"bearing_force_{name}": bearing[:, j] for j, name in enumerate(names)}
        return result, period

    def _closed(
        self, maps: list[FloatArray], guess: float, moments: FloatArray, torque: float, shape: FloatArray
    ) -> tuple[FloatArray, float]:
        """Return the periodic start and the brake torque, with which the pinion's moments balance."""
        balances = []
        starts = []
        for brake in (guess, 1.01 * guess):
            phi = np.eye(10)
            rest = np.zeros(10)
            for step in range(STEPS):
                rest = _stepped(maps, step, rest, brake)
                phi = maps[0][step][:10, :10] @ phi
            start = np.linalg.solve(np.eye(10) - phi, rest)
            z = start
            total = 0.0
            for step in range(STEPS):
                after = _stepped(maps, step, z, brake)
                middle = 0.5 * (z + after)
                by_approach, by_rate = moments[:, step]
                total += float(by_approach * (middle[:5] @ shape) + by_rate * (middle[5:] @ shape)) / STEPS
                z = after
            balances.append(torque - total)
            starts.append(start)
        share = balances[0] / (balances[0] - balances[1])
        return starts[0] + share * (starts[1] - starts[0]), guess * (1.0 + 0.01 * share)


def _averaged(values: FloatArray) -> FloatArray:
    """Mean over the parts of each step, of values (steps * parts, ...)."""
    return np.asarray(values.reshape(STEPS, PARTS, *values.shape[1:]).mean(axis=1), dtype=np.float64)


def _stepped(maps: list[FloatArray], step: int, z: FloatArray, brake: float) -> FloatArray:
    """State after a step of the foreign model."""
    drive_map, brake_map = maps
    forced = drive_map[step][:10, 10] + brake * brake_map[step][:10, 10]
    return np.asarray(drive_map[step][:10, :10] @ z + forced)


@dataclass(frozen=True)
class Case:
    """A wrong model with its true causes, any of several names for each.

    Attributes
    ----------
    name : words
    model : the wrong model
    causes : for each fault, names in the registry that say it
    channels : channels of the curves
    noise : standard deviation of the noise over that of the channel
    """

    name: str
    model: ForeignModel
    causes: tuple[tuple[str, ...], ...]
    channels: tuple[str, ...] = CHANNELS
    noise: float = 0.0


def cases() -> Iterator[Case]:
    """Yield the wrong models: one fault, then two faults, then noise and few channels."""
    sound = ForeignModel()
    few = ("dte", "x_p", "y_g", "bearing_force_x_p")
    stiff = ("mesh stiffness",)
    yield Case("stiffness 1.2", replace(sound, stiffness=lambda xi, k: 1.2 * k), (stiff,))
    yield Case("stiffness 0.7", replace(sound, stiffness=lambda xi, k: 0.7 * k), (stiff,))
    yield Case(
        "series stiffness",
        replace(sound, stiffness=lambda xi, k: 2.0 * k),
        (("series stiffness of both teeth",),),
    )
    yield Case(
        "constant stiffness",
        replace(sound, total=lambda k: np.full_like(k, k.mean())),
        (("stiffness over the mesh cycle",),),
    )
    yield Case("mesh damping 3", replace(sound, damping=3.0), (("mesh damping",),))
    yield Case("no mesh damping", replace(sound, damping=0.0), (("mesh damping left out",),))
    yield Case("constant damper", replace(sound, damper="constant"), (("damper law",),))
    yield Case("no friction", replace(sound, mu=0.0), (("friction left out",),))
    yield Case("friction 0.5", replace(sound, mu=0.5), (("friction coefficient",),))
    yield Case("friction sign", replace(sound, mu=-1.0), (("friction sign",),))
    yield Case("friction moments reversed", replace(sound, moment=(-1.0, -1.0)), (("friction sign",),))
    yield Case("friction force reversed", replace(sound, force=-1.0), (("friction sign",),))
    yield Case("no friction moments", replace(sound, moment=(0.0, 0.0)), (("part of friction",),))
    yield Case("torque 1.3", replace(sound, torque=1.3), (("torque",),))
    yield Case("speed 1/ratio", replace(sound, speed=0.0), (("speed of the curves",),))
    yield Case("inertia m r^2", replace(sound, inertia=(2.0, 2.0)), (("inertia by m r^2",),))
    yield Case("inertia of the gear 1.6", replace(sound, inertia=(1.0, 1.6)), (("inertia of the gear",),))
    yield Case("density 0.7", replace(sound, inertia=(0.7, 0.7), mass=(0.7, 0.7)), (("density",),))
    yield Case("mass of the pinion 2", replace(sound, mass=(2.0, 1.0)), (("mass of the pinion", "mass"),))
    yield Case("bearings 0.5", replace(sound, bearing=(0.5,) * 4), (("bearing stiffness",),))
    yield Case(
        "bearings across 5",
        replace(sound, bearing=(1.0, 1.0, 5.0, 5.0)),
        (("bearing stiffness across the line of action",),),
    )
    yield Case("bearing damping 4", replace(sound, bearing_damping=(4.0,) * 4), (("bearing damping",),))
    yield Case(
        "no bearing damping", replace(sound, bearing_damping=(0.0,) * 4), (("bearing damping left out",),)
    )
    yield Case("pitch radius", replace(sound, radius=1.0 / np.cos(np.radians(20.0))), (("pitch radius",),))
    yield Case(
        "rigid bearings",
        replace(sound, bearing=(1e4,) * 4),
        (("supports",),),
        ("dte", "mesh_force", "bearing_force_x_p"),
    )
    yield Case("sign of y_g", replace(sound, scale={"y_g": -1.0}), (("sign of a channel",),))
    yield Case(
        "bearing forces reversed",
        replace(sound, scale={"bearing_force_x_p": -1.0, "bearing_force_y_g": -1.0}),
        (("sign of a channel",),),
    )
    yield Case("x_p in mm", replace(sound, scale={"x_p": 1e3}), (("unit of a channel",),))
    yield Case(
        "all lengths in um",
        replace(sound, scale=dict.fromkeys(CHANNELS[:5], 1000000.0)),
        (("unit of a channel",),),
        CHANNELS[:5],
    )
    yield Case("dte late by 0.08", replace(sound, delay={"dte": 0.08}), (("delay of a channel",),))
    yield Case("x_p and y_p swapped", replace(sound, swap=(("x_p", "y_p"),)), (("channels swapped",),))
    yield Case(
        "x_p and x_g swapped",
        replace(sound, swap=(("x_p", "x_g"),)),
        (("channels swapped", "sign of a channel"),),
    )
    yield Case(
        "stiffness 1.2 and friction sign",
        replace(sound, stiffness=lambda xi, k: 1.2 * k, mu=-1.0),
        (stiff, ("friction sign",)),
    )
    yield Case(
        "sign of y_g, stiffness 0.7",
        replace(sound, scale={"y_g": -1.0}, stiffness=lambda xi, k: 0.7 * k),
        (("sign of a channel",), stiff),
    )
    yield Case(
        "no friction, bearings 2",
        replace(sound, mu=0.0, bearing=(2.0,) * 4),
        (("friction left out",), ("bearing stiffness",)),
    )
    yield Case(
        "damping 0.3, inertia m r^2",
        replace(sound, damping=0.3, inertia=(2.0, 2.0)),
        (("mesh damping",), ("inertia by m r^2",)),
    )
    yield Case(
        "torque 0.6, x_p in mm",
        replace(sound, torque=0.6, scale={"x_p": 1e3}),
        (("torque",), ("unit of a channel",)),
    )
    yield Case(
        "density 1.4, stiffness 1.3",
        replace(sound, inertia=(1.4, 1.4), mass=(1.4, 1.4), stiffness=lambda xi, k: 1.3 * k),
        (("density",), stiff),
    )
    yield Case("stiffness 1.2, noise", replace(sound, stiffness=lambda xi, k: 1.2 * k), (stiff,), noise=0.01)
    yield Case("friction sign, noise", replace(sound, mu=-1.0), (("friction sign",),), noise=0.01)
    yield Case("stiffness 1.2, four channels", replace(sound, stiffness=lambda xi, k: 1.2 * k), (stiff,), few)
    yield Case(
        "inertia m r^2, four channels", replace(sound, inertia=(2.0, 2.0)), (("inertia by m r^2",),), few
    )
    yield Case(
        "bearings along 0.3, four channels",
        replace(sound, bearing=(0.3, 0.3, 1.0, 1.0)),
        (("bearing stiffness along the line of action",),),
        few,
    )
    yield Case("no friction, four channels", replace(sound, mu=0.0), (("friction left out",),), few)


def pair_of(number: int) -> GearPair:
    """Return the pair of a case: cases and pairs go around."""
    return baseline(PAIRS[(7 * number + number // 6) % len(PAIRS)])


def climbed(case: Case, pair: GearPair, budget: float = 60.0) -> Ladder:
    """Return the ladder of a case."""
    if case.model.speed == 0.0:
        ratio = pair.pinion.teeth / pair.gear.teeth
        case = replace(case, model=replace(case.model, speed=ratio))
    curves = case.model.curves(pair, case.channels, case.noise)
    problem = Problem.of(pair, curves, lumped_motion(pair))
    return climb(problem, limit=LIMIT, budget=budget)


def rank(case: Case, ladder: Ladder) -> int:
    """Return the worst place of the true causes in steps and alternatives: 1 is first, 0 is none."""
    places = []
    for names in case.causes:
        place = 0
        for step in ladder.steps:
            listed = [step.name, *(one.name for one in step.alternatives)]
            hits = [number for number, name in enumerate(listed, 1) if name in names]
            if hits and (place == 0 or hits[0] < place):
                place = hits[0]
        places.append(place)
    return 0 if 0 in places else max(places)


def main(arguments: list[str]) -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    chosen = {int(one) for one in arguments}
    ranks = []
    print("  # place  e before  after      s  runs  case: steps")
    for number, case in enumerate(cases()):
        if chosen and number not in chosen:
            continue
        pair = pair_of(number)
        began = time.process_time()
        ladder = climbed(case, pair)
        place = rank(case, ladder)
        ranks.append(place)
        after = ladder.steps[-1].misfit if ladder.steps else ladder.start
        steps = "; ".join(f"{one.name} {_shown(one.factor)}" for one in ladder.steps)
        print(
            f"{number:3d} {place:5d} {ladder.start:9.4f} {after:7.4f} {time.process_time() - began:6.1f}"
            f" {ladder.runs:5d}  {case.name} [{pair.name}]: {steps}",
            flush=True,
        )
    print(f"first {ranks.count(1)}, among three {sum(0 < one <= 3 for one in ranks)}, of {len(ranks)}")


def _shown(factor: Any) -> str:
    return factor if isinstance(factor, str) else f"{factor:.4g}"


if __name__ == "__main__":
    main(sys.argv[1:])
