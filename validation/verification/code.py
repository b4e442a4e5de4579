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
from validation.verification.arithmetic import arithmetic
from validation.verification.checks import Check
from validation.verification.closed_forms import closed_forms
from validation.verification.published import published_checks
from validation.verification.stability_routes import fit_bound
from validation.verification.written_twice import written_twice

_CYCLES = 3


def code_checks(pair: GearPair) -> tuple[Check, ...]:
    """Errors against closed forms and laws of mechanics; those on a gear pair use this one.

    Raises
    ------
    NumericalError : a model fails on this pair
    """
    return (
        *published_checks(pair),
        *closed_forms(),
        *written_twice(pair),
        *arithmetic(pair),
        _block_form(pair),
        *_lumped_identities(pair),
        *(_energy(pair, fidelity) for fidelity in ("linear", "exact")),
        fit_bound(pair),
    )


def _block_form(pair: GearPair) -> Check:
    """The multipliers of all ten states against those of the 6-state block and the closed form of y."""
    block = gear_pair_multipliers(pair, rtol=1e-9)
    whole = monodromy(gear_pair_system(pair, "relative"), rtol=1e-9)
    gap = np.abs(whole.multipliers[:, None] - block.multipliers[None, :]).min(axis=1)
    return Check(
        key="block_form",
        subject="multipliers of this pair by blocks, those of y in closed form",
        exact="multipliers of the whole ten-state system; absolute",
        value=float(gap.max()),
        limit=1e-6,
        reason="close multipliers spread the error of the matrix, 1e-9, by its root at worst",
    )


def _lumped_identities(pair: GearPair) -> Iterator[Check]:
    """What a periodic motion must fulfil whatever the parameters are."""
    free = pair.with_({"friction.law": "none"})
    g = pair.geometry
    motion = steady_state(free, samples_per_cycle=1024)
    static = float(motion.attrs["pinion_torque"]) / g.base_radius_pinion
    held = -float(motion["x_p"].mean()) * pair.bearings.pinion.loa_stiffness
    yield Check(
        key="mean_load",
        subject="periodic motion of this pair without friction",
        exact="the pinion bearing carries T_p/r_bp on average (mean of equations 1 and 6)",
        value=abs(held / static - 1.0),
        limit=1e-6,
        reason="mean of 1024 samples of a motion whose second derivative jumps",
    )
    yield Check(
        key="no_loss",
        subject="mesh efficiency of this pair without friction",
        exact="1: nothing takes power from a frictionless mesh at constant mean speed",
        value=abs(float(motion.attrs["mesh_efficiency"]) - 1.0),
        limit=1e-9,
        reason="rounding of the solution for the brake torque",
    )
    rough = steady_state(pair, samples_per_cycle=4096)
    drive = float(rough.attrs["pinion_torque"]) * g.omega_pinion
    nominal = -float(rough["friction_power_nominal"].sum("pair").mean())
    yield Check(
        key="loss",
        subject="loss of this pair from the balanced brake torque",
        exact="mean friction power at nominal sliding; relative to the driving power",
        value=abs((1.0 - float(rough.attrs["mesh_efficiency"])) * drive - nominal) / drive,
        limit=1e-4,
        reason="mean of 4096 samples of a function that jumps, of which losses are a few percent",
    )


def _energy(pair: GearPair, fidelity: str) -> Check:
    balance = multibody.power_balance(pair, _CYCLES, fidelity=fidelity)  # type: ignore[arg-type]
    return Check(
        key=f"energy_{fidelity}",
        subject=f"multibody model, {fidelity}: {_CYCLES} mesh cycles from rest",
        exact="first law: driving work = braking work + stored + dissipated; over the driving work",
        value=abs(balance.residual) / abs(balance.driving),
        limit=1e-7,
        reason="integrated to 1e-8 per step",
    )
