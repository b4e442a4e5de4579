"""Does every case give one record, whichever batches are lost when workers die?"""

from __future__ import annotations

from collections import Counter
from concurrent.futures import CancelledError, Future

import pytest

from validation.studies.batch import Batch, versions
from validation.studies.cases import case_list
from validation.studies.dispatch import Dispatcher
from validation.studies.pools import SweepStopped
from validation.studies.record import Record, Status


class Died(Exception):
    """What a batch raises whose worker died."""


class ScriptedPool:
    """A pool whose batches end in the order and way that a test says.

    Parameters
    ----------
    deadly : case -> how often it kills its worker
    dies_together : whether the other batches under way die with it
    unfinished : whether these others are then not even marked as ended
    """

    died = (Died,)

    def __init__(self, deadly, dies_together, unfinished=False, slots=3):
        self.deadly, self.dies_together, self.unfinished = Counter(deadly), dies_together, unfinished
        self.slots = slots
        self.seconds = 1e-3
        self.under_way: list[tuple[Future[Batch], list[int]]] = []
        self.restarts = 0
        self.submitted: list[list[int]] = []

    def submit(self, work, evaluator, batch, limit):
        future: Future[Batch] = Future()
        cases = [case for case, _ in batch]
        self.submitted.append(cases)
        self.under_way.append((future, cases))
        if len(self.under_way) == 2 * self.slots or len(self.submitted) > 20:
            self.advance()
        return future

    def advance(self):
        """End the batch that was submitted last, and a deadly one with all others if they die together."""
        future, cases = self.under_way.pop()
        killers = [case for case in cases if self.deadly[case] > 0]
        if not killers:
            future.set_result(
                Batch(tuple(Record(c, Status.OK, self.seconds, (1.0, 2.0)) for c in cases), versions())
            )
            return
        self.deadly[killers[0]] -= 1
        future.set_exception(Died())
        if self.dies_together:
            for other, _ in self.under_way:
                if not self.unfinished:
                    other.set_exception(Died())
            self.under_way.clear()

    def check(self):
        if self.under_way:
            self.advance()

    def restart(self):
        self.restarts += 1


@pytest.fixture
def statuses(study, monkeypatch):
    """Dispatch the first 60 cases to a pool; status by case, each case once."""
    monkeypatch.setattr("validation.studies.dispatch._CHECK_SECONDS", 0.0)

    def run(pool):
        found: dict[int, Status] = {}
        for records in Dispatcher(pool, case_list(study)).records(iter(range(60)), 60):
            for record in records:
                assert record.case not in found
                found[record.case] = record.status
        assert sorted(found) == list(range(60))
        return found

    return run


@pytest.mark.parametrize(
    ("slots", "expected"),
    [
        (10, 50),  # half a second of 10 ms
        (500, 100),  # a second, so that the scheduler gets no more than 500 batches a second
        (5000, 1_000_000 // 20_000),  # a quarter of an equal share, so that no worker is idle at the end
    ],
)
def test_batches_grow_with_the_number_of_workers(make_study, slots, expected):
    axis = {"field": "operating.pinion_speed", "low": 500, "high": 9000, "count": 1_000_000}
    pool = ScriptedPool({}, dies_together=False, slots=slots)
    pool.seconds = 10e-3
    records = Dispatcher(pool, case_list(make_study(axes=[axis]))).records(iter(range(1_000_000)), 1_000_000)
    while len(pool.submitted) < 2 * slots + 10:
        next(records)
    # One by one until the first time is known.
    assert {len(batch) for batch in pool.submitted[: 2 * slots]} == {1}
    assert len(pool.submitted[-1]) == pytest.approx(expected, rel=0.02)


def test_the_last_batches_are_small_so_that_no_worker_has_many_cases_when_the_others_have_none(
    make_study, monkeypatch
):
    monkeypatch.setattr("validation.studies.dispatch._CHECK_SECONDS", 0.0)
    axis = {"field": "operating.pinion_speed", "low": 500, "high": 9000, "count": 10_000}
    pool = ScriptedPool({}, dies_together=False, slots=2)
    pool.seconds = 1e-6  # all of them would be one batch by time
    list(Dispatcher(pool, case_list(make_study(axes=[axis]))).records(iter(range(10_000)), 10_000))
    sizes = [len(batch) for batch in pool.submitted]
    assert max(sizes) > 1000
    assert sizes[-2:] == [1, 1]


POOLS = pytest.mark.parametrize(
    ("together", "unfinished"), [(True, False), (True, True), (False, False)], ids=["all", "cut off", "one"]
)


@POOLS
def test_batches_lost_with_a_worker_are_computed_again(statuses, together, unfinished):
    pool = ScriptedPool({5: 1, 30: 1}, together, unfinished)
    assert set(statuses(pool).values()) == {Status.OK}
    assert pool.restarts >= 2
    sent = Counter(case for batch in pool.submitted for case in batch)
    assert sent[5] == 2
    assert sum(sent.values()) > 60


@POOLS
def test_a_case_has_failed_when_it_killed_its_worker_twice_alone_on_it(statuses, together, unfinished):
    pool = ScriptedPool({5: 99, 30: 2}, together, unfinished)
    found = statuses(pool)
    # Case 30 killed a worker once among others and once alone: it gets its second chance.
    assert {case for case, status in found.items() if status is Status.WORKER_DIED} == {5}
    # Once beside other batches, which says nothing for sure, then twice alone.
    assert sum(5 in batch for batch in pool.submitted) == 3


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (CancelledError(), r"scheduler is gone.*--resume"),
        (ModuleNotFoundError("No module named 'validation'"), r"No module.*install this version.*--resume"),
    ],
)
def test_an_error_that_is_no_case_s_stops_the_sweep_and_says_what_to_do(statuses, error, words):
    class Broken(ScriptedPool):
        def advance(self):
            future, _ = self.under_way.pop()
            future.set_exception(error)

    with pytest.raises(SweepStopped, match=words):
        statuses(Broken({}, dies_together=False))


def test_workers_that_join_are_used_while_batches_end_all_the_time(statuses):
    class Growing(ScriptedPool):
        def submit(self, work, evaluator, batch, limit):
            future = super().submit(work, evaluator, batch, limit)
            if self.under_way:
                self.advance()
            return future

        def check(self):
            self.slots = 30

    pool = Growing({}, dies_together=False, slots=1)
    statuses(pool)
    assert pool.slots == 30
