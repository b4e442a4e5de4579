"""Does a second process change nothing but the time, and end with the first one?"""

import json
import os
import pickle
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import pytest

from lumped.errors import NumericalError, refuse
from tests.validation.reporting.written import PAIRS, SMALL
from validation.reporting import build, start, worker
from validation.reporting import results as of_results
from validation.reporting.results import Results
from validation.reporting.second_process import (
    WORK,
    Answer,
    Message,
    SecondProcess,
    present_process,
    warn_again,
)
from validation.reporting.start import second_process

#: Longest wait for a process on a busy machine [s].
PATIENCE = 120.0


@pytest.fixture(params=[True, False], ids=["fork", "interpreter"])
def two_processors(request, monkeypatch):
    """Two processors, and a second process of either kind."""
    if request.param and not hasattr(os, "fork"):
        pytest.skip("no forks here")
    monkeypatch.setattr(start, "FORKS", request.param)
    monkeypatch.setattr("validation.reporting.start.cores", lambda: 2)


def until(happens) -> None:
    end = time.monotonic() + PATIENCE
    while not happens():
        assert time.monotonic() < end
        time.sleep(0.02)


def is_alive(process_id: int) -> bool:
    """Whether a process runs. One that ended and waits for its parent's question does not."""
    try:
        return Path(f"/proc/{process_id}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def without_times(folder: Path) -> dict:
    document = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    del document["timestamps"]
    return document


def test_two_processes_write_the_numbers_of_one(tmp_path, monkeypatch, two_processors):
    monkeypatch.setattr(build, "FULL", SMALL)
    monkeypatch.setattr("validation.plots.style.save", lambda figure, path, new: path.write_bytes(b"<svg/>"))
    taken = []
    monkeypatch.setattr(of_results, "warn_again", lambda answer: (taken.append(answer), warn_again(answer)))
    build.report(PAIRS["lost"](), tmp_path / "one", name="lost")
    assert not taken
    with second_process():
        process = present_process()

        def wait(*_):
            """Where this process is faster than the start of the other one, that one has nothing to do."""
            until(lambda: any(map(process.computes, WORK)))

        build.report(PAIRS["lost"](), tmp_path / "two", name="lost", early=wait)
    assert taken
    assert without_times(tmp_path / "two") == without_times(tmp_path / "one")
    for path in (tmp_path / "one" / "tables").glob("*.csv"):
        assert (tmp_path / "two" / "tables" / path.name).read_bytes() == path.read_bytes()


def test_a_second_process_that_dies_costs_time_only(two_processors):
    stages = []
    with second_process():
        process = present_process()
        results = Results(PAIRS["calm"](), SMALL, "calm", process=process)
        until(lambda: process.computes("check"))

        def kill(fraction, stage="", /):
            stages.append(stage)
            os.kill(process.process_id, signal.SIGKILL)

        assert process.fetch("check", kill) is None
        assert stages
        assert all(stage.endswith("in the second process") for stage in stages)
        assert results.resonance is not None
        assert results.orders_over_speed.sizes["speed_rpm"] == SMALL.orders_speeds


def test_arguments_that_cannot_be_sent_leave_one_process(two_processors):
    with second_process():
        process = present_process()
        process.begin(lambda: None)
        assert not is_alive(process.process_id)
        assert process.fetch("check", lambda *_: None) is None


class Failing:
    """Results of which each ends in another way."""

    @property
    def value(self) -> float:
        warnings.warn("a doubt", stacklevel=1)
        return 0.1

    @property
    def failure(self) -> float:
        raise NumericalError("no motion")

    @property
    def refusal(self) -> float:
        raise refuse("field", 1.0, "2", "Write 2.")

    @property
    def unsent(self) -> object:
        return lambda: None


def answered(name: str) -> Answer:
    message = worker.answer_of(Failing(), name)
    assert message[:2] == ("value", name)
    return Answer(*pickle.loads(message.content))


def test_values_errors_and_warnings_come_back():
    assert answered("value").value == 0.1
    with pytest.warns(UserWarning, match="a doubt"):
        warn_again(answered("value"))
    error = answered("failure").error
    assert isinstance(error, NumericalError)
    assert str(error) == "no motion"
    for name in ("refusal", "unsent"):
        assert worker.answer_of(Failing(), name) == Message("nothing", name)


class Scripted:
    """A second process that computes ``check`` until this process has taken ``resonance``."""

    def __init__(self) -> None:
        self.asked, self.given = [], []

    def begin(self, *arguments):
        self.arguments = arguments

    def computes(self, name):
        return name == "check" and "resonance" not in self.given

    def spare(self, have):
        return "resonance"

    def fetch(self, name, tell):
        self.asked.append(name)
        return Answer(None, NumericalError("beats"), ()) if name == "check" else None

    def give(self, name, value):
        self.given.append(name)


def test_an_error_is_raised_again_and_a_process_that_waits_computes_something_else():
    process = Scripted()
    results = Results(PAIRS["calm"](), SMALL, "calm", process=process)
    assert process.arguments == (results.given, SMALL, "calm")
    for _ in range(2):
        with pytest.raises(NumericalError, match="beats"):
            _ = results.check
    assert process.asked == ["resonance", "check"]
    assert "resonance" in vars(results)


def test_what_a_waiting_process_takes_has_all_that_it_needs(two_processors):
    with second_process():
        process = present_process()
        for name in ("proven_stability", "multipliers"):
            assert process.spare(set()) == name
            assert process.fetch(name, lambda *_: None) is None
        assert process.spare(set()) == "orders_over_speed"
        assert process.spare({"uncertainty"}) == "teeth_band"
        assert process.spare({"uncertainty", "like_loses_contact"}) == "teeth_2"
        for name in WORK:
            assert process.fetch(name, lambda *_: None) is None
        assert process.spare({"uncertainty", "like_loses_contact", *WORK}) is None


def test_the_kernel_that_is_compiled_first_is_the_one_of_all_multipliers():
    """Of other types of arguments it would be compiled twice."""
    program = """
import lumped
from floquet.engine.kernels.eigenvalue_bounds import spectra
from validation.reporting.effort import QUICK
from validation.reporting.results import Results
results = Results(lumped.load_gear_pair("nasa_28_28"), QUICK)
results.eigenvalue_kernel
first = set(spectra.signatures)
results.multipliers, results.chart
print(len(first), first == set(spectra.signatures))
"""
    assert subprocess.check_output([sys.executable, "-c", program], text=True).split() == ["1", "True"]


def test_work_is_a_list_of_results():
    for name, needs in WORK.items():
        assert all(isinstance(vars(Results)[one], of_results.computed_once) for one in (name, *needs))


def test_on_one_processor_and_without_a_command_there_is_one_process(monkeypatch):
    assert present_process() is None
    monkeypatch.setattr("validation.reporting.start.cores", lambda: 1)
    with second_process():
        assert present_process() is None


def test_a_block_that_ends_ends_the_process(two_processors):
    with second_process():
        process = present_process()
        assert isinstance(process, SecondProcess)
    assert not is_alive(process.process_id)
    assert present_process() is None


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks here")
def test_a_fork_goes_on_with_nothing_of_the_first_process(tmp_path, monkeypatch, capfd):
    """Neither after an error nor after a signal, and what a library prints there goes nowhere."""

    def fail(work, answers):
        os.write(1, b"printed")
        os.write(2, b"printed")
        raise KeyboardInterrupt

    monkeypatch.setattr(start, "serve", fail)
    try:
        fork = start.Fork()
        assert fork.stdout.read() == b""
        assert os.waitstatus_to_exitcode(fork.wait()) == 1
    finally:
        (tmp_path / str(os.getpid())).touch()
    fork.stdin.close()
    fork.stdout.close()
    assert [path.name for path in tmp_path.iterdir()] == [str(os.getpid())]
    assert capfd.readouterr() == ("", "")
    fork.kill()  # ended already


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks here")
def test_a_fork_without_work_ends_with_the_first_process():
    program = "from validation.reporting.start import Fork; print(Fork().pid, flush=True); input()"
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", program], stdin=pipe, stdout=pipe) as first:
        second = int(first.stdout.readline())
        assert is_alive(second)
        first.kill()
    until(lambda: not is_alive(second))


#: A signal arrives in the fork before it can ignore it.
_AT_ONCE = """
import os, signal, time
from validation.reporting import start
from validation.stop_signals import interrupt_once
signal.signal(signal.SIGINT, signal.default_int_handler)
interrupt_once()
fork = os.fork
def interrupted():
    number = fork()
    if number == 0:
        os.kill(os.getpid(), signal.SIGINT)
    return number
os.fork = interrupted
start.serve = lambda work, answers: answers.write(b"serves") and answers.flush()
try:
    second = start.Fork()
    print(second.stdout.read().decode(), signal.pthread_sigmask(signal.SIG_BLOCK, ()), flush=True)
except KeyboardInterrupt:
    print("the fork goes on", flush=True)
"""


@pytest.mark.skipif(not start.FORKS, reason="no forks here")
def test_a_signal_in_the_first_moment_of_a_fork_waits_until_the_fork_ignores_it():
    said = subprocess.check_output([sys.executable, "-c", _AT_ONCE], text=True)
    assert said.strip() == "serves set()"


#: Writes the threads at the fork into a file, and starts no process.
_AT_FORK = """
import os, pathlib, threading
def fork():
    pathlib.Path("threads").write_text(" ".join(one.name for one in threading.enumerate()))
    raise OSError
os.fork = fork
"""


@pytest.mark.skipif(not start.FORKS, reason="no forks here")
def test_the_command_forks_while_it_has_one_thread(tmp_path):
    """A progress bar on a terminal has a thread, whose locks would stay closed in the fork."""
    first, terminal = os.openpty()
    program = (
        _AT_FORK + "import lumped.cache as c; c.cores = lambda: 2; from validation.cli import main; main()"
    )
    command = [sys.executable, "-c", program, "report", "nasa_28_28", "-o", "report"]
    process = subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=terminal, start_new_session=True
    )
    os.close(terminal)
    try:
        until((tmp_path / "threads").exists)
        until((tmp_path / "threads").read_text)
        assert (tmp_path / "threads").read_text() == "MainThread"
    finally:
        process.kill()
        process.wait()
        os.close(first)


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="children are found in /proc")
@pytest.mark.parametrize("forks", [True, False], ids=["fork", "interpreter"])
@pytest.mark.parametrize(
    ("number", "seconds"),
    [(signal.SIGINT, seconds) for seconds in (0.0, 0.4, 1.0, 3.0)] + [(signal.SIGKILL, 1.0)],
)
def test_no_second_process_and_no_half_report_outlive_the_command(number, seconds, forks, tmp_path):
    """Ctrl-C goes to all processes of a terminal, SIGKILL to the first process alone.

    ``seconds``: from the start of the second process. Both are in their imports or in their work.
    """
    # Where the tests themselves run in the background of a shell, their children ignore Ctrl-C.
    listens = "import signal as s; s.signal(s.SIGINT, s.default_int_handler); "
    kind = f"import validation.reporting.start as r; r.FORKS = {forks}; "
    program = "import lumped.cache as c; c.cores = lambda: 2; from validation.cli import main; main()"
    command = [sys.executable, "-c", listens + kind + program, "report", "nasa_28_28", "-o", "report"]
    nothing = subprocess.DEVNULL
    first = subprocess.Popen(command, cwd=tmp_path, stdout=nothing, stderr=nothing, start_new_session=True)
    children = Path(f"/proc/{first.pid}/task/{first.pid}/children")
    try:
        until(lambda: children.read_text().split())
        second = int(children.read_text().split()[0])
        if not forks:
            until(lambda: "worker" in Path(f"/proc/{second}/cmdline").read_text())
        time.sleep(seconds)
        if number == signal.SIGINT:
            os.killpg(first.pid, number)
            assert first.wait(PATIENCE) == 130
            assert list(tmp_path.iterdir()) == []
        else:
            first.kill()
            first.wait(PATIENCE)
            assert not (tmp_path / "report").exists()
        until(lambda: not is_alive(second))
    finally:
        first.kill()
        first.wait()
