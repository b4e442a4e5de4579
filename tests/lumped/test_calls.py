"""Do calls give the same results in the same order, here and on an executor, and end with the first error?"""

import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from lumped.calls import results_of
from lumped.errors import NumericalError

EXECUTORS = [None, "threads"]


@pytest.fixture(params=EXECUTORS, ids=str)
def executor(request):
    if request.param is None:
        yield None
    else:
        with ThreadPoolExecutor(3) as threads:
            yield threads


def test_results_come_in_the_order_of_the_arguments(executor):
    def late(number, seconds):
        time.sleep(seconds)
        return number

    arguments = ((number, 0.02 * (5 - number)) for number in range(5))
    assert list(results_of(late, arguments, executor)) == [0, 1, 2, 3, 4]


def test_the_first_error_ends_the_calls(executor):
    """Of 200 calls that wait for each other's turn most have not begun as the second one fails."""
    begun = []
    turn = threading.Lock()

    def call(number):
        with turn:
            begun.append(number)
            time.sleep(0.002)
        if number == 1:
            raise NumericalError("no motion")
        return number

    results = results_of(call, ((number,) for number in range(200)), executor)
    assert next(results) == 0
    with pytest.raises(NumericalError, match="no motion"):
        next(results)
    if executor is not None:
        executor.shutdown()  # waits for all calls that are not cancelled
    assert len(begun) < 100


def test_in_this_process_a_call_runs_when_its_result_is_asked_for_and_ends_in_time():
    begun = []
    results = results_of(begun.append, ((number,) for number in range(9)), stop=lambda: len(begun) == 3)
    next(results)
    assert begun == [0]
    assert len(list(results)) == 2
    assert begun == [0, 1, 2]
