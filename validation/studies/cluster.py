"""A Dask cluster as an executor of ``concurrent.futures``: a study, an uncertainty and a chart run on it.

The executor waits for the first worker, uses workers that join later, and ends every call: with its result,
or with an error where all workers or the scheduler are gone. Source: https://distributed.dask.org
"""

from __future__ import annotations

import asyncio
import logging
import re
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, InvalidStateError, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from lumped.arguments import real_number
from lumped.errors import ParameterError, SpurcheckError, refuse
from validation.studies.store import Provenance, provenance

if TYPE_CHECKING:
    from distributed import Client

#: Longest wait for the first worker [s]. Also the longest time in which a running cluster has no worker.
WAIT_SECONDS = 300.0
#: Longest time in which a scheduler answers [s].
ANSWER_SECONDS = 10.0
#: Time between two looks at the workers of a cluster [s].
LOOK_SECONDS = 1.0
MOST_WORKERS = 1024
#: Environment of worker processes: cases are parallel, and the matrices of a case are small.
ONE_THREAD = {"PYTHONSAFEPATH": "1"} | dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
_ON_THIS_MACHINE = re.compile(r"local:(\d+)")
_SCHEDULER = re.compile(r"(?:(?:tcp|tls|ws|wss|ucx)://)?(?:[^\s/:@\[\]]+|\[[0-9a-fA-F:.]+\]):(\d{1,5})/?")
Tell = Callable[[str], None]
P = ParamSpec("P")
R = TypeVar("R")


class ClusterStopped(SpurcheckError):
    """The cluster cannot go on: no worker, no scheduler, or a worker with another version of the program."""


def to_stderr(text: str) -> None:
    """Print a message on stderr."""
    print(text, file=sys.stderr, flush=True)


@contextmanager
def open_cluster(
    address: str, *, wait_seconds: float = WAIT_SECONDS, tell: Tell = to_stderr
) -> Iterator[Cluster]:
    """Connect to a Dask cluster: an executor for ``run_sweep``, ``uncertainty`` and ``stability_chart``.

    The connection waits until the cluster has a worker. Workers that join later are used too.

    Parameters
    ----------
    address : address of the scheduler, as ``dask scheduler`` prints it: "tcp://HOST:8786"; or "local:8", a
        cluster of 8 worker processes on this machine, which ends with the block
    wait_seconds : longest time without a worker [s], before the first worker and later
    tell : takes the message that the cluster has no worker yet; default: the message is printed on stderr

    Raises
    ------
    ParameterError : an address that is none, a scheduler that does not answer, no worker in the time, a
        worker with other source code or other versions of the libraries than this process, or Dask is not
        installed
    ClusterStopped : the workers of "local:N" do not start; later, in calls: the cluster cannot go on
    """
    wait = real_number("wait_seconds", wait_seconds, 0.0, 1e6, unit="s", action="Give the longest wait.")
    workers = workers_on_this_machine(address)
    try:
        import distributed
    except ImportError:
        action = 'Install it: pip install "spurcheck[cluster]".'
        raise refuse("cluster", address, "none without Dask", action) from None
    with _dask_messages_hidden(), ExitStack() as opened:
        scheduler: Any = address
        if workers:
            try:
                scheduler = opened.enter_context(
                    distributed.LocalCluster(
                        n_workers=workers,
                        threads_per_worker=1,
                        protocol="tcp",
                        dashboard_address="127.0.0.1:0",  # any free port: two sweeps may run at once
                        silence_logs=logging.CRITICAL,
                        env=ONE_THREAD,
                        preload=[__name__],
                    )
                )
            except Exception as error:
                reason = " ".join(str(error).split())[:300]
                raise ClusterStopped(
                    f"The workers of {address} do not start ({reason}): check the memory of this machine; in "
                    "a script, call open_cluster under `if __name__ == '__main__':`."
                ) from error
        else:
            _refuse_no_scheduler(address)
        try:
            client = distributed.Client(scheduler, timeout=ANSWER_SECONDS, set_as_default=False)
            cluster = Cluster(opened.enter_context(client), address, wait, tell)
        except SpurcheckError:
            raise
        except Exception as error:
            raise _no_answer(address, error) from error
        opened.callback(cluster.shutdown, wait=False)
        yield cluster


