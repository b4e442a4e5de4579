"""Signals that stop the program: Ctrl-C, SIGTERM of batch systems, SIGHUP of a closed terminal.

The first signal raises KeyboardInterrupt, which does not arrive by itself everywhere:

- numba looks for no errors while it makes Python objects of the results of compiled code, and the process
  crashes. Most signals arrive in compiled code, and Python handles them in the first function behind it.
- In a function that a library in C calls, and in ``__del__``, Python prints the error and goes on.
- A library makes another error of it: exudyn an ImportError of its import.

And numba's compiler, stopped in its work, leaves parts of a kernel with two owners. Both would free them when
Python takes its modules down at the end, and the process would crash.
"""

from __future__ import annotations

import atexit
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from types import FrameType
from typing import Any

_NAMES = ("SIGINT", "SIGTERM", "SIGHUP")
_OURS = (signal.SIG_DFL, signal.default_int_handler)
#: Whether a signal has stopped the program, since the last call of ``interrupt_once``.
_stopped = threading.Event()
#: The error that ends a stopped process, with all objects on its way, which would be freed without it.
_kept: list[BaseException] = []


def stop_signals() -> list[signal.Signals]:
    """Return the signals for which this thread can set a handler. Empty outside the main thread."""
    if threading.current_thread() is not threading.main_thread() or os.name != "posix":
        return []
    return [signal.Signals[name] for name in _NAMES]


def interrupt_once() -> dict[signal.Signals, Any]:
    """Let the first signal raise KeyboardInterrupt and ignore later signals.

    Signals that nohup, a shell or the caller handles are left alone. Returns signal -> earlier handler.
    """
    before = {number: signal.getsignal(number) for number in stop_signals()}
    before = {number: handler for number, handler in before.items() if handler in _OURS}
    _stopped.clear()

    def stop(number: int, frame: FrameType | None) -> None:
        for each in before:
            signal.signal(each, signal.SIG_IGN)
        _stopped.set()
        sys.unraisablehook = partial(_ignored, sys.unraisablehook)
        if _makes_results(frame):
            sys.setprofile(_interrupt_behind)  # called at the next call or return of a function
        else:
            raise KeyboardInterrupt

    for number in before:
        signal.signal(number, stop)
    return before


def _makes_results(frame: FrameType | None) -> bool:
    """Whether numba makes Python objects of results: it reads a stored class, or calls that of a record."""
    if frame is not None and (frame.f_code.co_filename, frame.f_code.co_name) == ("<string>", "<lambda>"):
        return True  # the constructor of a NamedTuple
    while frame is not None:
        if frame.f_code.co_name == "_numba_unpickle":
            return True
        frame = frame.f_back
    return False


def _ignored(earlier: Callable[[Any], object], unraisable: Any, /) -> None:
    """Raise a KeyboardInterrupt again that Python ignored. Takes what ``sys.unraisablehook`` takes."""
    if isinstance(unraisable.exc_value, KeyboardInterrupt):
        sys.setprofile(_interrupt_behind)
    else:
        earlier(unraisable)


def _interrupt_behind(frame: FrameType, event: str, argument: Any) -> None:
    """Raise KeyboardInterrupt in the first function where it arrives."""
    if frame.f_code is not _ignored.__code__ and not _makes_results(frame):
        sys.setprofile(None)
        raise KeyboardInterrupt


@contextmanager
def interruption_kept(*but: type[Exception]) -> Iterator[None]:
    """Raise KeyboardInterrupt where the block raises another error after a signal.

    ``but``: errors by which the block ends when it has said itself that it was interrupted.
    """
    try:
        yield
    except Exception as error:
        if _stopped.is_set() and not isinstance(error, but):
            raise KeyboardInterrupt from None
        raise


@contextmanager
def ended_at_once() -> Iterator[None]:
    """Let a process that a signal stops in the block end without taking its modules down.

    Functions that the block gives to ``atexit`` still run. The exit code is that of the ``SystemExit`` in
    which the block ends, or 130.
    """
    code = 128 + signal.SIGINT

    def end() -> None:
        for stream in (sys.stdout, sys.stderr):
            with suppress(Exception):  # closed, or a pipe that nobody reads
                stream.flush()
        os._exit(code)

    atexit.register(end)  # before all others, so that it is called last
    try:
        yield
    except BaseException as error:
        if isinstance(error, SystemExit):
            code = error.code if isinstance(error.code, int) else int(error.code is not None)
        if _stopped.is_set():
            _kept.append(error)
        raise
    finally:
        if not _stopped.is_set():
            atexit.unregister(end)


@contextmanager
def stopping_as_interrupt() -> Iterator[None]:
    """Let the first signal in the block raise KeyboardInterrupt. Later signals in the block are ignored."""
    before = interrupt_once()
    hook = sys.unraisablehook
    try:
        yield
    finally:
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)
