"""The second process of a report: it computes some shared results while the first process computes others.

The first process owns the list of work and decides who computes what: a result that it needs and that nobody
has begun it computes itself, one that is under way in the second process it waits for. So both end at about
the same time, whatever the pair is. A second process that dies, or a result that cannot be sent, costs time
only: the first process computes what is missing. Both processes compute the same numbers by the same
functions. A limit of processor time is that of the process that computes.

Messages are pickled tuples (kind, name, content) over two pipes. The content is pickled by itself, so that a
result that cannot be read spoils no other message. ``validation.reporting.start`` starts the process.
"""

from __future__ import annotations

import pickle
import threading
import warnings
from collections.abc import Container
from contextlib import suppress
from contextvars import ContextVar
from typing import IO, Any, NamedTuple, Protocol

from lumped.errors import NumericalError
from lumped.typing import Progress

#: What the second process computes, in this order: property of ``Results`` -> properties that it needs first,
#: from either process. What needs the multibody model or Floquet theory is here, so that of most kernels
#: each is loaded, or compiled, by one process alone. In a first report the process begins with a kernel that
#: needs no other one, while the first process compiles those that both need. The chart compiles most of all
#: behind the cross-check, so it comes next. The last two are what the first process takes first where it
#: waits: their kernels are those of the chart.
WORK: dict[str, tuple[str, ...]] = {
    "eigenvalue_kernel": (),
    "check": (),
    "run_on_shafts": (),
    "chart": (),
    "sweep": (),
    "contact_loss_windows": ("sweep", "like_loses_contact"),
    "jump_search": ("contact_loss_windows",),
    "resonance": (),
    "orders_over_speed": (),
    **{f"band_{number}": ("uncertainty",) for number in (1, 2, 3, 4)},
    "teeth_band": ("uncertainty",),
    **{f"teeth_{number}": ("uncertainty", "like_loses_contact") for number in (1, 2)},
    "multipliers": (),
    "proven_stability": (),
}
#: Time after which the first process says again what it waits for [s].
_WAIT = 0.5
#: The second process of the present command.
PRESENT: ContextVar[SecondProcess | None] = ContextVar("present", default=None)


class Message(NamedTuple):
    """A message between both processes.

    ``kind`` from the second process: "ready", "progress", "value", or "nothing" where a result cannot be
    sent. To the second process: "work".
    """

    kind: str
    name: str = ""
    content: bytes = b""


class Answer(NamedTuple):
    """A result of the second process: its value or its error, and the warnings of its computation."""

    value: Any
    error: NumericalError | None
    warnings: tuple[tuple[Warning | str, type[Warning], str, int], ...]


class Started(Protocol):
    """What is used of ``subprocess.Popen``."""

    @property
    def pid(self) -> int:
        """Number of the process."""

    @property
    def stdin(self) -> IO[bytes] | None:
        """Way to the process."""

    @property
    def stdout(self) -> IO[bytes] | None:
        """Way back."""

    def kill(self) -> None:
        """End the process, whatever it does."""

    def wait(self) -> int:
        """Wait for the end of the process."""


