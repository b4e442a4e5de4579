"""Does every case give one outcome, whichever batches are lost when workers die?"""

from __future__ import annotations

from collections import Counter
from concurrent.futures import CancelledError, Future
from concurrent.futures.process import BrokenProcessPool

import numpy as np
import pebble
import pytest

from validation.studies.cases import CaseList, StudyEvaluator
from validation.studies.dispatch import Dispatcher
from validation.studies.evaluate import Batch, Status
from validation.studies.pools import SweepStopped
from validation.studies.provenance import provenance


class ScriptedPool:
    """A pool whose batches end in the order and way that a test says.

    Parameters
    ----------
    deadly : case -> how often it kills its worker
    together : whether all batches under way then end with the pool
    error : how a batch ends on which a worker died
    """

    def __init__(self, deadly, together=False, error=pebble.ProcessExpired, slots=3):
        self.deadly, self.together, self.error = Counter(deadly), together, error
        self.slots = slots
        self.seconds = 1e-3
        self.under_way: list[tuple[Future[Batch], list[int]]] = []
        self.submitted: list[list[int]] = []

    def submit(self, evaluator, cases, values, limit):
        future: Future[Batch] = Future()
        self.submitted.append(cases)
        self.under_way.append((future, cases))
        if len(self.under_way) == 2 * self.slots or len(self.submitted) > 20:
            self.advance()
        return future

    def advance(self):
        """End the batch that was submitted last."""
        future, cases = self.under_way.pop()
        killers = [case for case in cases if self.deadly[case] > 0]
        if not killers:
            status, values = np.zeros(len(cases), np.int8), np.ones((len(cases), 2))
            future.set_result(Batch(cases, status, values, {}, self.seconds * len(cases), provenance()))
            return
        self.deadly[killers[0]] -= 1
        future.set_exception(self.error("ended"))
        if self.together:
            for other, _ in self.under_way:
                other.set_exception(BrokenProcessPool("ended"))
            self.under_way.clear()

    def check(self):
        if self.under_way:
            self.advance()
        return ""


def dispatcher(pool, study, limit=None):
    cases = CaseList(study)
    return Dispatcher(pool, StudyEvaluator.of(study), cases.values, limit)


@pytest.fixture
def statuses(study, monkeypatch):
    """Dispatch the first 60 cases to a pool; status by case, each case once."""
    monkeypatch.setattr("validation.studies.dispatch._CHECK_SECONDS", 0.0)

    def run(pool, limit=None):
        found: dict[int, Status] = {}
        for batch in dispatcher(pool, study, limit).batches(iter(range(60)), 60):
            for case, status in zip(batch.cases, batch.status, strict=True):
                assert case not in found
                found[case] = Status(status)
        assert sorted(found) == list(range(60))
        return found

    return run


@pytest.mark.parametrize(
    ("slots", "expected"),
    [
        (10, 50),  # half a second of 10 ms
        (500, 100),  # a second, so that the scheduler gets no more than 500 batches a second
        (5000, 12),  # a quarter of an equal share, so that no worker is idle at the end
    ],
)
def test_batches_grow_with_the_number_of_workers(make_study, slots, expected):
    axis = {"field": "operating.pinion_speed", "low": 500, "high": 9000, "count": 250_000}
    pool = ScriptedPool({}, slots=slots)
    pool.seconds = 10e-3
    batches = dispatcher(pool, make_study(axes=[axis])).batches(iter(range(250_000)), 250_000)
    while len(pool.submitted) < 2 * slots + 10:
        next(batches)
    # One by one until the first time is known.
    assert {len(batch) for batch in pool.submitted[: 2 * slots]} == {1}
    assert len(pool.submitted[-1]) == pytest.approx(expected, rel=0.02)


def test_the_last_batches_are_small_so_that_no_worker_has_many_cases_when_the_others_have_none(
    make_study, monkeypatch
):
    monkeypatch.setattr("validation.studies.dispatch._CHECK_SECONDS", 0.0)
    axis = {"field": "operating.pinion_speed", "low": 500, "high": 9000, "count": 10_000}
    pool = ScriptedPool({}, slots=2)
    pool.seconds = 1e-6  # all of them would be one batch by time
    list(dispatcher(pool, make_study(axes=[axis])).batches(iter(range(10_000)), 10_000))
    sizes = [len(batch) for batch in pool.submitted]
    assert max(sizes) > 1000
    assert sizes[-2:] == [1, 1]


@pytest.mark.parametrize("together", [True, False])
def test_batches_lost_with_a_worker_are_computed_again(statuses, together):
    pool = ScriptedPool({5: 1, 30: 1}, together)
    assert set(statuses(pool).values()) == {Status.OK}
    sent = Counter(case for batch in pool.submitted for case in batch)
    assert sent[5] >= 2
    assert sum(sent.values()) > 60


@pytest.mark.parametrize("together", [True, False])
def test_a_case_has_failed_when_it_killed_its_worker_twice_alone_on_it(statuses, together):
    pool = ScriptedPool({5: 99, 30: 2}, together)
    found = statuses(pool)
    # Case 30 killed a worker once among others and once alone: it gets its second chance.
    assert {case for case, status in found.items() if status is Status.WORKER_DIED} == {5}


def test_the_late_case_of_a_batch_is_found_out(statuses):
    found = statuses(ScriptedPool({30: 99}, error=TimeoutError), limit=1.0)
    assert {case for case, status in found.items() if status is not Status.OK} == {30}
    assert found[30] is Status.TIME_LIMIT


def test_workers_that_die_at_once_every_time_stop_the_sweep(statuses):
    with pytest.raises(SweepStopped, match=r"as soon as they start.*--resume"):
        statuses(ScriptedPool(dict.fromkeys(range(60), 99), error=BrokenProcessPool))


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
        statuses(Broken({}))


def test_workers_that_join_are_used_while_batches_end_all_the_time(statuses):
    class Growing(ScriptedPool):
        def submit(self, *arguments):
            future = super().submit(*arguments)
            if self.under_way:
                self.advance()
            return future

        def check(self):
            self.slots = 30
            return ""

    pool = Growing({}, slots=1)
    statuses(pool)
    assert pool.slots == 30


def test_a_cluster_that_loses_its_last_worker_is_waited_for(statuses):
    class Empty(ScriptedPool):
        def check(self):
            self.slots = 0
            return super().check()

    pool = Empty({5: 1})
    statuses(pool)
    assert pool.slots == 0
