"""Motions with loss of contact: which one is compared, and how finite motions change it.

Where teeth part the lumped model is taken with teeth that push only (``floquet.periodic_orbit``). Finite
motions shift its element laws as they do without loss of contact; with loaded contact the motion is linear
about itself, and a place at which teeth have parted carries nothing.

Sources: docs/theory/validity.md, "Beyond contact loss".
"""

from __future__ import annotations

from dataclasses import dataclass

import lumped
from floquet.gear.orbit import GearOrbit, absolute_states, long_run, periodic_orbit
from floquet.gear.unilateral import unilateral_system
from floquet.orbits.orbit import find_orbit
from lumped import GearPair
from lumped.errors import NumericalError
from lumped.model.periodic_system import LTVSystem
from lumped.model.results import load_range
from lumped.typing import FloatArray
from validation.cross_check.loaded_motion import LoadedModel
from validation.cross_check.shifted_motion import Motion, ShiftedModel
from validation.validity.flags import LOAD_NOISE

_PULL = "The lumped motion that was compared needs teeth that pull, which real teeth cannot:"
_ADVICE = "More torque or damping, or another speed, keeps the teeth in contact."


def parted_orbit(pair: GearPair) -> GearOrbit | None:
    """The stable motion of one mesh cycle with loss of contact that the multibody model is compared with.

    None where the teeth of the linear motion push all the time, or where no such motion is found: neither
    near the linear motion, nor where a run settles that starts there.
    """
    return _sought(pair)[0]


def why_teeth_pull(pair: GearPair) -> str:
    """Why a motion is compared in which teeth pull, in a sentence; empty where it is not."""
    return _sought(pair)[1]


def _sought(pair: GearPair) -> tuple[GearOrbit | None, str]:
    motion = lumped.steady_state(pair, samples_per_cycle=512)
    loads = motion["normal_load"].to_numpy(), motion["contact"].to_numpy()
    least = -LOAD_NOISE * pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    if load_range(pair.mesh.contact, *loads)[1] >= least:
        return None, ""
    try:
        orbit = periodic_orbit(pair)
        if not orbit.stable:
            settled = long_run(pair).orbit
            orbit = orbit if settled is None else GearOrbit(pair, settled)
    except NumericalError:
        return None, f"{_PULL} no periodic motion with teeth that part was found. {_ADVICE}"
    if not orbit.stable or orbit.n > 1:
        return None, f"{_PULL} with teeth that part no motion of one mesh cycle is stable. {_ADVICE}"
    if orbit.reaches_back_side:
        backlash = f"{pair.geometry.normal_backlash * 1e6:.3g} um"
        return None, (
            f"{_PULL} with teeth that part their backs strike, beyond the normal backlash of {backlash}. "
            f"State the real mesh.backlash if that is too little. {_ADVICE}"
        )
    return orbit, ""


@dataclass(frozen=True, eq=False)
class PartedModel(ShiftedModel):
    """The unilateral model near one of its motions, with shifted element laws.

    Attributes
    ----------
    orbit : the motion, of one mesh cycle
    """

    orbit: GearOrbit

    def _solved(self, system: LTVSystem, times: FloatArray) -> tuple[FloatArray, FloatArray | None]:
        return unilateral_motion(self.orbit, system, times)


@dataclass(frozen=True, eq=False)
class PartedLoadedModel(LoadedModel):
    """Loaded contact near one of its motions with loss of contact.

    Attributes
    ----------
    orbit : the motion, of one mesh cycle
    """

    orbit: GearOrbit

    def unmoved(self) -> Motion:
        """The motion itself. A wrong law of the contact would be taken off; the unlike twin, whose teeth push
        all the time, shows such a law.
        """
        return self.motion(None, line=0.0)

    def _solved(self, system: LTVSystem, times: FloatArray) -> tuple[FloatArray, FloatArray | None]:
        """The motion itself with the tangent of the static contact, all others linear about themselves."""
        if system is self.nominal:
            return unilateral_motion(self.orbit, system, times)
        return super()._solved(system, times)


def unilateral_motion(
    orbit: GearOrbit, system: LTVSystem, times: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """States (n, 12) and loads (pairs, n) of the motion near an orbit, at times in the mesh cycle.

    Raises
    ------
    NumericalError : the shifted laws have no such motion
    """
    near = orbit.whole
    contacts = unilateral_system(orbit.pair, system.cycle, "elastic")
    found = find_orbit(contacts, near.start, near.period, 1, near.parameter)
    run = contacts.run(found.start, found.period, 1, found.parameter, samples=times / found.period)
    return absolute_states(orbit.pair, system.cycle, found, run), run.loads.T
