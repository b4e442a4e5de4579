"""A model of one's own, or a record, beside both programs: verdict, misfit, and named explanations."""

from validation.check.check import Check, Verdict, check
from validation.check.curves import Channel, Curves, SpeedColumn, ValuesOverSpeed
from validation.check.ladder import Alternative, Explanation, Ladder

__all__ = [
    "Alternative",
    "Channel",
    "Check",
    "Curves",
    "Explanation",
    "Ladder",
    "SpeedColumn",
    "ValuesOverSpeed",
    "Verdict",
    "check",
]
