"""Laws of mechanics that every motion fulfils, and what is worked out from a motion, by hand calculation.

Sources: the closed forms are derived where they are used; Oberkampf and Roy, Verification and Validation in
Scientific Computing, 2010, for the method.
"""

import math
from collections.abc import Iterator

import numpy as np
import xarray as xr

import multibody
from floquet.gear.axes import operating_rpm
from lumped import GearPair, bodies, steady_state
from lumped.errors import NumericalError
from lumped.gear_geometry.geometry import Geometry
from lumped.losses import loss_factor, ohlendorf_of, quasi_static_losses
from lumped.model.averaged import averaged_matrix, modes
from lumped.model.periodic_system import periodic_system
from lumped.model.powers import mean_powers
from lumped.model.results import plain
from lumped.model.steady import PeriodicSolution, periodic_cycle, periodic_solution
from lumped.quasi_static.contacts import mesh_elements
from lumped.quasi_static.load_sharing import share_load
from lumped.typing import FloatArray
from multibody.contact.machine import machine
from tests.evidence.check import Check, rows
from validation.cross_check.agreement import FIDELITIES, Fidelity
from validation.cross_check.conservation import losses, quadrature
from validation.prediction.motion import Motion, Prediction

_CYCLES = 2
_SAMPLES = 512


def mechanics(pair: GearPair) -> Iterator[Check]:
    """What the report works out from a motion, and what a motion must fulfil whatever the parameters are."""
    yield from (_orders(pair), _speeds(pair), _losses(pair), _forces(pair), _averaged(pair), _sharing())
    yield from _lumped_identities(pair)
    for fidelity in FIDELITIES:
        yield _energy(pair, fidelity)


def _orders(pair: GearPair) -> Check:
    phase = 2.0 * np.pi * np.arange(64) / 64
    values = 3.0 + 2.0 * np.cos(phase + 0.4) + 0.5 * np.sin(3.0 * phase)
    wave = plain(xr.Dataset({"dte": ("time", values)}, {"time": phase}))
    motion = Prediction(pair, Motion.UNILATERAL, wave, 0.0, True, 1, {})
    both = list(zip(motion.orders_of("dte")[:4] + 1.0, (3.0, 1.0, 1.5, 1.0), strict=True))
    return rows("amplitudes by mesh order", "those of a sum of cosines", 1e-12, both)


def _speeds(pair: GearPair) -> Check:
    """Speed in rpm, natural frequency off the line of action and its speed, from the fields of the schema."""
    both = [(operating_rpm(pair), pair.operating.pinion_speed * 60.0 / (2.0 * math.pi))]
    try:
        results = modes(pair)
    except NumericalError:
        results = ()
    for mass, bearing in zip(
        (bodies(pair).mass_pinion, bodies(pair).mass_gear),
        (pair.bearings.pinion, pair.bearings.gear),
        strict=True,
    ):
        wanted = math.sqrt(bearing.oloa_stiffness / mass) / (2.0 * math.pi)
        near = min(results, key=lambda mode: abs(mode.natural_frequency - wanted), default=None)
        if near is not None:
            both.append((near.natural_frequency, wanted))
            both.append((near.resonant_speed, 60.0 * near.natural_frequency / pair.pinion.teeth))
    # An eigenvalue solver finds close frequencies to the root of rounding.
    exact = "sqrt(K/m)/(2 pi) of each bearing, and 60 f over the teeth of the pinion"
    return rows("speed, natural frequencies off the line of action, resonant speeds", exact, 1e-6, both)


def _losses(pair: GearPair) -> Check:
    """Quasi-static losses of a pair with constant friction coefficient, and the loss factor by hand."""
    mu = 0.05
    plain = pair.with_({"friction.law": "coulomb", "friction.coefficient": mu})
    still = quasi_static_losses(plain, sharing="uniform")
    power = pair.operating.pinion_torque * pair.operating.pinion_speed
    loss = _uniform_loss_factor(pair.geometry)
    both = [
        (still.input_power, power),
        (loss_factor(pair, "uniform"), loss),
        (1.0 - still.mesh_efficiency, still.power_loss / power),
        (still.power_loss / (mu * power), loss),
    ]
    g = pair.geometry
    arms = ((g.L_XD - g.L_XP) / g.base_pitch, (g.L_XP - g.L_XA) / g.base_pitch)
    if max(arms) <= 1.0 and min(arms) > 0.0 and 1.0 < g.contact_ratio < 2.0:
        both.append((ohlendorf_of(pair), loss))
    # To first order in mu = 0.05; half a percent of it remains.
    exact = "mean sliding velocity under equally shared load, summed over the cycle"
    return rows("loss factors, input power, efficiency at rest", exact, 0.02, both)