def workers_on_this_machine(address: str) -> int:
    """Return N of "local:N", or 0 for the address of a scheduler. What is neither is refused."""
    text = str(address)
    if (on_this_machine := _ON_THIS_MACHINE.fullmatch(text)) is not None:
        number = int(on_this_machine[1])
        if not 1 <= number <= MOST_WORKERS:
            action = "Use as many as there are cores."
            raise refuse("cluster", text, f"local:1 to local:{MOST_WORKERS}", action)
        return number
    scheduler = _SCHEDULER.fullmatch(text)
    if scheduler is None or not 1 <= int(scheduler[1]) <= 65535:
        allowed = "tcp://HOST:PORT or tls://HOST:PORT of a Dask scheduler, or local:N"
        action = "'dask scheduler' prints its address; local:2 is a cluster on this machine."
        raise refuse("cluster", text, allowed, action)
    return 0


def dask_setup(_worker: object) -> None:
    """Let a worker process of this machine ignore Ctrl-C, which a terminal sends to all processes.

    Dask calls this function as a worker starts. The client ends the workers.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _refuse_no_scheduler(address: str) -> None:
    """Refuse an address at which no scheduler answers in time, or something else does."""
    # In a notebook an event loop runs in this thread already.
    with ThreadPoolExecutor(1) as thread:
        try:
            kind = thread.submit(lambda: asyncio.run(_kind_at(address))).result()
        except Exception as error:
            raise _no_answer(address, error) from error
    if kind != "Scheduler":
        action = f"A {kind.lower()} has that address: give the address that 'dask scheduler' prints."
        raise refuse("cluster", address, "the address of a Dask scheduler", action)


async def _kind_at(address: str) -> str:
    """Return the kind of the server of Dask at an address, "Scheduler" or "Worker"."""
    from distributed.core import rpc
    from distributed.security import Security

    arguments = Security().get_connection_args("client")
    async with asyncio.timeout(ANSWER_SECONDS), rpc(address, connection_args=arguments) as server:
        identity = await server.identity()
    return str(identity["type"])


def _no_answer(address: str, error: Exception) -> ParameterError:
    """Return the refusal of an address at which no scheduler answers."""
    reason = " ".join(str(error).split())[:300]
    if isinstance(error, TimeoutError) or not reason:
        reason = f"no answer in {ANSWER_SECONDS:g} s"
    return refuse(
        "cluster",
        address,
        "the address of a Dask scheduler that answers",
        f"It does not: {reason}. Start 'dask scheduler', and give the address that it prints.",
    )


@contextmanager
def _dask_messages_hidden() -> Iterator[None]:
    """Hide what Dask logs in this process about lost workers: this module says what matters."""
    loggers = [
        logging.getLogger(name)
        for name in logging.root.manager.loggerDict
        if name.split(".")[0] == "distributed"
    ]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


def with_these_versions(
    expected: Provenance, function: Callable[P, R], *arguments: P.args, **keywords: P.kwargs
) -> R:
    """Call a function in a worker, if the worker has the versions of the client.

    Raises
    ------
    ClusterStopped : the worker has other versions
    """
    if (difference := other_versions("A worker", provenance(), expected)) is not None:
        raise ClusterStopped(difference)
    return function(*arguments, **keywords)


def other_versions(name: str, theirs: Provenance, ours: Provenance) -> str | None:
    """Return the sentence about a worker with other versions than this process. None: they are equal."""
    if theirs[:2] == ours[:2]:
        return None
    return (
        f"{name} runs {theirs.versions}, code {theirs.code[:12]}, but this process {ours.versions}, code "
        f"{ours.code[:12]}: install the same code and the same versions, or results depend on where a case "
        "ran."
    )


class Cluster(Executor):
    """The workers of a Dask scheduler as an executor; see ``open_cluster``.

    A thread looks at the cluster every second. Where the scheduler is gone, or no worker is there for
    ``wait_seconds``, all calls that are not finished end with ``ClusterStopped``.
    """

    def __init__(self, client: Client, address: str, wait_seconds: float, tell: Tell) -> None:
        self.address = address
        self._client = client
        self._wait_seconds = wait_seconds
        self._tell = tell
        self._unfinished: dict[Future[Any], Any] = {}
        self._lock = threading.Lock()
        self._reason: str | None = None
        self._threads = self._wait_for_first()
        self._refuse_other_versions()
        self._end = threading.Event()
        self._watch = threading.Thread(target=self._look, name="spurcheck-cluster", daemon=True)
        self._watch.start()

    @property
    def workers(self) -> int:
        """Number of worker processes at the last look. A worker computes one case at a time."""
        return len(self._threads)

    def submit(self, function: Callable[P, R], /, *arguments: P.args, **keywords: P.kwargs) -> Future[R]:
        """Send a call to the cluster. ``ClusterStopped``: the cluster cannot go on."""
        if self._reason is not None:
            raise ClusterStopped(self._reason)
        if self._end.is_set():
            raise RuntimeError("cannot send calls to a cluster after its end")
        future: Future[R] = Future()
        remote = self._client.submit(
            with_these_versions, provenance(), function, *arguments, pure=False, **keywords
        )
        with self._lock:
            self._unfinished[future] = remote
        remote.add_done_callback(lambda finished: self._pass_on(finished, future))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the watch, after all calls or at once. Calls that have not ended then are cancelled."""
        while wait and not cancel_futures and self._unfinished:
            time.sleep(0.01)
        self._end.set()
        self._watch.join(LOOK_SECONDS + ANSWER_SECONDS)
        with self._lock:
            unfinished, self._unfinished = self._unfinished, {}
        for future, remote in unfinished.items():
            future.cancel()
            remote.release()

    def _pass_on(self, remote: Any, future: Future[Any]) -> None:
        """Give the outcome of a call of Dask to the future of the caller."""
        with self._lock:
            if self._unfinished.pop(future, None) is None:
                return
        error: BaseException | None
        result = None
        try:
            error = remote.exception()
            if error is None:
                result = remote.result()
        except (asyncio.CancelledError, Exception) as lost:  # noqa: BLE001  (raised, not returned: no answer)
            error = ClusterStopped(self._silent_scheduler(type(lost).__name__))
        try:
            if error is None:
                future.set_result(result)
            else:
                future.set_exception(error)
        except InvalidStateError:  # the caller cancelled the call
            return

    def _threads_now(self) -> dict[str, int]:
        """Threads of each worker by its address. Raises an error of Dask: the scheduler does not answer."""
        threads: Any = self._client.sync(self._client.scheduler.ncores, callback_timeout=ANSWER_SECONDS)
        return dict(threads)

    def _wait_for_first(self) -> dict[str, int]:
        """Wait for the first worker. No worker in the time is refused."""
        end = time.monotonic() + self._wait_seconds
        said = False
        while not (threads := self._threads_now()):
            if not said:
                self._tell(
                    f"{self.address} has no workers yet: waiting for the first for up to "
                    f"{self._wait_seconds:g} s."
                )
                said = True
            if time.monotonic() >= end:
                action = (
                    f"None joined in {self._wait_seconds:g} s: start 'dask worker {self.address} --nthreads "
                    "1', or wait longer."
                )
                raise refuse("cluster", self.address, "a scheduler with a worker", action)
            time.sleep(min(LOOK_SECONDS / 4.0, max(end - time.monotonic(), 0.0)))
        if any(number > 1 for number in threads.values()):
            self._tell(
                f"{self.address} has workers with several threads, and a worker computes one case at a time: "
                "start workers with --nworkers auto, or with --nthreads 1."
            )
        return threads

    def _refuse_other_versions(self) -> None:
        """Refuse a cluster with a worker that does not have the versions of this process."""
        ours = provenance()
        answers = self._client.run(provenance, on_error="return")
        for worker, theirs in answers.items():
            if isinstance(theirs, OSError):  # the worker is gone
                continue
            difference = (
                other_versions(f"The worker {worker}", theirs, ours)
                if isinstance(theirs, Provenance)
                else f"The worker {worker} has no such spurcheck ({type(theirs).__name__}: {theirs}): "
                "install the same code and the same versions there."
            )
            if difference is not None:
                allowed = "workers with the code and the versions of this process"
                raise refuse("cluster", self.address, allowed, difference)

    def _look(self) -> None:
        """Look at the workers again and again, until the end or until the cluster cannot go on."""
        seen = time.monotonic()
        while not self._end.wait(LOOK_SECONDS):
            before = len(self._threads)
            try:
                self._threads = self._threads_now()
            except Exception as error:  # noqa: BLE001  (each transport of Dask has errors of its own)
                self._stop(self._silent_scheduler(type(error).__name__))
                return
            if self._threads:
                seen = time.monotonic()
            elif time.monotonic() - seen >= self._wait_seconds:
                self._stop(
                    f"{self.address} had no worker for {self._wait_seconds:g} s: start workers again, or "
                    "compute on this machine."
                )
                return
            elif before:
                self._tell(
                    f"{self.address} has lost all workers: waiting for another for up to "
                    f"{self._wait_seconds:g} s."
                )

    def _silent_scheduler(self, reason: str) -> str:
        return (
            f"The scheduler {self.address} does not answer any more ({reason}): start it again, or compute "
            "on this machine."
        )

    def _stop(self, reason: str) -> None:
        """End all calls that are not finished, with the reason."""
        self._reason = reason
        with self._lock:
            unfinished, self._unfinished = self._unfinished, {}
        for future in unfinished:
            try:
                future.set_exception(ClusterStopped(reason))
            except InvalidStateError:
                continue
