r"""What finite motions must change in the lumped motion, predicted without the multibody model.

The lumped model holds contact and friction at the nominal rotation. Three things follow the actual motion
instead; each is put back here into the lumped equations, whose periodic solution then is the prediction.

*Late entry, early exit.* With the overlap :math:`\delta` (the transmission error) and the length L of the
line of action, the flanks that meet at the distance :math:`\rho_p` from the pinion's tangent point have
:math:`\rho_p + \rho_g = L + \delta`, and their contact stands in the middle of the overlap, at
:math:`\xi = (\rho_p - \rho_g + L_{XY})/2`. The gear's tip lets go at :math:`\rho_g = L_{XY} - L_{XA}`, the
pinion's at :math:`\rho_p = L_{XD}`, so load is carried only from :math:`L_{XA} + s` to :math:`L_{XD} - s`,

.. math:: s = \tfrac12 (\delta + L - L_{XY}), \qquad
          L - L_{XY} = x_g - x_p + \frac{r_{bp} + r_{bg}}{L_{XY}} (y_g - y_p),

the second by differentiating :math:`L^2 = a^2 - (r_{bp} + r_{bg})^2`. Rotations move the contact along the
path, by :math:`p = \tfrac12 [r_{bp} (\theta_p + \psi) + r_{bg} (\theta_g - \psi)]` beyond its static value,
where :math:`\psi = (y_g - y_p)/L_{XY}` is the turn of the line of action; entry and exit are met where the
nominal position is :math:`L_{XA} + s - p` and :math:`L_{XD} - s - p`.

*Actual sliding velocity.* Friction has the sign and the size that belong to

.. math:: v_s = (\Omega_p + \dot\theta_p) \xi - (\Omega_g + \dot\theta_g)(L_{XY} - \xi)
          - (\dot y_p - \dot y_g) + (\Omega_p + \Omega_g) p + \tfrac12 (\Omega_p - \Omega_g)(L - L_{XY}).

*Turned line of action.* The normal load N acts along a line turned by :math:`\psi`, which pushes the pinion
off the nominal line by :math:`-N \psi` and the gear by :math:`+N \psi`.

Each depends on the motion it changes, so they are found by iteration. Where friction has enough to hold the
teeth at zero sliding (Filippov's condition: it can stop the sliding faster than the motion drives it through
zero), every motion reverses the friction that made it, and the iteration does not settle.

Not predicted: teeth that let go; quadratic terms of the overlap in the displacements of the centres; the
levers of friction about moved centres. They are of first order as well, but with lengths of the machine in
place of the mesh deflection's, so smaller by far.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from lumped import GearPair, geometry
from lumped.equations import Structure
from lumped.errors import NumericalError, refuse
from lumped.mesh_cycle import MeshCycle, mesh_cycle
from lumped.periodic_system import LTVSystem, periodic_system
from lumped.results import dataset
from lumped.solution import initial_state
from lumped.steady import periodic_solution, sample_times
from validation.effective_elements import at_sliding, moved, shortened
from validation.metrics import FloatArray

#: Times per mesh cycle at which the motion is read off: while it settles, and in the end at least.
_COARSE, _FINE = 1024, 4096
#: Settled: events and sliding move by less than this share of a base pitch, or of the shift of the contact,
#: whichever is more.
_SETTLED, _OF_SHIFT = 1e-5, 0.02
_ITERATIONS = 50
_SMALLEST_STEP = 0.1
#: Times of the motion lie at least so far apart, over the mesh cycle.
_APART = 1e-7
#: Effects that are predicted; names as in ``multibody.EFFECTS``.
PREDICTED = ("rotation_phase", "moving_line", "sliding_velocity", "entry_shift")
_CHANGED = ("dte", "x_p", "x_g", "y_p", "y_g", "normal_load", "friction_force")


@dataclass(frozen=True, eq=False)
class FiniteMotion:
    """Predicted changes over the mesh cycle, to be added to the lumped periodic motion.

    Attributes
    ----------
    changes : quantity -> (k,), of tooth forces (pairs, k), at the times of the lumped motion
    entry, exit : how far into the path the load starts, and how far before its end it stops [m]
    settled : whether friction and motion settled; if not, friction may hold the teeth, and in the prediction
        it stays that of the nominal sliding velocity. Where not even that settles, nothing is predicted
    """

    changes: Mapping[str, FloatArray]
    entry: float
    exit: float
    settled: bool

    def over(self, quantity: str, length: int) -> FloatArray:
        """Change of a quantity over whole cycles cut to ``length`` times."""
        change = self.changes[quantity]
        return np.resize(np.moveaxis(change, -1, 0), (length, *change.shape[:-1])).T


@dataclass(frozen=True, eq=False)
class _Shifts:
    """What a motion moves, over nominal places on the path [m].

    Entry, exit, where the contact stands and where the nominal motion slides as fast.
    """

    entry: float
    exit: float
    place: FloatArray
    stands_at: FloatArray
    slides_as: FloatArray

    def slides_at(self, place: FloatArray) -> FloatArray:
        """``slides_as`` at other places."""
        return np.asarray(np.interp(place, self.place, self.slides_as), dtype=np.float64)

    def toward(self, other: _Shifts, step: float) -> _Shifts:
        """Take the ends of another, and go this share of the way to its sliding."""
        own = self.slides_at(other.place)
        return replace(other, slides_as=own + step * (other.slides_as - own))

    def distance(self, other: _Shifts) -> float:
        """Largest difference [m]."""
        sliding = float(np.abs(self.slides_as - other.slides_at(self.place)).max())
        return max(abs(self.entry - other.entry), abs(self.exit - other.exit), sliding)


@dataclass(frozen=True, eq=False)
class _Lumped:
    """The lumped model of one pair with shifted element laws, its motion read off at ``times``."""

    pair: GearPair
    cycle: MeshCycle
    nominal: LTVSystem
    static: FloatArray
    times: FloatArray
    effects: frozenset[str]

    def system(self, shifts: _Shifts) -> LTVSystem:
        """Equations of motion with the element laws as they act after these shifts."""
        g, e = self.cycle.geometry, self.cycle.elements
        ends = g.L_XA + shifts.entry, g.L_XD - shifts.exit
        friction = e.friction
        if friction.coefficients.any():
            friction = at_sliding(friction, g.L_XP, shifts.place, shifts.slides_as)
        elements = replace(
            e,
            stiffness=shortened(moved(e.stiffness, shifts.place, shifts.stands_at), *ends),
            damping=shortened(moved(e.damping, shifts.place, shifts.stands_at), *ends),
            friction=friction,
        )
        return periodic_system(self.pair, "absolute", cycle=MeshCycle(g, elements))

    def shifts_after(self, shifts: _Shifts | None) -> _Shifts:
        """What the motion under these shifts moves in turn; None is the nominal motion."""
        system = self.nominal if shifts is None else self.system(shifts)
        times = self._with_jumps(system)
        states = periodic_solution(self.pair, times, system=system, estimate_error=False).states
        g, z, rate = self.cycle.geometry, states[:, :6].T, states[:, 6:].T
        way = times * (g.base_pitch / self.cycle.period)
        # A pair passes its path in as many cycles as there are pairs; each repeats the same motion.
        place = g.L_XA + (np.arange(g.pairs)[:, None] * g.base_pitch + way).ravel()
        place = place[: int(np.searchsorted(place, g.L_XD)) + 1]
        at = np.arange(place.size) % times.size
        r_p, r_g = g.base_radius_pinion, g.base_radius_gear
        entering, rotating, moving = (
            float(name in self.effects) for name in ("entry_shift", "rotation_phase", "moving_line")
        )
        turned = moving * (z[5] - z[4]) / g.L_XY
        longer = moving * (z[3] - z[2]) + (r_p + r_g) * turned
        reach = 0.5 * entering * (states[:, :6] @ system.deflection + longer)
        by_turns = r_p * (z[0] - self.static[0]) + r_g * (z[1] - self.static[1])
        further = 0.5 * (rotating * by_turns + (r_p - r_g) * turned)
        sliding = (
            rate[0][at] * place
            - rate[1][at] * (g.L_XY - place)
            - (rate[4] - rate[5])[at]
            + 0.5 * (g.omega_pinion - g.omega_gear) * longer[at]
        )
        stands_at = slides_as = place + further[at]
        if "sliding_velocity" in self.effects:
            slides_as = stands_at + sliding / (g.omega_pinion + g.omega_gear)
        return _Shifts(
            entry=self._met(way, reach - further, 0.0, 1.0),
            exit=self._met(way, reach + further, g.L_XD - g.L_XA, -1.0),
            place=place,
            stands_at=stands_at,
            slides_as=slides_as,
        )

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
        """The distance when it equals the way from an end of the path; never outside the path [m]."""
        pitch, found = self.cycle.geometry.base_pitch, 0.0
        for _ in range(20):  # the distance changes by far less than the way does
            found = max(float(np.interp(end + direction * found, way, distance, period=pitch)), 0.0)
        return found


def finite_motion(pair: GearPair, cycle: xr.Dataset, effects: Collection[str] = PREDICTED) -> FiniteMotion:
    """Predict what finite motions change.

    Parameters
    ----------
    pair : a validated gear pair
    cycle : lumped periodic motion at even times over one mesh cycle, the end left out
    effects : names out of ``PREDICTED``, as ``multibody.steady_state`` takes them

    Returns
    -------
    FiniteMotion

    Raises
    ------
    ParameterError : unknown effect
    NumericalError : a shifted motion is not periodic
    """
    for name in effects:
        if name not in PREDICTED:
            raise refuse(
                "effects", name, f"out of {', '.join(PREDICTED)}", "Name effects that are predicted."
            )
    nominal = mesh_cycle(pair)
    system = periodic_system(pair, "absolute", cycle=nominal)
    balance = periodic_solution(pair, np.zeros(1), system=system, estimate_error=False)
    every = -(-_FINE // cycle.sizes["time"])
    coarse = sample_times(nominal.period, _COARSE)
    fine = sample_times(nominal.period, every * cycle.sizes["time"])
    static = initial_state(pair, system, "static", balance)
    model = _Lumped(pair, nominal, system, static, coarse, frozenset(effects))
    shifts, settled = _settle(model, None)
    if settled:
        model = replace(model, times=fine)
        shifts, settled = _settle(model, shifts)
    if not settled:
        model = replace(model, times=fine, effects=model.effects - {"sliding_velocity"})
        shifts, without = _settle(model, None)
        if not without:
            return FiniteMotion({name: np.zeros(cycle[name].shape) for name in _CHANGED}, 0.0, 0.0, False)
    found = model.system(shifts)
    solution = periodic_solution(pair, fine, system=found, estimate_error=False)
    motion = dataset(pair, found, fine, solution.states, {})
    changes = {name: motion[name].to_numpy()[..., ::every] - cycle[name].to_numpy() for name in _CHANGED}
    turned = _turned_line(found.structure, motion, geometry(pair).L_XY) if "moving_line" in effects else {}
    for name, change in turned.items():
        changes[name] = changes[name] + change[::every]
    return FiniteMotion(changes, shifts.entry, shifts.exit, settled)


def _settle(model: _Lumped, start: _Shifts | None) -> tuple[_Shifts, bool]:
    """Iterate shifts and motion, with smaller steps where they swing: the last shifts, and if settled."""
    floor = _SETTLED * model.cycle.geometry.base_pitch
    shifts, step, last = model.shifts_after(start), 1.0, np.inf
    for _ in range(_ITERATIONS):
        try:
            found = model.shifts_after(shifts)
        except NumericalError:  # swung so far that no such motion exists
            return shifts, False
        distance = found.distance(shifts)
        if distance < max(floor, _OF_SHIFT * max(found.entry, found.exit)):
            return found, True
        step = min(1.5 * step, 1.0) if distance < last else max(0.5 * step, _SMALLEST_STEP)
        last = distance
        shifts = shifts.toward(found, step)
    return shifts, False


def _turned_line(s: Structure, motion: xr.Dataset, length: float) -> dict[str, FloatArray]:
    """Change of y_p and y_g by the normal load on the turned line, by the receptances of eqs. 8 and 9 [m]."""
    time, y_p, y_g = (motion[name].to_numpy() for name in ("time", "y_p", "y_g"))
    force = motion["normal_load"].to_numpy().sum(axis=0) * (y_g - y_p) / length
    omega = 2.0 * np.pi * np.fft.rfftfreq(time.size, float(time[1] - time[0]))
    spectrum = np.fft.rfft(force)
    return {
        name: np.fft.irfft(
            sign * spectrum / (s.stiffness[j] + 1j * omega * s.damping[j] - omega**2 * s.mass[j]), time.size
        )
        for name, j, sign in (("y_p", 4, -1.0), ("y_g", 5, 1.0))
    }
