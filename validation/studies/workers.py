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
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from multiprocessing import forkserver
from typing import Any

import pebble

from lumped.errors import LawRangeWarning, ParameterError, SpurcheckError, refuse
from validation.studies.analyses import LinearMotion
from validation.studies.cases import StudyEvaluator
from validation.studies.cluster import MOST_WORKERS, ONE_THREAD, Cluster, ClusterStopped, other_versions
from validation.studies.store import Chunk, Status, provenance

#: Aim of the time of a chunk [s]: what a killed run loses of each worker.
CHUNK_SECONDS = 0.5
MAX_CHUNK = 10_000
#: Longest error text kept with a case, in characters.
MAX_MESSAGE = 2000
_START_SECONDS = 60.0
#: Time after which a sweep looks for workers that joined, also where no case ends [s].
_LOOK_SECONDS = 1.0
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
            if any(issubclass(w.category, LinearMotion) for w in caught):
                status = Status.LINEAR_MOTION
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


@dataclass(frozen=True)
class Pool:
    """What runs the chunks of a sweep.

    Attributes
    ----------
    submit : starts a call and returns its future
    slots : returns how many calls run at the same time at present; workers may join and leave
    """

    submit: Submit
    slots: Callable[[], int]


@contextmanager
def workers_of(workers: int, executor: Executor | None, limit: float | None) -> Iterator[Pool]:
    """Give the pool that runs the chunks: an executor, worker processes, or this process."""
    if not 0 <= workers <= MOST_WORKERS:
        raise refuse("workers", workers, f"0 to {MOST_WORKERS}", "Use as many as there are cores.")
    if limit is not None and executor is not None:
        action = "Leave it out, or compute with worker processes of this machine."
        raise refuse("case_seconds", limit, "none on an executor or a cluster", action)
    if isinstance(executor, Cluster):
        if workers:
            action = "Leave it out: all workers of the cluster are used, also those that join later."
            raise refuse("workers", workers, "none with a cluster of open_cluster", action)
        yield Pool(executor.submit, lambda: executor.workers)
    elif executor is not None:
        if not workers:
            action = "Give how many calls the executor runs at the same time; open_cluster knows it itself."
            raise refuse("workers", workers, f"1 to {MOST_WORKERS} with an executor", action)
        yield Pool(executor.submit, lambda: workers)
    elif workers or limit is not None:
        number = max(workers, 1)
        with _processes(number, limit) as submit:
            yield Pool(submit, lambda: number)
    else:
        yield Pool(_here, lambda: 1)


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
    os.environ.update(ONE_THREAD)
    try:
        forkserver.ensure_running()
    finally:
        os.environ.clear()
        os.environ.update(before)
    return context


@dataclass(frozen=True)
class Batch:
    """Cases that one call computes.

    Attributes
    ----------
    cases : numbers of the cases
    alone : whether no other call runs meanwhile
    """

    cases: list[int]
    alone: bool = False


class Cases:
    """The cases that are still to be computed, in batches.

    A batch whose worker died is divided into single cases. A worker of Dask has several calls, and where the
    worker dies Dask blames all of them. A single case with a dead worker therefore runs again alone.

    Parameters
    ----------
    numbers : numbers of the cases
    count : how many they are
    most_seconds : aim of the time of a batch [s]
    """

    def __init__(self, numbers: Iterator[int], count: int, most_seconds: float) -> None:
        self._numbers = numbers
        self._remaining = count
        self._most_seconds = most_seconds
        self._singles: deque[int] = deque()
        self._suspects: deque[int] = deque()
        self._seconds = 0.0  # mean time of a case; 0: no case is computed yet

    def batches(self, running: Collection[Batch], slots: int) -> Iterator[Batch]:
        """Yield batches that can run beside the running batches, until each slot has two."""
        if any(batch.alone for batch in running):
            return
        if self._suspects:
            if not running:
                yield Batch([self._suspects.popleft()], alone=True)
            return
        for _ in range(2 * slots - len(running)):
            if self._singles:
                yield Batch([self._singles.popleft()])
            elif cases := list(islice(self._numbers, self._size(slots))):
                yield Batch(cases)
            else:
                return

    def _size(self, slots: int) -> int:
        """Number of cases in a batch."""
        if not self._seconds:
            return 1
        return max(min(int(self._most_seconds / self._seconds), self._remaining // (4 * slots), MAX_CHUNK), 1)

    def again(self, batch: Batch) -> None:
        """Compute the cases of a batch again, one by one, or a single case alone."""
        (self._suspects if len(batch.cases) == 1 else self._singles).extend(batch.cases)

    def computed(self, chunk: Chunk) -> None:
        """Count the cases of a chunk and learn the time of a case."""
        self._remaining -= len(chunk.rows)
        mean = max(chunk.seconds / len(chunk.rows), 1e-6)
        self._seconds = 0.8 * self._seconds + 0.2 * mean if self._seconds else mean


def chunks_of(
    evaluator: StudyEvaluator,
    values: Callable[[Sequence[int]], Sequence[tuple[Any, ...]]],
    numbers: Iterator[int],
    count: int,
    pool: Pool,
    limit: float | None,
) -> Iterator[Chunk]:
    """Yield the outcomes of cases in the order of their completion, each case once.

    A chunk is divided if it takes longer than one case may take (``limit`` [s]), or if its worker dies; see
    ``Cases``. ``pool`` comes from ``workers_of``.
    """
    queue = Cases(numbers, count, CHUNK_SECONDS if limit is None else min(CHUNK_SECONDS, limit / 4.0))
    running: dict[Future[Chunk], Batch] = {}
    while True:
        for batch in queue.batches(list(running.values()), max(pool.slots(), 1)):
            try:
                running[pool.submit(evaluate_chunk, evaluator, batch.cases, values(batch.cases))] = batch
            except Exception as error:
                raise _stopped(error) from error
        if not running:
            return
        for future in wait(running, timeout=_LOOK_SECONDS, return_when=FIRST_COMPLETED).done:
            batch = running.pop(future)
            chunk = _outcome(future, batch, limit)
            if chunk is None:
                queue.again(batch)
            else:
                queue.computed(chunk)
                yield chunk


def _stopped(error: Exception) -> SweepStopped:
    if isinstance(error, ClusterStopped):
        return SweepStopped(f"{error} What is computed is stored: go on with --resume.")
    return SweepStopped(
        f"The workers cannot run cases ({type(error).__name__}: {error}): check that they run and have this "
        "version of spurcheck, then run the same command with --resume."
    )


def _outcome(future: Future[Chunk], batch: Batch, limit: float | None) -> Chunk | None:
    """Outcomes of a finished chunk. None: the cases of the batch run again, in smaller batches."""
    try:
        chunk = future.result()
    except Exception as error:
        late = isinstance(error, TimeoutError) and limit is not None
        # Dask's error is compared by its name, for Dask is optional.
        of_dask = type(error).__name__ == "KilledWorker"
        if not late and not of_dask and not isinstance(error, pebble.ProcessExpired):
            raise _stopped(error) from error
        if len(batch.cases) > 1 or (of_dask and not batch.alone):
            return None
        status = Status.TIME_LIMIT if late else Status.WORKER_DIED
        text = f"longer than {limit:g} s" if late else "the worker process died on this case"
        return Chunk([(batch.cases[0], status, None, text)], 0.0, provenance())
    if (difference := other_versions("A worker", chunk.provenance, provenance())) is not None:
        raise SweepStopped(difference)
    return chunk
