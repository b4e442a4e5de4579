"""The code against closed forms and laws of mechanics, computed when asked.

Sources: the closed forms are derived where they are used; Oberkampf and Roy, Verification and
Validation in Scientific Computing, 2010, for the method.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import multibody
from floquet import gear_pair_multipliers, gear_pair_system, monodromy
from lumped import GearPair, steady_state
from lumped.model.periodic_system import periodic_system
from lumped.model.powers import mean_powers
from lumped.model.steady import PeriodicSolution, periodic_cycle, periodic_solution
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray
from multibody.contact.machine import machine
from validation.cross_check.agreement import FIDELITIES, Fidelity
from validation.cross_check.power_balance import losses, quadrature
from validation.verification.arithmetic import arithmetic
from validation.verification.checks import Check, check
from validation.verification.elastic_load import elastic_load
from validation.verification.published import published_checks
from validation.verification.stability_routes import fit_bound
from validation.verification.written_twice import written_twice

_CYCLES = 2


def code_checks(pair: AnyPair) -> tuple[Check, ...]:
    """Errors against closed forms and laws of mechanics; those on a gear pair use this one.

    Raises
    ------
    NumericalError : a model fails on this pair
    """
    pair = load_gear_pair(pair)
    return (
        *published_checks(pair),
        elastic_load(),
        *written_twice(pair),
        *arithmetic(pair),
        _block_form(pair),
        *_lumped_identities(pair),
        *(_energy(pair, fidelity) for fidelity in FIDELITIES),
        fit_bound(pair),
    )


def _block_form(pair: GearPair) -> Check:
    """The multipliers of all ten states against those of the 6-state block and the closed form of y."""
    block = gear_pair_multipliers(pair, rtol=1e-9)
    whole = monodromy(gear_pair_system(pair, "elastic"), rtol=1e-9)
    gap = np.abs(whole.multipliers[:, None] - block.multipliers[None, :]).min(axis=1)
    return check("block_form", float(gap.max()))


def _lumped_identities(pair: GearPair) -> Iterator[Check]:
    """What a periodic motion must fulfil whatever the parameters are."""
    free = pair.with_({"friction.law": "none"})
    motion = steady_state(free, samples_per_cycle=1024)
    static = float(motion.attrs["pinion_torque"]) / pair.geometry.base_radius_pinion
    held = -float(motion["x_p"].mean()) * pair.bearings.pinion.loa_stiffness
    yield check("mean_load", abs(held / static - 1.0))
    yield check("no_loss", abs(_share_lost(free) - _owed(free)))
    yield check("loss", abs(_share_lost(pair) - _owed(pair)))
    yield check("mean_powers", _powers_error(pair))


def _share_lost(pair: GearPair) -> float:
    """Share of the driving power that does not reach the brake."""
    found = steady_state(pair, samples_per_cycle=8).attrs
    braking = float(found["brake_torque"]) * pair.geometry.omega_gear
    driving = float(found["pinion_torque"]) * pair.geometry.omega_pinion
    efficiency = float(found["mesh_efficiency"])
    return 1.0 - (efficiency if abs(braking / driving - efficiency) < 1e-12 else np.nan)


def _owed(pair: GearPair) -> float:
    """Power of friction at nominal sliding (loaded: of all losses) over the driving power."""
    motion, weights = _motion(pair)
    if pair.mesh.contact == "loaded":
        lost = losses(motion.system, machine(pair), motion.time, motion.states, weights)
        taken = lost["friction"] + lost["bearings"] + lost["mesh_damping"]
    else:
        taken = -float(motion.values["friction_power_nominal"].sum(axis=0) @ weights)
    return taken / (motion.pinion_torque * pair.geometry.omega_pinion)


def _powers_error(pair: GearPair) -> float:
    """Losses by place, and what is unpaid, against those with the levers of the multibody model."""
    motion, weights = _motion(pair)
    found = mean_powers(periodic_cycle(pair, 8))
    wanted = losses(motion.system, machine(pair), motion.time, motion.states, weights)
    pairs = (
        (found.sliding, wanted["friction"]),
        (found.tooth_dampers, wanted["mesh_damping"]),
        (found.bearings, wanted["bearings"]),
        (found.energy_residual, -wanted["mesh_stiffness"]),
    )
    return max(abs(one - other) for one, other in pairs) / found.driving


def _motion(pair: GearPair) -> tuple[PeriodicSolution, FloatArray]:
    """Periodic motion at times of a quadrature over the cycle, and their weights."""
    system = periodic_system(pair, "full")
    times, weights = quadrature(system)
    return periodic_solution(system, times, estimate_error=False), weights


def _energy(pair: GearPair, fidelity: Fidelity) -> Check:
    rtol = 1e-10 if fidelity == "linear" else 1e-8
    balance = multibody.power_balance(pair, _CYCLES, fidelity=fidelity, rtol=rtol)
    return check(f"energy_{fidelity}", abs(balance.residual) / abs(balance.driving), cycles=_CYCLES)
