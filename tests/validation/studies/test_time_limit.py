"""Does the time limit of a case hold whatever the case does, and leave the other cases alone?"""

from __future__ import annotations

import importlib
import os
import sys
import threading
import time
from types import SimpleNamespace

import pytest

from validation.studies import Status, case_process, dispatch, run_sweep
from validation.studies.case_process import CaseProcess, evaluate_within

#: Evaluators of a module that the process finds on the path, as it finds spurcheck itself.
EVALUATORS = """
import itertools, os, time

class Odd:
    outputs = ("contact_ratio", "mesh_frequency")
    def __init__(self, what, note=""):
        self.what, self.note = what, note
    def prepare(self):
        if self.what == "cannot load":
            raise ImportError("no such analysis")
    def __call__(self, values):
        speed, *_ = values
        if speed == 500.0:
            if self.note:
                open(self.note, "a").write(f"{os.getpid()} ")
            getattr(self, self.what)()
        return (1.5, speed)
    def compiled_loop(self):  # no signal gets in here
        sum(itertools.repeat(0, 10**15))
    def swallows_everything(self):
        while True:
            try:
                time.sleep(1.0)
            except BaseException:
                pass
    def dies(self):
        os._exit(3)
    def dies_once(self):
        if len(open(self.note).read().split()) == 1:
            os._exit(3)
    def prints(self):
        print("progress of a library", flush=True)
        os.write(1, b"and of its compiled part")
"""


@pytest.fixture
def odd(tmp_path, monkeypatch):
    """Class of the evaluators above."""
    (tmp_path / "odd_evaluators.py").write_text(EVALUATORS)
    monkeypatch.syspath_prepend(tmp_path)
    yield importlib.import_module("odd_evaluators").Odd
    sys.modules.pop("odd_evaluators")
    case_process.end_idle()


@pytest.fixture
def statuses_of(make_study, tmp_path, monkeypatch, odd):
    """Sweep two cases with an evaluator that is odd in the first; statuses and failures."""
    study = make_study(axes=[{"field": "operating.pinion_speed", "values": [500.0, 1000.0]}])

    def run(what, limit, note=""):
        monkeypatch.setattr(dispatch, "Evaluator", SimpleNamespace(of=lambda study: odd(what, note)))
        summary = run_sweep(study, tmp_path / "out", case_seconds=limit)
        return dict(summary.statuses), dict(summary.failures)

    return run


@pytest.mark.parametrize("what", ["compiled_loop", "swallows_everything"])
def test_a_case_that_does_not_end_is_ended(statuses_of, what):
    start = time.monotonic()
    statuses, failures = statuses_of(what, 2.0)
    assert statuses == {Status.OK: 1, Status.TIME_LIMIT: 1}
    assert failures == {0: "longer than 2 s"}
    assert time.monotonic() - start < 60.0


def test_the_limit_holds_outside_the_main_thread(odd):
    found = []
    cases = [(0, (500.0,)), (1, (1000.0,))]
    thread = threading.Thread(target=lambda: found.extend(evaluate_within(odd("compiled_loop"), cases, 2.0)))
    thread.start()
    thread.join(60.0)
    assert [record.status for record in found] == [Status.TIME_LIMIT, Status.OK]
    assert found[1].values == (1.5, 1000.0)


def test_a_case_that_kills_its_process_fails_alone(statuses_of):
    statuses, failures = statuses_of("dies", 30.0)
    assert statuses == {Status.OK: 1, Status.WORKER_DIED: 1}
    assert failures[0] == "the process that evaluates it died on this case, every time"


def test_a_process_that_was_killed_from_outside_costs_nothing(statuses_of, tmp_path):
    assert statuses_of("dies_once", 30.0, str(tmp_path / "note"))[0] == {Status.OK: 2}
    assert len((tmp_path / "note").read_text().split()) == 2


def test_what_a_library_prints_is_no_answer(statuses_of):
    assert statuses_of("prints", 30.0)[0] == {Status.OK: 2}


def test_a_process_that_cannot_load_the_analysis_stops_the_sweep(statuses_of, capfd):
    with pytest.raises(dispatch.SweepStopped, match="does not start"):
        statuses_of("cannot load", 30.0)
    assert "no such analysis" in capfd.readouterr().err


def test_with_a_limit_the_result_is_the_same_bytes(study, tmp_path, undisturbed):
    assert run_sweep(study, tmp_path / "out", case_seconds=30.0).results.read_bytes() == undisturbed
    summary = run_sweep(study, tmp_path / "two", case_seconds=30.0, workers=2)
    assert summary.results.read_bytes() == undisturbed


def test_one_process_serves_many_cases_and_ends_with_the_sweep(odd, tmp_path):
    note = tmp_path / "note"
    for _ in range(2):
        records = evaluate_within(odd("prints", str(note)), [(0, (500.0,)), (1, (500.0,))], 30.0)
        assert [record.status for record in records] == [Status.OK, Status.OK]
    pids = set(note.read_text().split())
    assert len(pids) == 1
    assert os.getpgid(int(next(iter(pids)))) != os.getpgrp()  # a terminal sends Ctrl-C to the whole group
    case_process.end_idle()
    with pytest.raises(ProcessLookupError):
        os.kill(int(pids.pop()), 0)


def test_a_process_without_work_ends_by_itself(odd, monkeypatch):
    program = case_process._PROGRAM.replace("import serve;", "import serve;" + IMPATIENT)
    monkeypatch.setattr(case_process, "_PROGRAM", program)
    process = CaseProcess()
    process.load(case_process.pickle.dumps(odd("prints")))
    assert process.run(0, (1000.0,), 30.0).status is Status.OK
    assert process._process.wait(30.0) == 0
    assert process.run(1, (1000.0,), 30.0).status is Status.OK  # and the next case starts it again
    process.kill()


IMPATIENT = "import validation.studies.case_process as p; p.IDLE_SECONDS = 0.5;"


@pytest.mark.skipif(sys.platform != "linux", reason="kill and /proc of Linux")
def test_a_process_ends_without_its_parent_in_the_middle_of_a_case(sweep, tmp_path, odd):
    note = tmp_path / "note"
    patch = f"""
from types import SimpleNamespace
import sys; sys.path.insert(0, {str(tmp_path)!r})
import odd_evaluators
from validation.studies import dispatch, runner
dispatch.Evaluator = SimpleNamespace(of=lambda study: odd_evaluators.Odd("compiled_loop", {str(note)!r}))
limited = runner.Dispatcher
runner.Dispatcher = lambda pool, cases, limit: limited(pool, cases, 10.0)
"""
    run = sweep.start(patch)
    sweep.wait_for(lambda: note.exists() and note.read_text().endswith(" "), "the case")
    run.kill()
    run.communicate()
    pid = int(note.read_text())
    # This case never lets go of the interpreter, so its time limit is what ends it.
    sweep.wait_for(lambda: not os.path.exists(f"/proc/{pid}"), "the process to end", 60.0)


def test_without_a_limit_no_process_is_started(study, tmp_path, monkeypatch, undisturbed):
    monkeypatch.setattr(case_process.subprocess, "Popen", None)
    assert run_sweep(study, tmp_path / "out").results.read_bytes() == undisturbed
