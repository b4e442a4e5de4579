"""Does a sweep give the same bytes wherever its cases run, and survive cases that end a worker?"""

import signal
import subprocess
import sys
import time
from concurrent.futures import Future, ThreadPoolExecutor
from types import SimpleNamespace

import pytest

from lumped.errors import ParameterError
from validation.studies import Cluster, Status, StoreError, SweepStopped, run_sweep, runner, workers
from validation.studies.cases import CaseList, StudyEvaluator
from validation.studies.store import provenance, read_table


@pytest.fixture
def odd(study, monkeypatch):
    """Let case 41 of the study do something odd, in worker processes too; see ``odd_evaluators``."""
    from odd_evaluators import Odd

    def use_odd(what):
        evaluator = StudyEvaluator.of(study)
        (values,) = CaseList(study).values([41])
        changed = SimpleNamespace(of=lambda study: Odd(evaluator, what, values))
        monkeypatch.setattr(runner, "StudyEvaluator", changed)

    return use_odd


def test_processes_give_the_same_bytes_whatever_a_library_prints(study, tmp_path, odd, undisturbed):
    odd("prints")
    assert run_sweep(study, tmp_path, workers=2, case_seconds=60.0).results.read_bytes() == undisturbed


@pytest.mark.parametrize(("what", "options", "status", "text"), [
    ("is_killed", {"workers": 2}, Status.WORKER_DIED, "the worker process died on this case"),
    ("compiled_loop", {"workers": 1, "case_seconds": 1.0}, Status.TIME_LIMIT, "longer than 1 s"),
])  # fmt: skip
def test_a_case_that_ends_its_worker_costs_itself_alone(
    study, tmp_path, odd, monkeypatch, undisturbed, what, options, status, text
):
    odd(what)
    summary = run_sweep(study, tmp_path, **options)
    assert dict(summary.statuses) == {Status.OK: 95, Status.REFUSED: 24, status: 1}
    assert dict(summary.failures)[41] == text
    monkeypatch.undo()
    again = run_sweep(study, tmp_path, resume=True, retry_failed=True)
    assert again.results.read_bytes() == undisturbed


def test_any_executor_gives_the_same_bytes(study, tmp_path, undisturbed):
    with ThreadPoolExecutor(2) as executor:
        assert run_sweep(study, tmp_path, executor=executor, workers=2).results.read_bytes() == undisturbed
        with pytest.raises(ParameterError, match="case_seconds"):
            run_sweep(study, tmp_path / "limited", executor=executor, case_seconds=1.0)
        with pytest.raises(ParameterError, match="workers = 0: allowed 1 to 1024 with an executor"):
            run_sweep(study, tmp_path / "none", executor=executor)
    with pytest.raises(SweepStopped, match="after shutdown"):
        run_sweep(study, tmp_path / "closed", executor=executor, workers=1)


class Records:
    """A pool whose calls end when the test says so, and whose number of workers changes."""

    def __init__(self, workers):
        self.workers = workers
        self.calls = {}

    def submit(self, function, *arguments):
        future = Future()
        self.calls[future] = arguments
        return future

    def slots(self):
        return self.workers

    def end(self, *cases, error=None):
        """End the calls with these cases, or all calls."""
        for future, arguments in list(self.calls.items()):
            if not cases or set(arguments[1]) & set(cases):
                del self.calls[future]
                if error is None:
                    future.set_result(workers.evaluate_chunk(*arguments))
                else:
                    future.set_exception(error)

    def running(self):
        return sorted(case for arguments in self.calls.values() for case in arguments[1])


class KilledWorker(Exception):
    """Dask's error of the same name."""


def chunks(study, records):
    """Outcomes of the study's cases on a pool that keeps a record."""
    cases = CaseList(study)
    pool = workers.Pool(records.submit, records.slots)
    return workers.chunks_of(
        StudyEvaluator.of(study), cases.values, iter(range(cases.count)), cases.count, pool, None
    )


