"""The finite-motion effects of the exact model, each of which can be switched off to see what it does.

With all of them off the exact model solves the lumped equations, so every difference between the two models
is the sum of what these switches add.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from lumped.arguments import some_of
from lumped.errors import refuse
from multibody.contact import kernels as kn

#: Name -> (bits of the kernel, what it means).
EFFECTS: dict[str, tuple[int, str]] = {
    "rotation_phase": (kn.ROTATION_PHASE, "the contact moves with the actual rotations, vibration included"),
    "moving_line": (kn.MOVING_LINE, "the line of action turns and moves with the actual gear centres"),
    "sliding_velocity": (kn.SLIDING, "friction follows the actual sliding velocity in size and sign"),
    "entry_shift": (kn.ENTRY_SHIFT, "teeth enter and leave where the deflected flanks cross the tip circles"),
    "contact_loss": (
        kn.CONTACT_LOSS | kn.BACK_SIDE,
        "teeth push but never pull; after the backlash the back sides touch",
    ),
}


def effect_flags(effects: Collection[str] | Mapping[str, bool] | None) -> int:
    """Return the kernel's switch bits.

    Parameters
    ----------
    effects : names of the effects that act, or a mapping name -> bool where names left out act; None: all act

    Raises
    ------
    ParameterError : unknown effect
    """
    if effects is None:
        names: set[str] = set(EFFECTS)
    elif isinstance(effects, Mapping):
        some_of("effects", list(effects), EFFECTS)
        for name, acts in effects.items():
            if not isinstance(acts, bool | np.bool_):
                raise refuse(f"effects.{name}", acts, "True or False", "Say whether the effect acts.")
        names = {name for name in EFFECTS if effects.get(name, True)}
    else:
        names = set(some_of("effects", effects, EFFECTS, "Name the effects to keep."))
    flags = 0
    for name in names:
        flags |= EFFECTS[name][0]
    return flags


def active_effects(flags: int) -> tuple[str, ...]:
    """Names of the effects whose bits are set, in the order of ``EFFECTS``."""
    return tuple(name for name, (bits, _) in EFFECTS.items() if flags & bits == bits)
