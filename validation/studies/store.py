"""The store of a study: one SQLite file, one row for each case, one transaction for each chunk of cases.

After a crash the file has every chunk that was added. The labelled NetCDF file is compiled from the store
and has the same bytes each time.
"""

from __future__ import annotations

import os
import platform
import sqlite3
from collections import Counter
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np
import numpy.typing as npt

from lumped.cache import processor
from lumped.errors import StorageError, refuse
from lumped.labelling import source_hash
from lumped.typing import FloatArray
from validation.studies.cases import CaseList

STORE = "store.sqlite"
#: Error texts in the results: those of the failed cases with the lowest numbers.
MAX_FAILURES = 10_000
_BEGIN = (
    "CREATE TABLE about (key TEXT PRIMARY KEY, value TEXT)",
    "CREATE TABLE run (versions TEXT, code TEXT, processor TEXT)",
    "CREATE TABLE result (number INTEGER PRIMARY KEY, status INTEGER, outputs BLOB, message TEXT)",
)
_LIBRARIES = ("spurcheck", "numpy", "scipy", "numba", "llvmlite", "exudyn")
#: Settings of numba that change what it makes of the same source.
_COMPILER = ("NUMBA_DISABLE_JIT", "NUMBA_OPT", "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES")


class StoreError(StorageError):
    """The store cannot be read or written. Stored results are kept, and the text says how to continue."""


class Status(IntEnum):
    """Outcome of a case. The codes stand in stores and results: a code never gets another meaning."""

    MISSING = -1
    OK = 0
    OUTSIDE_LAW_RANGE = 1
    REFUSED = 2
    NUMERICAL = 3
    UNEXPECTED = 4
    WORKER_DIED = 5
    TIME_LIMIT = 6
    LINEAR_MOTION = 7

    @property
    def failed(self) -> bool:
        """Whether the case has no outputs."""
        return Status.REFUSED <= self <= Status.TIME_LIMIT

    @staticmethod
    def failed_among(codes: npt.NDArray[np.int8]) -> npt.NDArray[np.bool_]:
        """Return for each code of a status whether the case has no outputs."""
        return np.isin(codes, [int(status) for status in Status if status.failed])


class Provenance(NamedTuple):
    """Origin of the last digits of a result: versions, hash of the source, name of the processor."""

    versions: str
    code: str
    processor: str


@cache
def provenance() -> Provenance:
    """Return the provenance of results of this process."""
    parts = [f"python {platform.python_version()}"]
    parts += [f"{name} {metadata.version(name)}" for name in _LIBRARIES]
    parts += [platform.machine()] + [f"{name}={os.environ[name]}" for name in _COMPILER if name in os.environ]
    return Provenance(", ".join(parts), source_hash(), processor())


@dataclass(frozen=True)
class Chunk:
    """Outcomes of some cases.

    Attributes
    ----------
    rows : for each case number, status, outputs as bytes of doubles or None, error text or None
    seconds : computing time of all cases [s]
    provenance : process that computed the cases
    """

    rows: list[tuple[int, int, bytes | None, str | None]]
    seconds: float
    provenance: Provenance


@dataclass
class Table:
    """Outcomes of all cases.

    Attributes
    ----------
    status : (cases,) status of each case
    values : (cases, outputs) results; NaN: the case has no outputs
    messages : number of a failed case -> error text, for at most ``MAX_FAILURES`` cases
    runs : provenance of the results, in order, each once
    """

    status: np.ndarray[Any, np.dtype[np.int8]]
    values: FloatArray
    messages: dict[int, str] = field(default_factory=dict)
    runs: tuple[Provenance, ...] = ()

    def counts(self) -> Counter[Status]:
        """Cases by status."""
        codes, numbers = np.unique(self.status, return_counts=True)
        return Counter({Status(int(c)): int(n) for c, n in zip(codes, numbers, strict=True)})


