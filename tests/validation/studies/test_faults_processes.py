"""After a kill or an interrupt, does resuming give the undisturbed result, byte for byte?"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from validation.stop_signals import stopping_as_interrupt, undisturbed
from validation.studies import Status, SweepStopped, dispatch, pools, run_sweep
from validation.studies.provenance import provenance

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="signals and /proc of Linux"),
]


def workers_of(pid):
    """Worker processes of a sweep."""
    listed = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    servers = [int(child) for child in listed if is_fork(int(child))]
    below = [Path(f"/proc/{s}/task/{s}/children").read_text().split() for s in servers]
    return [int(worker) for found in below for worker in found]


def is_fork(pid):
    """Tell the process that worker processes are forks of, and these."""
    try:
        return b"forkserver" in Path(f"/proc/{pid}/cmdline").read_bytes()
    except (FileNotFoundError, ProcessLookupError):
        return False


def blocks_ctrl_c(pid):
    status = Path(f"/proc/{pid}/status").read_text().splitlines()
    (mask,) = [line.split()[1] for line in status if line.startswith("SigBlk:")]
    return bool(int(mask, 16) >> (signal.SIGINT - 1) & 1)


@pytest.mark.parametrize("seed", range(int(os.environ.get("SPURCHECK_FUZZ", "2"))))
def test_kill_9_in_the_middle_leaves_no_process_and_no_loss(sweep, seed):
    random.seed(seed)
    wanted, workers = random.randint(1, 60), 2 * (seed % 2)
    run = sweep.start("" if workers else sweep.SLOW, workers=workers)
    sweep.wait_for(lambda: len(sweep.finished()) >= wanted, "cases")
    known, forks = sweep.finished(), workers_of(run.pid)
    run.kill()
    run.communicate()
    before = sweep.finished()
    assert set(known) <= set(before)
    sweep.wait_for(lambda: not any(is_fork(pid) for pid in forks), "workers to end")
    sweep.check_resume(before)


TORN = """
import os, signal, sqlite3
from validation.studies import store
class Dying(sqlite3.Connection):
    calls = 0
    def execute(self, text, *arguments):
        if text == "COMMIT":
            Dying.calls += 1
            if Dying.calls == 5:
                os.kill(os.getpid(), signal.SIGKILL)
        return super().execute(text, *arguments)
