"""Evaluators that worker processes load by name, of which one case does something odd."""

from __future__ import annotations

import contextlib
import itertools
import os
import signal
import time
from pathlib import Path

from validation.studies import evaluate


class Odd:
    """An evaluator that does something odd in one case.

    Parameters
    ----------
    inner : evaluator of the other cases
    what : name of a method
    at : values of the odd case
    note : file that gets the process number at each odd case
    """

    nan_allowed = False

    def __init__(self, inner, what, at, note=""):
        self.inner, self.what, self.at, self.note = inner, what, at, note
        self.outputs = inner.outputs

    def prepare(self):
        if self.what == "cannot_load":
            raise ImportError("no such analysis")

    def __call__(self, values):
        if values == self.at:
            if self.note:
                with open(self.note, "a") as file:
                    file.write(f"{os.getpid()} ")
            getattr(self, self.what)()
        return self.inner(values)

    def times(self):
        return len(Path(self.note).read_text().split())

    def compiled_loop(self):  # neither a signal nor another thread gets in here
        sum(itertools.repeat(0, 10**15))

    def swallows_everything(self):
        while True:
            with contextlib.suppress(BaseException):
                time.sleep(1.0)

    def crashes(self):
        os.kill(os.getpid(), signal.SIGSEGV)

    def is_killed(self):
        os.kill(os.getpid(), signal.SIGKILL)

    def dies_once(self):
        if self.times() == 1:
            os._exit(3)

    def stands_still_once(self):
        if self.times() == 1:
            os.kill(os.getpid(), signal.SIGSTOP)

    def prints(self):
        print("progress of a library", flush=True)
        os.write(1, b"and of its compiled part")


class Orphan(Odd):
    """An odd evaluator; the worker that loads it waits half a second for whoever ends a late case."""

    def __setstate__(self, state):
        self.__dict__.update(state)
        evaluate._ORPHAN_SECONDS = 0.5
