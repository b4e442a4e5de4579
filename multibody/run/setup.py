"""Make a multibody model ready to run: loads, initial state, switches, tolerances, provenance."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import one_of, real_number
from lumped.errors import refuse, shown
from lumped.labelling import provenance
from lumped.model import cycle_maps
from lumped.model.periodic_system import LTVSystem
from lumped.model.powers import balance as balance_of
from lumped.model.solution import Initial, initial_state
from lumped.model.steady import periodic_solution
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.contact import kinematics as kn
from multibody.contact.friction import nominal_friction
from multibody.contact.machine import Machine, Supports, loaded_phase, machine
from multibody.contact.records import MAX_PAIRS
from multibody.gears.circles import circles
from multibody.gears.own_teeth import drawn_gears, own_ripples
from multibody.run.effects import EFFECTS, active_effects, effect_flags, form_of
from multibody.run.integration import Segment, integrate
from multibody.run.linear_motion import LinearMotion, energy_residual, linear_motion
from multibody.run.model import ExudynModel, build, from_lumped_state

Fidelity = Literal["linear", "exact"]

#: Most mesh cycles of a run.
MOST_CYCLES = 100_000
#: Force evaluations allowed in one interval; more in proportion where a mesh cycle has more vibrations of the
#: fastest mode than this. One takes some 500 at rtol 1e-8, and an ordinary mesh cycle has some five.
CALL_LIMIT = 400_000
_ORDINARY_VIBRATIONS = 80
#: Most vibrations in a mesh cycle: up to half a million force evaluations, a second or two.
_MOST_VIBRATIONS = 500
#: Largest static deflection over the base pitch: the pairing of flanks is lost at half a pitch.
_MOST_DEFLECTION = 0.25
#: exudyn has one absolute tolerance for coordinates and rates, set for the rates: this share of a static
#: deflection per mesh cycle, times rtol. With much less, a rate that is zero when an impact starts would have
#: to be found to the last bit.
_ATOL_SHARE = 0.1
#: On shafts a hundred times that: else their fastest modes, which hardly move, set the step.
_ATOL_SHARE_ON_SHAFTS = 10.0


@dataclass(frozen=True, eq=False)
class Setup:
    """A multibody model ready to run, with the lumped model's loads and initial state.

    q, v : (size,) initial state in the model's coordinates
    deflection : static deflection of the mesh under the driving torque [m]
    attributes : provenance of results
    motion : on shafts, the model's own periodic motion with the linear mesh
    """

    model: ExudynModel
    system: LTVSystem
    q: FloatArray
    v: FloatArray
    rtol: float
    deflection: float
    attributes: dict[str, Any]
    motion: LinearMotion | None = None

    @property
    def atol(self) -> float:
        """Absolute tolerance of the integration, see ``_ATOL_SHARE`` [m/s]."""
        share = _ATOL_SHARE if self.machine.train is None else _ATOL_SHARE_ON_SHAFTS
        return self.rtol * share * self.deflection / self.machine.period

    @property
    def machine(self) -> Machine:
        """The numbers the model was built from."""
        return self.model.machine

    @property
    def position_is_nominal(self) -> bool:
        """Whether contact positions depend on time alone, so that the switches are known beforehand."""
        return bool(self.model.flags & kn.LINEAR) or not self.model.flags

    def with_torques(self, pinion: float, gear: float) -> Setup:
        """The same model and initial state under other constant torques, driving and braking [N m]."""
        machine = replace(self.machine, torque_pinion=pinion, torque_gear=gear)
        return replace(self, model=build(machine, self.model.flags, self.model.budget.limit))

    def edges(self, cycles: int) -> FloatArray:
        """Ends of the integration intervals [s]: at the switches where those are known, else whole cycles."""
        phases = self.machine.switches if self.position_is_nominal else np.zeros(1)
        starts = (np.arange(cycles)[:, None] + phases).ravel()
        return np.asarray(np.append(starts, float(cycles)) * self.machine.period)

    def run(self, edges: FloatArray, visit: Callable[[int, Segment], None]) -> tuple[FloatArray, FloatArray]:
        """Integrate over the intervals from the initial state; returns (q, v) at the end."""
        return integrate(
            self.model,
            self.q,
            self.v,
            edges,
            rtol=self.rtol,
            atol=self.atol,
            clamp=self.position_is_nominal,
            visit=visit,
        )


def prepare(
    pair: GearPair,
    fidelity: Fidelity = "exact",
    initial: Initial | ArrayLike = "static",
    effects: Collection[str] | Mapping[str, bool] | None = None,
    rtol: float = 1e-8,
    friction_velocity: float | None = None,
    supports: Supports = "springs",
) -> Setup:
    """Build the model and the initial state. Arguments as of ``simulate``; ``supports`` is always stated."""
    one_of("fidelity", fidelity, get_args(Fidelity))
    one_of("supports", supports, get_args(Supports))
    rtol = real_number("rtol", rtol, 1e-12, 1e-3)
    if friction_velocity is not None:
        friction_velocity = real_number(
            "friction_velocity", friction_velocity, 0.0, unit="m/s", action="0 switches at once."
        )
    flags = effect_flags(effects, form_of(pair)) or (kn.LINEAR if pair.mesh.contact == "loaded" else 0)
    if fidelity == "linear":
        if effects is None:
            flags = 0
        if flags & ~(kn.LINEAR | EFFECTS["contact_loss"].bits):
            allowed = "at most contact_loss at fidelity 'linear'"
            raise refuse("effects", shown(effects), allowed, "Use fidelity='exact'.")
        flags |= kn.LINEAR
    if flags & kn.LINEAR and pair.healthy is not pair:
        allowed = "'exact' where teeth differ"
        raise refuse("fidelity", fidelity, allowed, "Use it with its effects, or pair.healthy.")
    system = LTVSystem.of(pair.healthy, "full", supports="springs")
    numbers = machine(pair, flags, supports, system.cycle)
    call_limit = _call_limit(numbers)
    if pair.mesh.contact == "loaded":
        offsets = system.cycle.offsets
        start = system.cycle.geometry.L_XA
        ahead = round((float(offsets[0]) - start) / system.cycle.geometry.base_pitch)
        numbers = replace(numbers, pairs=offsets.size, ahead=ahead)
    elif flags & kn.TIP_CONTACT:  # corners lengthen the contact of every pair
        numbers = replace(numbers, pairs=min(numbers.pairs + 1, MAX_PAIRS))
    begin = _on_springs if supports == "springs" else _on_shafts
    numbers, q, v, mean_balance, motion = begin(pair, system, numbers, flags, initial)
    velocity = 0.0
    reason = "sign of the nominal sliding velocity"
    if flags & kn.SLIDING:
        velocity, reason = (
            choose_friction_velocity(numbers)
            if friction_velocity is None
            else (friction_velocity, "as given")
        )
    record = numbers.record
    record.friction.reversal_velocity = velocity
    # With a brake near zero the mean torque that holds a relieved mesh may be below zero.
    deflection = abs(numbers.torque_pinion) / float(record.geometry.radius_p) / system.cycle.mean_stiffness
    if fidelity == "exact" and deflection > _MOST_DEFLECTION * record.geometry.pitch:
        raise refuse(
            "operating.pinion_torque",
            f"{numbers.torque_pinion:.4g} N m",
            f"a static deflection below {_MOST_DEFLECTION:g} of a base pitch",
            f"The mesh would yield by {deflection * 1e3:.3g} mm and skip teeth. Lower it.",
        )
    names = active_effects(flags)
    attributes = provenance(
        pair, fidelity=fidelity, effects=names, rtol=rtol, friction_velocity=velocity, supports=supports
    )
    attributes |= mean_balance | {
        "model": "multibody",
        "teeth": "alike" if pair.healthy is pair else "as given",
        "fidelity": fidelity,
        "supports": supports,
        "effects": ", ".join(names),
        "friction_velocity": velocity,
        "friction_velocity_reason": reason,
    }
    return Setup(
        model=build(numbers, flags, call_limit),
        system=system,
        q=q,
        v=v,
        rtol=rtol,
        deflection=deflection,
        attributes=attributes,
        motion=motion,
    )


#: Machine with its torques, initial q and v, the mean balance by name, and the linear motion on shafts.
_Start = tuple[Machine, FloatArray, FloatArray, dict[str, float], LinearMotion | None]


def _on_springs(
    pair: GearPair, system: LTVSystem, numbers: Machine, flags: int, initial: Initial | ArrayLike
) -> _Start:
    """Loads and initial state of the lumped model."""
    balance = periodic_solution(system, np.zeros(1), estimate_error=False)
    mean_balance = balance_of(balance, conservative=bool(flags & kn.PATH_WORK))
    if pair.healthy is not pair:
        with_unlike_teeth = cycle_maps.linear_motion(pair, 8, "springs")
        balance = replace(balance, states=with_unlike_teeth.states[:1])
        mean_balance = with_unlike_teeth.balance(conservative=bool(flags & kn.PATH_WORK))
    torques = mean_balance["pinion_torque"], mean_balance["brake_torque"]
    numbers = replace(numbers, torque_pinion=torques[0], torque_gear=torques[1])
    static, _ = from_lumped_state(initial_state(system, "static", balance))
    q, v = from_lumped_state(initial_state(system, initial, balance))
    return loaded_phase(numbers, flags, static), q, v, mean_balance, None


def _on_shafts(
    pair: GearPair, system: LTVSystem, numbers: Machine, flags: int, initial: Initial | ArrayLike
) -> _Start:
    """Loads and initial state of the multibody model's own periodic motion with the linear mesh."""
    train = numbers.train
    assert train is not None
    if not isinstance(initial, str):
        raise refuse(
            "initial", shown(initial), "'static' or 'periodic' with supports='shafts'", "Choose one of them."
        )
    one_of("initial", initial, get_args(Initial))
    straight = replace(machine(pair, kn.LINEAR, cycle=system.cycle), train=train)
    brake = pair.operating.brake_torque
    motion = linear_motion(straight, None if brake == "balanced" else brake)
    rolling = numbers.record.rolling
    omega_p = rolling.omega_p
    omega_g = rolling.omega_g
    torque = motion.torque_gear
    driving = motion.torque_pinion * omega_p
    if flags & kn.PATH_WORK and brake == "balanced":
        torque -= energy_residual(straight, motion) / omega_g
    numbers = replace(numbers, torque_pinion=motion.torque_pinion, torque_gear=torque)
    load = -motion.torque_pinion * (train.torques[0] + omega_p / omega_g * train.torques[1])
    static = train.static(load, numbers.overlap, system.cycle.mean_stiffness)
    mean_balance = {
        "pinion_torque": motion.torque_pinion,
        "brake_torque": torque,
        "mesh_efficiency": torque * omega_g / driving,
    }
    numbers = loaded_phase(numbers, flags, static[:6])
    if initial == "static":
        return numbers, static, np.zeros(train.size), mean_balance, motion
    q, v = motion.state.copy().reshape(2, -1)
    mesh = np.pad(np.outer(numbers.overlap, numbers.overlap), (0, train.size - 6))
    stiffness = train.stiffness + system.cycle.mean_stiffness * mesh
    # Without this start the ripples would push the free train out of the mean position.
    for ripple in own_ripples(pair, drawn_gears(pair, circles(pair))):
        turning = 1j * ripple.order * (omega_p, omega_g)[ripple.gear]
        dynamic = stiffness + turning * train.damping + turning**2 * train.mass
        torque = ripple.amplitude * np.exp(1j * ripple.phase)
        amplitude = np.linalg.solve(dynamic, -torque * train.torques[ripple.gear])
        q = q + amplitude.real
        v = v + (turning * amplitude).real
    return numbers, q, v, mean_balance, motion