connect = sqlite3.connect
store.sqlite3.connect = lambda path, **options: connect(path, factory=Dying, **options)
"""


def test_kill_9_during_a_write(sweep):
    run = sweep.start(TORN)
    run.communicate()
    assert run.returncode == -signal.SIGKILL
    before = sweep.finished()
    assert 0 < len(before) < 120
    sweep.check_resume(before)


COMPILING = """
import os, signal
from pathlib import Path
Path.replace = lambda part, path: os.kill(os.getpid(), signal.SIGKILL)
"""


def test_kill_9_while_the_result_is_compiled(sweep):
    run = sweep.start(COMPILING)
    run.communicate()
    assert run.returncode == -signal.SIGKILL
    assert not (sweep.out / "results.nc").exists()
    sweep.check_resume(sweep.finished())


def test_ctrl_c_while_the_workers_start_is_no_traceback(sweep):
    command = [sys.executable, "-m", "validation.cli", "sweep", sweep.file, "-o", sweep.out, "--workers", "2"]
    run = subprocess.Popen(command, text=True, stdout=-1, stderr=subprocess.STDOUT, start_new_session=True)
    sweep.wait_for(lambda: workers_of(run.pid), "workers")
    assert all(blocks_ctrl_c(pid) for pid in workers_of(run.pid))
    while run.poll() is None:  # an impatient user, and a terminal that tells every process of the group
        os.killpg(run.pid, signal.SIGINT)
        time.sleep(0.01)
    text, _ = run.communicate(timeout=400)
    assert run.returncode == 130, text
    assert "--resume" in text
    assert "Traceback" not in text
    sweep.check_resume(sweep.finished())


def test_ctrl_c_stops_a_sweep_and_its_workers(sweep):
    run = sweep.start(workers=2, start_new_session=True)
    sweep.wait_for(lambda: len(sweep.finished()) >= 5, "cases")
    os.killpg(run.pid, signal.SIGINT)
    _, errors = run.communicate(timeout=400)
    if run.returncode:  # else it was just done
        assert errors.rstrip().endswith("KeyboardInterrupt")
    sweep.check_resume(sweep.finished())


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_signals_of_batch_systems_and_terminals_stop_cleanly(sweep, number):
    def stop(done, total, failed):
        if done >= 5:
            signal.raise_signal(number)

    with pytest.raises(KeyboardInterrupt):
        run_sweep(sweep.study, sweep.out, progress=stop)
    before = sweep.finished()
    assert 5 <= len(before) < 120
    sweep.check_resume(before)


@stopping_as_interrupt()
def interrupted_while_it_ends():
    try:
        signal.raise_signal(signal.SIGTERM)
    finally:
        for number in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM):
            signal.raise_signal(number)


def test_only_the_first_signal_interrupts():
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(KeyboardInterrupt):
        interrupted_while_it_ends()
    assert signal.getsignal(signal.SIGTERM) is before


def test_a_signal_is_kept_back_and_one_that_a_shell_ignores_stays_ignored():
    ended = []

    @stopping_as_interrupt()
    @undisturbed()
    def start(number):
        signal.raise_signal(number)
        ended.append(number)

    with pytest.raises(KeyboardInterrupt):
        start(signal.SIGTERM)
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # as in a job that a script starts with &
    try:
        start(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)
    assert ended == [signal.SIGTERM, signal.SIGINT]


@pytest.mark.parametrize("together", [False, True])
def test_killing_workers_is_not_noticed_in_the_result_nor_in_the_time(sweep, together):
    killed, start = [], time.monotonic()

    def kill(done, total, failed):
        workers = workers_of(os.getpid())[: 2 if together else 1]
        if len(killed) < 2 and done > 5 * (1 + len(killed)):
            killed.extend(workers)
            for pid in workers:
                os.kill(pid, signal.SIGKILL)

    summary = run_sweep(sweep.study, sweep.out, workers=2, progress=kill)
    assert len(killed) >= 2
    assert time.monotonic() - start < 30.0  # a lock that dies with its worker was waited for for 60 s
    assert summary.results.read_bytes() == sweep.undisturbed


@pytest.mark.parametrize(("workers", "what"), [(1, "crashes"), (2, "is_killed")])
def test_a_case_that_kills_its_worker_is_found_out(sweep, odd, monkeypatch, workers, what):
    odd(what, 41)
    summary = run_sweep(sweep.study, sweep.out, workers=workers)
    statuses = dict(summary.statuses)
    assert statuses[Status.WORKER_DIED] == 1
    assert "worker process died" in dict(summary.failures)[41]
    assert statuses[Status.OK] == 95
    monkeypatch.undo()
    again = run_sweep(sweep.study, sweep.out, resume=True, retry_failed=True)
    assert again.results.read_bytes() == sweep.undisturbed


def test_a_worker_that_stands_still_is_told_and_given_up(sweep, odd, monkeypatch, tmp_path):
    monkeypatch.setattr(pools, "TOLD_SECONDS", 1.0)
    monkeypatch.setattr(pools, "GIVEN_UP_SECONDS", 3.0)
    note, told = tmp_path / "note", []
    odd("stands_still_once", 41, str(note))
    summary = run_sweep(sweep.study, sweep.out, workers=2, tell=told.append)
    assert len(note.read_text().split()) == 2
    assert note.read_text().split()[0] in told[0]  # an idle worker may be named beside it
    assert "uses no processor time" in told[0]
    assert summary.results.read_bytes() == sweep.undisturbed


def test_ctrl_c_is_answered_at_once_by_workers_that_stand_still(sweep):
    asked = []

    def freeze(done, total, failed):
        if not asked:
            for pid in workers_of(os.getpid()):
                os.kill(pid, signal.SIGSTOP)
            asked.append(time.monotonic())
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        run_sweep(sweep.study, sweep.out, workers=2, progress=freeze)
    assert time.monotonic() - asked[0] < 2.0
    sweep.check_resume(sweep.finished())


def test_a_script_that_workers_cannot_load_is_told_what_to_do(sweep, tmp_path):
    script = tmp_path / "script.py"
    call = f"run_sweep(load_study({str(sweep.file)!r}), {str(sweep.out)!r}, workers=1)"
    script.write_text(f"from validation.studies import *\n{call}\n")
    run = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False, timeout=400)
    assert run.returncode == 1
    assert "__main__" in run.stderr.splitlines()[-1]


def test_workers_that_cannot_run_cases_stop_the_sweep(sweep, monkeypatch):
    monkeypatch.setattr(dispatch, "provenance", lambda: provenance()._replace(versions="python 2.7"))
    with pytest.raises(SweepStopped, match="same code"):
        run_sweep(sweep.study, sweep.out, workers=2)
    monkeypatch.undo()
    sweep.check_resume([])


@pytest.mark.parametrize(("redirection", "workers", "code"), [(">&-", "1", 1), (">/dev/full", "0", 3)])
def test_an_output_that_takes_nothing_costs_no_result(sweep, redirection, workers, code):
    command = [sys.executable, "-m", "validation.cli", "sweep", sweep.file, "-o", sweep.out]
    command += ["--workers", workers]
    shell = ["/bin/sh", "-c", f'"$@" {redirection}', "sh", *command]
    run = subprocess.run(shell, stderr=subprocess.PIPE, text=True, check=False)
    assert run.returncode == code, run.stderr  # some cases of this study cannot exist
    assert "Traceback" not in run.stderr
    assert (sweep.out / "results.nc").read_bytes() == sweep.undisturbed
