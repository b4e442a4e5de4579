"""What runs as the second process of a report, see ``validation.reporting.second_process``."""

from __future__ import annotations

import gc
import os
import pickle
import queue
import signal
import sys
import threading
import time
import warnings
from typing import Any, BinaryIO, NoReturn

from validation.reporting.second_process import Answer, Message

#: Least time between two messages about the progress [s].
_EVERY = 0.25


class Answers:
    """The way back to the first process."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._last = 0.0
        self._fraction = 0.0
        self._compiled = 0

    def send(self, message: Message) -> None:
        """Send a message."""
        pickle.dump(tuple(message), self._stream)
        self._stream.flush()

    def tell(self, fraction: float, stage: str = "", /) -> None:
        """Send the progress of the present work, not too often."""
        self._fraction = fraction
        now = time.monotonic()
        if now - self._last > _EVERY:
            self._last = now
            self.send(Message("progress", "", pickle.dumps((fraction, stage))))

    def notify(self, event: Any) -> None:
        """Take one event of numba: the start or the end of a compilation."""
        self._compiled += event.is_end
        self.tell(self._fraction, f"compiling, once for this machine: {self._compiled} functions")


def answer_of(results: Any, name: str) -> Message:
    """Compute a result. Without a content where its computation fails in a way that the page does not say."""
    from lumped.errors import LawRangeWarning, NumericalError

    error = value = None
    try:
        with warnings.catch_warnings(record=True) as raised:
            warnings.simplefilter("always")
            warnings.simplefilter("ignore", LawRangeWarning)  # as in the first process
            try:
                value = getattr(results, name)
            except NumericalError as failure:
                error = failure
        noted = tuple((one.message, one.category, one.filename, one.lineno) for one in raised)
        return Message("value", name, pickle.dumps(tuple(Answer(value, error, noted))))
    except Exception:  # noqa: BLE001  (the first process computes it again, and says what is wrong)
        return Message("nothing", name)


def _receive(stream: BinaryIO, received: queue.SimpleQueue[Message]) -> None:
    """Read messages. The end of the stream is the end of the first process, and so of this one."""
    try:
        while True:
            received.put(Message(*pickle.load(stream)))
    finally:
        os._exit(0)


def ignore_interrupts() -> None:
    """Ignore Ctrl-C, which goes to both processes: it ends the first one, which ends this one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def serve(work: BinaryIO, to_answers: BinaryIO) -> NoReturn:
    """Compute what the first process asks for, until it says that this is all, or ends."""
    answers = Answers(to_answers)
    received: queue.SimpleQueue[Message] = queue.SimpleQueue()
    threading.Thread(target=_receive, args=(work, received), daemon=True).start()

    from numba.core import event

    from validation.reporting.results import Results

    event.Listener.register(Answers)
    event.register("numba:compile", answers)
    pair, effort, name = pickle.loads(received.get().content)
    results = Results(pair, effort, name, answers.tell)
    answers.send(Message("ready"))
    while (asked := received.get()).name:
        vars(results).update(pickle.loads(asked.content))
        answers.send(answer_of(results, asked.name))
    os._exit(0)  # nothing is left to do; to take libraries down would take time


def main() -> NoReturn:
    """Compute for the process that started this interpreter."""
    ignore_interrupts()
    gc.set_threshold(5_000_000)  # as in the command itself
    to_answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no message
    serve(sys.stdin.buffer, to_answers)


if __name__ == "__main__":
    main()
