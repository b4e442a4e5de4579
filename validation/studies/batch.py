"""Work of one worker: a batch of cases to records. A case can fail, the batch cannot."""

from __future__ import annotations

import platform
import threading
from dataclasses import dataclass
from functools import cache
from importlib import metadata

from validation.studies.analyses import Evaluator
from validation.studies.case_process import Cases, evaluate_within
from validation.studies.evaluate import evaluate
from validation.studies.record import Record

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


def evaluate_batch(evaluator: Evaluator, cases: Cases, limit: float | None = None) -> Batch:
    """Evaluate cases one after the other; whatever a case raises becomes its record.

    Parameters
    ----------
    evaluator : what to do
    cases : number and values of the axes of each
    limit : longest time of a case [s]
    """
    if limit is not None:
        return Batch(evaluate_within(evaluator, cases, limit), versions())
    with _ONE_AT_A_TIME:
        records = tuple(evaluate(evaluator, case, values) for case, values in cases)
    return Batch(records, versions())
