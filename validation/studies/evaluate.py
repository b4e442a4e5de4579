"""Work of one worker: a batch of cases to records. A case can fail, the batch cannot."""

from __future__ import annotations

import math
import platform
import threading
import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import metadata

from lumped.errors import LawRangeWarning, ParameterError, SpurcheckError
from validation.studies.analyses import Evaluator
from validation.studies.axes import AxisValue
from validation.studies.record import MAX_MESSAGE, Record, Status

# Warning filters belong to the process, so the threads of one process take turns.
_ONE_AT_A_TIME = threading.Lock()


@dataclass(frozen=True)
class Batch:
    """Records of a batch.

    Attributes
    ----------
    records : one a case
    versions : versions that computed them
    """

    records: tuple[Record, ...]
    versions: str


@cache
def versions() -> str:
    """Versions that decide the last bit of a result."""
    names = ("spurcheck", "numpy", "scipy", "numba", "exudyn")
    parts = [f"{name} {metadata.version(name)}" for name in names]
    return ", ".join([f"python {platform.python_version()}", *parts, platform.machine()])


def evaluate_batch(
    evaluator: Evaluator, cases: Sequence[tuple[int, tuple[AxisValue, ...]]], limit: float | None = None
) -> Batch:
    """Evaluate cases one after the other; whatever a case raises becomes its record.

    Parameters
    ----------
    evaluator : what to do
    cases : number and values of the axes of each
    limit : longest time of a case [s]
    """
    if limit is not None:
        from validation.studies.case_process import evaluate_within

        return Batch(evaluate_within(evaluator, cases, limit), versions())
    with _ONE_AT_A_TIME:
        records = tuple(evaluate(evaluator, case, values) for case, values in cases)
    return Batch(records, versions())


def evaluate(evaluator: Evaluator, case: int, values: tuple[AxisValue, ...]) -> Record:
    """Evaluate one case; whatever it raises becomes its record."""
    start = time.perf_counter()

    def record(status: Status, outputs: tuple[float, ...] = (), message: str = "") -> Record:
        return Record(case, status, time.perf_counter() - start, outputs, message[:MAX_MESSAGE])

    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            outputs = evaluator(values)
    except ParameterError as error:
        return record(Status.REFUSED, message=str(error))
    except SpurcheckError as error:
        return record(Status.NUMERICAL, message=f"{type(error).__name__}: {error}")
    except Exception as error:  # noqa: BLE001  (a defect in one case must not end the other cases)
        return record(Status.UNEXPECTED, message=f"{type(error).__name__}: {error}")
    bad = [name for name, x in zip(evaluator.outputs, outputs, strict=True) if not math.isfinite(x)]
    if bad:
        return record(Status.NUMERICAL, message="not finite: " + ", ".join(bad))
    outside = [str(w.message) for w in caught if issubclass(w.category, LawRangeWarning)]
    if outside:
        return record(Status.OUTSIDE_LAW_RANGE, outputs, outside[0])
    return record(Status.OK, outputs)
