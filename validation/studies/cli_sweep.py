"""What ``spurcheck sweep`` shows: progress and summary."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)
from rich.table import Table

from validation.studies.evaluate import MEANINGS
from validation.studies.runner import Summary

_PLAIN_SECONDS = 10.0


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class SweepProgress:
    """Progress with rate and time left: a bar on a terminal, else a line every ten seconds.

    Parameters
    ----------
    console : where
    """

    def __init__(self, console: Console) -> None:
        self._console = console
        self._bar = Progress(
            MofNCompleteColumn(),
            BarColumn(),
            TaskProgressColumn(),
            TextColumn("{task.fields[rate]}, {task.fields[failed]} failed, left"),
            TimeRemainingColumn(),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task("", total=None, rate="", failed=0)
        self._start = self._printed = time.monotonic()
        self._told = ""

    def __call__(self, done: int, total: int, failed: int) -> None:
        """Show how far the sweep is."""
        now = time.monotonic()
        rate = done / max(now - self._start, 1e-9)
        text = f"{rate:.3g} cases/s"
        if self._console.is_terminal:
            self._bar.update(self._task, completed=done, total=total, rate=text, failed=failed)
        elif now - self._printed > _PLAIN_SECONDS:
            self._printed = now
            left = (total - done) / rate
            with suppress(OSError):  # a full disk under a log file must not end the sweep
                self._console.print(f"{done}/{total}, {text}, {failed} failed, {left:.0f} s left")

    def tell(self, text: str) -> None:
        """Say once that something stands still, and again when it is something else."""
        if text != self._told:
            self._told = text
            with suppress(OSError):
                self._console.print(text, soft_wrap=True)

    def __enter__(self) -> Self:
        self._bar.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.__exit__(kind, error, trace)


def print_summary(summary: Summary, console: Console) -> None:
    """Print what a run did: counts by status, failures, the file."""
    table = Table("status", "cases", box=None, pad_edge=False)
    for status, number in summary.statuses:
        table.add_row(MEANINGS[status], str(number))
    console.print(table)
    for case, text in summary.failures:
        first = text.splitlines()[0] if text else ""
        console.print(f"case {case}: {first}", style="red", soft_wrap=True)
    if summary.failed > len(summary.failures):
        more = summary.failed - len(summary.failures)
        console.print(f"... and {more} more: see status in the results")
    if summary.damaged:
        console.print(f"{summary.damaged} damaged batches of the store were skipped, their cases computed")
    rate = summary.computed / max(summary.seconds, 1e-9)
    console.print(
        f"{summary.computed} computed, {summary.before} kept from before, in {summary.seconds:.3g} s "
        f"({rate:.3g} cases/s) -> {summary.results}",
        soft_wrap=True,
    )
