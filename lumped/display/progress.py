"""The argument ``progress`` of public functions: a bar, no bar, or a function of the caller.

``True``: a bar at once. ``None``, the default: a bar once the call has taken two seconds, where a person
watches: on a terminal or in a notebook. ``False``: no bar. A function is called with the finished fraction.
A function that is called by another one with this argument draws no bar of its own accord.
"""

from __future__ import annotations

import functools
import inspect
import multiprocessing
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from importlib import import_module
from typing import Any, ParamSpec, Protocol, TypeVar

from lumped.errors import refuse
from lumped.typing import Progress, ProgressRequest

P = ParamSpec("P")
R = TypeVar("R")
#: Time of a call after which the default draws a bar [s].
DELAY = 2.0
#: Whether the present call is part of a call that draws a bar, or of a command with its own bar.
_inside: ContextVar[bool] = ContextVar("inside", default=False)


class Bar(Protocol):
    """A bar that can be drawn. ``fraction`` is None where a computation cannot say how far it is."""

    def start(self) -> None:
        """Draw the bar."""

    def update(self, fraction: float | None, stage: str) -> None:
        """Draw the finished fraction, and what is being done."""

    def stop(self) -> None:
        """Remove the bar, or end its line."""


class TerminalBar:
    """A bar on the terminal of stderr. The bar disappears at the end."""

    def __init__(self, words: str) -> None:
        from rich.console import Console

        from lumped.display.terminal_bar import bar_of_stages

        self._words = words
        self._bar = bar_of_stages(Console(stderr=True))
        self._task = self._bar.add_task(words, total=None)

    def start(self) -> None:
        """Draw the bar."""
        self._bar.start()

    def update(self, fraction: float | None, stage: str) -> None:
        """Draw the finished fraction, and what is being done."""
        if fraction is not None:
            self._bar.update(self._task, total=1.0, completed=fraction, description=stage or self._words)

    def stop(self) -> None:
        """Remove the bar."""
        self._bar.stop()


class NotebookBar:
    """A bar below the cell of a notebook. The bar disappears at the end."""

    def __init__(self, words: str) -> None:
        self._words = words
        self._ipython: Any = None
        self._display: Any = None

    def start(self) -> None:
        """Draw the bar."""
        self._ipython = import_module("IPython.display")
        self._display = self._ipython.display(self._ipython.HTML(self.html(None, "")), display_id=True)

    def update(self, fraction: float | None, stage: str) -> None:
        """Draw the finished fraction, and what is being done."""
        self._display.update(self._ipython.HTML(self.html(fraction, stage)))

    def stop(self) -> None:
        """Remove the bar."""
        self._display.update(self._ipython.HTML(""))

    def html(self, fraction: float | None, stage: str) -> str:
        """Return the bar as HTML. A bar without a value moves by itself in a browser."""
        value = "" if fraction is None else f' value="{fraction:.4f}"'
        percent = "" if fraction is None else f" {100.0 * fraction:.0f} %"
        return f'<progress max="1"{value} style="width:300px"></progress> {stage or self._words}{percent}'


class LineBar:
    """Lines on a stderr that is no terminal, one each tenth: for the log of a job."""

    def __init__(self, words: str) -> None:
        self._words = words
        self._tenth = -1

    def start(self) -> None:
        """Print nothing: the first fraction begins."""

    def update(self, fraction: float | None, stage: str) -> None:
        """Print a line if another tenth is finished."""
        tenth = -1 if fraction is None else int(10.0 * fraction + 1e-9)
        if tenth > self._tenth:
            self._tenth = tenth
            print(f"{stage or self._words}: {10 * tenth} %", file=sys.stderr, flush=True)

    def stop(self) -> None:
        """Print nothing: the last fraction has ended the lines."""


class DelayedBar:
    """A bar that is drawn after a delay. A thread draws it, because a step may not report for a long time."""

    def __init__(self, bar: Bar, delay: float) -> None:
        self._bar = bar
        self._delay = delay
        self._lock = threading.Lock()
        self._fraction: float | None = None
        self._stage = ""
        self._is_drawn = False
        self._timer = threading.Timer(delay, self._draw)
        self._timer.daemon = True

    def __enter__(self) -> Progress:
        if self._delay > 0.0:
            self._timer.start()
        else:
            self._draw()
        return self._tell

    def __exit__(self, *_: object) -> None:
        self._timer.cancel()
        with self._lock:
            if self._is_drawn:
                self._bar.stop()
            self._is_drawn = True  # a timer that fires now draws nothing

    def _draw(self) -> None:
        with self._lock:
            if not self._is_drawn:
                self._is_drawn = True
                self._bar.start()
                self._bar.update(self._fraction, self._stage)

    def _tell(self, fraction: float, stage: str = "", /) -> None:
        with self._lock:
            self._fraction = min(max(fraction, 0.0), 1.0)
            self._stage = stage
            if self._is_drawn:
                self._bar.update(self._fraction, stage)


def in_notebook() -> bool:
    """Return whether the program runs in a notebook, whose kernel shows HTML."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return getattr(shell, "kernel", None) is not None


def _watched() -> bool:
    """Whether a person watches stderr of this process. Nobody watches a worker process."""
    is_worker = multiprocessing.parent_process() is not None
    return not is_worker and (in_notebook() or (sys.stderr is not None and sys.stderr.isatty()))


def bar_for(words: str) -> Bar:
    """Return the bar that suits the place where the program runs."""
    if in_notebook():
        return NotebookBar(words)
    return TerminalBar(words) if sys.stderr is not None and sys.stderr.isatty() else LineBar(words)


@contextmanager
def without_bars() -> Iterator[None]:
    """Let no function draw a bar of its own accord while the block runs."""
    before = _inside.set(True)
    try:
        yield
    finally:
        _inside.reset(before)


def shows_progress(words: str, *, counts: bool = False) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Return a decorator for functions whose argument ``progress`` may be True, False, None or a function.

    Parameters
    ----------
    words : what the bar says where the function names no stage
    counts : whether the function reports (computed, to compute, failed) in place of a fraction
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        @functools.wraps(function)
        def call(*args: P.args, **kwargs: P.kwargs) -> R:
            request = kwargs.get("progress")
            if not (request is None or isinstance(request, bool) or callable(request)):
                allowed = "True (a bar), False (none), None, or a function of the finished fraction"
                raise refuse("progress", request, allowed, "Give one of these.")
            is_drawn = request is True or (request is None and not _inside.get() and _watched())
            with without_bars():
                if not is_drawn:
                    return function(*args, **kwargs)
                with DelayedBar(bar_for(words), 0.0 if request else DELAY) as tell:
                    kwargs["progress"] = _of_counts(tell) if counts else tell
                    return function(*args, **kwargs)

        signature = inspect.signature(function)
        assert signature.parameters["progress"].kind is inspect.Parameter.KEYWORD_ONLY
        return call

    return decorate


def _of_counts(tell: Progress) -> Callable[[int, int, int], None]:
    def report(computed: int, to_compute: int, failed: int) -> None:
        words = f"{computed} of {to_compute} cases" + (f", {failed} failed" if failed else "")
        tell(computed / max(to_compute, 1), words)

    return report


def reported_to(progress: ProgressRequest) -> Progress | None:
    """Return the function to call with the finished fraction; None: nobody asks.

    ``shows_progress`` has replaced True before.
    """
    return progress if callable(progress) else None
