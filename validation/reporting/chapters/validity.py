"""Validity flags of the lumped model."""

from __future__ import annotations

from validation.reporting.blocks import Badge, Chapter, Quantity, Table, Text
from validation.reporting.results import Results
from validation.validity.flag import worst_state

_WORDS = {
    "ok": "the model's assumptions hold",
    "warning": "the model is near a limit of its validity",
    "violated": "an assumption of the model is violated",
}


def validity(results: Results) -> Chapter:
    """Write the chapter."""
    flags = results.flags
    state = worst_state(flags)
    table = Table(
        "flags",
        "Assumptions of the lumped model, checked on the periodic motion (drift of the mean speed: on the "
        "linear multibody run).",
        {
            "key": "check",
            "state": "state",
            "value": "value",
            "detail": "where and how much",
            "meaning": "what it means",
            "action": "what to do",
        },
        tuple(
            (
                flag.name,
                Badge(flag.state),
                None if flag.value is None else Quantity(flag.value, flag.unit),
                flag.detail,
                flag.meaning,
                flag.action or None,
            )
            for flag in flags
        ),
    )
    return Chapter(
        "validity", "Validity", (Text(f"At the operating point {_WORDS[state]}."), table), Badge(state)
    )
