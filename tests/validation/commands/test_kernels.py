"""Does a long command compile in two processes, and say what it does?"""

from __future__ import annotations

import subprocess
import sys
from types import SimpleNamespace

import pytest

import multibody
from lumped import load_gear_pair
from multibody.contact.kernels import tooth_forces
from multibody.run.integration import bridge
from validation.commands import kernels


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[subprocess.Popen[bytes]]:
    """Second processes, which do nothing here."""
    made: list[subprocess.Popen[bytes]] = []

    def start() -> subprocess.Popen[bytes]:
        made.append(subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"]))
        return made[-1]

    monkeypatch.setattr(kernels, "_start", start)
    return made


@pytest.mark.parametrize(("processors", "stored", "count"), [(2, False, 1), (1, False, 0), (2, True, 0)])
def test_a_second_process_compiles_while_the_command_runs(
    processors: int,
    stored: bool,
    count: int,
    started: list[subprocess.Popen[bytes]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("lumped.cache.cores", lambda: processors)
    monkeypatch.setattr(kernels, "_all_stored", lambda: stored)
    with kernels.compiling(lambda fraction, stage="", /: None):
        assert len(started) == count
        assert all(process.poll() is None for process in started)
    assert all(process.poll() is not None for process in started)


def test_what_is_compiled_is_told_and_the_fraction_stays() -> None:
    announced: list[tuple[float, str]] = []
    listener = kernels._Listener(lambda fraction, stage="", /: announced.append((fraction, stage)))
    listener.tell(0.3, "motion")
    for start in (True, True, False, False):
        listener.notify(SimpleNamespace(is_start=start, is_end=not start))
    assert {fraction for fraction, _ in announced} == {0.3}
    assert announced[-1][1] == "compiling, once for this machine, for a minute: 2 functions"


def test_the_second_process_compiles_what_runs_of_any_pair_take() -> None:
    kernels.main()
    compiled = (bridge, tooth_forces)
    before = [len(kernel.signatures) for kernel in compiled]
    pair = load_gear_pair("fzg_c").with_({"mesh.contact": "loaded"})
    multibody.simulate(pair, 1)
    assert before == [1, 1] == [len(kernel.signatures) for kernel in compiled]
    assert kernels._all_stored()
