"""Evaluation of cases in chunks: in this process, in worker processes, or on any executor."""

from __future__ import annotations

import math
import multiprocessing
import os
import struct
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from itertools import islice
from multiprocessing import forkserver
from typing import Any

import pebble

from lumped.errors import LawRangeWarning, ParameterError, SpurcheckError, refuse
from validation.studies.cases import StudyEvaluator
from validation.studies.store import Chunk, Status, provenance

#: Aim of the time of a chunk [s]: what a killed run loses of each worker.
CHUNK_SECONDS = 0.5
MAX_CHUNK = 10_000
#: Longest error text kept with a case, in characters.
MAX_MESSAGE = 2000
_START_SECONDS = 60.0
_ENVIRONMENT = {"PYTHONSAFEPATH": "1"} | dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
# Warning filters belong to the process, so the threads of one process take turns.
_ONE_AT_A_TIME = threading.Lock()
Submit = Callable[..., Future[Chunk]]


class SweepStopped(SpurcheckError):
    """The workers cannot go on. All computed cases are stored, and the text says how to continue."""


def evaluate_chunk(
    evaluator: StudyEvaluator, cases: Sequence[int], values: Sequence[tuple[Any, ...]]
) -> Chunk:
    """Evaluate cases one after the other. An exception in a case becomes the outcome of the case."""
    start = time.perf_counter()
    rows: list[tuple[int, int, bytes | None, str | None]] = []
    pack = struct.Struct(f"<{len(evaluator.outputs)}d").pack
    with _ONE_AT_A_TIME, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for case, value in zip(cases, values, strict=True):
            caught.clear()
            status, outputs, text = _evaluate(evaluator, value)
            if status.failed:
                rows.append((case, status, None, text[:MAX_MESSAGE].encode("utf-8", "replace").decode()))
                continue
            if any(issubclass(w.category, LawRangeWarning) for w in caught):
                status = Status.OUTSIDE_LAW_RANGE
            rows.append((case, status, pack(*outputs), None))
    return Chunk(rows, time.perf_counter() - start, provenance())


def _evaluate(evaluator: StudyEvaluator, values: tuple[Any, ...]) -> tuple[Status, tuple[float, ...], str]:
    try:
        outputs = evaluator(values)
    except ParameterError as error:
        return Status.REFUSED, (), str(error)
    except SpurcheckError as error:
        return Status.NUMERICAL, (), f"{type(error).__name__}: {error}"
    except Exception as error:  # noqa: BLE001  (a defect in one case must not end the other cases)
        return Status.UNEXPECTED, (), f"{type(error).__name__}: {error}"
    bad = [name for name, x in zip(evaluator.outputs, outputs, strict=True) if not math.isfinite(x)]
    if bad:
        return Status.NUMERICAL, (), "not finite: " + ", ".join(bad)
    return Status.OK, outputs, ""


@contextmanager
def workers_of(workers: int, executor: Executor | None, limit: float | None) -> Iterator[tuple[Submit, int]]:
    """Give the function that submits a call, and the number of parallel calls."""
    if not 0 <= workers <= 1024:
        raise refuse("workers", workers, "0 to 1024", "Use as many as there are cores.")
    if limit is not None and executor is not None:
        action = "Leave it out, or compute with worker processes of this machine."
        raise refuse("case_seconds", limit, "none on an executor or a cluster", action)
    if executor is not None:
        yield executor.submit, max(workers, 1)
    elif workers or limit is not None:
        with _processes(max(workers, 1), limit) as submit:
            yield submit, max(workers, 1)
    else:
        yield _here, 1


def _here(function: Callable[..., Chunk], *arguments: Any) -> Future[Chunk]:
    future: Future[Chunk] = Future()
    future.set_result(function(*arguments))
    return future


