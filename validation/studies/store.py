"""The store of a study: one SQLite file, to which every batch of outcomes is added in one transaction.

Write-ahead log with ``synchronous=NORMAL``: a transaction that has ended survives the end of this process
whatever ends it, and costs no wait for the disk. A power failure may take what was written since the last
checkpoint; there is one every second. ``FULL`` waits for the disk at every batch, which a cluster of
thousands of workers would feel. The labelled NetCDF file is compiled from the store, as often as wanted,
with the same bytes each time.

The outcomes of a run of consecutive cases are one row: a byte of status a case, then the outputs as
little-endian doubles, with a CRC-32. That takes 1 + 8 outputs bytes a case.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import sqlite3
import time
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol, Self

import numpy as np

from lumped.errors import refuse
from lumped.typing import FloatArray
from validation.stop_signals import undisturbed
from validation.studies.evaluate import Batch, Status
from validation.studies.provenance import Provenance, processor, provenance
from validation.studies.storage import (
    STORE,
    StoreError,
    check_plain,
    check_version,
    damaged,
    locked,
    translated,
)

#: What is written reaches the disk itself at most this much later [s].
SYNC_SECONDS = 1.0
#: Error texts kept: those of the failed cases with the lowest numbers.
MAX_FAILURES = 10_000
_APPLICATION, _FORMAT = 0x53505243, 1
_TABLES = """
CREATE TABLE about (key TEXT PRIMARY KEY, value);
CREATE TABLE run (versions TEXT, code TEXT, processor TEXT, began TEXT);
CREATE TABLE batch (id INTEGER PRIMARY KEY, first INTEGER, count INTEGER, crc INTEGER, data BLOB);
CREATE TABLE failure (number INTEGER PRIMARY KEY, message TEXT);
"""
_KEEP_FIRST = """DELETE FROM failure WHERE number >=
(SELECT number FROM failure ORDER BY number LIMIT 1 OFFSET ?)"""


class Cases(Protocol):
    """A list of cases that a store can belong to.

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


