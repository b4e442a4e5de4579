"""How much each finite-motion effect can change each quantity, from the lumped model alone.

An effect displaces element laws along the path: late entry and early exit by s, the stiffness by p, the
friction law by d, each a function of time; the line of action turns by psi. A displacement that changes over
the mesh cycle does at each place what a constant one of that size does there, and the largest of the cycle
bounds it. So the *raw limit* of a quantity is the sum over the effects of the change that a constant
displacement of the largest size makes, the larger one of both signs, plus the shift of the contact over the
base pitch for what is left out: levers, second order, and displacements that vibrate. What a constant
displacement of the friction law takes before the pitch point it gives back behind it. So the sliding is also
displaced with unlike signs on both sides: faster on both, and slower on both. Likewise a late entry may take
what an early exit gives, so the changes of both are added.

The *share* of an effect is the change when it alone acts as predicted, with the shifts that
``validation.cross_check.finite_motion`` found.

Where friction may hold the teeth, it has any value between both signs of the law, in any order, wherever the
sliding may vanish: within the largest displacement d of the sliding about the pitch point. To first order its
changes add, so by the triangle inequality no quantity changes by more than

    held_q = sum_j || q(friction reversed in piece j alone) - q || / || q ||

over the pieces of the zone from P - d to P + d. A piece is a sixteenth of the zone: friction that changes its
sign more often than that in the zone moves less, because its pushes cancel. The friction force itself changes
in its piece alone, by at most twice its size, and with the normal load.

Where teeth part a motion with one effect alone may be another motion. There an effect counts by what it
changes beside all others; what late entry changes then is the whole change. Friction that is not predicted
counts as above, with teeth that push only.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lumped.errors import NumericalError
from lumped.gear_geometry.geometry import Geometry
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import LTVSystem, periodic_system
from lumped.model.results import response
from lumped.model.steady import periodic_solution, sample_times
from lumped.path_function import PathFunction
from lumped.typing import FloatArray
from multibody.contact.machine import Machine, machine
from validation.cross_check.agreement import relative_size
from validation.cross_check.effective_elements import reversed_within
from validation.cross_check.finite_motion import PREDICTED, FiniteMotion
from validation.cross_check.ledger import LOSSES, losses
from validation.cross_check.parted_motion import PartedLoadedModel, PartedModel, unilateral_motion
from validation.cross_check.shifted_motion import Motion, ShiftedModel, Shifts
from validation.cross_check.tolerances import GROUPS

#: Times per mesh cycle at which the changes are read.
_TIMES = 1024
#: Pieces of the zone in which friction may hold the teeth, and times per mesh cycle to read their changes.
_PIECES, _HELD_TIMES = 16, 256
#: A change over twice this distance [m] by more than this share of the largest value is a jump.
_BESIDE, _JUMP = 1e-9, 1e-3
#: Effect -> what it is in words.
EFFECT_WORDS: Mapping[str, str] = {
    "entry_shift": "late entry and early exit",
    "rotation_phase": "stiffness where the contact stands",
    "sliding_velocity": "friction at the actual sliding",
    "moving_line": "turned line of action",
    "tip_contact": "contact where flanks and tip corners meet in motion",
    "path_work": "work along the path",
}


@dataclass(frozen=True)
class Effects:
    """What each effect can do and does, per quantity, relative to the norm of the lumped history.

    Attributes
    ----------
    size : effect -> its largest displacement, over the base pitch; of the turned line its angle [rad]
    most : effect -> quantity -> largest first-order change
    alone : effect -> quantity -> change predicted where it acts alone; empty where nothing is predicted
    powers : power of ``ledger.LOSSES`` -> sum of the largest changes over the driving power
    beyond : part of the change by late entry that contact beyond the nominal path makes; it is not predicted
    held : quantity -> largest first-order change by friction that holds the teeth; empty where it does not
    read : part of the change by sliding that one step between the places makes, at which the prediction reads
        the actual contact: so far a jump of the law beside the pitch point may be off; 0 without such a jump
    """

    size: Mapping[str, float]
    most: Mapping[str, Mapping[str, float]]
    alone: Mapping[str, Mapping[str, float]]
    powers: Mapping[str, float]
    beyond: float
    held: Mapping[str, float]
    read: float

    def largest(self, quantity: str) -> float:
        """Sum over the effects of the largest changes of a quantity."""
        return sum(changes[quantity] for changes in self.most.values())

    def unpredicted(self, quantity: str) -> float:
        """The same over the effects of which no prediction was found."""
        most = sum(changes[quantity] for name, changes in self.most.items() if name not in self.alone)
        if "entry_shift" in self.alone:
            most += self.beyond * self.most["entry_shift"][quantity]
        if self.read:
            most += self.read * self.most["sliding_velocity"][quantity]
        return most + self.held.get(quantity, 0.0)


def first_order(predicted: FiniteMotion) -> Effects:
    """Bound and attribute the changes by finite motions.

    Parameters
    ----------
    predicted : prediction of ``validation.cross_check.finite_motion``

    Returns
    -------
    Effects
    """
    if isinstance(predicted.model, PartedModel | PartedLoadedModel):
        return _where_teeth_part(predicted, predicted.model)
    cycle = predicted.model.cycle
    pitch = cycle.geometry.base_pitch
    every = replace(
        predicted.model,
        times=sample_times(cycle.period, _TIMES),
        effects=frozenset(PREDICTED[predicted.model.pair.mesh.contact]),
        friction_velocity=0.0,
    )
    nominal = every.motion(None, line=0.0)
    found = every.shifts_after(nominal)
    numbers, driving = machine(every.pair), every.pair.operating.pinion_torque * cycle.geometry.omega_pinion

    def values(motion: Motion) -> dict[str, FloatArray]:
        states = motion.states[np.searchsorted(motion.times, every.times)]
        taken = _losses(motion.system, numbers, driving, every.times, states)
        return every.response(motion, every.times) | taken

    before = values(every.unmoved())
    shifts = predicted.shifts
    end = max(max(one.entry, one.exit, one.beyond) for one in (found, shifts or found))
    static = every.static_overlap(found.place)
    every_size = {
        "entry_shift": end,
        "tip_contact": float(np.abs(found.overlap - static).max()),
        "path_work": 0.0,  # a force, no displacement
        "rotation_phase": float(np.abs(found.stands_at - found.place).max()),
        "sliding_velocity": float(np.abs(found.slides_as - found.place).max()),
        "moving_line": float(np.abs(every.turns(nominal)).max()),
    }
    size = {name: every_size[name] for name in sorted(every.effects)}

    def change(effect: str, shifts: Shifts, line: float, velocity: float = 0.0) -> dict[str, float]:
        alone = replace(every, effects=frozenset({effect}), friction_velocity=velocity)
        own = replace(
            shifts,
            entry=shifts.entry if effect == "entry_shift" else 0.0,
            exit=shifts.exit if effect == "entry_shift" else 0.0,
            stands_at=shifts.stands_at if effect == "rotation_phase" else shifts.place,
            slides_as=shifts.slides_as if effect == "sliding_velocity" else shifts.place,
        )
        try:
            after = values(alone.motion(own, line=line if effect == "moving_line" else 0.0))
        except NumericalError:  # displaced so far that no such motion exists
            return dict.fromkeys((*GROUPS, *LOSSES), np.inf)
        return _changes(before, after)

    def displaced(effect: str, pattern: FloatArray | float, entry: float, exit: float) -> dict[str, float]:
        moved = found.place + pattern * size[effect]
        shifted = replace(found, entry=entry, exit=exit, stands_at=moved, slides_as=moved)
        if effect == "tip_contact":
            shifted = replace(found, overlap=static + pattern * (found.overlap - static))
        return change(effect, shifted, size["moving_line"])

    after_pitch = np.where(found.place < cycle.geometry.L_XP, -1.0, 1.0)
    patterns: Mapping[str, Sequence[FloatArray | float]] = {
        "rotation_phase": (1.0, -1.0),
        "sliding_velocity": (1.0, -1.0, after_pitch, -after_pitch),
        "tip_contact": (1.0, -1.0, after_pitch, -after_pitch),
        "moving_line": (1.0,),  # the other sign does as much
        "path_work": (1.0,),  # the nominal motion tells it to first order
    }
    most: dict[str, dict[str, float]] = {}
    for effect in size:
        if effect == "entry_shift":
            late, early = displaced(effect, 0.0, end, 0.0), displaced(effect, 0.0, 0.0, end)
            most[effect] = {name: late[name] + early[name] for name in late}
            continue
        each = [displaced(effect, pattern, 0.0, 0.0) for pattern in patterns[effect]]
        most[effect] = {name: max(one[name] for one in each) for name in each[0]}
    alone = {}
    if shifts is not None:
        thinned = shifts.thinned(predicted.model.times.size // _TIMES)
        for effect in sorted(predicted.model.effects):
            alone[effect] = change(effect, thinned, size["moving_line"], predicted.model.friction_velocity)
    relative = {name: s if name == "moving_line" else s / pitch for name, s in size.items()}
    held = {} if predicted.settled else _held(every, size["sliding_velocity"], numbers, driving)
    powers = {name: sum(changes[name] for changes in most.values()) + held.get(name, 0.0) for name in LOSSES}
    beyond = 0.0 if shifts is None or end == 0.0 else shifts.beyond / end
    read = 0.0
    if shifts is not None and _jumps_beside(cycle.elements.friction, cycle.geometry.L_XP):
        read = pitch / predicted.model.times.size / max(size["sliding_velocity"], np.finfo(float).tiny)
    return Effects(relative, most, alone, powers, beyond, held, read)


def _where_teeth_part(predicted: FiniteMotion, model: PartedModel | PartedLoadedModel) -> Effects:
    """The same where teeth part: the motion with all effects less that without one of them."""
    shifts = predicted.shifts
    if shifts is None:
        nothing = {name: dict.fromkeys(GROUPS, np.inf) for name in model.effects}
        return Effects({}, nothing, {}, {}, 0.0, {}, 0.0)
    times = sample_times(model.cycle.period, _TIMES)
    model = replace(model, times=times)

    def change(after: Motion, before: Motion) -> dict[str, float]:
        one, other = model.response(after, times), model.response(before, times)
        return {name: relative_size(one[name] - other[name], name, other) for name in GROUPS}

    every = model.motion(shifts)
    ends = "tip_contact" if "tip_contact" in model.effects else "entry_shift"
    most = {ends: change(every, model.unmoved())}
    for effect in sorted(model.effects - {ends}):
        without = replace(
            shifts,
            stands_at=shifts.place if effect == "rotation_phase" else shifts.stands_at,
            slides_as=shifts.stands_at if effect == "sliding_velocity" else shifts.slides_as,
        )
        most[effect] = change(every, replace(model, effects=model.effects - {effect}).motion(without))
    if predicted.settled:
        return Effects({}, most, most, {}, 0.0, {}, 0.0)
    sliding, held = _sliding_where_teeth_part(model)
    return Effects({}, most | {"sliding_velocity": sliding}, most, {}, 0.0, held, 0.0)


def _sliding_where_teeth_part(
    model: PartedModel | PartedLoadedModel,
) -> tuple[dict[str, float], dict[str, float]]:
    """Largest changes by displaced friction, and by friction that holds the teeth, of all that may part."""
    g, times = model.cycle.geometry, model.times
    every = replace(model, effects=frozenset(PREDICTED[model.pair.mesh.contact]), friction_velocity=0.0)
    found = every.shifts_after(every.unmoved())
    reach = float(np.abs(found.slides_as - found.place).max())
    after_pitch = np.where(found.place < g.L_XP, -1.0, 1.0)

    def values(friction: PathFunction) -> dict[str, FloatArray]:
        turned = MeshCycle(g, replace(model.cycle.elements, friction=friction))
        system = periodic_system(model.pair, "full", cycle=turned)
        states, loads = unilateral_motion(model.orbit, system, times)
        return response(system, times, states, loads)

    def displaced(pattern: FloatArray | float) -> dict[str, float]:
        slides_as = found.place + pattern * reach
        return change(values(every.displaced_friction(replace(found, slides_as=slides_as))))

    def change(after: Mapping[str, FloatArray]) -> dict[str, float]:
        return {name: relative_size(after[name] - before[name], name, before) for name in GROUPS}

    law = model.cycle.elements.friction
    before = values(law)
    each = [displaced(pattern) for pattern in (1.0, -1.0, after_pitch, -after_pitch)]
    pieces, zone = _pieces(g, reach)
    held = [change(values(reversed_within(law, *piece))) for piece in pieces]
    most = {name: max(one[name] for one in each) for name in GROUPS}
    return most, _with_turned_force({name: sum(one[name] for one in held) for name in GROUPS}, before, zone)


def _jumps_beside(law: PathFunction, pitch_point: float) -> bool:
    """Whether a friction law jumps at another place than the pitch point, as a change of regime does."""
    inner = law.switches[np.abs(law.switches - pitch_point) > _BESIDE]
    jumps = np.abs(law(inner + _BESIDE) - law(inner - _BESIDE))
    return bool(np.any(jumps > _JUMP * np.abs(law(law.breaks[:-1])).max()))


def _losses(
    system: LTVSystem, numbers: Machine, driving: float, times: FloatArray, states: FloatArray
) -> dict[str, FloatArray]:
    """Mean powers over the driving one."""
    taken = losses(system, numbers, times, states, np.full(times.size, 1.0 / times.size))
    return {name: np.array(p / driving) for name, p in taken.items()}


def _changes(before: Mapping[str, FloatArray], after: Mapping[str, FloatArray]) -> dict[str, float]:
    changes = {name: relative_size(after[name] - before[name], name, before) for name in GROUPS}
    return changes | {name: abs(float(after[name] - before[name])) for name in LOSSES}


def _held(every: ShiftedModel, reach: float, numbers: Machine, driving: float) -> dict[str, float]:
    """Largest changes by friction that holds the teeth within ``reach`` [m] of the pitch point."""
    cycle, g = every.cycle, every.cycle.geometry
    times = sample_times(cycle.period, _HELD_TIMES)

    def values(system: LTVSystem) -> dict[str, FloatArray]:
        states = periodic_solution(system, times, estimate_error=False).states
        return response(system, times, states) | _losses(system, numbers, driving, times, states)

    before, (pieces, zone) = values(every.nominal), _pieces(g, reach)
    found = dict.fromkeys((*GROUPS, *LOSSES), 0.0)
    for piece in pieces:
        friction = reversed_within(cycle.elements.friction, *piece)
        turned = MeshCycle(g, replace(cycle.elements, friction=friction))
        changes = _changes(before, values(periodic_system(every.pair, "full", cycle=turned)))
        found = {name: found[name] + change for name, change in changes.items()}
    return _with_turned_force(found, before, zone)


def _pieces(g: Geometry, reach: float) -> tuple[list[tuple[float, float]], tuple[float, float]]:
    """Pieces of the zone in which friction may hold the teeth, and the zone itself [m]."""
    zone = max(g.L_XA, g.L_XP - reach), min(g.L_XD, g.L_XP + reach)
    return list(itertools.pairwise(np.linspace(*zone, _PIECES + 1).tolist())), zone


def _with_turned_force(
    found: dict[str, float], before: Mapping[str, FloatArray], zone: tuple[float, float]
) -> dict[str, float]:
    """The changes with that of the friction force: twice its size in the zone, and with the normal load."""
    place, force = before["position"], before["friction_force"]
    turned_over = np.where((place > zone[0]) & (place < zone[1]), 2.0 * force, 0.0)
    own = relative_size(turned_over, "friction_force", before)
    return found | {"friction_force": found["normal_load"] + own}
