"""Who decides whether a motion of the lumped model is linear or unilateral: the argument ``contact`` alone.

``lumped.steady_state``, ``simulate``, ``speed_sweep`` and ``run_up`` all ask ``motion_form``. Whether teeth
are alike decides only how a linear motion is computed.

| ``contact`` | a pair that would pull | force |
|---|---|---|
| "linear" | pulls | ``lumped.mesh.linear``; of like teeth the laws of ``MeshCycle`` |
| "unilateral" | has no load | ``lumped.mesh.unilateral_force`` |

``spurcheck.predict`` asks for "unilateral". Charts, boundaries and margins are linear. Branches and jumps of
``floquet`` are unilateral. The multibody model has the effect "contact_loss" in place of the argument
(``multibody.run.effects``). See decision 6 in docs/contributing/decisions.md.
"""

from __future__ import annotations

from enum import Enum, auto
from typing import Literal, get_args

from lumped.arguments import one_of
from lumped.schema.pair import GearPair

#: The argument ``contact``: teeth that may pull, or teeth that only push.
ContactArgument = Literal["linear", "unilateral"]


class MotionForm(Enum):
    """How a motion is computed."""

    LINEAR_LIKE_TEETH = auto()  # the laws of one mesh cycle
    LINEAR_OWN_TEETH = auto()  # like teeth, plus what the deviations of each pair change
    UNILATERAL = auto()  # by momentary load, like teeth or teeth that differ


def motion_form(pair: GearPair, contact: ContactArgument) -> MotionForm:
    """Return how the motion of a pair is computed; refuse a ``contact`` that does not exist."""
    one_of("contact", contact, get_args(ContactArgument))
    if contact == "unilateral":
        return MotionForm.UNILATERAL
    return MotionForm.LINEAR_LIKE_TEETH if pair.healthy is pair else MotionForm.LINEAR_OWN_TEETH