@dataclass
class Table:
    """Outcomes of all cases; a later outcome of a case replaces the earlier one.

    Attributes
    ----------
    status : (cases,) ``Status`` codes
    values : (cases, outputs), NaN where there is no result; None when not wanted
    messages : case -> error text of failed ones, at most ``MAX_FAILURES``
    damaged : batches whose checksum is wrong; their cases count as not computed
    runs : provenance of every run that computed cases, in order, each once
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
        self._lock = None if folder is None else locked(folder)
        self._in_memory = folder is None
        try:
            if folder is not None:
                check_plain(self._path)
            with translated(self._path, "write it"):
                self._db = sqlite3.connect(self._path, isolation_level=None)
                try:
                    self._open(other_code, new)
                except BaseException:
                    self._db.close()
                    raise
        except BaseException:
            self._unlock()
            raise
        self._synced = time.monotonic()

    def _open(self, other_code: bool, must_be_new: bool) -> None:
        self._new = _is_new(self._db, self._path)
        if not self._new:
            if must_be_new:  # since this run looked at the folder
                raise StoreError(
                    f"{self._path}: another run wrote to it just now. Run the same command with --resume."
                )
            for (found,) in self._db.execute("PRAGMA quick_check(1)"):
                if found != "ok":
                    raise damaged(self._path, found)
            _check_same(self._db, self._path, self._cases)
            if not other_code:
                self._check_code()
        self._file = None if self._in_memory else os.lstat(self._path)

    def _check_code(self) -> None:
        codes = {code for (code,) in self._db.execute("SELECT code FROM run")}
        if codes - {provenance().code}:
            raise refuse(
                "output",
                self._path,
                "a store that this very code began",
                "Spurcheck was changed since: use the code that began it, begin anew in another folder, or "
                "mix results of both with --other-code.",
            )

    @contextlib.contextmanager
    def _transaction(self) -> Iterator[None]:
        with undisturbed():
            self._db.execute("BEGIN IMMEDIATE")
            try:
                yield
                self._db.execute("COMMIT")
            except BaseException:
                with contextlib.suppress(sqlite3.Error):  # SQLite may have done it already
                    self._db.execute("ROLLBACK")
                raise

    def begin_run(self) -> None:
        """Note that this process computes cases from now on.

        Raises
        ------
        StoreError : it cannot be written
        """
        now = datetime.now(UTC).isoformat(timespec="seconds")
        with translated(self._path, "write to it"):
            self._db.execute("PRAGMA journal_mode=WAL")
            self._db.execute("PRAGMA synchronous=NORMAL")
            with self._transaction():
                if self._new:
                    for statement in _TABLES.strip().splitlines():
                        self._db.execute(statement)
                    self._db.executemany("INSERT INTO about VALUES (?, ?)", _about(self._cases).items())
                    self._db.execute(f"PRAGMA application_id={_APPLICATION}")
                    self._db.execute(f"PRAGMA user_version={_FORMAT}")
                self._db.execute("INSERT INTO run VALUES (?, ?, ?, ?)", (*provenance(), processor(), now))
        self._new = False

    def add(self, batch: Batch) -> None:
        """Write the outcomes of a batch; once this returns they survive the end of this process.

        Raises
        ------
        StoreError : they cannot be written; the store then is as before
        """
        cases = np.asarray(batch.cases, np.int64)
        rows = []
        for run in np.split(np.arange(cases.size), np.flatnonzero(np.diff(cases) != 1) + 1):
            data = batch.status[run].tobytes() + batch.values[run].astype("<f8").tobytes()
            rows.append((int(cases[run[0]]), run.size, zlib.crc32(data), data))
        with translated(self._path, "write to it"), self._transaction():
            self._db.executemany("INSERT INTO batch (first, count, crc, data) VALUES (?, ?, ?, ?)", rows)
            for first, count, *_ in rows:
                self._db.execute(
                    "DELETE FROM failure WHERE number BETWEEN ? AND ?", (first, first + count - 1)
                )
            if batch.messages:
                self._db.executemany("INSERT INTO failure VALUES (?, ?)", batch.messages.items())
                self._db.execute(_KEEP_FIRST, (MAX_FAILURES,))
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

    def close(self) -> None:
        """Put the log into the file, so that it is one file again, and unlock."""
        try:
            with contextlib.suppress(sqlite3.Error):  # a reader may have it open; a full disk keeps the log
                self._db.execute("PRAGMA journal_mode=DELETE")
            self._db.close()
        finally:
            self._unlock()

    def _unlock(self) -> None:
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def read_definition(folder: Path) -> str:
    """Return the text that says what a store belongs to.

    Raises
    ------
    StoreError : no store, a damaged one or one of an earlier version
    """
    with _reader(folder) as db:
        (text,) = db.execute("SELECT value FROM about WHERE key = 'definition'").fetchone()
        return str(text)


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
    check_version(folder)
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
    """Tell whether a file holds nothing yet, as after a kill before the first transaction."""
    (application,), (version,) = (
        db.execute(f"PRAGMA {n}").fetchone() for n in ("application_id", "user_version")
    )
    (tables,) = db.execute("SELECT count(*) FROM sqlite_master").fetchone()
    if application == 0 and tables == 0:
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


def _table(db: sqlite3.Connection | None, cases: Cases, with_values: bool) -> Table:
    outputs = len(cases.outputs)
    values = np.full((cases.count, outputs), np.nan) if with_values else None
    table = Table(np.full(cases.count, Status.MISSING, np.int8), values)
    if db is None:
        return table
    for first, count, crc, data in db.execute("SELECT first, count, crc, data FROM batch ORDER BY id"):
        if zlib.crc32(data) != crc or len(data) != count * (1 + 8 * outputs) or first + count > cases.count:
            table.damaged += 1
            continue
        table.status[first : first + count] = np.frombuffer(data, np.int8, count)
        if table.values is not None:
            found = np.frombuffer(data, "<f8", count * outputs, offset=count)
            table.values[first : first + count] = found.reshape(count, outputs)
    failed = table.status >= Status.REFUSED
    messages = db.execute("SELECT number, message FROM failure ORDER BY number")
    table.messages = {case: text for case, text in messages if failed[case]}
    runs = db.execute("SELECT versions, code FROM run ORDER BY rowid")
    table.runs = tuple(dict.fromkeys(Provenance(*run) for run in runs))
    return table
