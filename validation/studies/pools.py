"""Where cases run on this machine: in this process, or in worker processes."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from concurrent.futures import Future, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import connection, forkserver, resource_tracker
from pathlib import Path
from queue import SimpleQueue
from typing import Any, Protocol

import pebble

from lumped.errors import SpurcheckError
from validation.stop_signals import undisturbed
from validation.studies.evaluate import Batch, evaluate_batch, evaluate_guarded

#: Who stands still is named after so long, and given up after so long [s].
TOLD_SECONDS, GIVEN_UP_SECONDS = 10.0, 60.0
_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


class SweepStopped(SpurcheckError):
    """The workers cannot go on; every case that was computed is kept, and the text says how to continue."""


class Pool(Protocol):
    """Runs batches, ``slots`` at the same time."""

    slots: int

    def submit(self, *work: Any) -> Future[Batch]:
        """Start ``evaluate_batch(*work)``.

        The future raises ``pebble.ProcessExpired`` when a worker process died on the batch, ``TimeoutError``
        when the batch took longer than a case may, ``BrokenProcessPool`` when all workers are gone.
        """
        ...

    def check(self) -> str:
        """Look after the workers, once a second; returns what the user should know, "" when all is well.

        Raises
        ------
        SweepStopped : nothing can finish any more
        """
        ...

    def close(self) -> None:
        """End the workers of this pool, within a second whatever they do."""
        ...


class SerialPool:
    """One case after the other in this process, which a case that crashes takes with it."""

    slots = 1

    def submit(self, *work: Any) -> Future[Batch]:
        """Run the batch now."""
        future: Future[Batch] = Future()
        try:
            future.set_result(evaluate_batch(*work))
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


_ENVIRONMENT = threading.Lock()


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
        before = dict(os.environ)
        os.environ.update(changes)
        try:
            forkserver.ensure_running()
        finally:
            for name in changes:
                os.environ.pop(name)
                if name in before:
                    os.environ[name] = before[name]
    return context


class Worker:
    """A worker process with a pebble pool of its own: what it holds when it dies, nobody else waits for.

    It starts with its first batch, and again with the one after a batch that did not end well.
    """

    def __init__(self) -> None:
        self.closed = False
        self.still = 0
        self._busy = False
        self._used: int | None = None
        self._pool: Any = None
        self._processes: list[Any] = []
        self._ending = threading.Lock()

    def run(self, *work: Any) -> Batch:
        """Evaluate a batch; what is raised is said at ``Pool.submit``."""
        self.still, self._busy = 0, True
        try:
            if self._pool is None:
                pool = pebble.ProcessPool(1, initializer=_worker_start, context=_context())
                pool.schedule(abs, (0,))  # starts the process
                # pebble has no public name for it
                self._processes = list(pool._pool_manager.worker_manager.workers.values())
                self._pool = pool
            if self.closed:
                raise BrokenProcessPool("the sweep ends")
            try:
                future = self._pool.schedule(evaluate_guarded, work, timeout=work[-1])
            except RuntimeError as error:
                raise BrokenProcessPool("the process died while it had nothing to do") from error
            while not wait([future], 1.0).done:
                if not self._pool.active:  # it died just before, and pebble forgot the batch
                    raise BrokenProcessPool("the process died before it had the batch")
            batch: Batch = future.result()
            return batch
        except BaseException:
            self.end()
            raise
        finally:
            self._busy = False

    def look(self) -> int:
        """Return how many calls ago the process last used processor time, 0 where nobody can say."""
        used = _processor_time(self._processes) if self._busy and self._pool else None  # not while it starts
        self.still = self.still + 1 if used is not None and used == self._used else 0
        self._used = used
        return self.still

    @property
    def name(self) -> str:
        """Number of the process."""
        return " ".join(str(process.pid) for process in self._processes)

    def kill(self) -> None:
        """End the process; its batch is one on which a worker died."""
        for process in self._processes:
            process.kill()

    def end(self) -> None:
        """End the process, also one that stands still, which pebble would give 3 s."""
        with self._ending:
            pool, self._pool = self._pool, None
            if pool is not None:
                pool.stop()
                self.kill()
                pool.join()


class ProcessPool:
    """Worker processes of this machine.

    A worker that has work and uses no processor time, for it was stopped or waits for a disk that is gone, is
    named after ``TOLD_SECONDS`` and killed after ``GIVEN_UP_SECONDS``.
    """

    def __init__(self, workers: int) -> None:
        self.slots = workers
        resource_tracker.ensure_running()  # which lets Ctrl-C through to what is started with it
        with undisturbed():
            _context()
        self._threads = pebble.ThreadPool(workers)
        self._workers = [Worker() for _ in range(workers)]
        self._idle: SimpleQueue[Worker] = SimpleQueue()
        for worker in self._workers:
            self._idle.put(worker)

    def submit(self, *work: Any) -> Future[Batch]:
        """Queue a batch."""
        future: Future[Batch] = self._threads.schedule(self._run, work)
        return future

    def _run(self, *work: Any) -> Batch:
        worker = self._idle.get()
        try:
            return worker.run(*work)
        finally:
            self._idle.put(worker)

    def check(self) -> str:
        """Kill workers that stand still.

        Time is counted in calls: while this process stands still too, nobody is blamed.
        """
        silent = [worker for worker in self._workers if worker.look() >= TOLD_SECONDS]
        for worker in silent:
            if worker.still >= GIVEN_UP_SECONDS:
                worker.kill()
        names = ", ".join(worker.name for worker in silent)
        return names and (
            f"Worker process {names} uses no processor time; it is killed after {GIVEN_UP_SECONDS:g} s and "
            "its cases run again."
        )

    def close(self) -> None:
        """End the workers."""
        with undisturbed():
            self._threads.stop()
            for worker in self._workers:
                worker.closed = True  # should it start just now, it ends itself
            with ThreadPoolExecutor(self.slots) as each:
                each.map(Worker.end, self._workers)
        ending = threading.Thread(target=self._threads.join, daemon=True)
        ending.start()
        ending.join(1.0)  # longer only where a process cannot start


def _processor_time(processes: list[Any]) -> int | None:
    """Clock ticks that processes have used; None where the system does not say."""
    try:
        stats = [Path(f"/proc/{process.pid}/stat").read_text("ascii", "replace") for process in processes]
    except OSError:
        return None
    fields = (text.rpartition(")")[2].split()[11:13] for text in stats)
    return sum(int(user) + int(system) for user, system in fields)
