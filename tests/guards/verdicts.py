"""Rows of the verdict on page 1 of the report: where it says another thing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any
from unittest import mock

from validation.reporting import verdict
from validation.reporting.hazards import Hazard
from validation.reporting.verdict import Verdict

_WHERE = "validation/reporting/verdict.py"
_RPM = 2100.0


@dataclass(frozen=True)
class Turn:
    """A row of a verdict: the value at which it turns, and the verdicts just inside and just outside.

    Attributes
    ----------
    names : what is judged
    limit : its last value inside
    verdict : of results made so that the quantity is this one
    inside, outside : expected verdicts
    source : where the limit comes from
    out : +1 where values above the limit are outside, -1 where those below are
    """

    names: str
    limit: float
    verdict: Callable[[float], Verdict]
    inside: Verdict
    outside: Verdict
    source: str
    out: float = 1.0
    where: str = _WHERE

    @property
    def title(self) -> str:
        """Name of the row in the list of tests."""
        return self.names.replace(" ", "_")

    def complaints(self) -> list[str]:
        """Sides of the limit on which it says another thing."""
        near = 1e-9 * self.limit * self.out
        tried = {self.limit - near: self.inside, self.limit + near: self.outside}
        found = {value: self.verdict(value) for value in tried}
        return [f"{v!r}: {found[v]}, not {wanted}" for v, wanted in tried.items() if found[v] is not wanted]


def _of(*, half: float = 0.01, **changed: Any) -> Verdict:
    """The verdict on a calm, stable motion with known inputs, but for what is changed.

    ``half``: the further end of the range of the transmission error, relative to it.
    """
    calm = {
        "outside": (), "nearest_hazard": None, "operating_rpm": _RPM, "contact_lost": False,
        "teeth_apart": 0, "inputs": (9, 0), "varies": True, "measured_error": None,
        "prediction": SimpleNamespace(contact_lost=False, stable=True, roams=False, reason=""),
        "spread": lambda name: (-0.6 * half, half) if name == "dte_peak_to_peak" else (-half, 0.5 * half),
        "resonance": None, "on_springs": "", "other_motions": (), "searched": (200.0, 4000.0),
        "jump_search": SimpleNamespace(jumps=(), attractors=()),
    }  # fmt: skip
    results: Any = SimpleNamespace(**calm | changed)
    one: Any = SimpleNamespace(claim="a claim", value=0.0, scope=SimpleNamespace(speeds="over speeds"))
    named = ("contact", "stable", "unstable_speeds", "jumps", "resonance", "levels", "inputs")
    with mock.patch.object(verdict, "failed_checks", return_value=()):
        return verdict.verdict_of(results, dict.fromkeys(named, one)).verdict


def _jump(apart: float) -> Hazard:
    return Hazard(_RPM * (1.0 + apart), "jump", "running up")


TURNS = (
    Turn("range of the inputs", 0.10, lambda half: _of(half=half), Verdict.ABSOLUTE, Verdict.UNCERTAIN,
         "chosen: 1 dB is 12 %"),
    Turn("a jump above the speed", 0.05, lambda apart: _of(nearest_hazard=_jump(apart)),
         Verdict.DO_NOT_RUN, Verdict.ABSOLUTE, "chosen: drives hold their speed to 5 %"),
    Turn("a jump below the speed", 0.05, lambda apart: _of(nearest_hazard=_jump(-apart)),
         Verdict.DO_NOT_RUN, Verdict.ABSOLUTE, "the same"),
)  # fmt: skip
