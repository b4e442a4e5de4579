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
from lumped.schema.files import AnyPair, load_gear_pair
from validation.verification.arithmetic import arithmetic
from validation.verification.checks import Check, check
from validation.verification.closed_forms import closed_forms
from validation.verification.published import published_checks
from validation.verification.stability_routes import fit_bound
from validation.verification.written_twice import written_twice

_CYCLES = 3


def code_checks(pair: AnyPair) -> tuple[Check, ...]:
    """Errors against closed forms and laws of mechanics; those on a gear pair use this one.

    Raises
    ------
    NumericalError : a model fails on this pair
    """
    pair = load_gear_pair(pair)
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
    return check("block_form", float(gap.max()))


def _lumped_identities(pair: GearPair) -> Iterator[Check]:
    """What a periodic motion must fulfil whatever the parameters are."""
    free = pair.with_({"friction.law": "none"})
    g = pair.geometry
    motion = steady_state(free, samples_per_cycle=1024)
    static = float(motion.attrs["pinion_torque"]) / g.base_radius_pinion
    held = -float(motion["x_p"].mean()) * pair.bearings.pinion.loa_stiffness
    yield check("mean_load", abs(held / static - 1.0))
    yield check("no_loss", abs(float(motion.attrs["mesh_efficiency"]) - 1.0))
    rough = steady_state(pair, samples_per_cycle=4096)
    drive = float(rough.attrs["pinion_torque"]) * g.omega_pinion
    nominal = -float(rough["friction_power_nominal"].sum("pair").mean())
    yield check("loss", abs((1.0 - float(rough.attrs["mesh_efficiency"])) * drive - nominal) / drive)


def _energy(pair: GearPair, fidelity: str) -> Check:
    balance = multibody.power_balance(pair, _CYCLES, fidelity=fidelity)  # type: ignore[arg-type]
    return check(f"energy_{fidelity}", abs(balance.residual) / abs(balance.driving), cycles=_CYCLES)
