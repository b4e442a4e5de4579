"""A limit of processor time for a search.

A search asks its deadline between short pieces of work. Motions found before the deadline are as exact as
without a limit. The search names the ranges that it did not search.
"""

from __future__ import annotations

import math
import time


class OutOfTimeError(Exception):
    """The processor time of a search is used up.

    The error never reaches a user: the result of the search has the open speeds.
    """


class Deadline:
    """Processor time of this process from now on.

    Parameters
    ----------
    seconds : how much [s]; None: without limit
    """

    def __init__(self, seconds: float | None = None) -> None:
        self._start = time.process_time()
        self._end = math.inf if seconds is None else self._start + seconds

    @property
    def used(self) -> float:
        """Processor time since the deadline was set [s]."""
        return time.process_time() - self._start

    @property
    def limited(self) -> bool:
        """Whether there is a limit."""
        return math.isfinite(self._end)

    @property
    def left(self) -> float:
        """Remaining processor time [s], at least 0; infinite without limit."""
        return max(self._end - time.process_time(), 0.0) if self.limited else math.inf

    @property
    def passed(self) -> bool:
        """Whether no time remains."""
        return self.left == 0.0

    def check(self) -> None:
        """Raise OutOfTimeError where no time remains."""
        if self.passed:
            raise OutOfTimeError

    def share(self, part: float) -> Deadline:
        """A new deadline after a part of the remaining time."""
        return Deadline(part * self.left if self.limited else None)


#: Without limit.
ENDLESS = Deadline()
