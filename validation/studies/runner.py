"""Run a study: every case once, each outcome kept the moment it is known."""

from __future__ import annotations

import contextlib
import os
import shutil
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lumped.errors import refuse
from validation.files.regular import StoreError, write_text
from validation.stop_signals import stopping_as_interrupt
from validation.studies.batch import versions
from validation.studies.cases import CaseList, case_list
from validation.studies.dispatch import Dispatcher
from validation.studies.journal import NOTHING, Journal, Key, scan
from validation.studies.pools import pool_of
from validation.studies.record import Record, Status
from validation.studies.results import JOURNAL, RESULTS, STUDY, Table, results_dataset, write_results
from validation.studies.schema import Study

#: Called after every block of records with (cases computed in this run, cases to compute, failed so far).
Progress = Callable[[int, int, int], None]
_SHOWN_FAILURES = 20
_RECORD_BYTES = 25


@dataclass(frozen=True)
class Summary:
    """What a run of a sweep did.

    Attributes
    ----------
    study : name
    cases : number of cases of the study
    before : of these, computed by earlier runs
    computed : computed by this run
    statuses : (status, number) of all cases, by status
    failures : (case, text) of the first failed ones
    damaged_bytes : bytes of the journal that a crash had left unusable; their cases were computed again
    seconds : wall time of this run
    case_seconds : computing time of this run's cases together
    results : the compiled file
    """

    study: str
    cases: int
    before: int
    computed: int
    statuses: tuple[tuple[Status, int], ...]
    failures: tuple[tuple[int, str], ...]
    damaged_bytes: int
    seconds: float
    case_seconds: float
    results: Path

    @property
    def failed(self) -> int:
        """Cases without outputs; missing are those whose records something else took away."""
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
    case_seconds: float | None = None,
    progress: Progress | None = None,
) -> Summary:
    """Compute every case of a study into a folder.

    Parameters
    ----------
    study : the study
    folder : output folder; it is created, and holds ``study.toml``, ``journal.bin`` and ``results.nc``
    workers : processes of this machine, in which a case may crash without ending the sweep; 0 computes in
        this process, which starts faster
    scheduler : address of a Dask scheduler, instead of ``workers``
    resume : go on where an earlier run of the same study in that folder ended
    retry_failed : with ``resume``, also compute the failed cases again
    case_seconds : longest time of a case [s]; with it, processes of their own evaluate the cases, and are
        killed when one is late
    progress : called with (computed, to compute, failed)

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
    if case_seconds is not None and not 1e-3 <= case_seconds <= 1e9:
        raise refuse(
            "case_seconds", f"{case_seconds:g} s", "0.001 s to 1e9 s", "Give the longest time of a case."
        )
    root = Path(folder)
    cases = case_list(study)
    _check_memory(cases)
    key = Key(cases)
    begun = _prepare(root, resume)
    path = root / JOURNAL
    table = Table.of(cases, with_values=False)
    found = scan(path, key, table.add) if begun else NOTHING
    wanted = table.status == Status.MISSING
    if retry_failed:
        wanted |= table.status >= Status.REFUSED
    todo = int(np.count_nonzero(wanted))
    with (
        stopping_as_interrupt(),
        contextlib.closing(pool_of(workers, scheduler, todo)) as pool,
        Journal(path, key, found) as journal,
    ):
        # Only with the lock, so that of two runs into a new folder one leaves the other's study alone.
        if not (root / STUDY).exists():
            write_text(root / STUDY, study.to_toml())
        spent = 0.0
        if todo:
            _check_space(root, key, todo)
            journal.append([Record(len(found.sessions), Status.SESSION, 0.0, message=versions())])
            spent = _compute(cases, journal, Dispatcher(pool, cases, case_seconds), wanted, progress)
        journal.sync()
        full = Table.of(cases)
        complete = scan(path, key, full.add)
        write_results(root, results_dataset(cases, full, complete))
    return Summary(
        study=study.name,
        cases=cases.count,
        before=cases.count - todo,
        computed=todo,
        statuses=tuple(sorted(full.counts().items())),
        failures=tuple(sorted(full.messages.items())[:_SHOWN_FAILURES]),
        damaged_bytes=found.damaged_bytes,
        seconds=time.perf_counter() - start,
        case_seconds=spent,
        results=root / RESULTS,
    )


def _compute(
    cases: CaseList,
    journal: Journal,
    dispatcher: Dispatcher,
    wanted: np.ndarray[tuple[int], np.dtype[np.bool_]],
    progress: Progress | None,
) -> float:
    """Compute the wanted cases into the journal; returns their computing time [s]."""
    todo = int(np.count_nonzero(wanted))
    statuses: Counter[bool] = Counter()
    spent = 0.0
    for records in dispatcher.records(cases.pending(wanted), todo):
        journal.append(records)
        statuses.update(record.status.failed for record in records)
        spent += sum(record.seconds for record in records)
        if progress is not None:
            progress(statuses.total(), todo, statuses[True])
    return spent


def _prepare(root: Path, resume: bool) -> bool:
    """Make the folder; returns whether it has a journal.

    Raises
    ------
    ParameterError : the folder holds a sweep and ``resume`` was not asked for, or holds something else
    """
    try:
        root.mkdir(parents=True, exist_ok=True)
        names = {entry.name for entry in root.iterdir()}
    except (FileExistsError, NotADirectoryError):
        raise refuse("output", root, "a folder", "A file has that name: choose another --output.") from None
    except OSError as error:
        reason = f"It cannot be used: {error.strerror}."
        raise refuse("output", root, "a folder that can be made and read", reason) from error
    begun = JOURNAL in names
    if begun and not resume:
        raise refuse(
            "output",
            root,
            "a new folder",
            "It holds a sweep: go on with --resume, or choose another --output.",
        )
    # The journal is the first file of a sweep, so without one all others, a study.toml too, are the user's.
    foreign = sorted(name for name in names if not name.startswith("."))
    if foreign and not begun:
        raise refuse(
            "output", root, "a new or empty folder", f"It holds {foreign[0]}: choose another --output."
        )
    return begun


def _check_memory(cases: CaseList) -> None:
    """Refuse a sweep whose results this machine could not hold, for they are labelled in one piece."""
    if not hasattr(os, "sysconf") or "SC_PHYS_PAGES" not in os.sysconf_names:
        return  # this system does not say
    # Measured: the outputs, one of them again while it is written, the status; sampled axes as Python floats.
    sampled = 0 if cases.study.design.method == "grid" else len(cases.study.axes)
    need = cases.count * (8 * (len(cases.study.outputs) + 1) + 3 + 65 * sampled)
    present = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if need > present:
        raise refuse(
            "design",
            f"{cases.count} cases",
            f"results that fit in memory: these need {need / 1e9:.3g} GB of {present / 1e9:.3g} GB",
            "Split the study, or keep fewer outputs.",
        )


def _check_space(root: Path, key: Key, todo: int) -> None:
    """Refuse a sweep that cannot fit on the disk before it starts."""
    need = todo * (_RECORD_BYTES + 8 * key.outputs) + key.count * (1 + 8 * key.outputs)
    free = shutil.disk_usage(root).free
    if need > free:
        raise StoreError(
            f"{root}: the results need about {need / 1e6:.4g} MB and {free / 1e6:.4g} MB are free. "
            "Free space, or choose an --output on another disk."
        )
