"""Signals that stop the program: Ctrl-C, SIGTERM of batch systems, SIGHUP of a closed terminal."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_NAMES = ("SIGINT", "SIGTERM", "SIGHUP")
_OURS = (signal.SIG_DFL, signal.default_int_handler)


def _signals() -> list[signal.Signals]:
    """Return the signals for which this thread can set a handler. Empty outside the main thread."""
    if threading.current_thread() is not threading.main_thread() or os.name != "posix":
        return []
    return [signal.Signals[name] for name in _NAMES]


def interrupt_once() -> dict[signal.Signals, Any]:
    """Let the first signal raise KeyboardInterrupt and ignore later signals.

    Signals that nohup, a shell or the caller handles are left alone. Returns signal -> earlier handler.
    """
    before = {number: signal.getsignal(number) for number in _signals()}
    before = {number: handler for number, handler in before.items() if handler in _OURS}

    def stop(number: int, frame: FrameType | None) -> None:
        for each in before:
            signal.signal(each, signal.SIG_IGN)
        raise KeyboardInterrupt

    for number in before:
        signal.signal(number, stop)
    return before


@contextmanager
def stopping_as_interrupt() -> Iterator[None]:
    """Let the first signal in the block raise KeyboardInterrupt. Later signals in the block are ignored."""
    before = interrupt_once()
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
