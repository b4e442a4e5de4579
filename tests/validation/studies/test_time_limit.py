"""Does the time limit of a case hold whatever the case does, and leave the other cases alone?"""

from __future__ import annotations

import os
import sys
import time

import pytest

from validation.studies import Status, SweepStopped, run_sweep


@pytest.mark.parametrize("what", ["compiled_loop", "swallows_everything"])
def test_a_case_that_does_not_end_is_ended(study, tmp_path, odd, monkeypatch, undisturbed, what):
    odd(what, 41)
    start = time.monotonic()
    summary = run_sweep(study, tmp_path, case_seconds=0.5)
    assert time.monotonic() - start < 30.0
    assert dict(summary.statuses) == {Status.OK: 95, Status.REFUSED: 24, Status.TIME_LIMIT: 1}
    assert dict(summary.failures)[41] == "longer than 0.5 s"
    monkeypatch.undo()
    again = run_sweep(study, tmp_path, resume=True, retry_failed=True)
    assert again.results.read_bytes() == undisturbed


def test_a_case_that_is_late_and_ends_is_late_too(study, tmp_path, replace_analysis, undisturbed):
    # In a batch that takes less than the limit no case can be late, so a case's own time decides.
    summary = run_sweep(study, tmp_path, case_seconds=1e-3, workers=1)
    assert dict(summary.statuses)[Status.TIME_LIMIT] > 0


def test_a_process_that_was_killed_from_outside_costs_nothing(study, tmp_path, odd, undisturbed):
    odd("dies_once", 41, str(tmp_path / "note"))
    summary = run_sweep(study, tmp_path / "out", case_seconds=30.0)
    assert summary.results.read_bytes() == undisturbed
    assert len((tmp_path / "note").read_text().split()) == 2


def test_what_a_library_prints_is_no_answer(study, tmp_path, odd, undisturbed):
    odd("prints", 41)
    assert run_sweep(study, tmp_path, workers=2).results.read_bytes() == undisturbed


def test_workers_that_cannot_load_the_analysis_stop_the_sweep(study, tmp_path, odd):
    odd("cannot_load", 41)
    with pytest.raises(SweepStopped, match=r"no such analysis.*--resume"):
        run_sweep(study, tmp_path, workers=1)


@pytest.mark.parametrize("workers", [0, 2])
def test_with_a_limit_the_result_is_the_same_bytes(study, tmp_path, undisturbed, workers):
    summary = run_sweep(study, tmp_path, case_seconds=30.0, workers=workers)
    assert summary.results.read_bytes() == undisturbed


@pytest.mark.skipif(sys.platform != "linux", reason="kill and /proc of Linux")
def test_a_process_ends_without_its_parent_in_the_middle_of_a_case(sweep, tmp_path):
    note = tmp_path / "note"
    patch = f"""
import sys; sys.path.insert(0, {os.path.dirname(__file__)!r})
from types import SimpleNamespace
from odd_evaluators import Orphan
from validation.studies import runner
from validation.studies.cases import CaseList, StudyEvaluator
def odd(study):
    (values,) = CaseList(study).values([3])
    return Orphan(StudyEvaluator.of(study), "compiled_loop", values, {str(note)!r})
limited = run = runner.run_sweep
runner.StudyEvaluator = SimpleNamespace(of=odd)
import validation.studies
validation.studies.run_sweep = lambda *a, **o: run(*a, **o, case_seconds=1.0)
"""
    run = sweep.start(patch)
    sweep.wait_for(lambda: note.exists() and note.read_text().endswith(" "), "the case")
    run.kill()
    run.communicate()
    pid = int(note.read_text())
    # This case never lets go of the interpreter, so a watchdog outside of it is what ends it.
    sweep.wait_for(lambda: not os.path.exists(f"/proc/{pid}"), "the process to end")