@contextmanager
def _processes(workers: int, limit: float | None) -> Iterator[Submit]:
    """Worker processes of this machine. A process is ended when a chunk takes longer than ``limit`` [s]."""
    pool = pebble.ProcessPool(workers, context=_context())
    try:
        try:
            pool.schedule(os.getpid).result(_START_SECONDS)
        except Exception as error:
            raise SweepStopped(
                f"The worker processes do not start ({error!r}): check the memory of this machine; in a "
                "script, call run_sweep under `if __name__ == '__main__':`."
            ) from error
        yield lambda function, *arguments: pool.schedule(function, arguments, timeout=limit)
    finally:
        pool.stop()
        pool.join()


def _context() -> Any:
    """Start method of worker processes: forks of a clean process with all modules loaded and one thread.

    A fork of this process could copy a lock that a thread of numba or exudyn holds.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["validation.studies.analyses", "floquet.gear.multipliers", "multibody"])
    before = dict(os.environ)
    os.environ.update(_ENVIRONMENT)
    try:
        forkserver.ensure_running()
    finally:
        os.environ.clear()
        os.environ.update(before)
    return context


def chunks_of(
    evaluator: StudyEvaluator,
    values: Callable[[Sequence[int]], Sequence[tuple[Any, ...]]],
    numbers: Iterator[int],
    count: int,
    submit: Submit,
    slots: int,
    limit: float | None,
) -> Iterator[Chunk]:
    """Yield the outcomes of cases in the order of their completion, each case once.

    A chunk is divided into single cases if it takes longer than one case may take (``limit`` [s]), or if
    its worker dies. ``submit`` and ``slots`` come from ``workers_of``.
    """
    # seconds: mean time of a case, 0 where it is not known yet
    remaining = count
    seconds = 0.0
    singles: deque[int] = deque()
    running: dict[Future[Chunk], list[int]] = {}
    most_seconds = CHUNK_SECONDS if limit is None else min(CHUNK_SECONDS, limit / 4.0)
    while True:
        while len(running) < 2 * slots:
            size = min(int(most_seconds / seconds), remaining // (4 * slots), MAX_CHUNK) if seconds else 1
            cases = [singles.popleft()] if singles else list(islice(numbers, max(size, 1)))
            if not cases:
                break
            try:
                running[submit(evaluate_chunk, evaluator, cases, values(cases))] = cases
            except Exception as error:
                raise _stopped(error) from error
        if not running:
            return
        for future in wait(running, return_when=FIRST_COMPLETED).done:
            cases = running.pop(future)
            chunk = _outcome(future, cases, limit)
            if chunk is None:
                singles += cases
                continue
            remaining -= len(cases)
            mean = max(chunk.seconds / len(cases), 1e-6)
            seconds = 0.8 * seconds + 0.2 * mean if seconds else mean
            yield chunk


def _stopped(error: Exception) -> SweepStopped:
    return SweepStopped(
        f"The workers cannot run cases ({type(error).__name__}: {error}): check that they run and have this "
        "version of spurcheck, then run the same command with --resume."
    )


def _outcome(future: Future[Chunk], cases: list[int], limit: float | None) -> Chunk | None:
    """Outcomes of a finished chunk. None: the cases of the chunk run again one by one."""
    try:
        chunk = future.result()
    except Exception as error:
        late = isinstance(error, TimeoutError) and limit is not None
        # Dask's error is compared by its name, for Dask is optional.
        died = isinstance(error, pebble.ProcessExpired) or type(error).__name__ == "KilledWorker"
        if not late and not died:
            raise _stopped(error) from error
        if len(cases) > 1:
            return None
        status = Status.TIME_LIMIT if late else Status.WORKER_DIED
        text = f"longer than {limit:g} s" if late else "the worker process died on this case"
        return Chunk([(cases[0], status, None, text)], 0.0, provenance())
    theirs = chunk.provenance
    ours = provenance()
    if theirs[:2] != ours[:2]:
        raise SweepStopped(
            f"A worker runs {theirs.versions}, code {theirs.code[:12]}, but this process {ours.versions}"
            f", code {ours.code[:12]}: install the same code and the same versions, or results depend on "
            "where a case ran."
        )
    return chunk
