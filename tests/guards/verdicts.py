"""Rows of the verdict on page 1 of the report: where it says another thing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any
from unittest import mock

import numpy as np
import xarray as xr

from validation.reporting import page_one
from validation.reporting.page_one import Verdict

_WHERE = "validation/reporting/page_one.py"
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


def _of(**changed: Any) -> Verdict:
    """The verdict on a calm, stable motion with known inputs, but for what is changed."""
    calm = {
        "outside": (), "nearest_hazard": None, "operating_rpm": _RPM, "contact_lost": False,
        "teeth_apart": 0, "speeds": (200.0, 4000.0), "inputs": (9, 0, "assumed"), "measured_error": None,
        "prediction": SimpleNamespace(contact_lost=False, stable=True, reason=""),
        "uncertainty": _spread(0.01), "branches": None, "other_motions": (), "teeth": None,
        "teeth_band": None,
    }  # fmt: skip
    results: Any = SimpleNamespace(**calm | changed)
    with mock.patch.object(page_one, "failed_checks", return_value=()):
        return page_one._verdict(results)[0]


def _spread(half: float) -> xr.Dataset:
    """Percentiles of the transmission error whose half range over the median is this one."""
    ends = np.array([3.0 - 3.0 * 1.2 * half, 3.0, 3.0 + 3.0 * 0.8 * half])  # unlike on both sides
    return xr.Dataset({"dte_peak_to_peak_percentile": ("percentile", ends)})


def _record(error: float) -> SimpleNamespace:
    """A record whose difference from the prediction, over the record, is this one, with its sign."""
    return SimpleNamespace(explained=False, error=error * 4e-6, measured=4e-6)


TURNS = (
    Turn("half range of the inputs", 0.10, lambda half: _of(uncertainty=_spread(half)), Verdict.ABSOLUTE,
         Verdict.COMPARE, "chosen: 1 dB is 12 %"),
    Turn("a record above the prediction", 0.10, lambda error: _of(measured_error=_record(error)),
         Verdict.ABSOLUTE, Verdict.COMPARE, "the same"),
    Turn("a record below the prediction", 0.10, lambda error: _of(measured_error=_record(-error)),
         Verdict.ABSOLUTE, Verdict.COMPARE, "the same"),
    Turn("a jump above the speed", 0.05, lambda apart: _of(nearest_hazard=(_RPM * (1.0 + apart), "jump up")),
         Verdict.DO_NOT_RUN, Verdict.ABSOLUTE, "chosen: drives hold their speed to 5 %"),
    Turn("a jump below the speed", 0.05, lambda apart: _of(nearest_hazard=(_RPM * (1.0 - apart), "jump up")),
         Verdict.DO_NOT_RUN, Verdict.ABSOLUTE, "the same"),
)  # fmt: skip
