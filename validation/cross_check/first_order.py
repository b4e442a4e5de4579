"""How much each finite-motion effect can change each quantity, from the lumped model alone.

An effect displaces element laws along the path: late entry and early exit by s, the stiffness by p, the
friction law by d, each a function of time; the line of action turns by psi. A displacement that changes over
the mesh cycle does at each place what a constant one of that size does there, and the largest of the cycle
bounds it. So the *raw limit* of a quantity is the sum over the effects of the change that a constant
displacement of the largest size makes, the larger one of both signs, plus the shift of the contact over the
base pitch for what is left out: levers, second order, and displacements that vibrate.

The *share* of an effect is the change when it alone acts as predicted, with the shifts that
``validation.cross_check.finite_motion`` found.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from lumped.errors import NumericalError
from lumped.model.results import response
from lumped.model.steady import sample_times
from lumped.typing import FloatArray
from multibody.contact.machine import machine
from validation.cross_check.agreement import relative_size
from validation.cross_check.finite_motion import PREDICTED, FiniteMotion
from validation.cross_check.ledger import LOSSES, losses
from validation.cross_check.shifted_motion import Motion, Shifts
from validation.cross_check.tolerances import GROUPS

#: Times per mesh cycle at which the changes are read.
_TIMES = 1024
#: Effect -> what it is in words.
EFFECT_WORDS: Mapping[str, str] = {
    "entry_shift": "late entry and early exit",
    "rotation_phase": "stiffness where the contact stands",
    "sliding_velocity": "friction at the actual sliding",
    "moving_line": "turned line of action",
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
    """

    size: Mapping[str, float]
    most: Mapping[str, Mapping[str, float]]
    alone: Mapping[str, Mapping[str, float]]
    powers: Mapping[str, float]

    def largest(self, quantity: str) -> float:
        """Sum over the effects of the largest changes of a quantity."""
        return sum(changes[quantity] for changes in self.most.values())

    def unpredicted(self, quantity: str) -> float:
        """The same over the effects of which no prediction was found."""
        return sum(changes[quantity] for name, changes in self.most.items() if name not in self.alone)


def first_order(predicted: FiniteMotion) -> Effects:
    """Bound and attribute the changes by finite motions.

    Parameters
    ----------
    predicted : prediction of ``validation.cross_check.finite_motion``

    Returns
    -------
    Effects
    """
    cycle = predicted.model.cycle
    pitch = cycle.geometry.base_pitch
    every = replace(
        predicted.model,
        times=sample_times(cycle.period, _TIMES),
        effects=frozenset(PREDICTED),
        friction_velocity=0.0,
    )
    nominal = every.motion(None, line=0.0)
    found = every.shifts_after(nominal)
    numbers, driving = machine(every.pair), every.pair.operating.pinion_torque * cycle.geometry.omega_pinion
    weights = np.full(_TIMES, 1.0 / _TIMES)

    def values(motion: Motion) -> dict[str, FloatArray]:
        states = motion.states[np.searchsorted(motion.times, every.times)]
        taken = losses(motion.system, numbers, every.times, states, weights)
        shares = {name: np.array(power / driving) for name, power in taken.items()}
        return response(motion.system, every.times, states) | shares

    before = values(nominal)
    end = max(found.entry, found.exit)
    size = {
        "entry_shift": end,
        "rotation_phase": float(np.abs(found.stands_at - found.place).max()),
        "sliding_velocity": float(np.abs(found.slides_as - found.place).max()),
        "moving_line": float(np.abs(every.turns(nominal)).max()),
    }

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
        changes = {name: relative_size(after[name] - before[name], name, before) for name in GROUPS}
        return changes | {name: abs(float(after[name] - before[name])) for name in LOSSES}

    most: dict[str, dict[str, float]] = {}
    for effect in PREDICTED:
        both = []
        for sign in (1.0, -1.0):
            moved = found.place + sign * size[effect]
            displaced = replace(found, entry=end, exit=end, stands_at=moved, slides_as=moved)
            both.append(change(effect, displaced, size["moving_line"]))
            if effect in (
                "entry_shift",
                "moving_line",
            ):  # load cannot start early; the other sign does as much
                break
        most[effect] = {name: max(one[name] for one in both) for name in both[0]}
    shifts, alone = predicted.shifts, {}
    if shifts is not None:
        for effect in sorted(predicted.model.effects):
            alone[effect] = change(effect, shifts, size["moving_line"], predicted.model.friction_velocity)
    relative = {name: s if name == "moving_line" else s / pitch for name, s in size.items()}
    powers = {name: sum(changes[name] for changes in most.values()) for name in LOSSES}
    return Effects(relative, most, alone, powers)
