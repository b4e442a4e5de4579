"""Hand cases to a pool, a few at a time, and survive the death of workers."""

from __future__ import annotations

import time
from collections import Counter, deque
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from itertools import islice

from validation.studies.analyses import Evaluator
from validation.studies.batch import Batch, evaluate_batch, versions
from validation.studies.cases import CaseList
from validation.studies.pools import Pool, SweepStopped
from validation.studies.record import Record, Status

#: Aim of the time of a batch [s]; a killed run loses at most two batches under way a worker.
BATCH_SECONDS = 0.5
#: Batches a second that a scheduler is asked for at most: with many workers the batches last longer.
BATCHES_PER_SECOND = 500.0
MAX_BATCH = 10_000
#: How often a case may kill its worker, alone on it, before it counts as failed.
MAX_DEATHS = 2
_CHECK_SECONDS = 2.0


class Dispatcher:
    """Evaluates cases on a pool.

    Parameters
    ----------
    pool : where
    cases : the list that numbers refer to
    limit : longest time of a case [s]
    """

    def __init__(self, pool: Pool, cases: CaseList, limit: float | None = None) -> None:
        self._pool, self._cases, self._limit = pool, cases, limit
        self._evaluator = Evaluator.of(cases.study)
        self._seconds: float | None = None
        self._left = 0
        self._checked = time.monotonic()
        self._suspects: deque[int] = deque()
        self._deaths: Counter[int] = Counter()

    def records(self, numbers: Iterator[int], count: int) -> Iterator[tuple[Record, ...]]:
        """Evaluate ``count`` cases; yields records as they come, in any order, each case once.

        Raises
        ------
        SweepStopped : the workers cannot go on
        """
        self._left = count
        running: dict[Future[Batch], list[int]] = {}
        while True:
            while len(running) < 2 * self._pool.slots:
                batch = list(islice(numbers, self._size()))
                if not batch:
                    break
                running[self._submit(batch)] = batch
            if not running:
                return
            died = False
            for future in self._finished(running):
                batch = running.pop(future)
                records = self._result(future)
                if records is None:
                    died = True
                    self._suspects += batch
                else:
                    yield self._counted(records)
            if died:
                yield from self._quarantine(running)

    def _quarantine(self, running: dict[Future[Batch], list[int]]) -> Iterator[tuple[Record, ...]]:
        """A worker died: nobody knows on which of its cases, so run these one by one, alone."""
        if self._pool.dies_together:
            for future, batch in running.items():
                records = self._result(future) if future.done() else None
                if records is not None:
                    yield self._counted(records)
                else:
                    self._suspects += batch
            running.clear()
        self._pool.restart()
        while self._suspects:
            case = self._suspects.popleft()
            alone = {self._submit([case]): [case]}
            (future,) = self._finished(alone)
            records = self._result(future)
            if records is None:
                self._deaths[case] += 1
                self._pool.restart()
                if self._deaths[case] < MAX_DEATHS:
                    self._suspects.appendleft(case)
                    continue
                text = "the worker process died on this case, alone on it, every time"
                records = (Record(case, Status.WORKER_DIED, 0.0, message=text),)
            yield self._counted(records)

    def _submit(self, numbers: list[int]) -> Future[Batch]:
        batch = list(zip(numbers, self._cases.values(numbers), strict=True))
        return self._pool.submit(evaluate_batch, self._evaluator, batch, self._limit)

    def _finished(self, running: dict[Future[Batch], list[int]]) -> set[Future[Batch]]:
        while True:
            done, _ = wait(running, timeout=_CHECK_SECONDS, return_when=FIRST_COMPLETED)
            if time.monotonic() - self._checked >= _CHECK_SECONDS:  # also while batches end: workers may join
                try:
                    self._pool.check()
                except SweepStopped:
                    if not done:  # what is done is kept first
                        raise
                self._checked = time.monotonic()
            if done:
                return done

    def _result(self, future: Future[Batch]) -> tuple[Record, ...] | None:
        """Records of a finished batch, None when its worker died."""
        try:
            batch = future.result()
        except self._pool.died:
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
        if batch.versions != versions():
            raise SweepStopped(
                f"A worker runs {batch.versions} but this process {versions()}: install the same versions, "
                "or results depend on where a case ran."
            )
        return batch.records

    def _counted(self, records: tuple[Record, ...]) -> tuple[Record, ...]:
        self._left -= len(records)
        mean = sum(record.seconds for record in records) / max(len(records), 1)
        self._seconds = mean if self._seconds is None else 0.8 * self._seconds + 0.2 * mean
        return records

    def _size(self) -> int:
        """Cases of the next batch: by time, and small at the end so that all workers stay busy."""
        if self._seconds is None:
            return 1
        slots = max(self._pool.slots, 1)
        by_time = int(max(BATCH_SECONDS, slots / BATCHES_PER_SECOND) / max(self._seconds, 1e-6))
        share = self._left // (4 * slots)
        return max(1, min(by_time, share, MAX_BATCH))
