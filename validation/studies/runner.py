"""Run a study: every case once, each outcome kept the moment it is known."""

from __future__ import annotations

import contextlib
import os
import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lumped.arguments import file_path, of_type, real_number
from lumped.errors import refuse
from validation.stop_signals import stopping_as_interrupt, undisturbed
from validation.studies.cases import CaseList, StudyEvaluator
from validation.studies.cluster import pool_of
from validation.studies.dispatch import Dispatcher
from validation.studies.evaluate import Evaluator, Status
from validation.studies.results import RESULTS, results_dataset, write_results
from validation.studies.schema import Study
from validation.studies.storage import STORE, StoreError
from validation.studies.store import Cases, Store, Table, read_table

#: Called after every batch with (cases computed in this run, cases to compute, failed so far).
Progress = Callable[[int, int, int], None]
_SHOWN_FAILURES = 20
_BLOCK = 65_536


@dataclass(frozen=True)
class Summary:
    """What a run of a sweep did.

    Attributes
    ----------
    cases : number of cases of the study
    before : of these, computed by earlier runs
    computed : computed by this run
    statuses : (status, number) of all cases, by status
    failures : (case, text) of the first failed ones
    damaged : batches of the store whose checksum was wrong; their cases were computed again
    seconds : wall time of this run
    results : the compiled file
    """

    cases: int
    before: int
    computed: int
    statuses: tuple[tuple[Status, int], ...]
    failures: tuple[tuple[int, str], ...]
    damaged: int
    seconds: float
    results: Path

    @property
    def failed(self) -> int:
        """Cases without outputs."""
        return sum(number for status, number in self.statuses if status.failed or status is Status.MISSING)

    @property
    def exit_code(self) -> int:
        """0 when every case has its outputs, else 1."""
        return 1 if self.failed else 0


def run_sweep(
    study: Study,
    folder: str | Path,
    *,
    workers: int = 0,
    scheduler: str | None = None,
    resume: bool = False,
    retry_failed: bool = False,
    other_code: bool = False,
    case_seconds: float | None = None,
    progress: Progress | None = None,
    tell: Callable[[str], None] | None = None,
) -> Summary:
    """Compute every case of a study into a folder.

    Parameters
    ----------
    study : the study
    folder : output folder; it is created, and holds ``store.sqlite`` and ``results.nc``
    workers : processes of this machine, in which a case may crash without ending the sweep; 0 computes in
        this process, which starts faster
    scheduler : address of a Dask scheduler, instead of ``workers``
    resume : go on where an earlier run of the same study in that folder ended
    retry_failed : with ``resume``, also compute the failed cases again
    other_code : with ``resume``, also when the source of spurcheck was changed since
    case_seconds : longest time of a case [s]; with it, cases run in worker processes (one with ``workers``
        = 0), which are ended when a case is late
    progress : called with (computed, to compute, failed)
    tell : called with a text when a worker, the scheduler or the cluster gives no sign of life

    Returns
    -------
    Summary

    Raises
    ------
    ParameterError : the folder holds something else, or arguments out of range
    StoreError : the store cannot be written; nothing written before is lost
    SweepStopped : the workers are gone; nothing computed before is lost
    KeyboardInterrupt : Ctrl-C, SIGTERM or SIGHUP; nothing computed before is lost
    """
    start = time.perf_counter()
    if case_seconds is not None:
        real_number(
            "case_seconds", case_seconds, 1e-3, 1e6, unit="s", action="Give the longest time of a case."
        )
    root = file_path("folder", folder)
    of_type("study", study, Study, "a Study, as load_study returns it")
    cases = CaseList(study)
    _check_memory(cases)
    _prepare(root, resume)
    with stopping_as_interrupt(), Store(root, cases, other_code=other_code, new=not resume) as store:
        found = store.table(with_values=False)
        todo = wanted(found, retry_failed)
        number = int(np.count_nonzero(todo))
        _check_space(root, cases, number)
        compute(
            cases,
            StudyEvaluator.of(study),
            store,
            todo,
            workers=workers,
            scheduler=scheduler,
            limit=case_seconds,
            progress=progress,
            tell=tell,
        )
        store.sync()
        table = read_table(root, cases) if number else store.table()  # from the disk: it may be damaged since
        write_results(root, results_dataset(cases, table))
    return Summary(
        cases=cases.count,
        before=cases.count - number,
        computed=number,
        statuses=tuple(sorted(table.counts().items())),
        failures=tuple(sorted(table.messages.items())[:_SHOWN_FAILURES]),
        damaged=found.damaged,
        seconds=time.perf_counter() - start,
        results=root / RESULTS,
    )


