"""Hand cases to a pool, a few at a time, and survive the death of workers."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from concurrent.futures.process import BrokenProcessPool
from itertools import islice
from typing import Any

import pebble

from validation.studies.evaluate import Batch, Evaluator, Status, late
from validation.studies.pools import Pool, SweepStopped
from validation.studies.provenance import provenance

#: Aim of the time of a batch [s]; a killed run loses at most two batches under way a worker.
BATCH_SECONDS = 0.5
#: Batches a second that a scheduler is asked for at most: with many workers the batches last longer.
BATCHES_PER_SECOND = 500.0
MAX_BATCH = 10_000
_CHECK_SECONDS = 1.0
#: How often all workers may die, before any batch ends, until the sweep stops.
_MAX_BROKEN = 3
Values = Callable[[Sequence[int]], Sequence[tuple[Any, ...]]]


class Dispatcher:
    """Evaluates cases on a pool.

    A batch on which a worker died, or which took longer than a case may, is divided into single cases. A
    single case on which a worker died runs once more at the end, with nothing else in the pool: only then it
    is certain that no other case, queued at the same worker of a cluster, is to blame.

    Parameters
    ----------
    pool : where
    evaluator : what to do
    values : parameters of the cases of given numbers
    limit : longest time of a case [s]
    tell : called with what the user should know of the workers
    """

    def __init__(
        self,
        pool: Pool,
        evaluator: Evaluator,
        values: Values,
        limit: float | None = None,
        tell: Callable[[str], None] = lambda text: None,
    ) -> None:
        self._pool, self._evaluator, self._values, self._limit = pool, evaluator, values, limit
        self._tell = tell
        self._seconds: float | None = None
        self._left = 0
        self._checked = time.monotonic()
        self._singles: deque[int] = deque()
        self._suspects: deque[int] = deque()
        self._suspected: set[int] = set()
        self._broken = 0
        self._running: dict[Future[Batch], list[int]] = {}

    def batches(self, numbers: Iterator[int], count: int) -> Iterator[Batch]:
        """Evaluate ``count`` cases; yields outcomes as they come, in any order, each case once.

        Raises
        ------
        SweepStopped : the workers cannot go on
        """
        self._left = count
        while True:
            while len(self._running) < 2 * self._slots:
                cases = [self._singles.popleft()] if self._singles else list(islice(numbers, self._size()))
                if not cases:
                    if self._running or not self._suspects:
                        break
                    cases = [self._suspects.popleft()]
                future = self._pool.submit(self._evaluator, cases, self._values(cases), self._limit)
                self._running[future] = cases
            if not self._running:
                return
            for future in self._finished():
                if (batch := self._result(future, self._running.pop(future))) is not None:
                    self._left -= len(batch.cases)
                    self._broken = 0
                    mean = batch.seconds / len(batch.cases)
                    self._seconds = mean if self._seconds is None else 0.8 * self._seconds + 0.2 * mean
                    yield batch

    def done(self) -> Iterator[Batch]:
        """Yield the batches that have ended but were not asked for, after an interrupt."""
        for future in self._running:
            if future.done() and not future.cancelled() and future.exception() is None:
                yield future.result()

    @property
    def _slots(self) -> int:
        """At least 1: what a cluster without workers is sent waits there for one."""
        return max(self._pool.slots, 1)

    def _finished(self) -> set[Future[Batch]]:
        while True:
            done, _ = wait(self._running, timeout=_CHECK_SECONDS, return_when=FIRST_COMPLETED)
            if time.monotonic() - self._checked >= _CHECK_SECONDS:  # also while batches end: workers may join
                try:
                    if text := self._pool.check():
                        self._tell(text)
                except SweepStopped:
                    if not done:  # what is done is kept first
                        raise
                self._checked = time.monotonic()
            if done:
                return done

    def _result(self, future: Future[Batch], cases: list[int]) -> Batch | None:
        """Outcomes of a finished batch, None when its cases run again."""
        try:
            batch = future.result()
        except (pebble.ProcessExpired, TimeoutError) as error:
            if len(cases) == 1:
                return self._blamed(cases[0], died=isinstance(error, pebble.ProcessExpired))
            self._singles += cases
            return None
        except BrokenProcessPool as error:
            self._singles += cases
            self._broken += 1
            if self._broken > _MAX_BROKEN * self._slots:
                raise SweepStopped(
                    "The worker processes end as soon as they start: check the memory of this machine; in a "
                    "script, call run_sweep under `if __name__ == '__main__':`. Then go on with --resume."
                ) from error
            return None
        except CancelledError as error:
            raise SweepStopped(
                "The scheduler is gone or dropped a batch: check it, then run the same command with --resume."
            ) from error
        except Exception as error:
            raise SweepStopped(
                f"The workers cannot run cases ({type(error).__name__}: {error}): install this version of "
                "spurcheck on them, then run the same command with --resume."
            ) from error
        theirs, ours = batch.provenance, provenance()
        if not theirs.same_code(ours):
            raise SweepStopped(
                f"A worker runs {theirs.versions}, code {theirs.code[:12]}, but this process {ours.versions}"
                f", code {ours.code[:12]}: install the same code and the same versions, or results depend on "
                "where a case ran."
            )
        return batch

    def _blamed(self, case: int, *, died: bool) -> Batch | None:
        """Outcome of a case that ended its worker, alone on it; None when it has another chance."""
        outputs = len(self._evaluator.outputs)
        if not died and self._limit is not None:
            status, _, text = late(self._limit)
            return Batch.failure(case, outputs, status, text)
        if case not in self._suspected:
            self._suspected.add(case)
            self._suspects.append(case)
            return None
        text = "the worker process died on this case twice, the second time with no other case in the pool"
        return Batch.failure(case, outputs, Status.WORKER_DIED, text)

    def _size(self) -> int:
        """Cases of the next batch: by time, and small at the end so that all workers stay busy."""
        if self._seconds is None:
            return 1
        seconds = max(BATCH_SECONDS, self._slots / BATCHES_PER_SECOND)
        if self._limit is not None:
            seconds = min(seconds, self._limit / 4.0)
        by_time = int(seconds / max(self._seconds, 1e-6))
        return max(1, min(by_time, self._left // (4 * self._slots), MAX_BATCH))
