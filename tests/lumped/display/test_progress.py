"""Does ``progress`` draw a bar where a person wants one, no bar elsewhere, and call a function as before?"""

from __future__ import annotations

import inspect
import io
import multiprocessing
import sys
import time
import types

import numpy as np
import pytest
from typer.testing import CliRunner

import lumped
from lumped.display import progress
from lumped.display.progress import DelayedBar, LineBar, NotebookBar, shows_progress
from lumped.errors import ParameterError
from lumped.typing import ProgressRequest
from tests.meta.calls import PUBLIC
from tests.unlike_pairs import unlike_pair
from validation.cli import app


class Recorded:
    """A bar that records what is drawn."""

    bars: list[Recorded]

    def __init__(self, words: str) -> None:
        self.words = words
        self.drawn: list[tuple[float | None, str]] = []
        self.state = "made"
        type(self).bars.append(self)

    def start(self) -> None:
        self.state = "started"

    def update(self, fraction: float | None, stage: str) -> None:
        assert self.state == "started"
        self.drawn.append((fraction, stage))

    def stop(self) -> None:
        self.state = "stopped"


@pytest.fixture
def bars(monkeypatch: pytest.MonkeyPatch) -> list[Recorded]:
    """All bars of a test, on a screen that a person watches."""
    Recorded.bars = []
    monkeypatch.setattr(progress, "bar_for", Recorded)
    monkeypatch.setattr(progress, "_watched", lambda: True)
    monkeypatch.setattr(progress, "DELAY", 0.05)
    return Recorded.bars


@shows_progress("work")
def work(seconds: float, *, progress: ProgressRequest = None) -> str:
    """Report a half, then wait."""
    if callable(progress):
        progress(0.5, "second half")
    time.sleep(seconds)
    if callable(progress):
        progress(1.0)
    return "done"


def test_true_draws_a_bar_at_once_to_its_end(bars: list[Recorded]) -> None:
    pair = unlike_pair("rack_25_degrees_always_pushing")
    lumped.speed_sweep(pair, np.linspace(1000.0, 1500.0, 6), progress=True)
    (bar,) = bars
    fractions = [fraction for fraction, _ in bar.drawn if fraction is not None]
    assert bar.words == "speed sweep"
    assert bar.state == "stopped"
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    assert len(fractions) > 1


def test_the_default_waits_and_draws_also_in_a_silent_step(bars: list[Recorded]) -> None:
    assert work(0.0) == "done"
    assert [bar.drawn for bar in bars] == [[]]
    assert work(0.3) == "done"
    assert bars[1].drawn[0] == (0.5, "second half")
    assert bars[1].state == "stopped"


def test_false_draws_nothing_and_nobody_watches_nothing(
    bars: list[Recorded], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert work(0.1, progress=False) == "done"
    monkeypatch.setattr(progress, "_watched", lambda: False)
    assert work(0.1) == "done"
    assert bars == []


def test_a_function_is_called_as_before(bars: list[Recorded]) -> None:
    calls: list[tuple[float, str]] = []
    work(0.1, progress=lambda fraction, stage="": calls.append((fraction, stage)))
    assert calls == [(0.5, "second half"), (1.0, "")]
    assert bars == []


def test_an_inner_call_draws_no_bar_of_its_own(bars: list[Recorded]) -> None:
    @shows_progress("outer")
    def outer(*, progress: ProgressRequest = None) -> None:
        work(0.2)

    outer()
    assert [bar.words for bar in bars] == ["outer"]


def test_an_error_ends_the_bar(bars: list[Recorded]) -> None:
    with pytest.raises(ParameterError):
        lumped.speed_sweep(unlike_pair("rack_25_degrees_always_pushing"), [-5.0], progress=True)
    assert [bar.state for bar in bars] == ["stopped"]


@pytest.mark.parametrize(
    "name", [name for name, one in PUBLIC.items() if "progress" in inspect.signature(one).parameters]
)
def test_every_function_with_progress_takes_true_and_false(name: str) -> None:
    """What is neither is refused before the work begins, so the decorator is there."""
    with pytest.raises(ParameterError, match="progress = yes: allowed True"):
        PUBLIC[name](progress="yes")


def test_a_command_draws_its_own_bar_alone(bars: list[Recorded]) -> None:
    assert CliRunner().invoke(app, ["uncertainty", "nasa_28_28", "--samples", "16"]).exit_code == 0
    assert bars == []


def test_a_worker_process_is_not_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", types.SimpleNamespace(isatty=lambda: True))
    assert progress._watched()
    monkeypatch.setattr(multiprocessing, "parent_process", lambda: "parent")
    assert not progress._watched()


def test_a_log_gets_one_line_a_tenth(capsys: pytest.CaptureFixture[str]) -> None:
    with DelayedBar(LineBar("sweep"), 0.0) as tell:
        for step in range(101):
            tell(step / 100)
    lines = capsys.readouterr().err.splitlines()
    assert lines == [f"sweep: {10 * tenth} %" for tenth in range(11)]


def test_a_terminal_gets_the_bar_of_the_commands(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("TERM", "xterm")
    work(0.2, progress=True)
    assert "second half" in screen.getvalue()


def test_a_notebook_gets_html_that_disappears(monkeypatch: pytest.MonkeyPatch) -> None:
    pages: list[str] = []

    class Handle:
        def update(self, page: str) -> None:
            pages.append(page)

    def display(page: str, *, display_id: bool) -> Handle:
        assert display_id
        pages.append(page)
        return Handle()

    ipython = types.ModuleType("IPython")
    ipython.get_ipython = lambda: types.SimpleNamespace(kernel="kernel")  # type: ignore[attr-defined]
    shown = types.ModuleType("IPython.display")
    shown.display = display  # type: ignore[attr-defined]
    shown.HTML = str  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", shown)
    assert progress.in_notebook()
    assert isinstance(progress.bar_for("work"), NotebookBar)
    work(0.0, progress=True)
    assert pages[0].startswith("<progress")
    assert "value" not in pages[0]
    assert any('value="0.5000"' in page and "second half 50 %" in page for page in pages)
    assert pages[-1] == ""
