"""Run a study: compute every case once, and store every outcome at once."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lumped.arguments import file_path, of_type, real_number
from lumped.display.progress import shows_progress
from lumped.errors import refuse
from validation.files.output import write_dataset
from validation.stop_signals import stopping_as_interrupt
from validation.studies.cases import CaseList, StudyEvaluator
from validation.studies.results import RESULTS, results_dataset
from validation.studies.schema import Study
from validation.studies.store import STORE, Status, Store
from validation.studies.workers import chunks_of, workers_of

#: Called after every chunk with (cases computed in this run, cases to compute, failed so far).
Progress = Callable[[int, int, int], None]
_SHOWN_FAILURES = 20


@dataclass(frozen=True)
class Summary:
    """Result of a run of a sweep.

    Attributes
    ----------
    cases : number of cases of the study
    before : number of cases that earlier runs computed
    computed : number of cases that this run computed
    statuses : (status, number) of all cases, by status
    failures : (case, text) of the first failed cases
    seconds : wall time of this run [s]
    results : compiled file
    """

    cases: int
    before: int
    computed: int
    statuses: tuple[tuple[Status, int], ...]
    failures: tuple[tuple[int, str], ...]
    seconds: float
    results: Path

    @property
    def failed(self) -> int:
        """Cases without outputs."""
        return sum(number for status, number in self.statuses if status.failed)


@shows_progress("cases", counts=True)
def run_sweep(
    study: Study,
    folder: str | Path,
    *,
    workers: int = 0,
    executor: Executor | None = None,
    resume: bool = False,
    retry_failed: bool = False,
    case_seconds: float | None = None,
    progress: Progress | bool | None = None,
) -> Summary:
    """Compute every case of a study into a folder.

    Parameters
    ----------
    study : the study
    folder : output folder; it is created, and holds ``store.sqlite`` and ``results.nc``
    workers : processes of this machine, in which a case may crash without ending the sweep; 0 computes in
        this process, which starts faster. With an executor that is no ``Cluster``: how many calls it runs at
        the same time
    executor : what runs the cases instead: a ``Cluster`` of ``open_cluster``, or any executor of
        ``concurrent.futures``
    resume : go on where an earlier run of the same study in that folder ended
    retry_failed : with ``resume``, also compute the failed cases again
    case_seconds : longest time of a case [s]; with it, cases run in worker processes of this machine (one
        with ``workers`` = 0), which are ended when a case is late
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with (computed, to compute, failed)

    Raises
    ------
    ParameterError : the folder holds something else, or arguments out of range
    StoreError : the store cannot be written; nothing written before is lost
    StorageError : the results cannot be written; the store holds them all
    SweepStopped : the workers are gone; nothing computed before is lost
    KeyboardInterrupt : Ctrl-C, SIGTERM or SIGHUP; nothing computed before is lost
    """
    start = time.perf_counter()
    if case_seconds is not None:
        advice = "Give the longest time of a case."
        real_number("case_seconds", case_seconds, 1e-3, 1e6, unit="s", action=advice)
    root = file_path("folder", folder)
    of_type("study", study, Study, "a Study, as load_study returns it")
    cases = CaseList(study)
    with (
        stopping_as_interrupt(),
        workers_of(workers, executor, case_seconds) as pool,
        _opened(root, cases, resume) as store,
    ):
        status = store.table().status
        todo = np.flatnonzero((status == Status.MISSING) | (retry_failed & Status.failed_among(status)))
        number = todo.size
        evaluator = StudyEvaluator.of(study)
        done = 0
        failed = 0
        numbers: Iterator[int] = iter(todo.tolist())
        for chunk in chunks_of(evaluator, cases.values, numbers, number, pool, case_seconds):
            store.add(chunk)
            done += len(chunk.rows)
            failed += sum(Status(code).failed for _, code, _, _ in chunk.rows)
            if callable(progress):
                progress(done, number, failed)
        table = store.table()
        write_dataset(results_dataset(cases, table), root / RESULTS)
    return Summary(
        cases=cases.count,
        before=cases.count - number,
        computed=number,
        statuses=tuple(sorted(table.counts().items())),
        failures=tuple(table.messages.items())[:_SHOWN_FAILURES],
        seconds=time.perf_counter() - start,
        results=root / RESULTS,
    )


def refuse_other_contents(folder: Path, *, resume: bool) -> bool:
    """Refuse an output folder of a sweep that has something else in it. The folder may be missing.

    Parameters
    ----------
    folder : output folder
    resume : whether the sweep goes on with the store in the folder

    Returns
    -------
    bool : whether the folder has results of a sweep

    Raises
    ------
    ParameterError : the folder cannot be used, or has something else in it
    """
    with _refusals_of(folder):
        entries = list(folder.iterdir()) if folder.is_dir() else []
    names = {entry.name for entry in entries if not entry.name.startswith(".")}
    if STORE in names and not resume:
        action = "It holds a sweep: go on with --resume, or choose another --output."
        raise refuse("output", folder, "a new folder", action)
    if names and STORE not in names:  # the first file of a sweep, so all others are the user's
        action = f"It holds {min(names)}: choose another --output."
        raise refuse("output", folder, "a new or empty folder", action)
    return RESULTS in names


@contextmanager
def _refusals_of(folder: Path) -> Iterator[None]:
    """Refuse a folder that the operating system does not let us use."""
    try:
        yield
    except (FileExistsError, NotADirectoryError):
        raise refuse("output", folder, "a folder", "A file has that name: choose another --output.") from None
    except OSError as error:
        reason = f"It cannot be used: {error.strerror}."
        raise refuse("output", folder, "a folder that can be made and read", reason) from error


def _opened(root: Path, cases: CaseList, resume: bool) -> Store:
    """Open the store of a new or empty folder, or with ``resume`` of a folder with this study."""
    with _refusals_of(root):
        root.mkdir(parents=True, exist_ok=True)
    has_results = refuse_other_contents(root, resume=resume)
    store = Store(root, cases)
    if store.new and has_results:
        store.__exit__()
        action = f"It holds {RESULTS} of something else: choose another --output."
        raise refuse("output", root, "a folder of this study", action)
    return store
