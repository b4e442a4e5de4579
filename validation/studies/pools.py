"""Where cases run: this process, worker processes of this machine, or a Dask cluster."""

from __future__ import annotations

import asyncio
import importlib
import logging
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, suppress
from multiprocessing import connection, forkserver, resource_tracker
from pathlib import Path
from typing import Any, Protocol

import pebble

from lumped.errors import SpurcheckError, refuse
from validation.stop_signals import undisturbed
from validation.studies.evaluate import Batch, Evaluator, evaluate_batch, evaluate_guarded

#: A worker process that uses no processor time, or a cluster or scheduler that does not answer, is told after
#: so long, and given up after so long [s].
TOLD_SECONDS, GIVEN_UP_SECONDS = 10.0, 60.0
_CONNECT_SECONDS = 20.0
_ANSWER_SECONDS = 2.0
_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
_WORKER = "pebble_pool_worker"
_ENVIRONMENT = threading.Lock()


class SweepStopped(SpurcheckError):
    """The workers cannot go on; every case that was computed is kept, and the text says how to continue."""


class Pool(Protocol):
    """Runs batches.

    Attributes
    ----------
    slots : batches that run at the same time
    """

    slots: int

    def submit(
        self,
        evaluator: Evaluator,
        cases: Sequence[int],
        values: Sequence[tuple[Any, ...]],
        limit: float | None,
    ) -> Future[Batch]:
        """Start a batch; see ``evaluate_batch``. With a limit, the whole batch must end in that time.

        The future raises ``pebble.ProcessExpired`` when a worker process died on the batch, ``TimeoutError``
        when it took too long.
        """
        ...

    def check(self) -> str:
        """Look after the workers; returns what the user should know, "" when all is well.

        Raises
        ------
        SweepStopped : nothing can finish any more
        """
        ...

    def close(self) -> None:
        """End the workers of this pool."""
        ...


class SerialPool:
    """One case after the other in this process, which a case that crashes takes with it."""

    slots = 1

    def submit(
        self,
        evaluator: Evaluator,
        cases: Sequence[int],
        values: Sequence[tuple[Any, ...]],
        limit: float | None,
    ) -> Future[Batch]:
        """Run the batch now."""
        future: Future[Batch] = Future()
        try:
            future.set_result(evaluate_batch(evaluator, cases, values, limit))
        except Exception as error:  # noqa: BLE001  (as an executor does)
            future.set_exception(error)
        return future

    def check(self) -> str:
        """Nothing can be wrong."""
        return ""

    def close(self) -> None:
        """Nothing to do."""


def _worker_start() -> None:
    """Leave Ctrl-C to the parent, and end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)  # at once, also in compiled code
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        connection.wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True, name="parent watch").start()


def _context() -> Any:
    """How worker processes start: forks of one clean process that has everything loaded.

    A fork of this process could copy a lock that a thread of numba or exudyn holds. The clean process has no
    other thread, starts a worker in 20 ms instead of the 2 s of a new interpreter, and is started once.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["validation.studies.analyses", "floquet.gear.multipliers", "multibody"])
    # Its modules are those of this process, whatever lies in the working folder.
    path = os.pathsep.join(os.path.abspath(entry) for entry in sys.path)
    changes = _ONE_THREAD | {"PYTHONPATH": path, "PYTHONSAFEPATH": "1"}
    with _ENVIRONMENT:
        before = {name: os.environ.get(name) for name in changes}
        os.environ.update(changes)
        try:
            forkserver.ensure_running()
        finally:
            for name, value in before.items():
                os.environ.pop(name)
                if value is not None:
                    os.environ[name] = value
    return context


