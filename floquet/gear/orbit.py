"""Motions of a gear pair whose teeth may part: single periodic ones, and what a run settles to.

Sources: docs/theory/orbits.md, "Gear pair".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from floquet.gear.axes import operating_rpm
from floquet.gear.unilateral import unilateral_system
from floquet.orbits import long_run as runs
from floquet.orbits.orbit import Orbit, find_orbit
from lumped.arguments import real_array, whole_number
from lumped.errors import NumericalError, refuse
from lumped.labelling import Variable, labelled_dataset
from lumped.model.mesh_cycle import mesh_cycle
from lumped.model.periodic_system import periodic_system
from lumped.model.steady import periodic_solution
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import ComplexArray, FloatArray

if TYPE_CHECKING:
    import xarray as xr

MOST_CYCLES = 64
_SAMPLES = 256
#: Motions are followed to this many static deflections beyond twice the backlash, where back sides strike.
_LARGEST = 30.0


@dataclass(frozen=True, eq=False)
class GearOrbit:
    """A periodic motion of the unilateral gear pair.

    Attributes
    ----------
    pair : the gear pair at this speed
    orbit : the motion in (q, x_p, x_g) and their phase rates
    """

    pair: GearPair
    orbit: Orbit = field(repr=False)

    @property
    def speed_rpm(self) -> float:
        """Pinion speed [rpm]."""
        return operating_rpm(self.pair)

    @property
    def n(self) -> int:
        """Mesh cycles after which it repeats."""
        return self.orbit.n

    @property
    def dte_rms(self) -> float:
        """Root mean square of the dynamic transmission error about its mean, exact over time [m]."""
        return self.orbit.run.rms

    @property
    def dte_mean(self) -> float:
        """Time mean of the dynamic transmission error [m]."""
        return self.orbit.run.mean

    @property
    def dte_range(self) -> tuple[float, float]:
        """Smallest and largest transmission error [m]."""
        return self.orbit.run.least, self.orbit.run.most

    @property
    def largest_load(self) -> float:
        """Largest normal load of a tooth pair [N]."""
        return self.orbit.run.largest_load

    @property
    def balanced_torque(self) -> float:
        """Brake torque that holds the mean speed, or pinion torque where the brake torque is given [N m]."""
        return self.orbit.parameter

    @property
    def multipliers(self) -> ComplexArray:
        """(6,) Floquet multipliers over n cycles, largest first."""
        return self.orbit.multipliers

    @property
    def spectral_radius(self) -> float:
        """Largest modulus of the multipliers over n cycles."""
        return self.orbit.spectral_radius

    @property
    def error(self) -> float:
        """Estimate of the error of the multipliers."""
        return self.orbit.error

    @property
    def stable(self) -> bool:
        """Whether the motion returns after a small disturbance."""
        return self.orbit.stable

    @property
    def parts(self) -> bool:
        """Whether a tooth pair loses contact that the linear model takes for granted."""
        return self.orbit.parts

    @property
    def reaches_back_side(self) -> bool:
        """Whether the back sides of the teeth would touch, which the model does not have."""
        return self.orbit.run.least < -self.pair.geometry.normal_backlash

    @property
    def events(self) -> FloatArray:
        """(E, 3) time [s], tooth pair (index of ``MeshCycle.offsets``), 0 gap, 1 recovering or 2 contact."""
        return np.asarray(self.orbit.run.events * [self.orbit.period, 1.0, 1.0])

    @cached_property
    def motion(self) -> xr.Dataset:
        """The motion over its n cycles: dte, q, x_p, x_g, their rates and the normal loads over ``time``."""
        o, g = self.orbit, self.pair.geometry
        run = o.system.run(o.start, o.period, o.n, o.parameter, samples=np.arange(_SAMPLES) / _SAMPLES)
        z, rates = run.states[:, :3], run.states[:, 3:] / o.period
        output = np.array([1.0, 1.0, -1.0])
        names = ("q", "x_p", "x_g")
        texts = (
            "rotation along the line of action",
            "pinion centre, line of action",
            "gear centre, line of action",
        )
        table: dict[str, Variable] = {
            "dte": ("time", z @ output, "m", "dynamic transmission error"),
            "dte_dot": ("time", rates @ output, "m/s", "rate of the dynamic transmission error"),
            "normal_load": (("time", "pair"), run.loads, "N", "normal load of each tooth pair"),
        }
        for j, (name, text) in enumerate(zip(names, texts, strict=True)):
            table[name] = ("time", z[:, j], "m", text)
            table[f"{name}_dot"] = ("time", rates[:, j], "m/s", f"rate of {text}")
        pairs = (mesh_cycle(self.pair).offsets - g.L_XA) / g.base_pitch
        return labelled_dataset(
            table,
            {
                "time": (run.phases * o.period, "s", "time from pair n at A"),
                "pair": (np.round(pairs).astype(int), "1", "tooth pair, pitches ahead of pair n"),
            },
            {"speed_rpm": self.speed_rpm, "n": self.n, "stable": int(self.stable)},
        )

    @property
    def states(self) -> FloatArray:
        """(k, 6) q, x_p, x_g [m] and their rates [m/s] at 256 times of each cycle; the first is at t = 0."""
        names = ("q", "x_p", "x_g", "q_dot", "x_p_dot", "x_g_dot")
        return np.stack([self.motion[name].values for name in names], axis=1)


def periodic_orbit(pair: AnyPair, n: int = 1, start: ArrayLike | GearOrbit | None = None) -> GearOrbit:
    """One periodic motion of the gear pair whose teeth push and never pull.

    Where contact holds it is that of ``lumped.steady_state``. Where teeth part several motions may exist at
    one speed: which one is found depends on the start.

    Parameters
    ----------
    pair : the gear pair
    n : mesh cycles after which the motion repeats, 1 to 64
    start : 6 states q, x_p, x_g [m] and rates [m/s] at t = 0, or another motion, from which Newton's method
        starts; None: the motion of the linear model

    Raises
    ------
    ParameterError : a start that is no state
    NumericalError : no periodic motion was found from the start
    """
    pair = load_gear_pair(pair)
    n = whole_number("n", n, 1, MOST_CYCLES)
    state, parameter = start_of(pair, start)
    return GearOrbit(
        pair, find_orbit(unilateral_system(pair), state, pair.geometry.mesh_period, n, parameter)
    )


def long_run(
    pair: AnyPair, start: ArrayLike | GearOrbit | None = None, *, settle_cycles: int = 400, cycles: int = 800
) -> runs.LongRun:
    """Say what a run of the unilateral gear pair settles to: a periodic motion, beats or chaos.

    Parameters
    ----------
    pair : the gear pair
    start : 6 states or a motion as in ``periodic_orbit``; None: the motion of the linear model
    settle_cycles : mesh cycles before it is looked at
    cycles : mesh cycles of the observation, over which the Lyapunov exponent is a mean

    Raises
    ------
    ParameterError : a start that is no state
    """
    pair = load_gear_pair(pair)
    state, parameter = start_of(pair, start)
    return runs.long_run(
        unilateral_system(pair),
        state,
        pair.geometry.mesh_period,
        parameter,
        settle=whole_number("settle_cycles", settle_cycles, 0, 1_000_000),
        observe=whole_number("cycles", cycles, 64, 1_000_000),
        amplitude=largest_motion(pair),
    )


def static_deflection(pair: GearPair) -> float:
    """Deflection of the mesh by the mean load and the mean stiffness [m]."""
    return pair.operating.pinion_torque / pair.geometry.base_radius_pinion / mesh_cycle(pair).mean_stiffness


def largest_motion(pair: GearPair) -> float:
    """Motion of the transmission error about its mean that is followed [m]."""
    return 2.0 * pair.geometry.normal_backlash + _LARGEST * static_deflection(pair)


def start_of(pair: GearPair, start: ArrayLike | GearOrbit | None) -> tuple[FloatArray, float]:
    """State (6,) with phase rates, and the balanced torque, to start from."""
    period = pair.geometry.mesh_period
    if isinstance(start, GearOrbit):
        # Displacements and phase rates of a neighbouring speed are nearer than its rates.
        return start.orbit.start, start.orbit.parameter
    given = pair.operating.brake_torque != "balanced"
    g = pair.geometry
    nominal = (
        pair.operating.pinion_torque
        if given
        else pair.operating.pinion_torque * g.omega_pinion / g.omega_gear
    )
    if start is not None:
        state = real_array("start", start)
        if state.shape != (6,):
            raise refuse(
                "start", f"shape {state.shape}", "6 states: q, x_p, x_g and their rates", "Give them in SI."
            )
        return np.concatenate([state[:3], state[3:] * period]), nominal
    system = periodic_system(pair, "absolute")
    try:
        linear = periodic_solution(system, np.zeros(1), estimate_error=False)
    except NumericalError:
        return np.array([static_deflection(pair), 0.0, 0.0, 0.0, 0.0, 0.0]), nominal
    reduction = np.zeros((3, 6))
    reduction[0, :2] = g.base_radius_pinion, -g.base_radius_gear
    reduction[1, 2] = reduction[2, 3] = 1.0
    z, rates = reduction @ linear.states[0, :6], reduction @ linear.states[0, 6:]
    return np.concatenate([z, rates * period]), linear.pinion_torque if given else linear.brake_torque
