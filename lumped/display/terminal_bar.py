"""The progress bar on a terminal: what is computed, how long nothing has changed, and the finished part."""

from __future__ import annotations

import time
from collections.abc import Callable

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TimeElapsedColumn
from rich.table import Column
from rich.text import Text

#: Standstill from which the bar says how long the present step takes [s].
_LONG = 1


class StageColumn(ProgressColumn):
    """Name of the present step. Behind the name: the seconds in which neither name nor finished part changed.

    Some steps cannot say how far they are: a library is imported, a kernel is compiled, or another process
    compiles it. The seconds show that the program works.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__(Column(no_wrap=True))
        self._clock = clock
        self._last = ("", 0.0)
        self._since = clock()

    def render(self, task: Task) -> Text:
        """Return the text of the column. rich calls this ten times in a second, from a thread."""
        present = task.description, task.completed
        if present != self._last:
            self._last = present
            self._since = self._clock()
        seconds = int(self._clock() - self._since)
        return Text(task.description if seconds < _LONG else f"{task.description} ({seconds} s)")


def bar_of_stages(console: Console, *, moving: bool = True) -> Progress:
    """Return a progress bar on a console. Nothing is drawn on a console that is no terminal.

    A bar that is not ``moving`` is drawn when it changes, and has no thread.
    """
    return Progress(
        StageColumn(),
        BarColumn(),
        TimeElapsedColumn(),
        console=console,
        transient=True,
        auto_refresh=moving,
        disable=not console.is_terminal,
    )