class ProcessPool:
    """Worker processes of this machine, by pebble: it ends those that are late and replaces those that died.

    A worker that uses no processor time for ``GIVEN_UP_SECONDS`` while it has a batch, for it was stopped or
    waits for a disk that is gone, is killed: its batch is one on which a worker died.
    """

    def __init__(self, workers: int) -> None:
        self.slots = workers
        self._futures: list[Future[Batch]] = []
        self._silent: dict[int, tuple[int, int]] = {}
        self._start()

    def _start(self) -> None:
        resource_tracker.ensure_running()  # which lets Ctrl-C through to what is started with it
        with undisturbed():
            self._pool = pebble.ProcessPool(self.slots, initializer=_worker_start, context=_context())
            self._pool.schedule(abs, (0,))  # starts the workers

    def submit(
        self,
        evaluator: Evaluator,
        cases: Sequence[int],
        values: Sequence[tuple[Any, ...]],
        limit: float | None,
    ) -> Future[Batch]:
        """Queue a batch."""
        if not self._pool.active:  # all workers died while they had nothing to do
            self.close()
            self._start()
        arguments = (evaluator, cases, values, limit)
        future: Future[Batch] = self._pool.schedule(evaluate_guarded, arguments, timeout=limit)
        self._futures.append(future)
        return future

    def check(self) -> str:
        """Kill workers that stand still.

        Time is counted in calls, one a second: while this process stands still too, nobody is blamed.
        """
        if not self._pool.active:  # else a batch that came when all workers had just died would never end
            for future in self._futures:
                if not future.done():
                    future.set_exception(BrokenProcessPool("all workers died"))
        now = {pid: _processor_time(pid) for pid in _workers()}
        self._silent = {
            pid: (used, calls + 1) if used == before else (used, 0)
            for pid, used in now.items()
            if used is not None
            for before, calls in [self._silent.get(pid, (-1, 0))]
        }
        self._futures = [future for future in self._futures if not future.done()]
        idle = self.slots - sum(future.running() for future in self._futures)
        silent = {pid: calls for pid, (_, calls) in self._silent.items() if calls >= TOLD_SECONDS}
        if len(silent) <= idle:  # these have nothing to do
            return ""
        for pid, calls in silent.items():
            if calls >= GIVEN_UP_SECONDS:
                os.kill(pid, signal.SIGKILL)
        return (
            f"Worker process {', '.join(map(str, silent))} uses no processor time; it is killed after "
            f"{GIVEN_UP_SECONDS:g} s and its cases run again."
        )

    def close(self) -> None:
        """End the workers."""
        with undisturbed():
            self._pool.stop()
            self._pool.join()


def _workers() -> list[int]:
    """Process numbers of the workers."""
    found = multiprocessing.active_children()
    return [child.pid for child in found if child.name == _WORKER and child.pid is not None]


def _processor_time(pid: int) -> int | None:
    """Clock ticks that a process has used; None where the system does not say."""
    try:
        fields = (
            Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()
        )
        return int(fields[11]) + int(fields[12])
    except (OSError, IndexError, ValueError):
        return None


def evaluate_on_cluster(
    evaluator: Evaluator, cases: Sequence[int], values: Sequence[tuple[Any, ...]], limit: float | None
) -> Batch:
    """Evaluate a batch in a thread of a Dask worker; with a time limit, in a process that can be ended."""
    if limit is None:
        return evaluate_batch(evaluator, cases, values)
    multiprocessing.current_process().daemon = False  # which may not have processes of its own
    with closing(ProcessPool(1)) as pool:
        return pool.submit(evaluator, cases, values, limit).result()


#: Loggers that print tracebacks of what ``SweepStopped`` says in one line.
_TRACEBACKS = ("distributed.client", "distributed.protocol.core", "distributed.protocol.pickle")


def _nothing(record: logging.LogRecord) -> bool:
    return False


class DaskPool:
    """A Dask cluster by the address of its scheduler; spurcheck must be installed on its workers."""

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
        self._killed: type[Exception] = distributed.scheduler.KilledWorker
        self._silent_since: float | None = None

    def _first_threads(self) -> int:
        end = time.monotonic() + GIVEN_UP_SECONDS
        while not (threads := self._threads()):
            if time.monotonic() > end:
                raise TimeoutError(f"no worker came in {GIVEN_UP_SECONDS:g} s")
            time.sleep(0.1)
        return threads

    def _threads(self) -> int:
        # Without a limit a scheduler that stands still, its connection alive, would be waited for for ever.
        return sum(self._client.nthreads(callback_timeout=_ANSWER_SECONDS).values())

    def submit(
        self,
        evaluator: Evaluator,
        cases: Sequence[int],
        values: Sequence[tuple[Any, ...]],
        limit: float | None,
    ) -> Future[Batch]:
        """Send a batch to the scheduler."""
        try:
            task = self._client.submit(evaluate_on_cluster, evaluator, cases, values, limit, pure=False)
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
        try:
            threads = self._threads()
            problem = "" if threads else "The cluster has no worker"
        except TimeoutError:
            threads, problem = 0, "The scheduler does not answer"
        except Exception as error:
            raise self._lost(error) from error
        if not problem:
            self.slots, self._silent_since = threads, None
            return ""
        now = time.monotonic()
        self._silent_since = self._silent_since or now
        silent = now - self._silent_since
        if silent > GIVEN_UP_SECONDS:
            raise SweepStopped(
                f"{problem} for {silent:.0f} s: start workers that have spurcheck (one without it ends at "
                "its first case), or another scheduler, then run the same command with --resume."
            )
        return f"{problem}; given up after {GIVEN_UP_SECONDS:g} s." if silent > TOLD_SECONDS else ""

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
