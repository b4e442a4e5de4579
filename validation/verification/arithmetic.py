"""What the report works out from a motion, against laws of mechanics and hand calculation on this pair."""

from __future__ import annotations

import math

import numpy as np

from floquet.gear.axes import operating_rpm
from lumped import GearPair, bodies, steady_state
from lumped.errors import NumericalError
from lumped.gear_geometry.geometry import Geometry
from lumped.losses import dynamic_losses, loss_factor, ohlendorf_of, quasi_static_losses
from lumped.model.averaged import averaged_matrix, modes
from lumped.model.periodic_system import periodic_system
from lumped.quasi_static.contacts import mesh_elements
from lumped.quasi_static.load_sharing import share_load
from validation.cross_check.metrics import mesh_orders
from validation.verification.checks import Check, check, rows_check

_SAMPLES = 512


def arithmetic(pair: GearPair) -> tuple[Check, ...]:
    """Checks of orders, speeds, losses, frequencies and forces as the report shows them.

    Parameters
    ----------
    pair : a validated gear pair

    Raises
    ------
    NumericalError : the pair has no periodic motion
    """
    return (_orders(), _speeds(pair), _losses(pair), _forces(pair), _averaged(pair), _sharing())


def _orders() -> Check:
    phase = 2.0 * np.pi * np.arange(64) / 64
    found = mesh_orders(3.0 + 2.0 * np.cos(phase + 0.4) + 0.5 * np.sin(3.0 * phase), 64, 4)
    rows = list(zip(found.amplitude + 1.0, (4.0, 3.0, 1.0, 1.5, 1.0), strict=True))
    return rows_check("mesh_orders", [*rows, (float(found.phase[1]), 0.4)])


def _speeds(pair: GearPair) -> Check:
    """Speed in rpm, natural frequency off the line of action and its speed, from the fields of the schema."""
    rows = [(operating_rpm(pair), pair.operating.pinion_speed * 60.0 / (2.0 * math.pi))]
    try:
        found = modes(pair)
    except NumericalError:
        found = ()
    for mass, bearing in zip(
        (bodies(pair).mass_pinion, bodies(pair).mass_gear),
        (pair.bearings.pinion, pair.bearings.gear),
        strict=True,
    ):
        wanted = math.sqrt(bearing.oloa_stiffness / mass) / (2.0 * math.pi)
        near = min(found, key=lambda mode: abs(mode.natural_frequency - wanted), default=None)
        if near is not None:
            rows.append((near.natural_frequency, wanted))
            rows.append((near.resonant_speed, 60.0 * near.natural_frequency / pair.pinion.teeth))
    return rows_check("frequencies", rows)


def _losses(pair: GearPair) -> Check:
    """Losses of the mesh at rest of a pair whose friction is one coefficient, and its loss factor by hand."""
    mu = 0.05
    plain = pair.with_({"friction.law": "coulomb", "friction.coefficient": mu})
    still = quasi_static_losses(plain, sharing="uniform", samples_per_cycle=8).attrs
    power = pair.operating.pinion_torque * pair.operating.pinion_speed
    loss = _uniform_loss_factor(pair.geometry)
    rows = [
        (still["input_power"], power),
        (loss_factor(pair, "uniform"), loss),
        (1.0 - still["mesh_efficiency"], still["power_loss"] / power),
        (still["power_loss"] / (mu * power), loss),
    ]
    motion = steady_state(pair, samples_per_cycle=8)
    rows.append(
        (
            dynamic_losses(pair, motion).attrs["input_power"],
            motion.attrs["pinion_torque"] * pair.operating.pinion_speed,
        )
    )
    g = pair.geometry
    arms = ((g.L_XD - g.L_XP) / g.base_pitch, (g.L_XP - g.L_XA) / g.base_pitch)
    if max(arms) <= 1.0 and min(arms) > 0.0 and 1.0 < g.contact_ratio < 2.0:
        rows.append((ohlendorf_of(pair), loss))
    return rows_check("losses", rows)


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
    rows = []
    for name, k in (
        ("x_p", b.pinion.loa_stiffness),
        ("x_g", b.gear.loa_stiffness),
        ("y_p", b.pinion.oloa_stiffness),
        ("y_g", b.gear.oloa_stiffness),
    ):
        scale = k * max(float(np.abs(motion[name]).max()), 1e-300)
        mean = float(motion[f"bearing_force_{name}"].mean())
        rows.append((mean / scale + 1.0, 1.0 - k * float(motion[name].mean()) / scale))
    omega_p, teeth = pair.operating.pinion_speed, pair.pinion.teeth / pair.gear.teeth
    sliding = omega_p * motion["position"] - omega_p * teeth * (pair.geometry.L_XY - motion["position"])
    wanted = -(motion["friction_force"] * sliding).sum("pair")
    size = max(float(np.abs(wanted).max()), 1e-300)
    found = motion["friction_power_nominal"].sum("pair")
    rows.append((float(np.abs(found - wanted).max()) / size + 1.0, 1.0))
    if pair.operating.brake_torque == "balanced":
        rows.append((float(motion.attrs["pinion_torque"]), pair.operating.pinion_torque))
    # A pair is in contact from A to D, loaded where the static mesh has it; samples on either end
    # may round to either side.
    g, place = pair.geometry, motion["position"].to_numpy()
    loaded = pair.mesh.contact == "loaded"
    low, high = mesh_elements(pair).stiffness.interval if loaded else (g.L_XA, g.L_XD)
    clear = np.minimum(np.abs(place - low), np.abs(place - high)) > 1e-6 * g.base_pitch
    wrong = (motion["contact"].to_numpy() > 0.0) != ((place > low) & (place < high))
    rows.append((1.0 + float((wrong & clear).sum()), 1.0))
    return rows_check("forces", rows)


def _averaged(pair: GearPair) -> Check:
    system = periodic_system(pair, "elastic")
    samples = 4096
    matrices = system.matrices((np.arange(samples) + 0.5) * (system.period / samples))
    mean = np.asarray(matrices.mean(axis=0))
    error = float(np.abs(averaged_matrix(system) - mean).max() / np.abs(mean).max())
    return check("averaged", error, samples=samples)


def _sharing() -> Check:
    """Three springs of unequal stiffness and error, solved by hand: the third stays apart.

    Then two that move each other by 1e-9 m/N: late by 1 um the second helps, by 4.5 um it is pushed away.
    """
    found = share_load([2e8, 1e8, 3e8], [0.0, 2e-6, 1.0], 1000.0)
    delta = (1000.0 + 1e8 * 2e-6) / 3e8
    rows = [(float(found.transmission_error), delta), (float(found.load[0]), 2e8 * delta)]
    rows += [(float(found.load[1]), 1e8 * delta - 200.0)]
    coupling = [[0.0, 1e-9], [1e-9, 0.0]]
    late = [[0.0, 1e-6], [0.0, 4.5e-6]]
    found = share_load([2e8, 1e8], late, [1000.0, 1000.0], coupling)
    rows += list(zip(found.load.ravel().tolist(), [1e4 / 13.0, 3e3 / 13.0, 1000.0, 0.0], strict=True))
    rows += list(zip(found.transmission_error.tolist(), [53e-6 / 13.0, 5e-6], strict=True))
    return rows_check("load_sharing", rows)
