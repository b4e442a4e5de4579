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
from validation.studies import Status, SweepStopped, dispatch, run_sweep
from validation.studies.batch import evaluate_batch

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="signals and /proc of Linux"),
]


def workers_of(pid):
    """Worker processes of a sweep."""
    listed = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [int(child) for child in listed if is_worker(int(child))]


def is_worker(pid):
    try:
        return b"popen_loky" in Path(f"/proc/{pid}/cmdline").read_bytes()
    except (FileNotFoundError, ProcessLookupError):
        return False


def blocks_ctrl_c(pid):
    status = Path(f"/proc/{pid}/status").read_text().splitlines()
    (mask,) = [line.split()[1] for line in status if line.startswith("SigBlk:")]
    return bool(int(mask, 16) >> (signal.SIGINT - 1) & 1)


@pytest.mark.parametrize("seed", range(2))
def test_kill_9_in_the_middle(sweep, seed):
    random.seed(seed)
    wanted = random.randint(1, 60)
    print(f"seed {seed}: kill after {wanted} cases")
    run = sweep.start(sweep.SLOW)
    sweep.wait_for(lambda: len(sweep.finished()) >= wanted, "cases")
    run.kill()
    run.communicate()
    before = sweep.finished()
    assert wanted <= len(before) < 120
    sweep.check_resume(before)


def test_kill_9_of_the_whole_pool_leaves_no_process_and_no_loss(sweep):
    run = sweep.start(workers=2)
    sweep.wait_for(lambda: len(sweep.finished()) >= 10, "cases")
    workers = workers_of(run.pid)
    run.kill()
    run.communicate()
    before = sweep.finished()
    sweep.wait_for(lambda: not any(is_worker(pid) for pid in workers), "workers to end", 20)
    sweep.check_resume(before)


TORN = """
import os, signal
from validation.studies import journal
write, calls = os.write, 0
def torn(descriptor, block):
    global calls
    calls += 1
    if calls == 5:
        write(descriptor, block[:-7])  # inside the last record
        os.kill(os.getpid(), signal.SIGKILL)
    return write(descriptor, block)
journal.os.write = torn
"""


def test_kill_9_during_a_write(sweep):
    run = sweep.start(TORN)
    run.communicate()
    assert run.returncode == -signal.SIGKILL
    before = sweep.finished()
    summary = sweep.check_resume(before)
    assert summary.damaged_bytes > 0


COMPILING = """
import os, signal
from validation.files import regular as files
replace = os.replace
def die(part, path):
    if path.name == "results.nc":
        os.kill(os.getpid(), signal.SIGKILL)
    replace(part, path)
files.os.replace = die
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
    text, _ = run.communicate(timeout=60)
    assert run.returncode == 130, text
    assert "--resume" in text
    assert "Traceback" not in text
    sweep.check_resume(sweep.finished())


@pytest.mark.parametrize(("number", "workers"), [(signal.SIGINT, 2), (signal.SIGTERM, 0), (signal.SIGHUP, 0)])
def test_interrupts_stop_cleanly(sweep, number, workers):
    run = sweep.start(sweep.SLOW, workers=workers, start_new_session=True)
    sweep.wait_for(lambda: len(sweep.finished()) >= 5, "cases")
    os.killpg(run.pid, number) if number is signal.SIGINT else run.send_signal(number)
    _, errors = run.communicate(timeout=30)
    assert errors.rstrip().endswith("KeyboardInterrupt")
    sweep.check_resume(sweep.finished())


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


def test_killing_a_worker_is_not_noticed_in_the_result(sweep):
    killed = []

    def kill_one(done, total, failed):
        workers = workers_of(os.getpid())
        if len(killed) < 2 and workers and done > 5 * (1 + len(killed)):
            os.kill(workers[0], signal.SIGKILL)
            killed.append(workers[0])

    summary = run_sweep(sweep.study, sweep.out, workers=2, progress=kill_one)
    assert len(killed) == 2
    assert summary.results.read_bytes() == sweep.undisturbed


@pytest.mark.parametrize(("workers", "number"), [(1, signal.SIGSEGV), (2, signal.SIGKILL)])
def test_a_case_that_kills_its_worker_is_found_out(sweep, monkeypatch, workers, number):
    def deadly(evaluator, cases, limit):
        if any(case == 41 for case, values in cases):
            os.kill(os.getpid(), number)
        return evaluate_batch(evaluator, cases, limit)

    with monkeypatch.context() as patch:
        patch.setattr(dispatch, "evaluate_batch", deadly)
        summary = run_sweep(sweep.study, sweep.out, workers=workers)
    statuses = dict(summary.statuses)
    assert statuses[Status.WORKER_DIED] == 1
    assert "worker process died" in dict(summary.failures)[41]
    assert statuses[Status.OK] == 95
    again = run_sweep(sweep.study, sweep.out, resume=True, retry_failed=True)
    assert again.results.read_bytes() == sweep.undisturbed


def test_workers_that_cannot_run_cases_stop_the_sweep(sweep, monkeypatch):
    monkeypatch.setattr(dispatch, "versions", lambda: "python 2.7, numpy 1.0")
    with pytest.raises(SweepStopped, match="same versions"):
        run_sweep(sweep.study, sweep.out, workers=2)
    monkeypatch.undo()
    sweep.check_resume([])


@pytest.mark.parametrize(("redirection", "code"), [(">&-", 1), (">/dev/full", 3)])
def test_an_output_that_takes_nothing_costs_no_result(sweep, redirection, code):
    command = [sys.executable, "-m", "validation.cli", "sweep", sweep.file, "-o", sweep.out, "--workers", "1"]
    shell = ["/bin/sh", "-c", f'"$@" {redirection}', "sh", *command]
    run = subprocess.run(shell, stderr=subprocess.PIPE, text=True, check=False)
    assert run.returncode == code, run.stderr  # some cases of this study cannot exist
    assert "Traceback" not in run.stderr
    assert (sweep.out / "results.nc").read_bytes() == sweep.undisturbed