class SecondProcess:
    """A second process that computes ``WORK`` for one pair.

    ``process`` has started; it computes from ``begin`` on. ``close`` ends it at any time.
    """

    def __init__(self, process: Started) -> None:
        self._process = process
        self._changed = threading.Condition()
        self._open = dict(WORK)
        self._under_way = ""
        self._answers: dict[str, bytes] = {}
        #: Results that the second process has, and those of the first process that it may need.
        self._there: set[str] = set()
        self._here: dict[str, Any] = {}
        self._stage = (0.0, "")
        self._ended = False
        self._thread: threading.Thread | None = None

    @property
    def process_id(self) -> int:
        """Number of the process."""
        return self._process.pid

    def begin(self, *arguments: Any) -> None:
        """Begin the work with these arguments of ``Results``. Without them, where they cannot be sent."""
        try:
            content = pickle.dumps(arguments)
        except Exception:  # noqa: BLE001  (whatever an object of the user raises; the work is done here)
            self.close()
            return
        self._thread = threading.Thread(target=self._serve, args=(content,), daemon=True)
        self._thread.start()

    def computes(self, name: str) -> bool:
        """Whether the second process computes this result now."""
        with self._changed:
            return self._under_way == name

    def spare(self, have: Container[str]) -> str | None:
        """Return work that nobody has begun, for a first process that waits. None: there is none.

        ``have``: results of the first process. The first process takes work from the end of the list, the
        second from the start.
        """
        with self._changed:
            names = reversed(self._open.items())
            return next((name for name, needs in names if all(need in have for need in needs)), None)

    def fetch(self, name: str, tell: Progress) -> Answer | None:
        """Return a result. None: the caller computes the result itself, and nobody else will.

        While the second process computes the result, the function waits and says what it waits for.
        """
        while True:
            with self._changed:
                if self._under_way != name:
                    self._open.pop(name, None)
                    content = self._answers.pop(name, None)
                    break
                self._changed.wait(_WAIT)
                fraction, stage = self._stage
            tell(fraction, f"{stage or name.replace('_', ' ')}, in the second process")
        if content is None:
            return None
        try:
            return Answer(*pickle.loads(content))
        except Exception:  # noqa: BLE001  (whatever a class raises that cannot be made again)
            return None

    def give(self, name: str, value: Any) -> None:
        """Take a result of the first process. It is sent with the first work that needs it."""
        with self._changed:
            if any(name in needs for needs in self._open.values()):
                self._here[name] = value
                self._changed.notify_all()

    def close(self) -> None:
        """End the process, whatever it does."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        self._process.kill()
        self._process.wait()
        if self._thread is not None:
            self._thread.join()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                with suppress(OSError):  # what was not read at the end
                    stream.close()

    def _serve(self, arguments: bytes) -> None:
        """Hand out the work and take the answers, until the process ends."""
        try:
            self._send(Message("work", "", arguments))
            while self._take(self._received()):
                pass
        except Exception:  # noqa: BLE001  (a process that died in the middle of a message)
            pass
        finally:
            with self._changed:
                self._ended = True
                self._under_way = ""
                self._changed.notify_all()

    def _take(self, message: Message) -> bool:
        """Act on a message. Returns whether there will be another one."""
        if message.kind == "progress":
            self._stage = pickle.loads(message.content)
            return True
        with self._changed:
            if message.kind == "value":
                self._answers[message.name] = message.content
            if message.name:
                self._there.add(message.name)
            self._under_way = ""
            self._changed.notify_all()
        work = self._next()
        self._send(work)
        return bool(work.name)

    def _next(self) -> Message:
        """Choose the next work; wait until it has what it needs. Without a name: there is no more work."""
        with self._changed:
            while not self._ended and self._open:
                have = self._there | set(self._here)
                ready = next((name for name, needs in self._open.items() if have.issuperset(needs)), None)
                if ready is None:
                    self._changed.wait()
                    continue
                sent = {name: self._here.pop(name) for name in self._open.pop(ready) if name in self._here}
                self._there |= set(sent)
                self._under_way = ready
                self._stage = (0.0, "")
                return Message("work", ready, pickle.dumps(sent))
        return Message("work")

    def _send(self, message: Message) -> None:
        stream = self._process.stdin
        assert stream is not None
        pickle.dump(tuple(message), stream)
        stream.flush()

    def _received(self) -> Message:
        stream = self._process.stdout
        assert stream is not None
        return Message(*pickle.load(stream))


def present_process() -> SecondProcess | None:
    """Return the second process of the present command. None: there is none."""
    return PRESENT.get()


def warn_again(answer: Answer) -> None:
    """Give the warnings of a computation of the second process, from their own places in the source."""
    seen: dict[Any, Any] = {}
    for message, category, file, line in answer.warnings:
        warnings.warn_explicit(message, category, file, line, registry=seen)
