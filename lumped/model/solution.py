"""Solutions of the lumped model as labelled results: transient and periodic motion.

Sources: docs/theory/equations.md, "Periodic motion and the brake torque".
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import DOP853

from lumped.arguments import real_array, real_number, whole_number
from lumped.errors import NumericalError, refuse
from lumped.model import kernels, powers
from lumped.model.periodic_system import LTVSystem, Supports, periodic_system
from lumped.model.propagation import fastest_frequency, step_maps
from lumped.model.results import dataset, provenance
from lumped.model.steady import PeriodicSolution, periodic_solution, sample_times
from lumped.path_function import PathFunction
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray, Progress

if TYPE_CHECKING:
    import xarray as xr


Initial = Literal["static", "periodic"]
_MAX_STEPS_PER_SEGMENT = 200_000
#: Largest angle of the fastest vibration in a mesh cycle of a transient [rad]: some seconds of work a cycle.
_MOST_ANGLE = 5e4


def simulate(
    pair: AnyPair,
    cycles: int = 20,
    *,
    samples_per_cycle: int = 256,
    initial: Initial | ArrayLike = "static",
    rtol: float = 1e-10,
    as_printed: Collection[int] = (),
    supports: Supports = "springs",
    progress: Progress | None = None,
) -> xr.Dataset:
    """Transient of the linear time-varying model (docs/theory/equations.md, eqs. 1 to 9).

    Each smooth segment between two switch times is integrated on its own (scipy's DOP853), so no step
    straddles a jump. On shafts the maps of the periodic motion take the state from output to output, exact to
    about 1e-12 a step whatever ``rtol``.

    Parameters
    ----------
    pair : a validated gear pair
    cycles : mesh cycles, 1 to 100000
    samples_per_cycle : output times per mesh cycle; the grid ends on the last cycle's end
    initial : "static" (at rest relative to nominal rotation, mesh wound up by the mean load), "periodic"
        (the periodic solution at t = 0) or 12 states in SI (on shafts, those of ``LTVSystem.state_names``)
    rtol : relative tolerance of the integration
    as_printed : equations out of 1, 2, 7, 9 whose printed sign is used
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``
    progress : called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``time`` [s] and ``pair``, see ``lumped.model.results.VARIABLES``; the attributes
    carry the balanced brake torque and the provenance

    Raises
    ------
    ParameterError : arguments out of range, or a speed so low that a cycle would take minutes
    NumericalError : the integration fails or is not finite
    """
    pair = load_gear_pair(pair)
    cycles = whole_number("cycles", cycles, 1, 100_000)
    rtol = real_number("rtol", rtol, 1e-13, 1e-2)
    system = periodic_system(pair, "full", as_printed=as_printed, supports=supports)
    grid = sample_times(system.period, samples_per_cycle)
    _refuse_slow(system)
    # The torques that hold the mean speed are those of the repaired equations: a printed sign then shows up
    # as a drift instead of being balanced away.
    repaired = (
        system if not as_printed else periodic_system(pair, "full", cycle=system.cycle, supports=supports)
    )
    balance = periodic_solution(repaired, grid[:1], estimate_error=False)
    state = initial_state(system, initial, balance)
    time = np.concatenate([grid + j * system.period for j in range(cycles)] + [[cycles * system.period]])
    states = np.empty((time.size, system.size))
    states[0] = state
    outputs = np.append(grid[1:], system.period)  # t = T_m is the next cycle's first output
    advance = (
        _by_maps(system, balance, grid) if supports == "shafts" else _by_steps(system, balance, outputs, rtol)
    )
    for cycle in range(cycles):
        rows = slice(1 + cycle * outputs.size, 1 + (cycle + 1) * outputs.size)
        states[rows] = advance(states[rows.start - 1])
        if progress is not None:
            progress((cycle + 1) / cycles)
    attributes = provenance(
        pair,
        cycles=cycles,
        samples_per_cycle=samples_per_cycle,
        initial=initial if isinstance(initial, str) else "given",
        rtol=rtol,
        as_printed=tuple(as_printed),
    )
    attributes |= powers.balance(balance) | powers.power_attributes(balance) | {"model": "lumped"}
    return dataset(system, time, states, attributes)


def _by_steps(
    system: LTVSystem, balance: PeriodicSolution, outputs: FloatArray, rtol: float
) -> Callable[[FloatArray], FloatArray]:
    """From the state at t = 0 to the states at the outputs of a cycle, by integration of the segments."""
    rate, atol = rate_function(system, balance), rtol * _sizes(system)

    def advance(state: FloatArray) -> FloatArray:
        found = []
        for segment, (low, high) in enumerate(itertools.pairwise(system.cycle.edges.tolist())):
            inside = outputs[(outputs > low) & (outputs <= high)]
            values = _integrate(rate(segment), low, high, state, np.union1d(inside, high), rtol, atol)
            found.append(values[: inside.size])
            state = values[-1]
        return np.concatenate(found)

    return advance


def _by_maps(
    system: LTVSystem, balance: PeriodicSolution, grid: FloatArray
) -> Callable[[FloatArray], FloatArray]:
    """The same by the maps of the periodic motion."""
    torques = np.stack([system.torque_pinion, system.torque_gear], axis=1)
    maps = step_maps(system, torques, outputs=grid)
    weights = np.array([1.0, balance.pinion_torque - system.pinion_torque, balance.brake_torque])
    return lambda state: maps.states(state, weights)[1:]


def initial_state(system: LTVSystem, initial: Initial | ArrayLike, balance: PeriodicSolution) -> FloatArray:
    """Return the states at t = 0 for ``initial`` as ``simulate`` takes it.

    Raises
    ------
    ParameterError : not one of the names, another number of states, or not finite
    """
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
    """At rest under the mean mesh load T_p / r_bp and the mean mesh stiffness: all states, rates zero.

    The rotations split the wind-up so that J_p theta_p / r_bp + J_g theta_g / r_bg = 0, as two free rotors
    would.

    Parameters
    ----------
    system : the "full" system of a gear pair
    pinion_torque : T_p [N m]; default the operating point's
    """
    g, s = system.pair.geometry, system.structure
    r_bp, r_bg = g.base_radius_pinion, g.base_radius_gear
    load = (system.pinion_torque if pinion_torque is None else pinion_torque) / r_bp
    if system.shafts is not None:
        return _static_on_shafts(system, load)
    x_p, x_g = -load / s.stiffness[2], load / s.stiffness[3]
    wind_up = load / system.cycle.mean_stiffness - x_p + x_g
    by_pinion, by_gear = r_bp**2 / s.mass[0], r_bg**2 / s.mass[1]
    share_p = by_pinion / (by_pinion + by_gear)
    state = np.zeros(12)
    state[:4] = share_p * wind_up / r_bp, -(1.0 - share_p) * wind_up / r_bg, x_p, x_g
    return state


def _static_on_shafts(system: LTVSystem, load: float) -> FloatArray:
    m, g = len(system.coordinates), system.pair.geometry
    u = system.deflection[1:]
    stiffness = -system.constant[m + 1 :, 1:m] + system.cycle.mean_stiffness * np.multiply.outer(u, u)
    torques = g.base_radius_pinion * system.torque_pinion + g.base_radius_gear * system.torque_gear
    state = np.zeros(2 * m)
    state[1:m] = np.linalg.solve(stiffness, load * torques[m + 1 :])
    return state


def _sizes(system: LTVSystem) -> FloatArray:
    """Size of each of the 12 states, (12,), by which absolute tolerances are scaled.

    Each displacement has the size of its own deflection at rest; y that of the largest friction of the mean
    load, which may be a thousandth of the others. A rate has this size for every mesh cycle.
    """
    size = np.abs(static_deflection(system))[:6]
    load = system.pinion_torque / system.pair.geometry.base_radius_pinion
    law = system.cycle.elements.friction
    largest = float(np.abs(law(np.append(law.breaks, 0.5 * (law.breaks[1:] + law.breaks[:-1])))).max())
    size[4:] = largest * load / system.structure.stiffness[4:]
    size = np.maximum(size, 1e-6 * max(float(size.max()), 1e-12))
    return np.concatenate([size, size / system.period])


def rate_function(
    system: LTVSystem, balance: PeriodicSolution
) -> Callable[[int], Callable[[float, FloatArray], FloatArray]]:
    """For a segment, the function (time, state) -> rates on the compiled equations of motion."""
    g, s, cycle = system.pair.geometry, system.structure, system.cycle
    e = cycle.elements
    speed = g.omega_pinion * g.base_radius_pinion
    functions: list[PathFunction] = [e.stiffness, e.damping, e.friction, e.error, e.error_slope]
    tables = [array for f in functions for array in (f.breaks, f.coefficients)]
    external = np.array([balance.pinion_torque, -balance.brake_torque, 0.0, 0.0, 0.0, 0.0])
    constants = [*tables, s.mass, s.damping, s.stiffness, s.deflection, s.normal, s.friction_arm, external]

    def of(segment: int) -> Callable[[float, FloatArray], FloatArray]:
        margin, ends = 1e-12 * g.base_pitch, (cycle.start, cycle.end)
        start = speed * float(cycle.edges[segment]) + margin
        end = speed * float(cycle.edges[segment + 1]) - margin

        def rate(time: float, state: FloatArray) -> FloatArray:
            values: FloatArray = kernels.state_rate(
                time, state, start, end, cycle.offsets, speed, *ends, *constants
            )
            return values

        return rate

    return of


def _integrate(
    rate: Callable[[float, FloatArray], FloatArray],
    low: float,
    high: float,
    state: FloatArray,
    targets: FloatArray,
    rtol: float,
    atol: FloatArray,
) -> FloatArray:
    """States at the increasing ``targets`` in (low, high], the last of which is ``high``."""
    solver = DOP853(rate, low, state, high, rtol=rtol, atol=atol)  # type: ignore[arg-type]  # stubs: scalar only
    values = np.empty((targets.size, state.size))
    row = 0
    for _ in range(_MAX_STEPS_PER_SEGMENT):
        message = solver.step()
        if solver.status == "failed" or not np.isfinite(solver.y).all():
            raise NumericalError(
                f"Integration stopped at t = {solver.t:.6g} s of the mesh cycle ({message}): "
                "raise rtol, or check stiffness, damping and inertia for extremes."
            )
        if row < targets.size and targets[row] <= solver.t:
            dense = solver.dense_output()
            while row < targets.size and targets[row] <= solver.t:
                values[row] = solver.y if targets[row] == solver.t else dense(targets[row])
                row += 1
        if solver.status == "finished":
            return values
    raise NumericalError(
        f"More than {_MAX_STEPS_PER_SEGMENT} steps in one segment of the mesh cycle: raise speed or rtol, "
        "or take the periodic motion (--steady, steady_state), which bears many vibrations in a mesh cycle."
    )


def _refuse_slow(system: LTVSystem) -> None:
    """Raise a ParameterError where a mesh cycle holds too many vibrations for a transient."""
    angle, rpm = fastest_frequency(system) * system.period, system.pair.operating.pinion_speed * 30.0 / np.pi
    if angle > _MOST_ANGLE:
        turns = f"the fastest mode swings {angle / (2.0 * np.pi):.2g} times in a mesh cycle"
        least = f"at least {1.05 * rpm * angle / _MOST_ANGLE:.2g} rpm, because {turns}"
        action = "Raise it, or take the periodic motion (--steady, steady_state)."
        raise refuse("operating.pinion_speed", f"{rpm:g} rpm", least, action)


def steady_state(
    pair: AnyPair,
    *,
    samples_per_cycle: int = 512,
    as_printed: Collection[int] = (),
    supports: Supports = "springs",
) -> xr.Dataset:
    """Periodic motion over one mesh cycle, without settling.

    Parameters
    ----------
    pair : a validated gear pair
    samples_per_cycle : output times in [0, T_m)
    as_printed : equations out of 1, 2, 7, 9 whose printed sign is used
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``; then
        ``bearing_force`` over ``bearing`` and ``direction`` is the force of each bearing on its shaft, and
        ``power_shafts`` what the shafts' damping takes [W]

    Returns
    -------
    xarray.Dataset as of ``simulate`` over one cycle; the attributes carry ``brake_torque`` and
    ``pinion_torque`` [N m] that hold the mean speed, ``mesh_efficiency`` = T_g Omega_g / (T_p Omega_p),
    the mean losses ``power_sliding``, ``power_tooth_dampers`` and ``power_bearings`` [W], ``power_unpaid``,
    what of them the brake torque leaves out in prescribed contact [W],
    ``error_estimate``, the relative error of the dynamic transmission error, ``dte_peak_to_peak`` [m], its
    peak to peak whatever the sampling (and so for the translations), and ``spectral_radius``, the
    largest modulus of the Floquet multipliers: above 1 the motion is unstable, and a pair leaves it

    Raises
    ------
    NumericalError : the speed sits on a stability boundary, where no periodic motion exists
    """
    pair = load_gear_pair(pair)
    system = periodic_system(pair, "full", as_printed=as_printed, supports=supports)
    times = sample_times(system.period, samples_per_cycle)
    solution = periodic_solution(system, times)
    attributes = provenance(pair, samples_per_cycle=samples_per_cycle, as_printed=tuple(as_printed))
    attributes |= (
        powers.balance(solution)
        | powers.power_attributes(solution)
        | {
            "model": "lumped",
            "closure": solution.closure,
            "error_estimate": solution.error,
            "spectral_radius": solution.spectral_radius,
        }
    )
    attributes |= {f"{name}_peak_to_peak": value for name, value in solution.peak_to_peak.items()}
    return dataset(system, times, solution.states, attributes)
