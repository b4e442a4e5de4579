"""An evaluator that worker processes load by name, of which one case does something odd."""

import itertools
import os
import signal
import time
from pathlib import Path


class Odd:
    """An evaluator that does something odd in one case."""

    def __init__(self, inner, what, odd_values):
        self.inner = inner
        self.what = what
        self.odd_values = odd_values
        self.outputs = inner.outputs

    def __call__(self, values):
        if values == self.odd_values:
            getattr(self, self.what)()
        return self.inner(values)

    def compiled_loop(self):  # neither a signal nor another thread gets in here
        sum(itertools.repeat(0, 10**15))

    def is_killed(self):
        os.kill(os.getpid(), signal.SIGKILL)

    def prints(self):
        print("progress of a library", flush=True)
        os.write(1, b"and of its compiled part")


class Slow:
    """An evaluator that takes its time, and notes in a folder which processes computed cases.

    With ``processes`` a case waits until so many processes have begun a case, for half a minute at most.
    """

    def __init__(self, inner, folder, seconds=0.01, processes=1):
        self.inner = inner
        self.folder = folder
        self.seconds = seconds
        self.processes = processes
        self.outputs = inner.outputs

    def __call__(self, values):
        Path(self.folder, str(os.getpid())).touch()
        time.sleep(self.seconds)
        for _ in range(300):
            if len(os.listdir(self.folder)) >= self.processes:
                break
            time.sleep(0.1)
        return self.inner(values)