def test_workers_that_join_later_get_cases(study, monkeypatch):
    """A worker has two calls, one that runs and the next one: 2 calls of one worker, 8 of four workers."""
    monkeypatch.setattr(workers, "_LOOK_SECONDS", 0.01)
    monkeypatch.setattr(workers, "CHUNK_SECONDS", 0.0)
    records = Records(1)
    sizes = []

    def slots():  # the sweep asks at each of its looks
        sizes.append(len(records.calls))
        if len(sizes) == 5:
            records.workers = 4
        if len(sizes) == 10:
            records.end(0)
        return records.workers

    records.slots = slots
    next(chunks(study, records))
    assert sizes == [0, 2, 2, 2, 2, 8, 8, 8, 8, 8][: len(sizes)]


def test_the_slots_of_a_cluster_are_its_workers_at_present():
    cluster = object.__new__(Cluster)
    cluster._threads = {"tcp://a:1": 1}
    with workers.workers_of(0, cluster, None) as pool:
        assert pool.slots() == 1
        cluster._threads = {"tcp://a:1": 1, "tcp://b:1": 4}  # a worker computes one case at a time
        assert pool.slots() == 2


def test_cases_of_a_lost_worker_run_again_and_a_case_has_the_blame_only_alone(study, monkeypatch):
    """Two workers die with two calls each. One of the four cases is to blame: that with number 2."""
    monkeypatch.setattr(workers, "_LOOK_SECONDS", 0.01)
    monkeypatch.setattr(workers, "CHUNK_SECONDS", 0.0)
    records = Records(2)
    seen = []

    def slots():
        seen.append(records.running())
        if len(seen) == 2 or records.running() == [2]:
            records.end(error=KilledWorker())
        elif len(seen) > 2:
            records.end()
        return records.workers

    records.slots = slots
    rows = [row for chunk in chunks(study, records) for row in chunk.rows]
    assert sorted(row[0] for row in rows) == list(range(120))
    assert [row[0] for row in rows if row[1] == Status.WORKER_DIED] == [2]
    assert seen[1] == [0, 1, 2, 3]
    assert sorted([running for running in seen if running][1:5]) == [[0], [1], [2], [3]]


def test_workers_of_other_code_stop_the_sweep(study, tmp_path, monkeypatch):
    old = provenance()._replace(code="0" * 64)
    evaluate = workers.evaluate_chunk

    def of_old_code(*arguments):
        chunk = evaluate(*arguments)
        return workers.Chunk(chunk.rows, chunk.seconds, old)

    monkeypatch.setattr(workers, "evaluate_chunk", of_old_code)
    with pytest.raises(SweepStopped, match="install the same code"):
        run_sweep(study, tmp_path)


#: Run a sweep of the study in argv[1] into argv[2] with argv[3] workers; a case takes 20 ms in this process.
PROGRAM = """
import dataclasses, sys, time
from validation.studies import analyses, load_study, run_sweep
fast = analyses.ANALYSES["geometry"]
def slow(variation, settings):
    time.sleep(0.02)
    return fast.compute(variation, settings)
if sys.argv[3] == "0":
    analyses.ANALYSES["geometry"] = dataclasses.replace(fast, compute=slow)
run_sweep(load_study(open(sys.argv[1]).read()), sys.argv[2], workers=int(sys.argv[3]), resume=True)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="signals of Linux")
@pytest.mark.parametrize(
    ("number", "count"), [(signal.SIGKILL, 0), (signal.SIGKILL, 2), (signal.SIGINT, 2), (signal.SIGTERM, 0)]
)
def test_after_a_kill_or_an_interrupt_resuming_gives_the_same_bytes(
    study, tmp_path, undisturbed, number, count
):
    (tmp_path / "study.toml").write_text(study.to_toml())
    out = tmp_path / "out"

    def finished():
        try:
            return int((read_table(out, CaseList(study)).status != Status.MISSING).sum())
        except StoreError:  # none yet
            return 0

    command = [sys.executable, "-c", PROGRAM, str(tmp_path / "study.toml"), str(out), str(count)]
    run = subprocess.Popen(command, text=True, stderr=subprocess.PIPE)
    end = time.monotonic() + 400.0  # a process takes 5 s of processor time to start
    while finished() < 5:
        assert time.monotonic() < end, "no case was computed"
        time.sleep(0.005)
    run.send_signal(number)
    run.communicate(timeout=30)
    assert run.returncode != 0 or finished() == 120
    before = finished()
    summary = run_sweep(study, out, resume=True)
    assert (summary.before, summary.computed) == (before, 120 - before)
    assert summary.results.read_bytes() == undisturbed