def _call_limit(numbers: Machine) -> int:
    """Most force evaluations of one interval. Refuse a speed at which a mesh cycle would take minutes."""
    vibrations = numbers.vibrations_per_cycle
    natural = numbers.rates.natural
    damped = numbers.rates.damped
    if vibrations > _MOST_VIBRATIONS and damped > 2.0 * natural:
        raise refuse(
            "shafts",
            f"a damper that answers within {1.0 / damped:.2g} s",
            f"dampers no faster than {1.0 / natural:.2g} s, a swing of the fastest mode over 2 pi",
            "Lower loa_damping and oloa_damping of the bearings, or coupling_damping.",
        )
    if vibrations > _MOST_VIBRATIONS:
        rpm = float(numbers.record.rolling.omega_p) * 30.0 / np.pi
        raise refuse(
            "operating.pinion_speed",
            f"{rpm:.4g} rpm",
            f"at least {rpm * vibrations / _MOST_VIBRATIONS:.3g} rpm for the multibody model of this pair",
            f"The fastest mode would swing {vibrations:.0f} times in a mesh cycle: the motion is "
            "quasi-static. Take lumped.static_transmission_error, which holds there, or raise the speed.",
        )
    return int(CALL_LIMIT * max(1.0, vibrations / _ORDINARY_VIBRATIONS))


