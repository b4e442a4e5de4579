"""A measured record beside the prediction: every channel in per cent, orders and phase, explanations."""

from __future__ import annotations

from validation.reporting.blocks import Content
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content | None:
    """Write the chapter. None: there is no record."""
    comparison = results.measured_error
    if comparison is None:
        return None
    from validation.reporting.record_content import record_content

    return record_content(comparison, results.record_explanations)


CHAPTER = Chapter("record", "The record", write, seconds=3.0)
