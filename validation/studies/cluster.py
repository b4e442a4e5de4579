"""Cases on a Dask cluster."""

from __future__ import annotations

import asyncio
import importlib
import logging
import multiprocessing
import time
from concurrent.futures import Future
from contextlib import suppress
from typing import Any

import pebble

from lumped.errors import refuse
from validation.studies import pools
from validation.studies.evaluate import Batch, evaluate_batch
from validation.studies.pools import Pool, ProcessPool, SerialPool, SweepStopped, Worker

_CONNECT_SECONDS = 20.0
# Without a limit a scheduler that stands still, its connection alive, would be waited for for ever.
_ANSWER_SECONDS = 2.0
#: Loggers that print tracebacks of what ``SweepStopped`` says in one line.
_TRACEBACKS = ("distributed.client", "distributed.protocol.core", "distributed.protocol.pickle")


def evaluate_on_cluster(*work: Any) -> Batch:
    """Evaluate a batch in a thread of a Dask worker; with a time limit, in a process that can be ended."""
    if work[-1] is None:
        return evaluate_batch(*work)
    multiprocessing.current_process().daemon = False  # which may not have processes of its own
    worker = Worker()
    try:
        return worker.run(*work)
    finally:
        worker.end()


def _nothing(record: logging.LogRecord) -> bool:
    return False


class DaskPool:
    """A Dask cluster by the address of its scheduler; spurcheck must be installed on its workers.

    A worker without a sign of life is named after ``TOLD_SECONDS``; the scheduler gives it up, by its own
    setting, and its batches run on others. A scheduler that does not answer, or has no worker, is named as
    well, and ends the sweep after ``GIVEN_UP_SECONDS``.
    """

    def __init__(self, address: str) -> None:
        try:
            distributed: Any = importlib.import_module("distributed")
        except ImportError:
            raise refuse(
                "scheduler",
                address,
                "an installation with dask.distributed",
                "Install the extra: pip install 'spurcheck[cluster]'.",
            ) from None
        for name in _TRACEBACKS:
            logging.getLogger(name).addFilter(_nothing)
        self.slots = 0
        self._heard: dict[str, tuple[float, float]] = {}  # worker -> its last sign of life, when it came here
        self._silent_since: float | None = None
        self._client: Any = distributed.Client.__new__(distributed.Client)
        try:
            self._client.__init__(address, timeout=_CONNECT_SECONDS, set_as_default=False)
            end = time.monotonic() + pools.GIVEN_UP_SECONDS
            while not self._ask():
                if time.monotonic() > end:
                    raise TimeoutError(f"no worker came in {pools.GIVEN_UP_SECONDS:g} s")
                time.sleep(0.1)
        except BaseException as error:  # each protocol refuses an address in its own way
            if self._client.status != "running":
                self._client.status = "closed"  # the end of one half made would wait, and fail, for 40 s
            self.close()
            if not isinstance(error, Exception):
                raise
            raise refuse(
                "scheduler", address, "address of a running scheduler with workers", f"No answer: {error}."
            ) from None
        self._killed: type[Exception] = distributed.scheduler.KilledWorker

    def _ask(self) -> int:
        """Ask the scheduler for its workers; returns their threads."""
        asked = self._client.scheduler.identity
        workers = self._client.sync(asked, callback_timeout=_ANSWER_SECONDS)["workers"]
        before, now = self._heard, time.monotonic()
        self._heard = {}
        for name, worker in workers.items():
            sign = worker["last_seen"]
            same, since = before.get(name, (sign, now))
            self._heard[name] = sign, since if sign == same else now
        self.slots = sum(int(worker["nthreads"]) for worker in workers.values())
        return self.slots

    def submit(self, *work: Any) -> Future[Batch]:
        """Send a batch to the scheduler."""
        try:
            task = self._client.submit(evaluate_on_cluster, *work, pure=False)
        except Exception as error:
            raise self._lost(error) from error

        # The client's own executor never ends the future of a batch whose result is lost with its worker
        # before it was fetched, when the scheduler then gives the batch up.
        async def outcome() -> Batch:
            try:
                batch: Batch = await task
            except self._killed as error:
                raise pebble.ProcessExpired(str(error)) from None
            return batch

        return asyncio.run_coroutine_threadsafe(outcome(), self._client.loop.asyncio_loop)

    def check(self) -> str:
        """Follow a growing cluster; stop when it is gone, or silent or without workers for long."""
        if self._client.status != "running":
            raise self._lost("the connection is closed")
        now = time.monotonic()
        try:
            problem = "" if self._ask() else "The cluster has no worker"
        except TimeoutError:
            problem = "The scheduler does not answer"
        except Exception as error:
            raise self._lost(error) from error
        if problem:
            self._silent_since = self._silent_since or now
            silent = now - self._silent_since
            if silent > pools.GIVEN_UP_SECONDS:
                raise SweepStopped(
                    f"{problem} for {silent:.0f} s: start workers that have spurcheck (one without it ends "
                    "at its first case), or another scheduler, then run the same command with --resume."
                )
            given_up = f"{problem}; given up after {pools.GIVEN_UP_SECONDS:g} s."
            return given_up if silent > pools.TOLD_SECONDS else ""
        self._silent_since = None
        names = [name for name, (_, since) in self._heard.items() if now - since > pools.TOLD_SECONDS]
        if not names:
            return ""
        return (
            f"Worker {', '.join(names)} gives no sign of life; the scheduler gives it up after its setting "
            "distributed.scheduler.worker-ttl, and its cases run on others."
        )

    @staticmethod
    def _lost(error: object) -> SweepStopped:
        return SweepStopped(
            f"The scheduler does not answer any more ({error}): restart it, then run the same command with "
            "--resume."
        )

    def close(self) -> None:
        """Leave the cluster running and disconnect."""
        with suppress(Exception):  # a scheduler that is gone cannot say goodbye
            self._client.close(timeout=1)
        for name in _TRACEBACKS:
            logging.getLogger(name).removeFilter(_nothing)


def pool_of(workers: int, scheduler: str | None, limited: bool, todo: int) -> Pool:
    """Return the pool of the options ``--workers`` and ``--scheduler``, for ``todo`` cases.

    Raises
    ------
    ParameterError : workers out of range, or no scheduler at the address
    """
    if not 0 <= workers <= 1024:
        raise refuse("workers", workers, "0 to 1024", "Use as many as there are cores.")
    if scheduler is not None and todo:
        return DaskPool(scheduler)
    most = min(max(workers, 1) if limited else workers, todo)
    return ProcessPool(most) if most else SerialPool()
