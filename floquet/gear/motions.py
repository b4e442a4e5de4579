"""Motions of a gear pair with unilateral contact: periodic motions, motions that do not repeat, start states.

Sources: docs/theory/orbits.md, "Gear pair", "Motions that do not repeat".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import betaincinv, stdtrit

from floquet.gear.axes import operating_rpm
from floquet.gear.unilateral import ContactForm, contact_cycle, unilateral_system
from floquet.orbits import long_run as runs
from floquet.orbits.attractors import Attractor, AttractorEnd
from floquet.orbits.closing import close_orbit
from floquet.orbits.long_run import BLOCKS, LongRun, Settled
from floquet.orbits.orbit import Orbit
from floquet.orbits.response import Member, Response
from floquet.orbits.system import Run
from lumped.arguments import real_array, whole_number
from lumped.display.result import DisplayedResult
from lumped.errors import NumericalError, refuse
from lumped.labelling import Variable, provenance
from lumped.model.equations import COORDINATES, X_P
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import LTVSystem, Supports, on_springs
from lumped.model.results import labelled, response
from lumped.model.steady import periodic_solution
from lumped.quasi_static.elements import MeshElements
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import ComplexArray, FloatArray

if TYPE_CHECKING:
    import xarray as xr

MOST_CYCLES = 64
_SAMPLES = 256
#: Coordinates with y_p and y_g.
_WHOLE = 5
#: Largest motion, in static deflections beyond twice the backlash. Back sides strike before.
_LARGEST = 30.0
#: Change of the root mean square that is a jump.
JUMP = 0.1
_SURE = 0.95


@dataclass(frozen=True, eq=False, repr=False)
class GearOrbit(DisplayedResult):
    """A periodic motion of the unilateral gear pair.

    Attributes
    ----------
    pair : the gear pair at this speed, without shafts
    orbit : the motion in (q, x_p, x_g) and phase rates; with y_p, y_g where the back sides may strike
    """

    shown: ClassVar = (
        "speed_rpm",
        "n",
        "stable",
        "spectral_radius",
        "error",
        "dte_rms",
        "dte_mean",
        "peak_to_peak",
        "largest_load",
        "contact_lost",
        "pinion_torque",
        "brake_torque",
    )

    pair: GearPair
    orbit: Orbit = field(repr=False)

    @property
    def speed_rpm(self) -> float:
        """Pinion speed [rpm]."""
        return operating_rpm(self.pair)

    @property
    def n(self) -> int:
        """Mesh cycles after which the motion repeats."""
        return self.orbit.n

    @property
    def dte_rms(self) -> float:
        """Root mean square of the dynamic transmission error about the mean, exact over time [m]."""
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
    def peak_to_peak(self) -> float:
        """Peak to peak value of the transmission error [m]."""
        low, high = self.dte_range
        return high - low

    @property
    def largest_load(self) -> float:
        """Largest normal load of a tooth pair [N]."""
        return self.orbit.run.largest_load

    @property
    def brake_torque(self) -> float:
        """T_g [N m]: the solution of the search, or the input of the pair."""
        return _torques(self.pair, self.orbit.parameter)[1]

    @property
    def pinion_torque(self) -> float:
        """T_p [N m]: the input of the pair, or the solution of the search."""
        return _torques(self.pair, self.orbit.parameter)[0]

    @property
    def multipliers(self) -> ComplexArray:
        """(6,) Floquet multipliers over n cycles, largest first; (10,) with the back sides."""
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
    def contact_lost(self) -> bool:
        """Whether a tooth pair loses contact within the contact that the linear model prescribes."""
        return self.orbit.contact_lost

    @property
    def reaches_back_side(self) -> bool:
        """Whether the back sides of the teeth would touch.

        The motion has this contact only with ``back_side``.
        """
        return self.orbit.run.least < -self.pair.geometry.normal_backlash

    @property
    def events(self) -> FloatArray:
        """(E, 3) time [s], tooth pair (index of ``MeshCycle.offsets``), 0 gap, 1 recovering or 2 contact."""
        events = self.orbit.run.events
        return np.stack([events["phase"] * self.orbit.period, events["contact"], events["state"]], axis=1)

    @cached_property
    def whole(self) -> Orbit:
        """The motion with y_p and y_g. Friction alone drives y_p and y_g, where no back sides touch."""
        o = self.orbit
        if o.start.size == 2 * _WHOLE:
            return o
        system = unilateral_system(self.pair, form="elastic")
        return close_orbit(system, _in_five_coordinates(o.start), o.period, o.n, o.parameter)

    @cached_property
    def motion(self) -> xr.Dataset:
        """``sampled`` at 256 times of each cycle."""
        return self.sampled(_SAMPLES)

    @property
    def states(self) -> FloatArray:
        """(k, 12) states of ``motion``, as ``lumped.simulate`` takes them; the first is at t = 0."""
        names = [*COORDINATES, *(f"{name}_dot" for name in COORDINATES)]
        return np.stack([self.motion[name].to_numpy() for name in names], axis=1)

    def sampled(self, samples_per_cycle: int) -> xr.Dataset:
        """The motion at even times, with the variables of ``lumped.steady_state`` and one more:

        normal_load_back : normal load on the back sides of the teeth, of all pairs [N]
        """
        o = self.whole
        cycle = contact_cycle(self.pair)
        phases = np.arange(samples_per_cycle) / samples_per_cycle
        run = o.system.run(o.start, o.period, o.n, o.parameter, samples=phases)
        states = _absolute_states(self.pair, cycle, o, run)
        system = LTVSystem.of(self.pair, "full", cycle=cycle, supports="springs")
        time = run.phases * o.period
        drive = cycle.offsets.size
        values = response(system, time, states, run.loads[:, :drive].T)
        values["contact"] = (values["normal_load"] > 0.0).astype(float)
        back: Variable = ("time", run.loads[:, drive:].sum(axis=1), "N", "normal load on the back sides")
        attributes = provenance(self.pair, samples_per_cycle=samples_per_cycle) | {
            "model": "lumped",
            "contact": "unilateral",
            "supports": "springs",
            "speed_rpm": self.speed_rpm,
            "n": self.n,
            "stable": int(self.stable),
            "brake_torque": self.brake_torque,
            "dte_rms": self.dte_rms,
            "dte_peak_to_peak": self.peak_to_peak,
        }
        return labelled(time, values, attributes, {"normal_load_back": back})


def _torques(pair: GearPair, parameter: float) -> tuple[float, float]:
    """T_p and T_g [N m]. One of the torques is the free parameter."""
    if pair.operating.brake_torque == "balanced":
        return pair.operating.pinion_torque, parameter
    return parameter, float(pair.operating.brake_torque)


def _absolute_states(pair: GearPair, cycle: MeshCycle, orbit: Orbit, run: Run) -> FloatArray:
    """(k, 12) states of the lumped model at the samples of a run of ``GearOrbit.whole``, from phase 0 on.

    The rigid rotation J_p theta_p/r_bp + J_g theta_g/r_bg has no effect on the other coordinates. The
    rotation follows from torques and friction by the trapezoidal rule.
    """
    g = pair.geometry
    support = LTVSystem.of(pair, "elastic", cycle=cycle, supports="springs").supports
    time = run.phases * orbit.period
    torques = _torques(pair, orbit.parameter)
    steps = np.diff(time, append=orbit.n * orbit.period)

    def integral(values: FloatArray) -> FloatArray:
        """Integral, from the first time on, of a periodic history less the mean of the history."""
        both = 0.5 * (values + np.roll(values, -1))
        return np.concatenate([[0.0], np.cumsum(steps * (both - steps @ both / steps.sum()))[:-1]])

    mesh = cycle.sample(time)
    friction = mesh.friction * run.loads[:, : cycle.offsets.size].T
    lever = (g.L_XY - mesh.position) / g.base_radius_gear - mesh.position / g.base_radius_pinion
    push = (
        (friction * lever).sum(axis=0) + torques[0] / g.base_radius_pinion - torques[1] / g.base_radius_gear
    )
    rate = integral(push)
    rate = rate - steps @ (rate + np.roll(rate, -1)) / (2.0 * steps.sum())
    halves = []
    for z, rigid in ((run.states[:, :_WHOLE], integral(rate)), (run.states[:, _WHOLE:] / orbit.period, rate)):
        half = z @ support.back.T
        missing = (rigid - half @ support.common_weights) / (support.common_weights @ support.common)
        halves.append(half + np.outer(missing, support.common))
    return np.concatenate(halves, axis=1)


def periodic_orbit(
    pair: AnyPair,
    n: int = 1,
    start: ArrayLike | GearOrbit | None = None,
    *,
    back_side: bool = False,
    supports: Supports | None = None,
) -> GearOrbit:
    """One periodic motion of the gear pair with unilateral contact.

    Teeth are alike, and loaded contact has the tangents and dampers of the static load. Branches and jumps
    consist of these motions; the prediction is another motion. Where contact holds, the motion is the motion
    of ``lumped.steady_state`` with linear contact. With contact loss several motions may exist at one speed:
    the start decides which motion is found.

    Parameters
    ----------
    pair : the gear pair
    n : mesh cycles after which the motion repeats, 1 to 64
    start : 12 states at t = 0 as ``lumped.simulate`` takes them, or another motion, from which Newton's
        method starts; None: the motion of the linear model
    back_side : whether the back sides of the teeth touch after the backlash
    supports : "springs": the motion is computed on springs alone; needed for a pair with shafts

    Raises
    ------
    ParameterError : a start that is no state, or shafts
    NumericalError : no periodic motion was found from the start
    """
    pair = on_springs(load_gear_pair(pair), supports, "periodic_orbit")
    n = whole_number("n", n, 1, MOST_CYCLES)
    form = form_with(back_side=back_side)
    state, parameter = start_of(pair, start, form)
    system = unilateral_system(pair, form=form)
    return GearOrbit(pair, close_orbit(system, state, pair.geometry.mesh_period, n, parameter))


def long_run(
    pair: AnyPair,
    start: ArrayLike | GearOrbit | None = None,
    *,
    settle_cycles: int = 400,
    cycles: int = 800,
    back_side: bool = False,
    supports: Supports | None = None,
) -> runs.LongRun:
    """The motion to which a run of the unilateral gear pair settles: a periodic motion, beats or chaos.

    Parameters
    ----------
    pair : the gear pair
    start : 12 states or a motion as in ``periodic_orbit``; None: the motion of the linear model
    settle_cycles : mesh cycles before the observation
    cycles : mesh cycles of the observation, over which the Lyapunov exponent is a mean
    back_side : whether the back sides of the teeth touch after the backlash
    supports : "springs": the run is computed on springs alone; needed for a pair with shafts

    Raises
    ------
    ParameterError : a start that is no state, or shafts
    """
    pair = on_springs(load_gear_pair(pair), supports, "long_run")
    form = form_with(back_side=back_side)
    state, parameter = start_of(pair, start, form)
    return runs.long_run(
        unilateral_system(pair, form=form),
        state,
        pair.geometry.mesh_period,
        parameter,
        settle=whole_number("settle_cycles", settle_cycles, 0, 1_000_000),
        observe=whole_number("cycles", cycles, 64, 1_000_000),
        amplitude=largest_motion(pair),
    )


def form_with(*, back_side: bool) -> ContactForm:
    """The form with the fewest coordinates for a motion with or without contact of the back sides."""
    return "back_side" if back_side else "mesh"


def static_deflection(pair: GearPair) -> float:
    """Deflection of the mesh by the mean load and the mean stiffness [m]."""
    return pair.operating.pinion_torque / pair.geometry.base_radius_pinion / MeshCycle.of(pair).mean_stiffness


def largest_motion(pair: GearPair) -> float:
    """Largest motion of the transmission error about the mean [m]; a larger motion is not followed."""
    return 2.0 * pair.geometry.normal_backlash + _LARGEST * static_deflection(pair)


def start_of(
    pair: GearPair,
    start: ArrayLike | GearOrbit | None,
    form: ContactForm = "mesh",
    elements: MeshElements | None = None,
) -> tuple[FloatArray, float]:
    """Start of Newton's method: coordinates of the form with phase rates, and the balanced torque.

    ``elements`` are the elements of the linear model; None: the elements are computed here.
    """
    if isinstance(start, GearOrbit):
        # Phase rates of a neighbouring speed are nearer to the solution than rates in m/s.
        return _of_form(_in_five_coordinates(start.orbit.start), form), start.orbit.parameter
    g = pair.geometry
    operating = pair.operating
    states = np.zeros(12)
    balanced = operating.brake_torque == "balanced"
    torque = operating.pinion_torque * (g.omega_pinion / g.omega_gear if balanced else 1.0)
    cycle = MeshCycle.of(pair) if elements is None else MeshCycle(g, elements)
    absolute = LTVSystem.of(pair, "full", cycle=cycle, supports="springs")
    if start is not None:
        states = real_array("start", start)
        if states.shape != (12,):
            allowed = "12 states as lumped.simulate takes them"
            raise refuse("start", f"shape {states.shape}", allowed, "Give them in SI.")
    else:
        try:
            linear = periodic_solution(absolute, np.zeros(1), estimate_error=False)
            states = linear.states[0]
            torque = linear.brake_torque if balanced else linear.pinion_torque
        except NumericalError:
            states[X_P] = static_deflection(pair)
    relative = absolute.supports.relative
    start_state = np.concatenate([relative @ states[:6], relative @ states[6:] * g.mesh_period])
    return _of_form(start_state, form), torque


def _of_form(start: FloatArray, form: ContactForm) -> FloatArray:
    """The coordinates of the form, from a start in five coordinates."""
    return start[[0, 1, 2, 5, 6, 7]] if form == "mesh" else start


def _in_five_coordinates(start: FloatArray) -> FloatArray:
    """(10,) a start in five coordinates; a start without y_p and y_g has both at rest."""
    return np.pad(start.reshape(2, -1), ((0, 0), (0, _WHOLE - start.size // 2))).ravel()


def label(unit: str, text: str) -> dict[str, str]:
    """Unit and name of a field in a dataset."""
    return {"unit": unit, "text": text}


@dataclass(frozen=True)
class AttractorPoint:
    """A motion that does not repeat, at one speed.

    The kind is "beats", "chaos" or "periodic". A periodic motion here repeats after more cycles than the
    search covers.
    """

    speed_rpm: float = field(metadata=label("rpm", "pinion speed"))
    kind: Settled = field(metadata=label("1", "motion"))
    dte_rms: float = field(metadata=label("m", "dynamic transmission error, rms"))
    dte_peak_to_peak: float = field(metadata=label("m", "dynamic transmission error, peak to peak"))
    largest_load: float = field(metadata=label("N", "largest normal load"))
    exponent: float = field(metadata=label("1", "largest Lyapunov exponent per mesh cycle"))
    uncertainty: float = field(metadata=label("1", "standard error of the exponent"))


@dataclass(frozen=True)
class GearAttractor:
    """A motion over speed that does not repeat. Runs settle to this motion and stay there.

    Attributes
    ----------
    low_rpm, high_rpm : lowest and highest speed of the motion [rpm]
    kind : "chaos": the exponent is positive at some speed; "periodic": the motion repeats at all speeds,
        after more cycles than the search covers; otherwise "beats"
    rms : smallest and largest root mean square of the transmission error about the mean [m]
    dte_largest : largest transmission error, of either sign [m]
    exponent : largest Lyapunov exponent per mesh cycle, of all speeds; NaN: the motion repeats at all speeds
    exponent_interval : interval of 95 % of the exponent, from blocks of cycles
    reaches_back_side : whether the motion exceeds the backlash at some speed
    points : the motion at each speed of the search
    """

    low_rpm: float
    high_rpm: float
    kind: Settled
    rms: tuple[float, float]
    dte_largest: float
    exponent: float
    exponent_interval: tuple[float, float]
    reaches_back_side: bool
    points: tuple[AttractorPoint, ...] = field(repr=False)

    @property
    def text(self) -> str:
        """Speeds, kind and size in words."""
        kind = {"periodic": "a motion of many mesh cycles"}.get(self.kind, self.kind)
        size = " to ".join(dict.fromkeys(f"{1e6 * rms:.3g}" for rms in self.rms))
        low, high = (f"{end:.2g}" for end in self.exponent_interval)
        grows = f", Lyapunov exponent at most {self.exponent:.2g} ({low} to {high}) per mesh cycle"
        back = "; it exceeds the backlash" if self.reaches_back_side else ""
        return (
            f"From {self.low_rpm:.5g} to {self.high_rpm:.5g} rpm runs can stay on {kind}: transmission error "
            f"{size} µm rms, at most {1e6 * self.dte_largest:.3g} µm"
            f"{grows if np.isfinite(self.exponent) else ''}{back}"
        )


@dataclass(frozen=True)
class Basin:
    """A motion at one speed, and the share of the start states that lead to this motion.

    Attributes
    ----------
    kind : "periodic", "beats", "chaos" or "grows"; a motion that grows is not followed: the results are NaN
    n : mesh cycles after which the motion repeats; 0: the motion does not repeat
    dte_rms, dte_peak_to_peak : root mean square and peak to peak value of the transmission error [m]
    largest_load : largest normal load [N]
    starts : number of start states that lead to the motion
    share : this number over the number of all start states
    share_interval : interval of 95 % of the share (Clopper and Pearson)
    """

    kind: Settled
    n: int
    dte_rms: float
    dte_peak_to_peak: float
    largest_load: float
    starts: int
    share: float
    share_interval: tuple[float, float]


def end_rate(one: Attractor, side: int, losses: list[tuple[float, float]]) -> float:
    """1/T of the end of an attractor at low (side 0) or high speed (side 1).

    An attractor that continues to the end of the range ends at 0 or infinity. An attractor whose size does
    not jump becomes a motion that repeats: ``losses`` are the 1/T and the root mean square at which such
    motions lose stability.
    """
    end = one.ends[side]
    if end is None:
        return (0.0, np.inf)[side]
    if jumps(end):
        return end.rate
    low, high = sorted((float(one.rates[-side]), 1.0 / end.behind))
    near = [(abs(rms - end.size[0]), rate) for rate, rms in losses if low <= rate <= high]
    near = [(apart, rate) for apart, rate in near if apart < 2.0 * JUMP * end.size[0]]
    return min(near)[1] if near else float(one.rates[-side])


def jumps(end: AttractorEnd) -> bool:
    """Whether the root mean square changes at once at the end of an attractor, or grows without bound."""
    return not abs(end.after.rms - end.size[0]) < JUMP * end.size[0]


def gear_attractor(
    one: Attractor, cycle: float, backlash: float, low_rpm: float, high_rpm: float
) -> GearAttractor:
    """An attractor over pinion speeds [rpm]. A pinion speed is ``cycle`` times 1/T."""
    inside = [
        (float(rate) * cycle, run)
        for rate, run in zip(one.rates, one.runs, strict=True)
        if low_rpm <= cycle * rate <= high_rpm
    ] or [(float(one.rates[0]) * cycle, one.runs[0])]
    points = tuple(
        AttractorPoint(
            rpm, run.kind, run.rms, peak_to_peak(run), run.largest_load, run.exponent, run.uncertainty
        )
        for rpm, run in inside
    )
    measured = [point for point in points if np.isfinite(point.exponent)]
    largest = max(measured, key=lambda point: point.exponent, default=points[0])
    half = float(stdtrit(BLOCKS - 2, 0.5 + 0.5 * _SURE)) * largest.uncertainty
    kinds: list[Settled] = [point.kind for point in points]
    extremes = [(run.run.least, run.run.most) for _, run in inside if run.run is not None]
    return GearAttractor(
        low_rpm=low_rpm,
        high_rpm=high_rpm,
        kind="chaos" if "chaos" in kinds else "beats" if "beats" in kinds else "periodic",
        rms=(min(point.dte_rms for point in points), max(point.dte_rms for point in points)),
        dte_largest=max(max(-least, most) for least, most in extremes),
        exponent=largest.exponent,
        exponent_interval=(largest.exponent - half, largest.exponent + half),
        reaches_back_side=any(least < -backlash for least, _ in extremes),
        points=points,
    )


def basins(response: Response, member: Member, rate: float, starts: int, seed: int) -> tuple[Basin, ...]:
    """Motions at 1/T = rate to which seeded start states lead, the most frequent first."""
    places = np.random.default_rng(seed).uniform(size=(starts, 2))
    result = []
    for run, count in response.basins(member, rate, places):
        cycles = run.orbit.n if run.orbit else 0
        sizes = (run.rms, peak_to_peak(run), run.largest_load)
        shares = count, count / starts, binomial_interval(count, starts)
        result.append(Basin(run.kind, cycles, *sizes, *shares))
    return tuple(result)


def binomial_interval(count: int, trials: int) -> tuple[float, float]:
    """Interval of 95 % of a share (Clopper and Pearson, Biometrika 26 (1934) 404)."""
    tail = 0.5 * (1.0 - _SURE)
    low = 0.0 if count == 0 else float(betaincinv(count, trials - count + 1, tail))
    high = 1.0 if count == trials else float(betaincinv(count + 1, trials - count, 1.0 - tail))
    return low, high


def peak_to_peak(run: LongRun) -> float:
    """Peak to peak value of the output; NaN where the motion grows."""
    return float("nan") if run.run is None else run.run.most - run.run.least
