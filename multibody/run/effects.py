"""The finite-motion effects of the exact model. Each effect can be switched off, to see what the effect does.

Without all effects the exact model solves the lumped equations.

The momentary load in the friction law is no finite motion: the load changes the coefficient of friction
however small the torque is. So this effect acts only where the caller names it, and the attribution shows
its size.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np

from lumped.arguments import some_of
from lumped.errors import refuse
from lumped.schema.pair import GearPair
from multibody.contact import kinematics as kn

#: Form of the contact with a stiffness of the whole mesh.
WHOLE = "whole mesh"


class Effect(NamedTuple):
    """One finite-motion effect.

    bits : switches of the effect in ``kernels``
    cause : cause of differences to which the effect belongs, a key of ``CAUSES``
    forms : forms of the contact, see ``form_of``, with which the effect acts by default
    """

    bits: int
    cause: str
    forms: tuple[str, ...] = ("prescribed", "loaded", WHOLE)


EFFECTS: dict[str, Effect] = {
    # The contact moves with the actual rotations, vibration included ...
    "rotation_phase": Effect(kn.ROTATION_PHASE, "contact"),
    # ... and its line with the actual gear centres.
    "moving_line": Effect(kn.MOVING_LINE, "contact"),
    "sliding_velocity": Effect(kn.SLIDING, "sliding_velocity"),
    # Teeth enter and leave where deflected flanks cross the tip circles; a stiffness of the whole mesh has
    # been measured or computed with that.
    "entry_shift": Effect(kn.ENTRY_SHIFT, "contact", ("prescribed", "loaded")),
    # After the backlash the back sides touch.
    "contact_loss": Effect(kn.CONTACT_LOSS | kn.BACK_SIDE, "contact"),
    "friction_load": Effect(kn.FRICTION_LOAD, "friction_load", ()),
    "path_work": Effect(kn.PATH_WORK, "path_work", ("loaded",)),
    # Teeth touch where the gap of flanks and tip corners closes, also before A and behind D ...
    "tip_contact": Effect(kn.TIP_CONTACT, "contact", ("loaded",)),
    # ... and where their flanks meet, not where statics say: relief is clearance.
    "clearance": Effect(kn.CLEARANCE, "contact", ("loaded",)),
    # The contact grows stiffer with its own momentary load, by Weber and Banaschek.
    "contact_law": Effect(kn.CONTACT_LAW, "contact", ("loaded",)),
    # The load of a tooth moves the next teeth, where the stiffness model knows how far.
    "neighbours": Effect(kn.NEIGHBOURS, "contact", ("loaded",)),
}
#: Why the models may differ, in words. Rotations, centres, tip circles and gaps together say where and if
#: teeth touch; one without the others is no motion of the machine, so these effects are one cause.
CAUSES: dict[str, str] = {
    "contact": "contact is where the actual flanks meet, and unilateral",
    "sliding_velocity": "friction follows the actual sliding and rolling velocities",
    "path_work": "bent teeth turn the contact normal: the shafts supply what the teeth store",
    "friction_load": "friction law at the momentary load of each pair",
}


def form_of(pair: GearPair) -> str:
    """Form of the contact: ``mesh.contact`` of the pair, or ``WHOLE`` with a stiffness of the whole mesh."""
    return WHOLE if pair.mesh.stiffness.whole_mesh else pair.mesh.contact


def default_effects(form: str) -> tuple[str, ...]:
    """Names of the effects that act where none are named, with this form of the contact."""
    return tuple(name for name, effect in EFFECTS.items() if form in effect.forms)


def effect_flags(effects: Collection[str] | Mapping[str, bool] | None, form: str = "prescribed") -> int:
    """Return the kernel's switch bits of named effects, or of a mapping name -> bool.

    Names that a mapping leaves out, or all with None, act if they are ``default_effects`` of ``form``.
    """
    default = default_effects(form)
    if effects is None:
        names = set(default)
    elif isinstance(effects, Mapping):
        some_of("effects", list(effects), EFFECTS)
        for name, acts in effects.items():
            if not isinstance(acts, bool | np.bool_):
                raise refuse(f"effects.{name}", acts, "True or False", "Say whether the effect acts.")
        names = {name for name in EFFECTS if effects.get(name, name in default)}
    else:
        names = set(some_of("effects", effects, EFFECTS, "Name the effects to keep."))
    return sum(EFFECTS[name].bits for name in names)


def active_effects(flags: int) -> tuple[str, ...]:
    """Names of the effects whose bits are set, in the order of ``EFFECTS``."""
    return tuple(name for name, effect in EFFECTS.items() if flags & effect.bits == effect.bits)
