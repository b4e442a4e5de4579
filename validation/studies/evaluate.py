"""What a worker does: a batch of cases to their outcomes. A case can fail, the batch cannot."""

from __future__ import annotations

import faulthandler
import math
import os
import threading
import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Protocol

import numpy as np

from lumped.errors import LawRangeWarning, ParameterError, SpurcheckError
from lumped.typing import FloatArray
from validation.studies.provenance import Provenance, provenance

#: Longest error text kept with a case, in characters.
MAX_MESSAGE = 2000
#: A worker ends itself when a case with a time limit takes this much longer: nobody else ended it [s].
_ORPHAN_SECONDS = 5.0
# Warning filters belong to the process, so the threads of one process take turns.
_ONE_AT_A_TIME = threading.Lock()


class Status(IntEnum):
    """What became of a case; no code, kept in stores and results, ever gets another meaning."""

    MISSING = -1
    OK = 0
    OUTSIDE_LAW_RANGE = 1
    REFUSED = 2
    NUMERICAL = 3
    UNEXPECTED = 4
    WORKER_DIED = 5
    TIME_LIMIT = 6

    @property
    def failed(self) -> bool:
        """Whether there are no outputs."""
        return self >= Status.REFUSED


MEANINGS = {
    Status.MISSING: "not computed yet",
    Status.OK: "computed",
    Status.OUTSIDE_LAW_RANGE: "computed, a friction or film law outside the range it was fitted in",
    Status.REFUSED: "the combination of parameters was refused",
    Status.NUMERICAL: "the analysis did not reach its accuracy",
    Status.UNEXPECTED: "an unexpected error",
    Status.WORKER_DIED: "the worker process died on this case",
    Status.TIME_LIMIT: "the time limit of a case was exceeded",
}


class Evaluator(Protocol):
    """What computes one case: its values to its outputs.

    It travels with every batch, so it is small and can be pickled. ``nan_allowed`` says whether NaN is a
    result; else a number that is not finite is a failure.
    """

    @property
    def outputs(self) -> tuple[str, ...]: ...

    @property
    def nan_allowed(self) -> bool: ...

    def prepare(self) -> None:
        """Load what is needed, so that the first case takes no longer than the others."""
        ...

    def __call__(self, values: tuple[Any, ...]) -> tuple[float, ...]: ...


@dataclass(frozen=True)
class Batch:
    """Outcomes of cases.

    Attributes
    ----------
    cases : their numbers, rising
    status : (cases,) ``Status`` codes
    values : (cases, outputs), NaN where a case failed
    messages : case -> error text of the failed ones
    seconds : time that it took
    provenance : of the process that computed them
    """

    cases: Sequence[int]
    status: np.ndarray[Any, np.dtype[np.int8]]
    values: FloatArray
    messages: dict[int, str]
    seconds: float
    provenance: Provenance

    @staticmethod
    def failure(case: int, outputs: int, status: Status, message: str) -> Batch:
        """Return the outcome of one case that its worker could not tell itself."""
        nothing = np.full((1, outputs), np.nan)
        return Batch([case], np.array([status], np.int8), nothing, {case: message}, 0.0, provenance())


def evaluate_batch(
    evaluator: Evaluator, cases: Sequence[int], values: Sequence[tuple[Any, ...]], limit: float | None = None
) -> Batch:
    """Evaluate cases one after the other; whatever a case raises becomes its outcome.

    Parameters
    ----------
    evaluator : what to do
    cases : numbers of the cases
    values : parameters of each case
    limit : longest time of a case [s]

    Raises
    ------
    ImportError : the analysis cannot be loaded here
    """
    evaluator.prepare()
    status = np.empty(len(cases), np.int8)
    found = np.full((len(cases), len(evaluator.outputs)), np.nan)
    messages: dict[int, str] = {}
    began = time.perf_counter()
    with _ONE_AT_A_TIME, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for row, (case, value) in enumerate(zip(cases, values, strict=True)):
            caught.clear()
            start = time.perf_counter()
            status[row], outputs, text = _evaluate(evaluator, value)
            if limit is not None and time.perf_counter() - start > limit:
                status[row], outputs, text = late(limit)
            if status[row] >= Status.REFUSED:
                messages[case] = text[:MAX_MESSAGE].encode("utf-8", "replace").decode()
            else:
                found[row] = outputs
                if any(issubclass(w.category, LawRangeWarning) for w in caught):
                    status[row] = Status.OUTSIDE_LAW_RANGE
    return Batch(cases, status, found, messages, time.perf_counter() - began, provenance())


def evaluate_guarded(
    evaluator: Evaluator, cases: Sequence[int], values: Sequence[tuple[Any, ...]], limit: float | None
) -> Batch:
    """Evaluate a batch in a worker process of its own; without anybody who ends it, it ends itself.

    A case with a time limit may never let go of the interpreter, so that the thread which watches the parent
    process does not run. The watchdog of ``faulthandler`` needs no interpreter.
    """
    if limit is None:
        return evaluate_batch(evaluator, cases, values)
    with open(os.devnull, "w") as nowhere:
        faulthandler.dump_traceback_later(min(limit + _ORPHAN_SECONDS, 4e6), exit=True, file=nowhere)
        try:
            return evaluate_batch(evaluator, cases, values, limit)
        finally:
            faulthandler.cancel_dump_traceback_later()


def late(limit: float) -> tuple[Status, tuple[float, ...], str]:
    """Outcome of a case that took too long."""
    return Status.TIME_LIMIT, (), f"longer than {limit:g} s"


def _evaluate(evaluator: Evaluator, values: tuple[Any, ...]) -> tuple[Status, tuple[float, ...], str]:
    try:
        outputs = evaluator(values)
    except ParameterError as error:
        return Status.REFUSED, (), str(error)
    except SpurcheckError as error:
        return Status.NUMERICAL, (), f"{type(error).__name__}: {error}"
    except Exception as error:  # noqa: BLE001  (a defect in one case must not end the other cases)
        return Status.UNEXPECTED, (), f"{type(error).__name__}: {error}"
    if not evaluator.nan_allowed:
        bad = [name for name, x in zip(evaluator.outputs, outputs, strict=True) if not math.isfinite(x)]
        if bad:
            return Status.NUMERICAL, (), "not finite: " + ", ".join(bad)
    return Status.OK, outputs, ""
