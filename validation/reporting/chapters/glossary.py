"""Glossary: the words of the report that a gear engineer may meet here first."""

from __future__ import annotations

from validation.reporting.blocks import Content, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results

_WORDS = {
    "LOA, OLOA": "Along and off the line of action: the line on which flanks touch and press, and the "
    "direction across it, in which friction acts.",
    "DTE": "Dynamic transmission error: how far the gear is from where rigid, perfect teeth would have it, "
    "along the line of action, while it runs.",
    "peak to peak": "Largest minus smallest value over a mesh cycle.",
    "mesh cycle": "The time from one tooth pair's first contact to the next one's.",
    "multiplier": "Factor by which a small disturbance of the periodic motion grows in a mesh cycle (Floquet "
    "multiplier). Stable: all below 1 in modulus. The largest modulus is the spectral radius.",
    "tongue": "Range of speeds, narrower with more damping, in which the changing mesh stiffness feeds a "
    "vibration so that the motion is unstable.",
    "Liouville residual": "Mismatch between the product of all multipliers and its exact value, which the "
    "damping alone decides: a check of the computation.",
    "S-G M, P, C": "Difference of two histories in magnitude and phase, and both combined, after Sprague and "
    "Geers; 0 where they agree.",
    "lumped model": "Six coordinates, linear, with stiffness and friction that change over the mesh cycle.",
    "multibody model": "The same gears as rigid bodies; “exact” follows their actual motion, “linear” holds "
    "the equations of the lumped model.",
}


def write(_: Results) -> Content:
    """Write the chapter."""
    words = list(_WORDS.items())
    columns = {"word": ("word", lambda one: one[0]), "meaning": ("meaning", lambda one: one[1])}
    return Content((table_of("glossary", "Words of this report.", words, columns),))


CHAPTER = Chapter("glossary", "Glossary", write)