#: Velocity over which tanh changes the sign of friction [m/s]. Halving it changes the transmission error at
#: 79.1 N m and 800 rpm of the 28/28 pair by some 1e-4 of its peak to peak.
SMALL_VELOCITY = 1e-4
#: A law is continuous at the pitch point if it jumps by less than this share of its largest value.
_CONTINUOUS = 1e-3
_BESIDE = 1e-9  # m
_PLACES = 101  # at which the largest coefficient is looked for


def choose_friction_velocity(machine: Machine) -> tuple[float, str]:
    """Choose the velocity over which friction changes its sign [m/s], and give the reason. 0: sign function.

    At the pitch point the sliding velocity passes zero with the acceleration
    a_s = (Omega_p + Omega_g) Omega_p r_bp. Friction changes this acceleration by a_f = mu N/m_s,
    1/m_s = 1/m_p + 1/m_g + X_p^2/J_p + X_g^2/J_g, and vibration changes it by up to a_f/(2 zeta). Friction
    can stick where the rest of the acceleration may be less than a_f; there sign() has no solution.
    """
    packed = machine.packed
    geometry = machine.record.geometry
    rolling = machine.record.rolling
    pitch_point = float(geometry.L_XP)
    beside = max(abs(nominal_friction(packed, pitch_point + side * _BESIDE)) for side in (-1.0, 1.0))
    path = np.linspace(geometry.L_XA, geometry.L_XD, _PLACES)
    if beside <= _CONTINUOUS * max(abs(nominal_friction(packed, xi)) for xi in path):
        return 0.0, "sign(): the friction law is continuous at the pitch point"
    arms = np.array([pitch_point, float(geometry.L_XY) - pitch_point])
    mobility = float((1.0 / machine.mass).sum() + (arms**2 / machine.inertia).sum())
    by_friction = beside * machine.torque_pinion / geometry.radius_p * mobility
    nominal = (rolling.omega_p + rolling.omega_g) * rolling.omega_p * geometry.radius_p
    if machine.train is None:
        critical = 2.0 * np.sqrt(machine.bearing_stiffness[:, 1] * machine.mass)
        ratio = float((machine.bearing_damping[:, 1] / critical).min())  # of the less damped bearing
    else:
        ratio = machine.train.damping_ratio
    needed = 1.0 + (0.5 / ratio if ratio > 0.0 else np.inf)
    share = nominal / by_friction
    numbers = f"sliding passes zero at {nominal:.3g} m/s^2, {share:.3g} times what friction can change"
    if share > needed:
        return 0.0, f"sign(): {numbers}, more than the {needed:.3g} times that resonance could take away"
    return SMALL_VELOCITY, (
        f"tanh over {SMALL_VELOCITY * 1e3:g} mm/s: {numbers}, less than the {needed:.3g} times that "
        "resonance could take away, so friction may stick at the pitch point"
    )
