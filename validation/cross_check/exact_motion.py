"""Periodic motion of the multibody model for a comparison: with friction that changes its sign sharply."""

from __future__ import annotations

import xarray as xr

import multibody
from lumped import GearPair
from lumped.errors import NumericalError
from multibody.contact.machine import machine
from multibody.contact.reversal import friction_velocity
from validation.cross_check.agreement import Fidelity

#: Share of the default velocity over which friction changes its sign, where sliding does not stick: there a
#: sharper change costs little. The default leaves twice the tolerance in y at the Kahraman-Blankenship pair.
_SHARPER = 0.01
#: Velocity for a motion that the integrator cannot follow with a sharper one [m/s].
BLUNT = 0.01


def periodic_motion(
    pair: GearPair, fidelity: Fidelity, *, samples: int, rtol: float, passes: bool
) -> xr.Dataset:
    """Motion over one mesh cycle, with blunter changes of the sign of friction where it cannot go on.

    Parameters
    ----------
    pair : the gear pair
    fidelity, rtol : as ``multibody.steady_state``
    samples : output times
    passes : whether the teeth pass zero sliding without being held (``FiniteMotion.settled``)

    Raises
    ------
    NumericalError : no periodic motion is found near the lumped one
    """
    sharp = _SHARPER * friction_velocity(machine(pair))[0] if passes else None

    def motion(velocity: float | None) -> xr.Dataset:
        return multibody.steady_state(
            pair, fidelity=fidelity, samples_per_cycle=samples, rtol=rtol, friction_velocity=velocity
        )

    try:
        return motion(sharp)
    except NumericalError:
        return motion(BLUNT)
