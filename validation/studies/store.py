"""The store of a study: one SQLite file, to which every batch of outcomes is added in one transaction.

Write-ahead log with ``synchronous=NORMAL``: a transaction that has ended survives the end of this process
whatever ends it, and costs no wait for the disk. A power failure may take what was written since the last
checkpoint; there is one every second. ``FULL`` waits for the disk at every batch, which a cluster of
thousands of workers would feel. The labelled NetCDF file is compiled from the store, as often as wanted,
with the same bytes each time.

The outcomes of a run of consecutive cases are one row: a byte of status a case, then the outputs as
little-endian doubles, with a CRC-32 that begins at the first case's number, for SQLite notices damage to its
own structure only. That takes 1 + 8 outputs bytes a case, and what the pages leave empty.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import sqlite3
import time
import zlib
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol, Self

import numpy as np

from lumped.errors import refuse
from lumped.typing import FloatArray
from validation.stop_signals import undisturbed
from validation.studies.evaluate import Batch, Status
from validation.studies.provenance import Provenance, provenance
from validation.studies.storage import STORE, StoreError, check_plain, damaged, locked, translated

#: What is written reaches the disk itself at most this much later [s].
SYNC_SECONDS = 1.0
#: Error texts kept: those of the failed cases with the lowest numbers.
MAX_FAILURES = 10_000
_APPLICATION, _FORMAT = 0x53505243, 1
_BEGIN = f"""
CREATE TABLE about (key TEXT PRIMARY KEY, value);
CREATE TABLE run (versions TEXT, code TEXT, processor TEXT);
CREATE TABLE batch (id INTEGER PRIMARY KEY, first INTEGER, count INTEGER, crc INTEGER, data BLOB);
CREATE TABLE failure (number INTEGER PRIMARY KEY, crc INTEGER, message BLOB);
PRAGMA application_id={_APPLICATION};
PRAGMA user_version={_FORMAT};
"""
_KEEP_FIRST = """DELETE FROM failure WHERE number >=
(SELECT number FROM failure ORDER BY number LIMIT 1 OFFSET ?)"""


class Cases(Protocol):
    """A numbered list of cases that a store can belong to.

    Attributes
    ----------
    definition : text that says everything about them
    sha256 : hash of the parameters of all cases
    count : how many
    outputs : names of the numbers that a case gives
    """

    @property
    def definition(self) -> str: ...

    @property
    def sha256(self) -> str: ...

    @property
    def count(self) -> int: ...

    @property
    def outputs(self) -> tuple[str, ...]: ...

    def values(self, cases: Sequence[int]) -> Sequence[tuple[Any, ...]]:
        """Return the parameters of the cases of given numbers."""
        ...


@dataclass
class Table:
    """Outcomes of all cases; a later outcome of a case replaces the earlier one.

    Attributes
    ----------
    status : (cases,) ``Status`` codes
    values : (cases, outputs), NaN where there is no result; None when not wanted
    messages : case -> error text of failed ones, at most ``MAX_FAILURES``
    damaged : batches and texts whose checksum is wrong; their cases count as not computed
    runs : what computed cases, in order, each once
    """

    status: np.ndarray[Any, np.dtype[np.int8]]
    values: FloatArray | None
    messages: dict[int, str] = field(default_factory=dict)
    damaged: int = 0
    runs: tuple[Provenance, ...] = ()

    def counts(self) -> Counter[Status]:
        """Cases by status."""
        codes, numbers = np.unique(self.status, return_counts=True)
        return Counter({Status(int(c)): int(n) for c, n in zip(codes, numbers, strict=True)})


class Store:
    """The store of a list of cases, opened for adding and locked against a second process.

    Parameters
    ----------
    folder : where the file is or shall be; None: in memory
    cases : what it belongs to
    other_code : whether cases may be added that other code computes than those there are
    new : whether it must hold nothing yet

    Raises
    ------
    ParameterError : it belongs to other cases, or other code began it
    StoreError : it cannot be used, is damaged or of an earlier version, or another process writes to it
    """

    def __init__(
        self, folder: Path | None, cases: Cases, *, other_code: bool = False, new: bool = False
    ) -> None:
        self._cases = cases
        self._path = Path(":memory:") if folder is None else folder / STORE
        self._file: os.stat_result | None = None
        self._begun = False  # to write
        self._synced = time.monotonic()
        with contextlib.ExitStack() as stack:
            if folder is not None:
                stack.enter_context(locked(folder))
                check_plain(self._path)
            with translated(self._path, "write it"):
                self._db = stack.enter_context(
                    contextlib.closing(sqlite3.connect(self._path, isolation_level=None))
                )
                self._new = folder is None or _is_new(self._db, self._path)
                self._runs: set[Provenance] = set()
                if not self._new:
                    self._go_on(other_code, new)
            if folder is not None:
                self._file = os.lstat(self._path)
            self._open = stack.pop_all()

    def _go_on(self, other_code: bool, new: bool) -> None:
        if new:  # since this run looked at the folder
            raise StoreError(
                f"{self._path}: another run wrote to it just now. Run the same command with --resume."
            )
        for (found,) in self._db.execute("PRAGMA quick_check(1)"):
            if found != "ok":
                raise damaged(self._path, found)
        _check_same(self._db, self._path, self._cases)
        self._runs.update(_runs(self._db))
        if not other_code and {run.code for run in self._runs} - {provenance().code}:
            raise refuse(
                "output",
                self._path,
                "a store that this very code began",
                "Spurcheck was changed since: use the code that began it, begin anew in another folder, or "
                "mix results of both with --other-code.",
            )

    @contextlib.contextmanager
    def _transaction(self) -> Iterator[None]:
        with undisturbed(), translated(self._path, "write to it"):
            self._db.execute("BEGIN IMMEDIATE")
            try:
                yield
                self._db.execute("COMMIT")
            except BaseException:
                with contextlib.suppress(sqlite3.Error):  # SQLite may have done it already
                    self._db.execute("ROLLBACK")
                raise

    def _begin(self) -> None:
        """Make the tables where there are none, without a log yet: a file is empty or has them all."""
        if self._new:
            with self._transaction():
                for statement in _BEGIN.strip().splitlines():
                    self._db.execute(statement)
                self._db.executemany("INSERT INTO about VALUES (?, ?)", _about(self._cases).items())
        with translated(self._path, "write to it"):
            self._db.execute("PRAGMA journal_mode=WAL")
            self._db.execute("PRAGMA synchronous=NORMAL")
        self._new, self._begun = False, True

    def add(self, batch: Batch) -> None:
        """Write the outcomes of a batch; once this returns they survive the end of this process.

        Raises
        ------
        StoreError : they cannot be written; the store then is as before
        """
        if not self._begun:
            self._begin()
        cases = np.asarray(batch.cases, np.int64)
        with self._transaction():
            if batch.provenance not in self._runs:
                self._db.execute("INSERT INTO run VALUES (?, ?, ?)", batch.provenance)
            for run in np.split(np.arange(cases.size), np.flatnonzero(np.diff(cases) != 1) + 1):
                first, last = int(cases[run[0]]), int(cases[run[-1]])
                data = batch.status[run].tobytes() + batch.values[run].astype("<f8").tobytes()
                row = first, run.size, zlib.crc32(data, first), data
                self._db.execute("INSERT INTO batch (first, count, crc, data) VALUES (?, ?, ?, ?)", row)
                self._db.execute("DELETE FROM failure WHERE number BETWEEN ? AND ?", (first, last))
            if batch.messages:
                texts = ((case, text.encode()) for case, text in batch.messages.items())
                rows = ((case, zlib.crc32(text, case), text) for case, text in texts)
                self._db.executemany("INSERT INTO failure VALUES (?, ?, ?)", rows)
                self._db.execute(_KEEP_FIRST, (MAX_FAILURES,))
        self._runs.add(batch.provenance)
        if time.monotonic() - self._synced > SYNC_SECONDS:
            self.sync()

    def sync(self) -> None:
        """Make everything written so far survive a power failure.

        Raises
        ------
        StoreError : it cannot, or the file is no longer where it was, so that nobody would find its cases
        """
        self._synced = time.monotonic()
        if self._file is None:
            return
        try:
            there = os.path.samestat(self._file, os.lstat(self._path))
        except OSError as error:
            there = not isinstance(error, FileNotFoundError)  # else nobody can say
        if not there:
            raise StoreError(
                f"{self._path} was moved, deleted or replaced while the sweep ran. If it was moved, go on "
                "there with --resume; else begin again in a new --output."
            )
        with translated(self._path, "write to it"):
            self._db.execute("PRAGMA wal_checkpoint(PASSIVE)")

    def table(self, *, with_values: bool = True) -> Table:
        """Return the outcomes so far."""
        with translated(self._path, "read it"):
            return _table(None if self._new else self._db, self._cases, with_values)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """Put the log into the file, so that it is one file again, and unlock."""
        with self._open, contextlib.suppress(sqlite3.Error):  # a reader may have it open, or the disk is full
            self._db.execute("PRAGMA journal_mode=DELETE")


def read_definition(folder: Path) -> str:
    """Return the text that says what a store belongs to.

    Raises
    ------
    StoreError : no store, a damaged one or one of an earlier version
    """
    with _reader(folder) as db:
        return str(dict(db.execute("SELECT key, value FROM about"))["definition"])


def read_table(folder: Path, cases: Cases) -> Table:
    """Return the outcomes that a store holds, also while another process adds to it.

    Raises
    ------
    StoreError, ParameterError : as for ``Store``
    """
    with _reader(folder) as db:
        _check_same(db, folder / STORE, cases)
        return _table(db, cases, with_values=True)


@contextlib.contextmanager
def _reader(folder: Path) -> Iterator[sqlite3.Connection]:
    path = folder / STORE
    check_plain(path)
    with translated(path, "read it"):
        if not path.exists():
            raise StoreError(f"{path}: no store of a study. Name the folder that a sweep wrote.")
        db = sqlite3.connect(path.absolute().as_uri() + "?mode=ro", uri=True, isolation_level=None)
        with contextlib.closing(db):
            if _is_new(db, path):
                raise StoreError(f"{path} holds nothing yet. Run its sweep again with --resume.")
            yield db


def _is_new(db: sqlite3.Connection, path: Path) -> bool:
    """Tell whether a file holds nothing yet, as after a kill before the first transaction.

    A file with anything in it is never new, whatever its header says.
    """
    (application,) = db.execute("PRAGMA application_id").fetchone()
    (version,) = db.execute("PRAGMA user_version").fetchone()
    if path.stat().st_size == 0:
        return True
    if application != _APPLICATION:
        raise damaged(path, "it belongs to another program")
    if version != _FORMAT:
        raise StoreError(
            f"{path} has format {version}; this version of spurcheck uses {_FORMAT}. It stays as it is: use "
            "the version that wrote it, or choose another --output."
        )
    return False


def _about(cases: Cases) -> dict[str, str | int]:
    return {
        "definition": cases.definition,
        "definition_sha256": hashlib.sha256(cases.definition.encode()).hexdigest(),
        "cases_sha256": cases.sha256,
        "count": cases.count,
        "outputs": " ".join(cases.outputs),
    }


def _check_same(db: sqlite3.Connection, path: Path, cases: Cases) -> None:
    """Refuse the store of other cases."""
    known = dict(db.execute("SELECT key, value FROM about"))
    wanted = _about(cases)
    if known == wanted:
        return
    if known.get("definition") == wanted["definition"]:
        allowed = "a store of the same cases"
        action = "Another version of scipy draws other samples: use the version that began the study."
    else:
        allowed = "a store of this very study"
        action = "The study was changed since: choose another folder."
    raise refuse("output", path, allowed, action)


def _runs(db: sqlite3.Connection) -> list[Provenance]:
    return [
        Provenance(*row) for row in db.execute("SELECT versions, code, processor FROM run ORDER BY rowid")
    ]


def _table(db: sqlite3.Connection | None, cases: Cases, with_values: bool) -> Table:
    outputs = len(cases.outputs)
    values = np.full((cases.count, outputs), np.nan) if with_values else None
    table = Table(np.full(cases.count, Status.MISSING, np.int8), values)
    if db is None:
        return table
    for first, count, crc, data in db.execute("SELECT first, count, crc, data FROM batch ORDER BY id"):
        size = count * (1 + 8 * outputs)
        if not isinstance(data, bytes) or len(data) != size or zlib.crc32(data, first) != crc:
            table.damaged += 1
            continue
        table.status[first : first + count] = np.frombuffer(data, np.int8, count)
        if table.values is not None:
            found = np.frombuffer(data, "<f8", count * outputs, offset=count)
            table.values[first : first + count] = found.reshape(count, outputs)
    for case, crc, text in db.execute("SELECT number, crc, message FROM failure ORDER BY number"):
        if not isinstance(text, bytes) or zlib.crc32(text, case) != crc:
            table.damaged += 1
            table.status[case : case + 1] = Status.MISSING
        elif table.status[case] >= Status.REFUSED:
            table.messages[case] = text.decode()
    table.runs = tuple(dict.fromkeys(_runs(db)))
    return table
