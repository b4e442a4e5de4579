"""Nodes of a chart in groups, in this process or in worker processes, with the same result to the last bit.

A group is evaluated by one call in one process, and the groups do not depend on the number of workers.

Sources: docs/theory/floquet.md, "Many systems at once".
"""

from __future__ import annotations

import multiprocessing
import pickle
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NamedTuple, cast

import numpy as np

from floquet.engine.nodes import (
    TOGETHER,
    TOGETHER_IN_ONE_CALL,
    BatchedFamily,
    Family,
    NodeSpectra,
    Point,
    node_spectra,
    sampled_spectra,
)
from lumped.errors import NumericalError, refuse, shown
from lumped.typing import FloatArray, IntArray

#: Groups of a worker that are computed or wait: the worker never waits for work, and memory stays flat.
_GROUPS_IN_HAND = 2


@dataclass(frozen=True, eq=False)
class GridNodes:
    """The nodes of a product grid, and the family that has a system at each.

    Attributes
    ----------
    family : a `Family`, or with ``batched`` a `BatchedFamily`
    grid : parameters -> values
    batched : whether the family takes arrays of parameters
    rtol : of the monodromy matrices
    """

    family: Family | BatchedFamily
    grid: Mapping[str, FloatArray]
    batched: bool
    rtol: float

    def groups(self, places: IntArray) -> list[IntArray]:
        """Cut flat indices (k,) of nodes in groups that are evaluated together."""
        together = TOGETHER_IN_ONE_CALL if self.batched else TOGETHER
        return [places[first : first + together] for first in range(0, places.size, together)]

    def points(self, places: IntArray) -> list[Point]:
        """Return the parameters at flat indices (k,)."""
        shape = tuple(values.size for values in self.grid.values())
        nodes = np.transpose(np.unravel_index(places, shape)).tolist()
        return [
            {name: float(self.grid[name][i]) for name, i in zip(self.grid, node, strict=True)}
            for node in nodes
        ]

    def spectra(self, places: IntArray) -> list[NodeSpectra]:
        """Return the multipliers at the nodes of a group; their ``points`` count in the group."""
        points = self.points(places)
        if self.batched:
            return [sampled_spectra(cast("BatchedFamily", self.family), points, self.rtol)]
        return list(node_spectra(cast("Family", self.family), points, self.rtol))


#: Groups -> the multipliers of each, in the order of the groups.
Results = Callable[[Sequence[IntArray]], Iterable[list[NodeSpectra]]]


@contextmanager
def results_of(nodes: GridNodes, workers: int) -> Iterator[Results]:
    """Give the function that evaluates groups of nodes, by this process (1) or by worker processes.

    Raises
    ------
    ParameterError : a family that no other process can import, with more than one worker
    """
    if workers == 1:
        yield lambda groups: map(nodes.spectra, groups)
        return
    try:
        packed = pickle.dumps(nodes)
    except Exception as error:  # noqa: BLE001  (pickle raises many kinds)
        action = (
            "Define it with def at the head of a module, not inside a function and not as a lambda; or "
            "leave workers out."
        )
        value = f"{shown(nodes.family)} ({type(error).__name__})"
        allowed = "a function that another process can import, for more than one worker"
        raise refuse("evaluate", value, allowed, action) from None
    with ProcessPoolExecutor(workers, _context(), _unpack, (packed,)) as pool:
        try:
            yield lambda groups: _in_order(pool, groups, workers)
        except BrokenProcessPool as error:
            raise NumericalError(
                "the worker processes ended. In a script, call scan under `if __name__ == '__main__':`, and "
                "check the memory of this machine; workers = 1 shows an error of the family itself."
            ) from error
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


class _Reply(NamedTuple):
    """What a worker sends back: multipliers of a group, and the warnings of its evaluation."""

    spectra: list[NodeSpectra]
    warnings: list[tuple[str, type[Warning]]]


def _in_order(
    pool: ProcessPoolExecutor, groups: Sequence[IntArray], workers: int
) -> Iterator[list[NodeSpectra]]:
    """Yield the multipliers of groups in their order; as few groups as keep all workers busy are in work."""
    waiting: deque[Future[_Reply]] = deque()
    left = iter(groups)
    while True:
        while len(waiting) < _GROUPS_IN_HAND * workers and (group := next(left, None)) is not None:
            waiting.append(pool.submit(_evaluated, group))
        if not waiting:
            return
        reply = waiting.popleft().result()
        for text, category in reply.warnings:
            warnings.warn(text, category, stacklevel=2)
        yield reply.spectra


_nodes: GridNodes | None = None  # of this worker process


def _unpack(packed: bytes) -> None:
    """Begin a worker process: its nodes are those of its chart."""
    global _nodes
    _nodes = pickle.loads(packed)


def _evaluated(places: IntArray) -> _Reply:
    """Evaluate a group in a worker process."""
    assert _nodes is not None
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        spectra = _nodes.spectra(places)
    return _Reply(spectra, [(str(one.message), one.category) for one in caught])


def _context() -> Any:
    """Start method of worker processes: not a fork of this process, which could copy a lock of a thread."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["floquet.engine.node_workers"])
    return context
