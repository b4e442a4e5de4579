"""Where cases run: this process, worker processes of this machine, or a Dask cluster."""

from __future__ import annotations

import asyncio
import importlib
import logging
import os
import signal
import threading
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Future
from contextlib import suppress
from multiprocessing import resource_tracker
from typing import Any, Protocol

from lumped.errors import SpurcheckError, refuse
from validation.stop_signals import undisturbed
from validation.studies.batch import Batch
from validation.studies.case_process import end_idle

Work = Callable[..., Batch]
#: How long a cluster may be without workers, or its scheduler without an answer, before the sweep stops [s].
WORKER_WAIT = 60.0
_CONNECT_SECONDS = 20.0
_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


class SweepStopped(SpurcheckError):
    """The workers cannot go on; every case that was computed is kept, and the text says how to continue."""


class Pool(Protocol):
    """Runs batches.

    Attributes
    ----------
    slots : batches that run at the same time
    died : exceptions by which a batch says that its worker process died
    dies_together : whether the death of one worker ends all batches under way
    """

    slots: int
    died: tuple[type[BaseException], ...]
    dies_together: bool

    def submit(self, work: Work, *arguments: Any) -> Future[Batch]:
        """Start a batch."""
        ...

    def check(self) -> None:
        """Raise ``SweepStopped`` when nothing can finish any more."""
        ...

    def restart(self) -> None:
        """Make the pool usable after a worker died."""
        ...

    def close(self) -> None:
        """End the workers of this pool."""
        ...


class SerialPool:
    """One case after the other in this process, which a case that crashes takes with it."""

    slots = 1
    died: tuple[type[BaseException], ...] = ()
    dies_together = True

    def submit(self, work: Work, *arguments: Any) -> Future[Batch]:
        """Run the batch now."""
        future: Future[Batch] = Future()
        try:
            future.set_result(work(*arguments))
        except Exception as error:  # noqa: BLE001  (as an executor does)
            future.set_exception(error)
        return future

    def check(self) -> None:
        """Nothing can be wrong."""

    def restart(self) -> None:
        """Nothing to do."""

    def close(self) -> None:
        """End the process of cases with a time limit."""
        end_idle()


def _worker_start(parent: int) -> None:
    """Leave Ctrl-C to the parent, and end when the parent is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(1)

    if os.name == "posix":
        threading.Thread(target=watch, daemon=True, name="parent watch").start()


class ProcessPool:
    """Worker processes of this machine (joblib's process executor, one thread each)."""

    died: tuple[type[BaseException], ...] = (BrokenExecutor,)
    dies_together = True

    def __init__(self, workers: int) -> None:
        self.slots = workers
        self._executor = self._start()

    def _start(self) -> Any:
        from joblib.externals.loky import ProcessPoolExecutor

        # Else it starts with the first worker, and lets Ctrl-C through to all of them.
        resource_tracker.ensure_running()
        return ProcessPoolExecutor(
            self.slots, env=_ONE_THREAD, initializer=_worker_start, initargs=(os.getpid(),)
        )

    def submit(self, work: Work, *arguments: Any) -> Future[Batch]:
        """Queue a batch."""
        try:
            with undisturbed():  # the first one starts the workers
                future: Future[Batch] = self._executor.submit(work, *arguments)
        except BrokenExecutor as error:  # a worker died between two batches
            future = Future()
            future.set_exception(error)
        return future

    def check(self) -> None:
        """The executor itself notices dead workers."""

    def restart(self) -> None:
        """Replace all workers."""
        self.close()
        self._executor = self._start()

    def close(self) -> None:
        """End the workers."""
        with undisturbed():
            self._executor.shutdown(wait=True, kill_workers=True)


#: Loggers that print tracebacks of what ``SweepStopped`` says in one line.
_TRACEBACKS = ("distributed.client", "distributed.protocol.core", "distributed.protocol.pickle")


def _nothing(record: logging.LogRecord) -> bool:
    return False


class DaskPool:
    """A Dask cluster by the address of its scheduler; spurcheck must be installed on its workers."""

    dies_together = False

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
        self._client: Any = distributed.Client.__new__(distributed.Client)
        try:
            self._client.__init__(address, timeout=_CONNECT_SECONDS, set_as_default=False)
            self.slots = self._first_threads()
        except BaseException as error:  # each protocol refuses an address in its own way
            if self._client.status != "running":
                self._client.status = "closed"  # the end of one half made would wait, and fail, for 40 s
            self.close()
            if not isinstance(error, Exception):
                raise
            raise refuse(
                "scheduler", address, "address of a running scheduler with workers", f"No answer: {error}."
            ) from None
        self.died: tuple[type[BaseException], ...] = (distributed.scheduler.KilledWorker,)
        self._without_workers: float | None = None

    def _first_threads(self) -> int:
        end = time.monotonic() + WORKER_WAIT
        while not (threads := self._threads()):
            if time.monotonic() > end:
                raise TimeoutError(f"no worker came in {WORKER_WAIT:g} s")
            time.sleep(0.1)
        return threads

    def _threads(self) -> int:
        # Without a limit a scheduler that stands still, its connection alive, would be waited for for ever.
        return sum(self._client.nthreads(callback_timeout=WORKER_WAIT).values())

    def submit(self, work: Work, *arguments: Any) -> Future[Batch]:
        """Send a batch to the scheduler."""
        try:
            task = self._client.submit(work, *arguments, pure=False)
        except Exception as error:
            raise self._lost(error) from error

        # The client's own executor never ends the future of a batch whose result is lost with its worker
        # before it was fetched, when the scheduler then gives the batch up.
        async def outcome() -> Batch:
            batch: Batch = await task
            return batch

        return asyncio.run_coroutine_threadsafe(outcome(), self._client.loop.asyncio_loop)

    def check(self) -> None:
        """Stop when the scheduler is gone, or has been without workers for long; follow a growing cluster."""
        if self._client.status != "running":
            raise self._lost("the connection is closed")
        try:
            threads = self._threads()
        except Exception as error:
            raise self._lost(error) from error
        if threads:
            self.slots, self._without_workers = threads, None
        elif self._without_workers is None:
            self._without_workers = time.monotonic()
        elif time.monotonic() - self._without_workers > WORKER_WAIT:
            raise SweepStopped(
                f"The cluster has had no worker for {WORKER_WAIT:g} s: start workers that have spurcheck "
                "(one without it ends at its first case), then run the same command with --resume."
            )

    @staticmethod
    def _lost(error: object) -> SweepStopped:
        return SweepStopped(
            f"The scheduler does not answer any more ({error}): restart it, then run the same command with "
            "--resume."
        )

    def restart(self) -> None:
        """Dask replaces dead workers itself."""

    def close(self) -> None:
        """Leave the cluster running and disconnect."""
        with suppress(Exception):  # a scheduler that is gone cannot say goodbye
            self._client.close(timeout=5)
        for name in _TRACEBACKS:
            logging.getLogger(name).removeFilter(_nothing)


def pool_of(workers: int, scheduler: str | None, todo: int) -> Pool:
    """Return the pool of the options ``--workers`` and ``--scheduler``, for ``todo`` cases.

    Raises
    ------
    ParameterError : workers out of range, or no scheduler at the address
    """
    if not 0 <= workers <= 1024:
        raise refuse("workers", workers, "0 to 1024", "Use as many as there are cores.")
    if scheduler is not None and todo:
        return DaskPool(scheduler)
    most = min(workers, todo)
    return ProcessPool(most) if most else SerialPool()