def _uniform_loss_factor(g: Geometry) -> float:
    """Mean over the cycle of the sliding velocities of pairs that share the load equally, over v_t."""
    phase = (np.arange(20000) + 0.5) / 20000
    xi = g.L_XA + (phase[:, None] + np.arange(5)) * g.base_pitch
    touching = xi < g.L_XD
    arm = np.abs(xi - g.base_radius_pinion * math.tan(g.operating_pressure_angle)) * touching
    per_pair = arm.sum(axis=1) / touching.sum(axis=1)
    return float(per_pair.mean()) * (1.0 / g.base_radius_pinion + 1.0 / g.base_radius_gear)


def _forces(pair: GearPair) -> Check:
    """Mean bearing forces and mean friction power of the periodic motion, from other columns of its table."""
    motion = steady_state(pair, samples_per_cycle=_SAMPLES)
    b = pair.bearings
    both = []
    for name, k in (
        ("x_p", b.pinion.loa_stiffness),
        ("x_g", b.gear.loa_stiffness),
        ("y_p", b.pinion.oloa_stiffness),
        ("y_g", b.gear.oloa_stiffness),
    ):
        scale = k * max(float(np.abs(motion[name]).max()), 1e-300)
        mean = float(motion[f"bearing_force_{name}"].mean())
        both.append((mean / scale + 1.0, 1.0 - k * float(motion[name].mean()) / scale))
    omega_p = pair.operating.pinion_speed
    teeth = pair.pinion.teeth / pair.gear.teeth
    sliding = omega_p * motion["position"] - omega_p * teeth * (pair.geometry.L_XY - motion["position"])
    wanted = -(motion["friction_force"] * sliding).sum("pair")
    size = max(float(np.abs(wanted).max()), 1e-300)
    results = motion["friction_power_nominal"].sum("pair")
    both.append((float(np.abs(results - wanted).max()) / size + 1.0, 1.0))
    if pair.operating.brake_torque == "balanced":
        both.append((float(motion.attrs["pinion_torque"]), pair.operating.pinion_torque))
    # A pair is in contact from A to D, loaded where the static mesh has it; samples on either end
    # may round to either side.
    g = pair.geometry
    place = motion["position"].to_numpy()
    loaded = pair.mesh.contact == "loaded"
    low, high = mesh_elements(pair).stiffness.interval if loaded else (g.L_XA, g.L_XD)
    clear = np.minimum(np.abs(place - low), np.abs(place - high)) > 1e-6 * g.base_pitch
    wrong = (motion["contact"].to_numpy() > 0.0) != ((place > low) & (place < high))
    both.append((1.0 + float((wrong & clear).sum()), 1.0))
    # The damping force has no mean over a whole cycle, but for samples beside a jump.
    exact = "means of stiffness times displacement; force times sliding velocity; contact from A to D"
    return rows("bearing forces, friction power, contacts, driving torque", exact, 1e-4, both)


def _averaged(pair: GearPair) -> Check:
    system = periodic_system(pair, "elastic")
    samples = 4096
    matrices = system.matrices((np.arange(samples) + 0.5) * (system.period / samples))
    mean = np.asarray(matrices.mean(axis=0))
    error = float(np.abs(averaged_matrix(system) - mean).max() / np.abs(mean).max())
    # A sample to either side of each jump.
    return Check("averaged system", f"mean of A(t) at {samples} times", error, 2e-3)


def _sharing() -> Check:
    """Springs of unequal stiffness and error, solved by hand.

    First three springs: the third spring does not touch. Then two springs that move each other by 1e-9 m/N:
    with an error of 1 um the second spring carries a load; with 4.5 um the second spring does not touch.
    """
    results = share_load([2e8, 1e8, 3e8], [0.0, 2e-6, 1.0], 1000.0)
    delta = (1000.0 + 1e8 * 2e-6) / 3e8
    both = [(float(results.transmission_error), delta), (float(results.load[0]), 2e8 * delta)]
    both += [(float(results.load[1]), 1e8 * delta - 200.0)]
    coupling = [[0.0, 1e-9], [1e-9, 0.0]]
    late = [[0.0, 1e-6], [0.0, 4.5e-6]]
    results = share_load([2e8, 1e8], late, [1000.0, 1000.0], coupling)
    both += list(zip(results.load.ravel().tolist(), [1e4 / 13.0, 3e3 / 13.0, 1000.0, 0.0], strict=True))
    both += list(zip(results.transmission_error.tolist(), [53e-6 / 13.0, 5e-6], strict=True))
    return rows("static load sharing", "three cases solved by hand", 1e-12, both)


