"""One thing that the cross-check judges, and the verdict on all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

Verdict = Literal["confirmed", "explained", "not confirmed"]

#: Verdict -> what it means.
MEANINGS: Mapping[str, str] = {
    "confirmed": "every difference between the models is within its own limit",
    "explained": "a difference is above its own limit, finite motions account for it, and what they leave is "
    "within its limit",
    "not confirmed": "the multibody model or a law of nature does not support the lumped prediction",
}


@dataclass(frozen=True)
class Judgement:
    """A value against its limit.

    Attributes
    ----------
    check : what is judged, as "linear: dte", "remainder: y_p", "nature: efficiency, lumped", "twin: ..."
    value : what was found
    limit : largest value that passes
    reason : why this limit
    """

    check: str
    value: float
    limit: float
    reason: str

    @property
    def within(self) -> bool:
        """Whether it passes; a value that is not a number does not."""
        return self.value <= self.limit


def verdict_of(decisive: Sequence[Judgement], raw: Sequence[Judgement]) -> Verdict:
    """Verdict from single judgements.

    Parameters
    ----------
    decisive : each of them must pass
    raw : differences before finite motions are taken off; beyond its limit one is explained, not confirmed
    """
    if not all(j.within for j in decisive):
        return "not confirmed"
    return "confirmed" if all(j.within for j in raw) else "explained"