def wanted(table: Table, retry_failed: bool = False) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Return which cases are to compute, (cases,)."""
    todo: np.ndarray[Any, np.dtype[np.bool_]] = table.status == Status.MISSING
    if retry_failed:
        todo |= table.status >= Status.REFUSED
    return todo


def compute(
    cases: Cases,
    evaluator: Evaluator,
    store: Store,
    todo: np.ndarray[Any, np.dtype[np.bool_]],
    *,
    workers: int,
    scheduler: str | None = None,
    limit: float | None = None,
    progress: Progress | None = None,
    tell: Callable[[str], None] | None = None,
) -> None:
    """Compute cases into a store; see ``run_sweep``.

    Parameters
    ----------
    cases, evaluator : what to compute
    store : where the outcomes go
    todo : (cases,) which of them
    limit : longest time of a case [s]

    Raises
    ------
    StoreError, SweepStopped, KeyboardInterrupt : see ``run_sweep``
    """
    number = int(np.count_nonzero(todo))
    done = failed = 0
    with contextlib.closing(pool_of(workers, scheduler, limit is not None, number)) as pool:
        if not number:
            return
        dispatcher = Dispatcher(pool, evaluator, cases.values, limit, tell or (lambda text: None))
        try:
            for batch in dispatcher.batches(_numbers(todo), number):
                store.add(batch)
                done += len(batch.cases)
                failed += int(np.count_nonzero(batch.status >= Status.REFUSED))
                if progress is not None:
                    progress(done, number, failed)
        except KeyboardInterrupt:
            with undisturbed():
                for batch in dispatcher.done():
                    store.add(batch)
            raise


def _numbers(todo: np.ndarray[Any, np.dtype[np.bool_]]) -> Iterator[int]:
    """Numbers of the wanted cases, in order, without holding them all."""
    for start in range(0, todo.size, _BLOCK):
        yield from (start + np.flatnonzero(todo[start : start + _BLOCK])).tolist()


def _prepare(root: Path, resume: bool) -> None:
    """Make the folder.

    Raises
    ------
    ParameterError : it holds a sweep and ``resume`` was not asked for, or holds something else
    """
    try:
        root.mkdir(parents=True, exist_ok=True)
        names = {entry.name for entry in root.iterdir()}
    except (FileExistsError, NotADirectoryError):
        raise refuse("output", root, "a folder", "A file has that name: choose another --output.") from None
    except OSError as error:
        reason = f"It cannot be used: {error.strerror}."
        raise refuse("output", root, "a folder that can be made and read", reason) from error
    if STORE in names and not resume and (root / STORE).lstat().st_size > 0:
        action = "It holds a sweep: go on with --resume, or choose another --output."
        raise refuse("output", root, "a new folder", action)
    foreign = sorted(name for name in names if not name.startswith("."))
    if foreign and STORE not in names:  # the first file of a sweep, so all others are the user's
        action = f"It holds {foreign[0]}: choose another --output."
        raise refuse("output", root, "a new or empty folder", action)


def _check_memory(cases: CaseList) -> None:
    """Refuse a sweep whose results this machine could not hold, for they are labelled in one piece."""
    if not hasattr(os, "sysconf") or "SC_PHYS_PAGES" not in os.sysconf_names:
        return  # this system does not say
    # Measured: the outputs, one of them again while it is written, the status; sampled axes as Python floats.
    sampled = 0 if cases.study.design.method == "grid" else len(cases.study.axes)
    need = cases.count * (8 * (len(cases.outputs) + 1) + 3 + 65 * sampled)
    present = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if need > present:
        raise refuse(
            "design",
            f"{cases.count} cases",
            f"results that fit in memory: these need {need / 1e9:.3g} GB of {present / 1e9:.3g} GB",
            "Split the study, or keep fewer outputs.",
        )


def _check_space(root: Path, cases: CaseList, todo: int) -> None:
    """Refuse a sweep that cannot fit on the disk before it starts: store and results."""
    need = (todo + cases.count) * (1 + 8 * len(cases.outputs))
    free = shutil.disk_usage(root).free
    if need > free:
        raise StoreError(
            f"{root}: the results need about {need / 1e6:.4g} MB and {free / 1e6:.4g} MB are free. "
            "Free space, or choose an --output on another disk."
        )
