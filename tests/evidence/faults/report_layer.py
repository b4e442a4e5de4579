"""Which check sees a fault in the text, tables and figures of the report; see docs/verification/faults.md.

The checks are the tests of ``tests/validation/reporting`` that need nothing but a written report. Two unequal
pairs are reported with the fault, from results that are known already.
"""

from __future__ import annotations

import atexit
import contextlib
import copy
import importlib
import inspect
import json
import shutil
import tempfile
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path

import pytest

from lumped.errors import LawRangeWarning
from tests.evidence.faults.fault import REPORT_FAULTS, Fault
from tests.evidence.faults.rewriting import applied
from tests.validation.reporting.written import PAIRS, Written, known, write_report

_MODULES = (
    "test_numbers", "test_numbers_of_trust", "test_tables", "test_words", "test_curves", "test_figures",
    "test_report",
)  # fmt: skip
#: Results that follow from others at once.
_QUICK = ("budget", "unstable_speeds", "same_equations", "outside")


@cache
def checks() -> dict[str, Callable[[Written], None]]:
    """Name -> check of a written report."""
    failures = {}
    for module in _MODULES:
        for name, value in vars(importlib.import_module(f"tests.validation.reporting.{module}")).items():
            if name.startswith("test_") and list(inspect.signature(value).parameters) == ["written"]:
                failures[name] = value
    return failures


def seen_by(fault: Fault | None, pairs: Iterable[str] = PAIRS) -> tuple[str, ...]:
    """Return the failing checks of the first report in which a check fails.

    Without a fault no check may fail.
    """
    for name in pairs:
        sound(name)
        with contextlib.nullcontext() if fault is None else applied(fault):
            if failing := tuple(_failing(name, fault)):
                return failing
    return ()


def report_faults(keys: Sequence[str], output: Path | None) -> int:
    """Judge faults; print and store the checks that see each fault. Returns 1 if a fault is missed.

    Rows of other faults in ``output`` are unchanged.
    """
    rows: dict[str, list[str]] = {}
    if output is not None and output.exists():
        rows = json.loads(output.read_text(encoding="utf-8"))
    for key in keys or REPORT_FAULTS:
        rows[key] = list(seen_by(REPORT_FAULTS[key]))
        print(f"{key:24} {', '.join(rows[key]) or 'missed'}", flush=True)
        if output is not None:
            ordered = {one: rows[one] for one in REPORT_FAULTS if one in rows}
            output.write_text(json.dumps(ordered, indent=1) + "\n", encoding="utf-8")
    return int(not all(rows.values()))


@cache
def sound(name: str) -> Written:
    """The report of a pair without a fault; it computes all results once."""
    folder = Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    with _quiet():
        return write_report(name, folder / "report", drawn=False, results=known(name))


def _failing(name: str, fault: Fault | None) -> Iterator[str]:
    results = copy.copy(known(name))
    same = sound(name)
    if fault is not None and ":Results." in fault.target:
        same = None
        for one in (*_QUICK, fault.target.partition(":Results.")[2]):
            vars(results).pop(one, None)
    folder = Path(tempfile.mkdtemp())
    try:
        with _quiet():
            try:
                written = write_report(name, folder / "report", drawn=False, results=results, same=same)
            except Exception as error:  # noqa: BLE001  (whatever stops a program with a fault is seen)
                yield f"{type(error).__name__}: {str(error).splitlines()[0][:80] if str(error) else ''}"
                return
            for check, judge in checks().items():
                try:
                    judge(written)
                except pytest.skip.Exception:
                    continue
                except Exception:  # noqa: BLE001  (as above)
                    yield check
    finally:
        shutil.rmtree(folder)


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    with warnings.catch_warnings():
        for kind in (LawRangeWarning, RuntimeWarning):
            warnings.simplefilter("ignore", kind)
        yield
