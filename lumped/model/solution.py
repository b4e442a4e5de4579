"""Solutions of the lumped model as labelled results: transient and periodic motion.

Sources: docs/theory/equations.md, "Periodic motion and the brake torque".
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import real_array
from lumped.errors import NumericalError, refuse
from lumped.labelling import provenance
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.model.powers import power_attributes
from lumped.model.propagation import STEP_ANGLE, step_maps
from lumped.model.results import PlainMotion, dataset, plain_linear
from lumped.model.steady import periodic_solution, sample_times
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, Progress

if TYPE_CHECKING:
    import xarray as xr


Initial = Literal["static", "periodic"]


def transient(
    pair: GearPair,
    cycles: int,
    samples_per_cycle: int,
    initial: Initial | ArrayLike,
    as_printed: Collection[int],
    supports: Supports,
    progress: Progress | None,
) -> xr.Dataset:
    """Result of ``lumped.simulate`` for the linear motion of like teeth."""
    system = LTVSystem.of(pair, "full", as_printed=as_printed, supports=supports)
    grid = sample_times(system.period, samples_per_cycle)
    # The torques that hold the mean speed are those of the repaired equations: a printed sign then shows up
    # as a drift instead of being balanced away.
    repaired = system if not as_printed else LTVSystem.of(pair, "full", cycle=system.cycle, supports=supports)
    balance = periodic_solution(repaired, grid[:1], estimate_error=False)
    state = initial_state(system, initial, balance)
    time = np.concatenate([grid + j * system.period for j in range(cycles)] + [[cycles * system.period]])
    states = np.empty((time.size, system.size))
    states[0] = state
    maps = step_maps(system, np.stack([system.torque_pinion, system.torque_gear], axis=1), outputs=grid)
    weights = np.array([1.0, balance.pinion_torque - system.pinion_torque, balance.brake_torque])
    for cycle in range(cycles):
        first = cycle * grid.size
        states[first : first + grid.size + 1] = maps.states(states[first], weights)
        if progress is not None:
            progress((cycle + 1) / cycles)
    if not np.isfinite(states).all():
        raise NumericalError("The motion grows beyond all numbers: take fewer cycles, or a stable pair.")
    attributes = provenance(
        pair,
        cycles=cycles,
        samples_per_cycle=samples_per_cycle,
        initial=initial if isinstance(initial, str) else "given",
        as_printed=tuple(as_printed),
    )
    attributes |= power_attributes(balance) | {"model": "lumped", "contact": "linear"}
    return dataset(system, time, states, attributes)


class Balanced(Protocol):
    """The part of a periodic motion that ``initial_state`` reads."""

    @property
    def states(self) -> FloatArray:
        """(k, n) from the start of the cycle on."""

    @property
    def pinion_torque(self) -> float:
        """Mean driving torque [N m]."""


def initial_state(system: LTVSystem, initial: Initial | ArrayLike, balance: Balanced) -> FloatArray:
    """Return the states at t = 0 for ``initial`` as ``simulate`` takes it."""
    if isinstance(initial, str):
        if initial == "static":
            return static_deflection(system, balance.pinion_torque)
        if initial == "periodic":
            return np.array(balance.states[0])
        raise refuse("initial", initial, "'static', 'periodic' or 12 states", "Choose one of them.")
    state = real_array("initial", initial)
    if state.shape != (system.size,):
        allowed = f"{system.size} states: {', '.join(system.coordinates)} and their rates"
        raise refuse("initial", f"shape {state.shape}", allowed, "Give them in SI.")
    return np.array(state)


def static_deflection(system: LTVSystem, pinion_torque: float | None = None) -> FloatArray:
    """State at rest under the mean mesh load T_p / r_bp, with the mean mesh stiffness; all rates are zero.

    ``system`` is the "full" one; the torque [N m] is by default the operating point's.
    """
    g = system.pair.geometry
    support = system.supports
    m = len(system.coordinates)
    load = (system.pinion_torque if pinion_torque is None else pinion_torque) / g.base_radius_pinion
    mesh = system.reduction @ (system.structure.deflection / system.structure.mass)
    stiffness = -system.constant[m:, :m] + system.cycle.mean_stiffness * np.outer(mesh, system.deflection)
    torques = g.base_radius_pinion * system.torque_pinion + g.base_radius_gear * system.torque_gear
    z = support.back @ np.linalg.solve(
        support.relative @ stiffness @ support.back, support.relative @ torques[m:] * load
    )
    # The common rotation is free: its weighted sum is zero, as of two free rotors.
    z -= support.common * ((support.common_weights @ z) / (support.common_weights @ support.common))
    return np.concatenate([z, np.zeros(m)])


def steady_cycle(
    pair: GearPair,
    samples_per_cycle: int = 512,
    as_printed: Collection[int] = (),
    supports: Supports = "springs",
    *,
    estimate_error: bool = True,
    step_angle: float = STEP_ANGLE,
) -> PlainMotion:
    """Motion of ``lumped.steady_state`` in the linear form of like teeth, over one mesh cycle.

    ``estimate_error`` says whether the error is estimated; ``step_angle`` is the largest angle of the fastest
    vibration in a step [rad].
    """
    system = LTVSystem.of(pair, "full", as_printed=as_printed, supports=supports)
    times = sample_times(system.period, samples_per_cycle)
    solution = periodic_solution(system, times, estimate_error=estimate_error, step_angle=step_angle)
    attributes: dict[str, Any] = power_attributes(solution) | {
        "model": "lumped",
        "contact": "linear",
        "closure": solution.closure,
        "spectral_radius": solution.spectral_radius,
    }
    attributes |= {} if solution.error is None else {"error_estimate": solution.error}
    attributes |= {f"{name}_peak_to_peak": value for name, value in solution.peak_to_peak.items()}

    def origin() -> dict[str, Any]:
        return provenance(pair, samples_per_cycle=samples_per_cycle, as_printed=tuple(as_printed))

    return plain_linear(system, times, solution.states, attributes, origin)