class Store:
    """The store of cases in a folder, opened for adding. A lock keeps other processes out.

    A store of other cases, or of another version of the code, is refused. A StoreError says that the store
    cannot be used, is damaged, or that another process writes to the store.
    """

    def __init__(self, folder: Path, cases: CaseList) -> None:
        self._cases = cases
        self.path = folder / STORE
        with _translated(self.path):
            self._db = sqlite3.connect(self.path, isolation_level=None, timeout=0.5)
        try:
            with _translated(self.path):
                self.new = not self._db.execute("SELECT * FROM sqlite_master").fetchall()
                if not self.new:
                    _check_same(self._db, self.path, cases)
                self._db.execute("PRAGMA journal_mode=WAL")
                self._db.execute("PRAGMA synchronous=NORMAL")
                self._db.execute("BEGIN IMMEDIATE")  # the lock; every commit takes it again
                if self.new:
                    for statement in _BEGIN:
                        self._db.execute(statement)
                    self._db.executemany("INSERT INTO about VALUES (?, ?)", _about(cases).items())
                    self._commit()
                self._runs = set(_runs(self._db))
            if {run.code for run in self._runs} - {provenance().code}:
                action = "Spurcheck was changed since: use the code that began it, or another folder."
                raise refuse("output", self.path, "a store that this very code began", action)
        except BaseException:
            self._db.close()
            raise

    def _commit(self) -> None:
        self._db.execute("COMMIT")
        self._db.execute("BEGIN IMMEDIATE")

    def add(self, chunk: Chunk) -> None:
        """Write the outcomes of a chunk. A later outcome of a case replaces an earlier outcome."""
        with _translated(self.path):
            if chunk.provenance not in self._runs:
                self._db.execute("INSERT INTO run VALUES (?, ?, ?)", chunk.provenance)
                self._runs.add(chunk.provenance)
            self._db.executemany("INSERT OR REPLACE INTO result VALUES (?, ?, ?, ?)", chunk.rows)
            self._commit()

    def table(self) -> Table:
        """Return the outcomes so far."""
        with _translated(self.path):
            return _table(self._db, self._cases)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """Close the file and give its lock back."""
        self._db.close()


def read_definition(folder: Path) -> str:
    """Return the study of a store as text. Raises StoreError where there is no store."""
    with _reader(folder) as db:
        return str(dict(db.execute("SELECT key, value FROM about"))["definition"])


def read_table(folder: Path, cases: CaseList) -> Table:
    """Return the outcomes in a store, also while another process adds outcomes."""
    with _reader(folder) as db:
        _check_same(db, folder / STORE, cases)
        return _table(db, cases)


@contextmanager
def _reader(folder: Path) -> Iterator[sqlite3.Connection]:
    path = folder / STORE
    if not path.exists():
        raise StoreError(f"{path}: no store of a study. Name the folder that a sweep wrote.")
    with _translated(path), closing(sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True)) as db:
        yield db


@contextmanager
def _translated(path: Path) -> Iterator[None]:
    """Raise errors of SQLite as StoreError, in the words of the user."""
    try:
        yield
    except sqlite3.Error as error:
        if "locked" in str(error):
            text = f"{path}: another run is writing to it. Wait for it, or choose another --output."
        elif isinstance(error, sqlite3.OperationalError) and not str(error).startswith("no such"):
            text = (
                f"{path}: cannot be used: {error}. What was computed so far is kept; free space or restore "
                "the permission, then run the same command with --resume."
            )
        else:
            text = f"{path} is damaged or no store: {error}. It stays as it is: begin in a new --output."
        raise StoreError(text) from error


def _about(cases: CaseList) -> dict[str, str]:
    return {"definition": cases.study.to_toml(), "cases_sha256": cases.sha256}


def _check_same(db: sqlite3.Connection, path: Path, cases: CaseList) -> None:
    """Refuse the store of other cases."""
    stored = dict(db.execute("SELECT key, value FROM about"))
    wanted = _about(cases)
    if stored == wanted:
        return
    if stored.get("definition") == wanted["definition"]:
        allowed = "a store of the same cases"
        action = "Another version of scipy draws other samples: use the version that began the study."
    else:
        allowed = "a store of this very study"
        action = "The study was changed since: choose another folder."
    raise refuse("output", path, allowed, action)


def _runs(db: sqlite3.Connection) -> list[Provenance]:
    return [Provenance(*row) for row in db.execute("SELECT * FROM run ORDER BY rowid")]


def _table(db: sqlite3.Connection, cases: CaseList) -> Table:
    table = Table(
        np.full(cases.count, Status.MISSING, np.int8),
        np.full((cases.count, len(cases.study.outputs)), np.nan),
    )
    for case, status, outputs, message in db.execute("SELECT * FROM result ORDER BY number"):
        table.status[case] = status
        if outputs is not None:
            table.values[case] = np.frombuffer(outputs, "<f8")
        elif len(table.messages) < MAX_FAILURES:
            table.messages[case] = message
    table.runs = tuple(_runs(db))
    return table
