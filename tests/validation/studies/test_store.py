"""Does the store give back what was added, and is every other file refused and left as it is?"""

from __future__ import annotations

import hashlib
import os
import sqlite3
import sys
import zlib

import numpy as np
import pytest

from lumped.errors import ParameterError
from validation.studies import StoreError, read_results, run_sweep
from validation.studies import store as stores
from validation.studies.cases import CaseList
from validation.studies.evaluate import MAX_MESSAGE, Batch, Status, evaluate_batch
from validation.studies.provenance import provenance
from validation.studies.storage import STORE
from validation.studies.store import Store, read_table


def batch_of(cases, status=Status.OK, message=""):
    """Outcomes of cases: outputs that depend on the number, or the same failure."""
    values = np.sqrt(np.outer(cases, [1.0, -0.0]))
    if status.failed:
        values[:] = np.nan
    messages = dict.fromkeys(cases, message) if status.failed else {}
    return Batch(list(cases), np.full(len(cases), status, np.int8), values, messages, 0.5, provenance())


@pytest.fixture
def cases(study):
    return CaseList(study)


@pytest.fixture
def store(cases, tmp_path):
    with Store(tmp_path, cases) as store:
        yield store


def test_what_was_added_comes_back_bit_for_bit_and_the_last_outcome_counts(store, cases, tmp_path):
    store.add(batch_of([0, 1, 2, 7, 8, 119]))
    store.add(batch_of([5, 7], Status.NUMERICAL, "did not converge"))
    store.add(batch_of([5]))
    for table in (store.table(), read_table(tmp_path, cases)):
        good = [0, 1, 2, 5, 8, 119]
        assert np.flatnonzero(table.status == Status.OK).tolist() == good
        assert table.values[good].tobytes() == batch_of(good).values.tobytes()
        assert table.messages == {7: "did not converge"}
        assert np.isnan(table.values[7]).all()
        assert (table.damaged, table.runs) == (0, (provenance(),))


def test_a_case_takes_its_outputs_and_a_byte(make_study, tmp_path):
    axis = {"field": "operating.pinion_speed", "low": 500, "high": 9000, "count": 20_000}
    cases = CaseList(make_study(axes=[axis]))
    with Store(tmp_path, cases) as store:
        for start in range(0, cases.count, 1000):
            store.add(batch_of(range(start, start + 1000)))
    # 2 outputs of 8 bytes, a status, and what pages leave empty; the old store used 41 bytes.
    assert (tmp_path / STORE).stat().st_size / cases.count < 21


def test_the_status_codes_are_those_of_the_stores_there_are():
    names = "MISSING OK OUTSIDE_LAW_RANGE REFUSED NUMERICAL UNEXPECTED WORKER_DIED TIME_LIMIT"
    assert {status.name: int(status) for status in Status} == {n: k - 1 for k, n in enumerate(names.split())}


def test_texts_are_bounded_in_length_and_number(store, monkeypatch, study):
    class Loud:
        outputs, nan_allowed = ("x", "y"), False

        def prepare(self):
            pass

        def __call__(self, values):
            raise ValueError("\udc80x" * 10**5)

    monkeypatch.setattr(stores, "MAX_FAILURES", 3)
    for case in (9, 3, 5, 1, 7):
        store.add(evaluate_batch(Loud(), [case], [()]))
    table = store.table()
    assert list(table.messages) == [1, 3, 5]
    assert {len(text) for text in table.messages.values()} == {MAX_MESSAGE}
    assert np.count_nonzero(table.status == Status.UNEXPECTED) == 5


def test_a_flipped_bit_costs_its_batch_which_is_computed_again(study, tmp_path, undisturbed):
    run_sweep(study, tmp_path / "out")
    with sqlite3.connect(tmp_path / "out" / STORE) as db:
        number, data = db.execute("SELECT id, data FROM batch ORDER BY length(data) DESC").fetchone()
        changed = bytes([data[0]]) + bytes([data[1] ^ 4]) + data[2:]
        assert zlib.crc32(changed) != zlib.crc32(data)
        db.execute("UPDATE batch SET data = ? WHERE id = ?", (changed, number))
    db.close()
    summary = run_sweep(study, tmp_path / "out", resume=True)
    assert summary.damaged == 1
    assert summary.computed == len(data) // 17
    assert summary.results.read_bytes() == undisturbed


@pytest.fixture
def folder(study, tmp_path):
    """Folder with a finished sweep."""
    run_sweep(study, tmp_path / "out")
    return tmp_path / "out"


def test_the_store_of_another_study_is_refused(folder, make_study):
    with pytest.raises(ParameterError, match=r"this very study.*choose another folder"):
        run_sweep(make_study(outputs=["contact_ratio", "base_pitch"]), folder, resume=True)


def test_the_store_of_other_samples_of_the_study_is_refused(make_study, tmp_path):
    # As another version of scipy would draw them; the study itself is the same.
    axes = [{"field": "operating.pinion_speed", "low": 500, "high": 9000}]
    study = make_study(design={"method": "sobol", "samples": 8}, axes=axes)
    other = CaseList(study)
    other.__dict__["sha256"] = hashlib.sha256(b"other samples").hexdigest()
    with Store(tmp_path, other) as store:
        store.add(batch_of([0]))
    with pytest.raises(ParameterError, match=r"the same cases.*Another version of scipy"):
        run_sweep(study, tmp_path, resume=True)


def test_what_a_kill_before_the_first_transaction_leaves_is_no_store_yet(study, tmp_path, undisturbed):
    (tmp_path / STORE).touch()
    with pytest.raises(StoreError, match="holds nothing yet"):
        read_results(tmp_path)
    assert run_sweep(study, tmp_path).results.read_bytes() == undisturbed


@pytest.mark.parametrize("what", ["moved", "deleted", "replaced"])
def test_a_store_that_is_taken_away_is_told_at_once_not_at_the_end(store, cases, tmp_path, monkeypatch, what):
    monkeypatch.setattr(stores, "SYNC_SECONDS", -1.0)
    store.add(batch_of([0]))
    path, aside = tmp_path / STORE, tmp_path / "aside"
    path.rename(aside)
    if what == "replaced":
        path.write_bytes(aside.read_bytes())
    if what == "deleted":
        aside.unlink()
    with pytest.raises(StoreError, match="moved, deleted or replaced"):
        store.add(batch_of([1]))


def test_what_is_written_reaches_the_disk_after_a_while(store, tmp_path, monkeypatch):
    asked = []
    store._db.set_trace_callback(asked.append)
    store.add(batch_of([0]))
    assert not any("checkpoint" in text for text in asked)
    monkeypatch.setattr(stores, "SYNC_SECONDS", -1.0)
    store.add(batch_of([1]))
    assert any("checkpoint" in text for text in asked)


@pytest.mark.skipif(sys.platform != "linux", reason="/proc of Linux")
def test_no_file_is_left_open(study, make_study, folder):
    # A worker or a notebook lives for thousands of reads, and systems give a process about 1000 open files.
    before = len(os.listdir("/proc/self/fd"))
    read_results(folder).close()
    with pytest.raises(ParameterError):
        run_sweep(make_study(outputs=["base_pitch"]), folder, resume=True)
    (folder / STORE).write_bytes(b"x" * 5000)
    with pytest.raises(StoreError):
        read_results(folder)
    with pytest.raises(StoreError):
        run_sweep(study, folder, resume=True)
    assert len(os.listdir("/proc/self/fd")) == before
