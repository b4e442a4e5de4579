"""Cases with a time limit: a process of its own evaluates them one by one, and ends when one is late.

An alarm in the worker itself would not do: compiled code does not see it, exudyn takes the exception for its
own failure, and threads, on which a Dask worker runs its tasks, get no signals. The watchdog of
``faulthandler`` is a thread without the interpreter's lock, so it ends the process whatever the case does,
also when nobody is left to kill it.
"""

from __future__ import annotations

import atexit
import contextlib
import faulthandler
import os
import pickle
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from typing import IO, Any

from validation.studies.analyses import Evaluator
from validation.studies.axes import AxisValue
from validation.studies.evaluate import evaluate
from validation.studies.record import Record, Status

Cases = Sequence[tuple[int, tuple[AxisValue, ...]]]
#: A process that gets no case for so long ends [s]: a cluster's workers outlive the sweep.
IDLE_SECONDS = 60.0
#: How often a case may end its process before it counts as failed.
MAX_DEATHS = 2
#: Longest time that the watchdog of every system takes [s].
_LONGEST = 4e6
# The same modules as here, whatever lies in the working folder.
_PROGRAM = "import sys; sys.path[:] = {path}; from validation.studies.case_process import serve; serve()"


def evaluate_within(evaluator: Evaluator, cases: Cases, limit: float) -> tuple[Record, ...]:
    """Evaluate cases one after the other, each at most ``limit`` seconds; see ``evaluate``.

    Parameters
    ----------
    evaluator : what to do
    cases : number and values of the axes of each
    limit : longest time of a case [s]; loading the libraries does not count

    Raises
    ------
    RuntimeError : the process does not start
    """
    try:
        process = _IDLE.pop()
    except IndexError:
        process = CaseProcess()
    try:
        process.load(pickle.dumps(evaluator))
        records = tuple(process.run(case, values, limit) for case, values in cases)
    except BaseException:
        process.kill()
        raise
    _IDLE.append(process)
    return records


class CaseProcess:
    """A process that evaluates the cases it is sent."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._evaluator = b""

    def load(self, evaluator: bytes) -> None:
        """Have the pickled evaluator ready."""
        if evaluator != self._evaluator:
            self.kill()
            self._evaluator = evaluator

    def run(self, case: int, values: tuple[AxisValue, ...], limit: float) -> Record:
        """Evaluate a case; its time starts when the process has everything loaded."""
        for _ in range(MAX_DEATHS):
            if self._process is None or self._process.poll() is not None:
                self._start()
            start = time.perf_counter()
            record = self._ask((case, values, limit))
            if isinstance(record, Record):
                return record
            self.kill()
            seconds = time.perf_counter() - start
            if seconds >= limit:
                return Record(case, Status.TIME_LIMIT, seconds, message=f"longer than {limit:g} s")
        text = "the process that evaluates it died on this case, every time"
        return Record(case, Status.WORKER_DIED, seconds, message=text)

    def _start(self) -> None:
        self.kill()
        program = _PROGRAM.format(path=[*sys.path])
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", program],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            process_group=0,  # Ctrl-C is the parent's
        )
        if self._ask(self._evaluator) is None:
            self.kill()
            raise RuntimeError("a process for cases with a time limit does not start")

    def _ask(self, message: object) -> object:
        """Send a message and return the answer, None when the process died before it."""
        assert self._process is not None
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            pickle.dump(message, self._process.stdin)
            self._process.stdin.flush()
            return pickle.load(self._process.stdout)
        except (OSError, EOFError, pickle.UnpicklingError):
            return None

    def kill(self) -> None:
        """End the process."""
        if self._process is None:
            return
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):  # what was not sent cannot be flushed any more
                    pipe.close()
        self._process = None


_IDLE: list[CaseProcess] = []


@atexit.register
def end_idle() -> None:
    """End the processes that wait for cases."""
    while _IDLE:
        _IDLE.pop().kill()


def serve() -> None:
    """Be the process: read messages from the standard input, answer on the standard output."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no answer
    asked = [time.monotonic()]
    threading.Thread(target=_watch, args=(os.getppid(), asked), daemon=True, name="parent watch").start()
    requests, nowhere = sys.stdin.buffer, os.open(os.devnull, os.O_WRONLY)
    evaluator: Evaluator | None = None
    while (message := _received(requests)) is not None:
        asked[:] = []
        if evaluator is None:
            evaluator = pickle.loads(message)
            evaluator.prepare()
            answer: object = True
        else:
            case, values, limit = message
            faulthandler.dump_traceback_later(min(limit, _LONGEST), exit=True, file=nowhere)
            answer = evaluate(evaluator, case, values)
            faulthandler.cancel_dump_traceback_later()
        pickle.dump(answer, answers)
        answers.flush()
        asked[:] = [time.monotonic()]


def _received(requests: IO[bytes]) -> Any:
    try:
        return pickle.load(requests)
    except (EOFError, OSError):  # the parent is gone, or has no more cases
        return None


def _watch(parent: int, asked: list[float]) -> None:
    """End this process with its parent, in the middle of a case too, and when it is not needed any more."""
    while True:
        time.sleep(1.0)
        orphan = os.name == "posix" and os.getppid() != parent
        if orphan or any(time.monotonic() - since > IDLE_SECONDS for since in asked):
            os._exit(0)
