"""Where cases run on this machine: in this process, or in worker processes."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import connection, forkserver, resource_tracker
from pathlib import Path
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


class ProcessPool:
    """Worker processes of this machine, by pebble: it ends those that are late and replaces those that died.

    A worker that has work and uses no processor time, for it was stopped or waits for a disk that is gone, is
    named after ``TOLD_SECONDS`` and killed after ``GIVEN_UP_SECONDS``: its batch is one on which a worker
    died. Where no worker has begun a batch in that time, all are replaced: one died with the lock of the
    channel that they share.
    """

    def __init__(self, workers: int) -> None:
        self.slots = workers
        self._futures: list[Future[Batch]] = []
        self._start()

    def _start(self) -> None:
        self._still: dict[int, tuple[int, int]] = {}  # process -> ticks used, calls of ``check`` since
        resource_tracker.ensure_running()  # which lets Ctrl-C through to what is started with it
        with undisturbed():
            self._pool = pebble.ProcessPool(self.slots, initializer=_worker_start, context=_context())
            self._pool.schedule(abs, (0,))  # starts the workers

    def submit(self, *work: Any) -> Future[Batch]:
        """Queue a batch."""
        if not self._pool.active:  # all workers died while they had nothing to do
            self._restart()
        future: Future[Batch] = self._pool.schedule(evaluate_guarded, work, timeout=work[-1])
        self._futures.append(future)
        return future

    def check(self) -> str:
        """Kill workers that stand still.

        Time is counted in calls: while this process stands still too, nobody is blamed.
        """
        self._futures = [future for future in self._futures if not future.done()]
        if not self._pool.active:  # a batch that came when all workers had just died would never end
            self._restart()
        before, self._still = self._still, {}
        for pid in self._workers():
            if (used := _processor_time(pid)) is not None:
                same, calls = before.get(pid, (-1, 0))
                self._still[pid] = used, calls + 1 if used == same else 0
        silent = {pid: calls for pid, (_, calls) in self._still.items() if calls >= TOLD_SECONDS}
        if len(silent) <= max(self.slots - len(self._futures), 0):  # these have nothing to do
            return ""
        late = [pid for pid, calls in silent.items() if calls >= GIVEN_UP_SECONDS]
        if late and not any(future.running() for future in self._futures):
            self._restart()
        else:
            for pid in late:
                os.kill(pid, signal.SIGKILL)
        return (
            f"Worker process {', '.join(map(str, silent))} uses no processor time; it is killed after "
            f"{GIVEN_UP_SECONDS:g} s and its cases run again."
        )

    def _workers(self) -> dict[int, Any]:
        """Processes of this pool; pebble has no public name for them."""
        return dict(self._pool._pool_manager.worker_manager.workers)

    def _restart(self) -> None:
        self.close()
        for future in self._futures:
            if not future.done():
                future.set_exception(BrokenProcessPool("all workers were replaced"))
        self._start()

    def close(self) -> None:
        """End the workers, also those that stand still, which pebble would give 3 s each."""
        with undisturbed():
            self._pool.stop()
            for worker in self._workers().values():
                worker.kill()
            self._pool.join()


def _processor_time(pid: int) -> int | None:
    """Clock ticks that a process has used; None where the system does not say."""
    try:
        text = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace")
    except OSError:
        return None
    user, system = text.rpartition(")")[2].split()[11:13]
    return int(user) + int(system)
