"""Does the progress bar change all the time, in a step too that cannot say how far it is?"""

from __future__ import annotations

import io
import itertools
import time

import pytest
from rich.progress import Progress
from rich.text import Text

from lumped.display import terminal_bar
from validation.commands import terminal
from validation.commands.terminal import PlainConsole, progress_bar


def test_a_step_says_how_long_nothing_has_changed() -> None:
    now = [100.0]
    bar = Progress(terminal_bar.StageColumn(lambda: now[0]), disable=True)
    task = bar.add_task("report", total=1.0)
    column = bar.columns[0]

    def shown() -> str:
        text = column(bar.tasks[0])  # type: ignore[operator]
        assert isinstance(text, Text)
        return text.plain

    assert shown() == "report"
    bar.update(task, completed=0.4, description="stability chart")
    texts = []
    for _ in range(5):
        texts.append(shown())
        now[0] += 1.0
    assert texts == ["stability chart", *(f"stability chart ({seconds} s)" for seconds in (1, 2, 3, 4))]
    bar.update(task, completed=0.5, description="stability chart")
    assert shown() == "stability chart"
    now[0] += 2.5
    assert shown() == "stability chart (2 s)"


def test_the_bar_on_a_terminal_is_drawn_anew_while_the_program_is_silent(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The times at which the terminal gets text, while the block waits in one step for three seconds."""
    written: list[float] = []

    class Terminal(io.StringIO):
        def write(self, text: str) -> int:
            written.append(time.monotonic())
            return super().write(text)

    screen = Terminal()
    monkeypatch.setattr(
        terminal, "stderr", lambda: PlainConsole(file=screen, force_terminal=True, width=100, quiet=False)
    )
    start = time.monotonic()
    with progress_bar("report") as tell:
        tell(0.3, "stability chart")
        time.sleep(3.2)
        end = time.monotonic()
    times = [start, *(one for one in written if one < end), end]
    assert max(later - earlier for earlier, later in itertools.pairwise(times)) < 1.5
    assert "stability chart (2 s)" in screen.getvalue()


def test_without_a_terminal_nothing_is_drawn(capfd: pytest.CaptureFixture[str]) -> None:
    with terminal.progress_bar("report") as tell:
        tell(0.3, "stability chart")
    assert capfd.readouterr() == ("", "")
