"""Scope: what was computed, with which models, and what this report cannot tell."""

from __future__ import annotations

from validation.reporting.blocks import Content, Text
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    text = Text(
        "This report predicts the motion of one spur gear pair with a lumped model, checks the prediction "
        "with an independent multibody model, decides the stability of the motion, and lists where the "
        "lumped model stops being valid. What no model of this report covers stands in its chapter on "
        "assumptions and limitations. The frame: x runs along the line of action, y off it; pair 0 is "
        "the tooth pair ahead; time zero is when the newest pair enters contact at A."
    )
    models = Text(
        "Three models share one set of parameters and the stiffness of the teeth along the path of contact; "
        "the multibody model evaluates friction, damping and relief by itself:",
        (
            "Lumped: six coordinates (two rotations, and the centres of both gears along and off the line "
            "of action), linear, with coefficients that repeat every mesh cycle; stiffness and friction "
            "switch where teeth enter and leave contact and pass the pitch point. The periodic motion is "
            "computed directly, without waiting for a transient to settle.",
            "Multibody: the same gears as rigid bodies in exudyn. Fidelity “linear” assembles the same "
            "equations from the body side, so it must agree to integration error. Fidelity “exact” turns "
            "the bodies through finite angles, finds the contacts from true involutes, and takes friction "
            "from the actual sliding velocity; its difference measures what the lumped model leaves out.",
            "Floquet: the growth or decay of disturbances from one mesh cycle to the next, with error "
            "bounds.",
        ),
    )
    return Content((text, models))


CHAPTER = Chapter("scope", "Scope", write)
