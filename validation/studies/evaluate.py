"""Work of one worker: a batch of cases to records. A case can fail, the batch cannot."""

from __future__ import annotations

import contextlib
import math
import platform
import signal
import threading
import time
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from types import FrameType

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


class _TimeLimit(BaseException):
    """Raised inside a case that takes too long; not an Exception, so that no analysis swallows it."""


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
    limit : longest time of a case [s]; acts on the main thread of a process on systems with interval timers
    """
    with _ONE_AT_A_TIME:
        records = tuple(evaluate(evaluator, case, values, limit) for case, values in cases)
    return Batch(records, versions())


def evaluate(
    evaluator: Evaluator, case: int, values: tuple[AxisValue, ...], limit: float | None = None
) -> Record:
    """Evaluate one case; see ``evaluate_batch``."""
    start = time.perf_counter()

    def record(status: Status, outputs: tuple[float, ...] = (), message: str = "") -> Record:
        return Record(case, status, time.perf_counter() - start, outputs, message[:MAX_MESSAGE])

    try:
        with warnings.catch_warnings(record=True) as caught, _time_limit(limit):
            warnings.simplefilter("always")
            outputs = evaluator(values)
    except _TimeLimit:
        return record(Status.TIME_LIMIT, message=f"longer than {limit:g} s")
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


@contextlib.contextmanager
def _time_limit(seconds: float | None) -> Iterator[None]:
    """Raise ``_TimeLimit`` in the block after some time, where the system and the thread allow it."""
    main = threading.current_thread() is threading.main_thread()
    if seconds is None or not main or not hasattr(signal, "setitimer"):
        yield
        return

    def expired(number: int, frame: FrameType | None) -> None:
        raise _TimeLimit

    before = signal.signal(signal.SIGALRM, expired)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
