"""Periodic motion of the gear pair without settling, with the brake torque balanced as an unknown."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from lumped.arguments import whole_number
from lumped.errors import NumericalError
from lumped.model.equations import COORDINATES
from lumped.model.period_closure import BRAKE_TORQUE, MORE_PINION_TORQUE, balanced_start
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.model.propagation import STAGES, STEP_ANGLE, StepMaps, step_maps, step_maps_together
from lumped.model.results import peak_to_peak, response
from lumped.model.speeds_together import goes_with
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: A largest multiplier above this is an instability. Without damping it is 1, and steps and rounding move a
#: defective multiplier by up to the root of their error, 1e-12.
UNSTABLE = 1.0 + 1e-6
#: Variables of which a periodic motion has the peak to peak: the transmission error and the translations.
SWINGING = ("dte", *COORDINATES[2:])
#: Most systems that are computed together.
_MOST_TOGETHER = 64


@dataclass(frozen=True, eq=False)
class PeriodicSolution:
    """Periodic motion over one mesh cycle.

    Attributes
    ----------
    system : the "full" system, of n states: 12, or more on shafts
    time : (k,) [s]
    states : (k, n)
    pinion_torque, brake_torque : mean torques that hold the mean speed [N m]
    error : estimate of the largest relative error of the dynamic transmission error; None: not estimated
    cycle_time : (i,) times that resolve the fastest vibration, with 0, the period and all switches [s]
    cycle_states : (i, n) states at these times
    weights : (3,) weights of the forcings, as of ``balanced_start``
    """

    system: LTVSystem
    time: FloatArray
    states: FloatArray
    pinion_torque: float
    brake_torque: float
    error: float | None
    cycle_time: FloatArray
    cycle_states: FloatArray
    _maps: StepMaps = field(repr=False)
    weights: FloatArray = field(repr=False)

    @cached_property
    def closure(self) -> float:
        """Largest difference of the states at both ends, over the largest displacement or rate."""
        return _closure(self.system, self.cycle_states)

    @property
    def over_cycle(self) -> tuple[FloatArray, FloatArray]:
        """Map of the states over the cycle (n, n), and the states that each forcing makes (n, 3)."""
        return self._maps.over_all

    @cached_property
    def spectral_radius(self) -> float:
        """Largest modulus of the Floquet multipliers, the rigid rotation taken out.

        Above 1 the motion is unstable, and a pair leaves it.
        """
        return relative_spectral_radius(self.system, self.over_cycle[0])

    @cached_property
    def peak_to_peak(self) -> dict[str, float]:
        """Variable -> its peak to peak over the cycle [m], with switches and extremes between samples."""
        return {name: self.peak_to_peak_of(name) for name in SWINGING}

    def peak_to_peak_of(self, name: str) -> float:
        """Peak to peak of one of the variables of ``peak_to_peak`` [m]."""
        return _peak_to_peak(self.system, self.cycle_time, self.cycle_states, name)

    @property
    def between(self) -> dict[str, float]:
        """Part of the peak to peak of each variable that lies between the times and is missed there [m]."""
        times = np.append(self.time, self.system.period)
        states = np.vstack([self.states, self.states[:1]])
        return {
            name: exact - _peak_to_peak(self.system, times, states, name)
            for name, exact in self.peak_to_peak.items()
        }

    @cached_property
    def energy_residual(self) -> float:
        """Mean power of the normal loads that is no loss, see ``StepMaps.energy_residual`` [W]."""
        return self._maps.energy_residual(self.cycle_states[0], self.weights)

    @property
    def values(self) -> dict[str, FloatArray]:
        """Variable of ``lumped.model.results.VARIABLES`` -> (k,) or (pairs, k), in SI."""
        return response(self.system, self.time, self.states)


def periodic_solution(
    system: LTVSystem, times: FloatArray, *, estimate_error: bool = True, step_angle: float = STEP_ANGLE
) -> PeriodicSolution:
    """Linear periodic motion of like teeth, at some times of the mesh cycle.

    ``balanced_start`` gives the start, with J_p theta_p / r_bp + J_g theta_g / r_bg = 0 at t = 0.

    Parameters
    ----------
    system : the "full" system of a gear pair
    times : increasing, within [0, T_m) [s]
    estimate_error : whether to compute ``error``, by a second integration of lower order
    step_angle : largest angle of the fastest frequency per step [rad]
    """
    torques = np.stack([system.torque_pinion, system.torque_gear], axis=1)
    dte: list[FloatArray] = []
    for stages in (STAGES - 1, STAGES) if estimate_error else (STAGES,):
        maps = step_maps(
            system, torques, outputs=times, every_step=True, step_angle=step_angle, stages=stages
        )
        solution = _closed(system, maps, times)
        dte.append(solution.states[:, : len(system.coordinates)] @ system.deflection)
    if estimate_error:
        error = float(np.abs(dte[1] - dte[0]).max() / np.abs(dte[1]).max())
        solution = replace(solution, error=error)
    return solution


def solutions_over_speed(
    systems: Iterable[LTVSystem], samples: int, *, step_angle: float = STEP_ANGLE
) -> Iterator[PeriodicSolution | None]:
    """Yield the ``periodic_solution`` of systems of one pair over speed, without error estimate.

    Systems that differ in nothing but the speed are computed together: a motion then takes 0.6 of the time.

    Parameters
    ----------
    systems : as of ``systems_over_speed``
    samples : number of times in the mesh cycle, equally spaced
    step_angle : largest angle of the fastest frequency per step [rad]

    Yields
    ------
    PeriodicSolution, or None at a speed without periodic motion
    """
    for together in _going_together(systems):
        first = together[0]
        torques = np.stack([first.torque_pinion, first.torque_gear], axis=1)
        of_first = sample_times(first.period, samples)
        all_maps = step_maps_together(together, torques, of_first, step_angle)
        for system, maps in zip(together, all_maps, strict=True):
            try:
                if isinstance(maps, NumericalError):
                    raise maps
                solution = _closed(system, maps, sample_times(system.period, samples))
            except NumericalError:
                yield None
                continue
            yield solution


def _going_together(systems: Iterable[LTVSystem]) -> Iterator[list[LTVSystem]]:
    """Yield neighbouring systems that go together, at most ``_MOST_TOGETHER``."""
    together: list[LTVSystem] = []
    for system in systems:
        if together and (len(together) == _MOST_TOGETHER or not goes_with(together[0], system)):
            yield together
            together = []
        together.append(system)
    if together:
        yield together


def _closed(system: LTVSystem, maps: StepMaps, times: FloatArray) -> PeriodicSolution:
    """The periodic motion from the maps of its steps, at some times of the mesh cycle [s]."""
    initial, weights = balanced_start(system, *maps.over_all)
    cycle = maps.states(initial, weights)
    return PeriodicSolution(
        system=system,
        time=times,
        states=cycle[np.searchsorted(maps.times, times - 1e-9 * system.period)],
        pinion_torque=system.pinion_torque + float(weights[MORE_PINION_TORQUE]),
        brake_torque=float(weights[BRAKE_TORQUE]),
        error=None,
        cycle_time=maps.times,
        cycle_states=cycle,
        _maps=maps,
        weights=weights,
    )


def periodic_cycle(pair: GearPair, samples: int, *, supports: Supports = "springs") -> PeriodicSolution:
    """Linear periodic motion without error estimate and labels, in half the time of ``steady_state``."""
    system = LTVSystem.of(pair, "full", supports=supports)
    return periodic_solution(system, sample_times(system.period, samples), estimate_error=False)


def _peak_to_peak(system: LTVSystem, times: FloatArray, states: FloatArray, name: str) -> float:
    """Peak to peak of the transmission error or of a translation [m]."""
    z, rates = system.gear_motion(states)
    direction = system.structure.deflection if name == "dte" else np.eye(6)[COORDINATES.index(name)]
    return peak_to_peak(times, z @ direction, rates @ direction)


def _closure(system: LTVSystem, states: FloatArray) -> float:
    """Relative difference of the last and the first state.

    A rotation counts as a length on the base circle.
    """
    radius = np.append(np.abs(system.structure.deflection[:2]), np.ones(4))
    z, rates = (part * radius for part in system.gear_motion(states))
    length = np.abs(z).max()
    # The rates of a pair at rest are rounding: the length over the period is the least scale of a rate.
    velocity = max(np.abs(rates).max(), length / system.period)
    return float(max(np.abs(z[-1] - z[0]).max() / length, np.abs(rates[-1] - rates[0]).max() / velocity))


def relative_spectral_radius(system: LTVSystem, phi: FloatArray) -> float:
    """Largest modulus of the multipliers of a map phi (n, n) of the "full" system, without the rigid
    rotation.

    Nothing depends on the common rotation. With the matrix S to coordinates without the common rotation,
    S phi = phi_rel S, and any right inverse R of S gives phi_rel = S phi R.
    """
    relative = system.supports.to_relative_states @ phi @ system.supports.from_relative_states
    return float(np.abs(np.linalg.eigvals(relative)).max())


def sample_times(period: float, samples: int) -> FloatArray:
    """Evenly spaced times (samples,) over one period, without its end [s]."""
    count = whole_number("samples_per_cycle", samples, 8, 65536)
    return np.asarray(np.arange(count) * (period / count), dtype=np.float64)
