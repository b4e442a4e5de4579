"""Does the store give back what was added, and is every other file refused and left as it is?"""

import hashlib
import os
import sqlite3
import struct
import sys

import numpy as np
import pytest

from lumped.errors import ParameterError
from validation.studies import StoreError, read_results, run_sweep
from validation.studies.cases import CaseList
from validation.studies.store import STORE, Chunk, Status, Store, provenance, read_table


def outputs_of(case):
    return struct.pack("<2d", case**0.5, -0.0)


def chunk_of(cases, status=Status.OK, message=None):
    """Outcomes of cases: outputs that depend on the number, or the same failure."""
    return Chunk([(c, status, None if message else outputs_of(c), message) for c in cases], 0.5, provenance())


@pytest.fixture
def cases(study):
    return CaseList(study)


def test_what_was_added_comes_back_bit_for_bit_and_the_last_outcome_counts(cases, tmp_path):
    with Store(tmp_path, cases) as store:
        store.add(chunk_of([0, 1, 2, 7, 8, 119]))
        store.add(chunk_of([5, 7], Status.NUMERICAL, "did not converge"))
        store.add(chunk_of([5]))
        for table in (store.table(), read_table(tmp_path, cases)):
            good = [0, 1, 2, 5, 8, 119]
            assert np.flatnonzero(table.status == Status.OK).tolist() == good
            assert table.values[good].tobytes() == b"".join(map(outputs_of, good))
            assert table.messages == {7: "did not converge"}
            assert np.isnan(table.values[7]).all()
            assert table.runs == (provenance(),)
    assert [path.name for path in tmp_path.iterdir()] == [STORE]


def test_the_status_codes_are_those_of_the_stores_there_are():
    names = "MISSING OK OUTSIDE_LAW_RANGE REFUSED NUMERICAL UNEXPECTED WORKER_DIED TIME_LIMIT LINEAR_MOTION"
    assert {status.name: int(status) for status in Status} == {n: k - 1 for k, n in enumerate(names.split())}


def test_a_chunk_that_cannot_be_written_leaves_those_before(cases, tmp_path):
    with Store(tmp_path, cases) as store:
        store.add(chunk_of([0]))
        pages = store._db.execute("PRAGMA page_count").fetchone()[0]
        store._db.execute("COMMIT")
        store._db.execute(f"PRAGMA max_page_count={pages}")  # as a full disk
        store._db.execute("BEGIN IMMEDIATE")
        with pytest.raises(StoreError, match=r"disk is full.*free space.*--resume"):
            store.add(chunk_of(range(1, 120), Status.NUMERICAL, "x" * 2000))
    assert np.flatnonzero(read_table(tmp_path, cases).status != Status.MISSING).tolist() == [0]


def test_the_store_of_other_samples_of_the_study_is_refused(make_study, tmp_path):
    # As another version of scipy would draw them; the study itself is the same.
    axes = [{"field": "operating.pinion_speed", "low": 500, "high": 9000}]
    study = make_study(design={"method": "sobol", "samples": 8}, axes=axes)
    other = CaseList(study)
    other.__dict__["sha256"] = hashlib.sha256(b"other samples").hexdigest()
    with Store(tmp_path, other) as store:
        store.add(chunk_of([0]))
    with pytest.raises(ParameterError, match=r"the same cases.*Another version of scipy"):
        run_sweep(study, tmp_path, resume=True)


def test_what_a_kill_before_the_first_transaction_leaves_is_no_store_yet(study, tmp_path, undisturbed):
    (tmp_path / STORE).touch()
    with pytest.raises(StoreError, match="no store"):
        read_results(tmp_path)
    assert run_sweep(study, tmp_path, resume=True).results.read_bytes() == undisturbed


@pytest.mark.parametrize("kind", ["text", "truncated", "other database"])
def test_a_file_that_is_no_store_is_refused_and_stays(study, tmp_path, kind):
    path = tmp_path / STORE
    if kind == "text":
        path.write_bytes(b"x" * 5000)
    elif kind == "truncated":
        run_sweep(study, tmp_path)
        path.write_bytes(path.read_bytes()[:5000])
    else:
        with sqlite3.connect(path) as db:
            db.execute("CREATE TABLE thesis (text)")
        db.close()
    before = path.read_bytes()
    files = len(os.listdir("/proc/self/fd")) if sys.platform == "linux" else 0
    with pytest.raises(StoreError, match=r"damaged or no store.*stays"):
        run_sweep(study, tmp_path, resume=True)
    with pytest.raises(StoreError, match="damaged or no store"):
        read_results(tmp_path)
    assert path.read_bytes() == before
    if files:
        assert len(os.listdir("/proc/self/fd")) == files
