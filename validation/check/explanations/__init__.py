"""Named explanations of a misfit: changes of our model, or of the reading of the curves."""

from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.explanations.registry import EXPLANATIONS

__all__ = ["EXPLANATIONS", "Cause", "Choice", "Kind", "Variant"]
