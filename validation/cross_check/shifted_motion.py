r"""The lumped motion with element laws shifted as finite motions shift them, and the shifts that it makes.

The derivations are in ``validation.cross_check.finite_motion``.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from lumped import GearPair
from lumped.errors import NumericalError
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import LTVSystem, periodic_system
from lumped.model.results import response
from lumped.model.steady import periodic_solution
from lumped.path_function import PathFunction
from lumped.quasi_static.elements import MeshElements
from lumped.typing import FloatArray
from validation.cross_check.actual_friction import law_ratio
from validation.cross_check.effective_elements import at_sliding, moved, shortened

#: Times of the motion lie at least so far apart, over the mesh cycle.
_APART = 1e-7
#: The iteration stops where events and sliding move by less than this share of a base pitch, or of the shift
#: of the contact, whichever is more ...
_SETTLED, _OF_SHIFT = 1e-7, 1e-3
#: ... and so many times as much is settled where it comes no closer within so many more iterations.
_ACCEPTED, _PATIENCE = 10.0, 20
_ITERATIONS = 60
#: Iterations before the last that its next guess is made from.
_REMEMBERED = 6
#: Combinations of remembered iterations that differ by less than this share of the largest are left out.
_ALIKE = 1e-8
#: Parts of ``Shifts`` that are numbers.
_NUMBERS = ("entry", "exit", "beyond")
#: Sliding as good as zero, as a distance from the pitch point [m].
_BESIDE = 1e-9


@dataclass(frozen=True, eq=False)
class Shifts:
    """What a motion moves, over nominal places on the path [m].

    Attributes
    ----------
    entry, exit : how far into the path the load starts, and how far before its end it stops; not negative
    beyond : how far the load starts before the path, or stops after it, whichever is more: not predicted
    place : (k,) nominal places
    stands_at : (k,) where the contact stands there
    slides_as : (k,) where the nominal motion slides as fast as the teeth do there
    rolling : (k,) sum of the rolling velocities there [m/s]
    arm_pinion, arm_gear : (k,) distances of the contact from both tangent points there
    overlap, longer : (k,) overlap of the flanks, and by how much the line of action is longer than nominal
    load, elastic : (k,) normal load there, and without its damper [N]
    """

    entry: float
    exit: float
    beyond: float
    place: FloatArray
    stands_at: FloatArray
    slides_as: FloatArray
    rolling: FloatArray
    arm_pinion: FloatArray
    arm_gear: FloatArray
    overlap: FloatArray
    longer: FloatArray
    load: FloatArray
    elastic: FloatArray

    def thinned(self, every: int) -> Shifts:
        """The same at every so-many-th place."""
        arrays = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in _NUMBERS}
        return replace(self, **{name: values[:: max(every, 1)] for name, values in arrays.items()})

    def judged(self, place: FloatArray, along: tuple[str, ...]) -> FloatArray:
        """What must settle: the two ends, and what is named ``along`` at some places, (2 + n k,)."""
        values = [np.interp(place, self.place, getattr(self, name)) for name in along]
        return np.concatenate([[self.entry, self.exit], *values])


@dataclass(frozen=True, eq=False)
class Motion:
    """Periodic motion under shifts.

    Attributes
    ----------
    system : the equations of motion with shifted laws
    times : (n,) times in the mesh cycle [s]
    states : (n, 12) lumped states
    place, at : (k,) nominal places of one tooth pair along its whole path [m], and the time of each
    load, elastic : (k,) its normal load there, and without its damper [N]
    loads : (pairs, n) normal loads over the times, where teeth may part; None: the law of the linear mesh [N]
    """

    system: LTVSystem
    times: FloatArray
    states: FloatArray
    place: FloatArray
    at: NDArray[np.int64]
    load: FloatArray
    elastic: FloatArray
    loads: FloatArray | None


@dataclass(frozen=True, eq=False)
class ShiftedModel:
    """The lumped model of one pair with shifted element laws.

    Attributes
    ----------
    pair, cycle, nominal : the pair, its nominal mesh cycle and equations of motion
    static : (12,) states at rest
    times : (n,) even times at which the motion is read off, beside those when friction jumps [s]
    effects : finite-motion effects that act
    friction_velocity : sliding velocity over which friction changes its sign [m/s]
    """

    pair: GearPair
    cycle: MeshCycle
    nominal: LTVSystem
    static: FloatArray
    times: FloatArray
    effects: frozenset[str]
    friction_velocity: float

    #: What of ``Shifts`` must settle along the path.
    settling: ClassVar[tuple[str, ...]] = ("slides_as",)

    @property
    def reach(self) -> tuple[float, float]:
        """Places between which a pair is followed [m]."""
        return self.cycle.geometry.L_XA, self.cycle.geometry.L_XD

    def static_overlap(self, place: FloatArray) -> FloatArray:
        """Overlap about which the contact is linear, at places of one pair (k,) [m]."""
        return np.zeros(place.size)

    def settle(self, start: Shifts | None) -> tuple[Shifts, bool]:
        """Shifts that are those of their own motion: the last ones, and whether they settled.

        Anderson's iteration: the next guess is the combination of the remembered ones whose mismatches cancel
        best.

        References
        ----------
        D. G. Anderson, "Iterative procedures for nonlinear integral equations", J. ACM 12 (1965) 547-560.
        """
        floor, along = _SETTLED * self.cycle.geometry.base_pitch, self.settling
        shifts = self.shifts_after(self.motion(start))
        best, closest, age = shifts, np.inf, 0
        tried: list[tuple[Shifts, Shifts]] = []
        for number in range(_ITERATIONS):
            try:
                found = self.shifts_after(self.motion(shifts))
            except NumericalError:  # swung so far that no such motion exists
                break
            tried = [*tried[-_REMEMBERED:], (shifts, found)]
            given, results = (
                np.stack([s.judged(found.place, along) for s in part]) for part in zip(*tried, strict=True)
            )
            mismatch = results - given
            size = np.abs(mismatch[-1]).max() / max(floor, _OF_SHIFT * max(found.entry, found.exit))
            if size < closest:
                best, closest, age = found, float(size), number
            if closest < 1.0 or number - age > _PATIENCE:
                break
            weights = np.linalg.lstsq(np.diff(mismatch, axis=0).T, mismatch[-1], rcond=_ALIKE)[0]
            guess = results[-1] - weights @ np.diff(results, axis=0)
            first, last = np.maximum(guess[:2], 0.0)
            shifts = replace(found, entry=float(first), exit=float(last))
            guessed = dict(zip(along, np.split(guess[2:], len(along)), strict=True))
            shifts = replace(shifts, **guessed)  # type: ignore[arg-type]
        return best, closest < _ACCEPTED

    def unmoved(self) -> Motion:
        """The motion that changes are counted from: the nominal one."""
        return self.motion(None, line=0.0)

    def motion(self, shifts: Shifts | None, *, line: float | None = None) -> Motion:
        """Periodic motion under these shifts; None is the nominal motion.

        ``line`` is a constant turn of the line of action [rad] instead of the motion's own.
        """
        system = self.nominal if shifts is None else self._system(shifts)
        times = self._with_jumps(system)
        states, loads = self._solved(system, times)
        g, e = self.cycle.geometry, system.cycle.elements
        # A pair passes its path in several cycles; each repeats the same motion.
        speed, (low, high) = g.base_pitch / self.cycle.period, self.reach
        before, after = np.floor((low - g.L_XA) / g.base_pitch), np.ceil((high - g.L_XA) / g.base_pitch)
        cycles = np.arange(before, after)[:, None]
        place = g.L_XA + (cycles * g.base_pitch + times * speed).ravel()
        at = np.arange(place.size) % times.size
        inside = slice(int(np.searchsorted(place, low)), int(np.searchsorted(place, high)) + 1)
        place, at = place[inside], at[inside]
        overlap, rate = states[at, :6] @ system.deflection, states[at, 6:] @ system.deflection
        elastic = e.stiffness(place) * (overlap - e.error(place))
        load = elastic + e.damping(place) * (rate - e.error_slope(place) * speed)
        if loads is not None:
            pair = np.rint((system.cycle.offsets[0] + times[at] * speed - place) / g.base_pitch).astype(int)
            load = loads[np.clip(pair, 0, len(loads) - 1), at]
        found = Motion(system, times, states, place, at, load, elastic, loads)
        if line is not None:
            return self._on_turned_line(found, line)
        return self._on_turned_line(found, self.turns(found)) if "moving_line" in self.effects else found

    def _solved(self, system: LTVSystem, times: FloatArray) -> tuple[FloatArray, FloatArray | None]:
        """States (n, 12) of the periodic motion, and the loads where the linear law does not give them."""
        return periodic_solution(system, times, estimate_error=False).states, None

    def response(self, motion: Motion, times: FloatArray) -> dict[str, FloatArray]:
        """Variables of ``lumped.model.results.response`` at times of the motion, in the nominal slots."""
        at = np.searchsorted(motion.times, times)
        loads = None if motion.loads is None else motion.loads[:, at]
        found = response(motion.system, times, motion.states[at], loads)
        offsets = motion.system.cycle.offsets
        if offsets.size == self.cycle.offsets.size:
            return found
        slots = np.abs(self.cycle.offsets[:, None] - offsets).argmin(axis=1)
        return {name: values if values.ndim == 1 else values[slots] for name, values in found.items()}

    def turns(self, motion: Motion) -> FloatArray:
        """By how much the line of action turns at each time, (n,) [rad]."""
        turned: FloatArray = (motion.states[:, 5] - motion.states[:, 4]) / self.cycle.geometry.L_XY
        return turned

    def shifts_after(self, motion: Motion) -> Shifts:
        """What a motion moves."""
        g, place, at = self.cycle.geometry, motion.place, motion.at
        z = motion.states[:, :6].T
        r_p, r_g = g.base_radius_pinion, g.base_radius_gear
        entering, rotating, moving = (
            float(name in self.effects) for name in ("entry_shift", "rotation_phase", "moving_line")
        )
        turned = moving * (z[5] - z[4]) / g.L_XY
        longer = moving * (z[3] - z[2]) + (r_p + r_g) * turned
        reach = 0.5 * entering * (motion.system.deflection @ z + longer)
        by_turns = r_p * (z[0] - self.static[0]) + r_g * (z[1] - self.static[1])
        further = 0.5 * (rotating * by_turns + (r_p - r_g) * turned)
        # Sliding is the work of friction: its rate of work per unit force, with the opposite sign.
        sliding = -np.sum(motion.states[at, 6:] * motion.system.structure.friction(place), axis=1)
        sliding += 0.5 * (g.omega_pinion - g.omega_gear) * longer[at]
        stands_at = slides_as = place + further[at]
        if "sliding_velocity" in self.effects:
            slides_as = stands_at + sliding / (g.omega_pinion + g.omega_gear)
        arm_p = stands_at + 0.5 * longer[at]
        arm_g = g.L_XY + longer[at] - arm_p
        rates = motion.states[at, 6:].T
        turning = moving * (rates[5] - rates[4]) / g.L_XY
        rolling = (g.omega_pinion + rates[0] + turning) * arm_p
        rolling += (g.omega_gear + rates[1] - turning) * arm_g
        way = motion.times * (g.base_pitch / self.cycle.period)
        entry, last = self._ends(way, reach, further)
        return Shifts(
            entry=max(entry, 0.0),
            exit=max(last, 0.0),
            beyond=max(-entry, -last, 0.0),
            place=place,
            stands_at=stands_at,
            slides_as=slides_as,
            rolling=rolling,
            arm_pinion=arm_p,
            arm_gear=arm_g,
            overlap=(motion.system.deflection @ z)[at],
            longer=longer[at],
            load=motion.load,
            elastic=motion.elastic,
        )

    def held(self, motion: Motion) -> bool:
        """Whether friction holds the teeth where a motion passes zero sliding: Filippov's condition."""
        g = self.cycle.geometry
        way, law = self.shifts_after(motion).slides_as - g.L_XP, motion.system.cycle.elements.friction
        nominal = self.cycle.elements.friction
        passing = np.flatnonzero(way[1:] * way[:-1] < 0.0)
        passing = passing[passing > 0]
        # Sliding acceleration just before, without friction, against what friction takes of it.
        s, speed = motion.system.structure, g.base_pitch / self.cycle.period
        before = np.diff(way)[passing - 1] / np.diff(motion.place)[passing - 1]
        without = before * speed * (g.omega_pinion + g.omega_gear)
        place = 0.5 * (motion.place[passing] + motion.place[passing - 1])
        mobility = np.sum(s.friction(place) ** 2 / s.mass, axis=1)
        load = motion.load[passing]
        without += law(place) * load * mobility
        most = max(abs(float(nominal(g.L_XP + side * _BESIDE))) for side in (-1.0, 1.0))
        return bool(np.any(np.abs(without) < most * load * mobility))

    def _system(self, shifts: Shifts) -> LTVSystem:
        """Equations of motion with the element laws as they act after these shifts."""
        elements = replace(self._contact(shifts), friction=self.displaced_friction(shifts))
        return periodic_system(self.pair, "full", cycle=MeshCycle(self.cycle.geometry, elements))

    def displaced_friction(self, shifts: Shifts) -> PathFunction:
        """The friction law as it acts after these shifts."""
        g, friction = self.cycle.geometry, self.cycle.elements.friction
        if friction.coefficients.any():
            width = self.friction_velocity / (g.omega_pinion + g.omega_gear)
            ratio = np.ones_like(shifts.place)
            if "sliding_velocity" in self.effects:
                rates = shifts.rolling, shifts.arm_pinion, shifts.arm_gear
                ratio = law_ratio(self.pair, friction.interval, shifts.slides_as, *rates)
            friction = at_sliding(friction, self.reach, g.L_XP, shifts.place, shifts.slides_as, width, ratio)
        return friction

    def _contact(self, shifts: Shifts) -> MeshElements:
        """Stiffness, damping and error after these shifts."""
        g, e = self.cycle.geometry, self.cycle.elements
        ends = g.L_XA + shifts.entry, g.L_XD - shifts.exit
        return replace(
            e,
            stiffness=shortened(moved(e.stiffness, shifts.place, shifts.stands_at), *ends),
            damping=shortened(moved(e.damping, shifts.place, shifts.stands_at), *ends),
            error=moved(e.error, shifts.place, shifts.stands_at) if e.error.coefficients.any() else e.error,
        )

    def _ends(self, way: FloatArray, reach: FloatArray, further: FloatArray) -> tuple[float, float]:
        """How far into the path the load starts, and how far before its end it stops [m].

        ``way`` is the way since A at the times of the motion, ``reach`` and ``further`` how far the contact
        stands inside its tips and along the path there.
        """
        length = self.cycle.geometry.L_XD - self.cycle.geometry.L_XA
        return self._met(way, reach - further, 0.0, 1.0), self._met(way, reach + further, length, -1.0)

    def _on_turned_line(self, motion: Motion, turned: float | FloatArray) -> Motion:
        """Let the normal load act along the turned line: y moves by the receptances of eqs. 8 and 9."""
        s, n, period = motion.system.structure, self.times.size, self.cycle.period
        z = motion.states
        total = np.bincount(motion.at, motion.load, motion.times.size)
        force = total * turned
        spectrum = np.fft.rfft(force[np.searchsorted(motion.times, self.times)])
        omega = 2.0 * np.pi * np.fft.rfftfreq(n, period / n)
        states = z.copy()
        for j, sign in ((4, -1.0), (5, 1.0)):
            y = sign * spectrum / (s.stiffness[j] + 1j * omega * s.damping[j] - omega**2 * s.mass[j])
            for column, part in ((j, y), (6 + j, 1j * omega * y)):
                states[:, column] += np.interp(motion.times, self.times, np.fft.irfft(part, n), period=period)
        return replace(motion, states=states)

    def _with_jumps(self, system: LTVSystem) -> FloatArray:
        """``times``, and those when friction jumps: sliding has a kink there, which must not be missed."""
        cycle = system.cycle
        phase = np.mod(
            (cycle.elements.friction.switches - cycle.geometry.L_XA) / cycle.geometry.base_pitch, 1.0
        )
        jumps = np.unique(phase * cycle.period)
        near = np.abs(jumps[:, None] - np.append(self.times, cycle.period)).min(axis=1, initial=np.inf)
        jumps = jumps[near > _APART * cycle.period]
        return np.union1d(self.times, jumps[np.diff(jumps, prepend=-np.inf) > _APART * cycle.period])

    def _met(self, way: FloatArray, distance: FloatArray, end: float, direction: float) -> float:
        """The distance when it equals the way from an end of the path; negative outside the path [m]."""
        pitch, found = self.cycle.geometry.base_pitch, 0.0
        for _ in range(20):  # the distance changes by far less than the way does
            found = float(np.interp(end + direction * found, way, distance, period=pitch))
        return found
