"""Validity flags of the lumped model."""

from __future__ import annotations

from validation.reporting.blocks import Answer, Badge, Content, Quantity, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.reporting.words import contact_off
from validation.reporting.words import validity as words
from validation.validity.flags import worst_state

_WORDS = {
    "ok": "the model's assumptions hold",
    "warning": "the model is near a limit of its validity",
    "violated": "an assumption of the model is violated",
}


def write(results: Results) -> Content:
    """Write the chapter."""
    flags = results.flags
    state = worst_state(flags)
    table = table_of(
        "flags",
        "Assumptions of the lumped model, checked on the periodic motion (drift of the mean speed: on the "
        "linear multibody run).",
        flags,
        {
            "key": ("check", lambda f: f.name),
            "state": ("state", lambda f: Badge(f.state)),
            "value": ("value", lambda f: None if f.value is None else Quantity(f.value, f.unit)),
            "detail": ("where and how much", lambda f: f.detail),
            "meaning": ("what it means", lambda f: f.meaning),
            "action": ("what to do", lambda f: f.action or None),
        },
    )
    return Content((Text(f"At the operating point {_WORDS[state]}."), table), Badge(state))


def answer(results: Results) -> Answer:
    """Whether the assumptions of the lumped model hold."""
    state = worst_state(results.flags)
    if state == "ok" and contact_off(results):
        state = "warning"
    return Answer("Is the model valid here?", Badge(state), words(results))


CHAPTER = Chapter("validity", "Validity", write, answer, ("flags",))