def _lumped_identities(pair: GearPair) -> Iterator[Check]:
    """What a periodic motion must fulfil whatever the parameters are."""
    free = pair.with_({"friction.law": "none"})
    motion = steady_state(free, samples_per_cycle=1024)
    static = float(motion.attrs["pinion_torque"]) / pair.geometry.base_radius_pinion
    pair_on_springs = -float(motion["x_p"].mean()) * pair.bearings.pinion.loa_stiffness
    # Mean of 1024 samples of a motion whose second derivative jumps.
    exact = "T_p/r_bp, mean of equations 1 and 6"
    yield Check(
        "mean load of the pinion bearing without friction", exact, abs(pair_on_springs / static - 1.0), 1e-6
    )
    # Errors of two quadratures, 1e-7 of losses of up to some percent.
    exact = "the losses of dampers of teeth and bearings; over the driving power"
    yield Check("loss without friction", exact, _efficiency_error(free), 1e-7)
    exact = "all losses at the actual motion; over the driving power"
    yield Check("loss of the efficiency", exact, _efficiency_error(pair), 1e-7)
    exact = "mean friction power at nominal sliding; with loaded contact all losses at the actual motion"
    yield Check("loss from brake torque", exact, _brake_error(pair), 1e-7)
    exact = "the same powers with the levers of the multibody model; over the driving power"
    yield Check("losses by place, energy residual", exact, _powers_error(pair), 1e-7)


def _efficiency_error(pair: GearPair) -> float:
    """The efficiency of the periodic motion against all losses at its states."""
    motion, _ = _motion(pair)
    driving = motion.pinion_torque * pair.geometry.omega_pinion
    efficiency = float(steady_state(pair, samples_per_cycle=8).attrs["mesh_efficiency"])
    return abs(1.0 - efficiency - _all_losses(pair) / driving)


def _brake_error(pair: GearPair) -> float:
    """The braking power against the driving one less friction at nominal sliding (loaded: all losses)."""
    attributes = steady_state(pair, samples_per_cycle=8).attrs
    braking = float(attributes["brake_torque"]) * pair.geometry.omega_gear
    motion, weights = _motion(pair)
    driving = motion.pinion_torque * pair.geometry.omega_pinion
    taken = -float(motion.values["friction_power_nominal"].sum(axis=0) @ weights)
    if pair.mesh.contact == "loaded":
        taken = _all_losses(pair)
    return abs(1.0 - (braking + taken) / driving)


def _all_losses(pair: GearPair) -> float:
    """Mean losses by the levers of the multibody model [W]."""
    motion, weights = _motion(pair)
    lost = losses(motion.system, machine(pair), motion.time, motion.states, weights)
    return float(lost["friction"] + lost["bearings"] + lost["mesh_damping"])


def _powers_error(pair: GearPair) -> float:
    """Losses by place, and the energy residual, against those with the levers of the multibody model."""
    motion, weights = _motion(pair)
    powers = mean_powers(periodic_cycle(pair, 8))
    wanted = losses(motion.system, machine(pair), motion.time, motion.states, weights)
    pairs = (
        (powers.sliding, wanted["friction"]),
        (powers.tooth_dampers, wanted["mesh_damping"]),
        (powers.bearings, wanted["bearings"]),
        (powers.energy_residual, -wanted["mesh_stiffness"]),
    )
    return max(abs(one - other) for one, other in pairs) / powers.driving


def _motion(pair: GearPair) -> tuple[PeriodicSolution, FloatArray]:
    """Periodic motion at times of a quadrature over the cycle, and their weights."""
    system = periodic_system(pair, "full")
    times, weights = quadrature(system)
    return periodic_solution(system, times, estimate_error=False), weights


def _energy(pair: GearPair, fidelity: Fidelity) -> Check:
    rtol = 1e-10 if fidelity == "linear" else 1e-8
    balance = multibody.power_balance(pair, _CYCLES, fidelity=fidelity, rtol=rtol)
    exact = "driving work = braking work + stored + dissipated; over the driving work"
    value = abs(balance.residual) / abs(balance.driving)
    return Check(f"power balance of the multibody model, {fidelity}, from rest", exact, value, 1e-7)
