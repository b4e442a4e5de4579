"""Independent calls of one function, here or on an executor: the same results in the same order."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor
from typing import Any, TypeVar

from lumped.arguments import of_type

R = TypeVar("R")


def checked_executor(executor: Executor | None) -> Executor | None:
    """Return the executor, or refuse what is no executor. None stays None."""
    if executor is not None:
        of_type("executor", executor, Executor, "an executor of concurrent.futures, or of open_cluster")
    return executor


def results_of(
    function: Callable[..., R],
    arguments: Iterable[tuple[Any, ...]],
    executor: Executor | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> Iterator[R]:
    """Yield the result of each call, in the order of the arguments.

    Parameters
    ----------
    function : the function; an executor with processes finds it by its name
    arguments : arguments of each call
    executor : what runs the calls, all of them at once; None: this process, one call when its result is
        asked for
    stop : without an executor, asked before each call: True ends the calls

    Raises
    ------
    Exception : what a call raises; calls that have not begun are cancelled
    """
    if executor is None:
        for one in arguments:
            if stop():
                return
            yield function(*one)
        return
    futures = [executor.submit(function, *one) for one in arguments]
    try:
        for future in futures:
            yield future.result()
    finally:
        for future in futures:
            future.cancel()
