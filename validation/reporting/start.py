"""How the second process of a report starts: as a fork of the first process, or as a new interpreter.

A fork has all libraries that the first process has imported, for which a new interpreter needs more than a
second. A lock that another thread holds during a fork stays closed in the fork for ever. So the fork comes
after the imports, and before the progress bar and everything else that starts a thread; threads of OpenBLAS
end by themselves before a fork. Elsewhere than on Linux libraries of the system may not work in a fork.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import IO, NoReturn

from lumped.cache import cores
from validation.reporting.second_process import PRESENT, SecondProcess, Started
from validation.reporting.worker import ignore_interrupts, serve
from validation.stop_signals import stop_signals

#: Whether the second process is a fork.
FORKS = sys.platform == "linux"


@contextmanager
def second_process() -> Iterator[None]:
    """Let reports in the block use a second process, where there are two processors."""
    process = None
    if cores() > 1:
        with suppress(OSError):  # no process can be started
            process = SecondProcess(started())
    token = PRESENT.set(process)
    try:
        yield
    finally:
        PRESENT.reset(token)
        if process is not None:
            process.close()


def started() -> Started:
    """Start ``validation.reporting.worker``. OSError: no process can be started."""
    if FORKS:
        import_module("validation.reporting.build")  # what both processes need
        return Fork()
    # -P: a folder of the user cannot replace a package of the same name.
    command = [sys.executable, "-P", "-m", "validation.reporting.worker"]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL)


class Fork:
    """A fork of this process, in which ``validation.reporting.worker`` computes."""

    def __init__(self) -> None:
        work, to_work = os.pipe()
        answers, to_answers = os.pipe()
        # A signal waits until the fork ignores it, else its KeyboardInterrupt would end the command twice.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, stop_signals())
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 counts threads of OpenBLAS
                self.pid = os.fork()
            if self.pid == 0:
                _run(work, to_answers, not_ours=(to_work, answers))
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        os.close(work)
        os.close(to_answers)
        self.stdin: IO[bytes] | None = os.fdopen(to_work, "wb")
        self.stdout: IO[bytes] | None = os.fdopen(answers, "rb")
        self._code: int | None = None

    def kill(self) -> None:
        """End the process, whatever it does."""
        if self._code is None:
            with suppress(ProcessLookupError):
                os.kill(self.pid, signal.SIGKILL)

    def wait(self) -> int:
        """Wait for the end of the process. Returns what ``os.waitpid`` says."""
        if self._code is None:
            self._code = os.waitpid(self.pid, 0)[1]
        return self._code


def _run(work: int, to_answers: int, not_ours: tuple[int, int]) -> NoReturn:
    """Compute in the fork. Nothing of the first process goes on here, whatever happens.

    ``not_ours``: ends of the first process; open here too they would hide its end.
    """
    try:
        ignore_interrupts()
        signal.pthread_sigmask(signal.SIG_UNBLOCK, stop_signals())
        for one in not_ours:
            os.close(one)
        nowhere = os.open(os.devnull, os.O_RDWR)
        for standard in range(3):
            os.dup2(nowhere, standard)
        sys.stdout = sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115  (to its end)
        serve(os.fdopen(work, "rb"), os.fdopen(to_answers, "wb"))
    finally:
        os._exit(1)
