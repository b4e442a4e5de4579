"""The store that cannot be lost: an append-only file of checksummed records, one a case.

Why not straight into HDF5 or Zarr: an HDF5 file killed in the middle of a write does not open again, and a
Zarr array that takes single cases is one file and one rename a case. An appended record is one system call,
is whole or detectably not, and costs only itself when it is damaged. The labelled NetCDF file is compiled
from the journal (``validation.studies.results``), as often as wanted, with the same bytes each time.
"""

from __future__ import annotations

import contextlib
import hashlib
import mmap
import os
import struct
import time
import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from lumped.errors import refuse
from validation.files.regular import StoreError, open_regular, storage_failure
from validation.studies.cases import CaseList
from validation.studies.record import MAGIC, Record, Status, decode, encode

try:
    import fcntl
except ImportError:  # pragma: no cover  (no advisory locks on this system)
    fcntl = None  # type: ignore[assignment]

_HEADER = struct.Struct("<8s32s32sQII")
_START = b"SPURSWP1"
#: Written records reach the disk itself at most this much later [s]; a killed process loses none of them.
SYNC_SECONDS = 1.0


@dataclass(frozen=True)
class Scan:
    """What a pass over a journal found.

    Attributes
    ----------
    damaged_bytes : bytes between or after the records that are no whole record
    end : end of the last undamaged record
    sessions : texts of the session records, in order
    size : bytes of the file
    """

    damaged_bytes: int
    end: int
    sessions: tuple[str, ...]
    size: int


#: What a pass finds where there is no journal.
NOTHING = Scan(0, 0, (), 0)


class Key:
    """What binds a journal to one list of cases of one study."""

    def __init__(self, cases: CaseList) -> None:
        self.study = bytes.fromhex(cases.study.sha256)
        self.cases = bytes.fromhex(cases.sha256)
        self.count = cases.count
        self.outputs = len(cases.study.outputs)
        #: Start of every checksum: a record of another study or another list of cases never passes.
        self.seed = zlib.crc32(hashlib.sha256(self.study + self.cases).digest())
        head = _HEADER.pack(_START, self.study, self.cases, self.count, self.outputs, 0)
        self.header = head + struct.pack("<I", zlib.crc32(head))


def scan(path: Path, key: Key, visit: Callable[[Record], None]) -> Scan:
    """Visit every undamaged record of a journal in the order of writing.

    After damage the pass goes on at the next place where a record with a right checksum starts.

    Raises
    ------
    StoreError : it cannot be read
    ParameterError : it belongs to another study
    """
    descriptor = open_regular(path, os.O_RDONLY)
    try:
        size = os.fstat(descriptor).st_size
        if size == 0:
            return NOTHING
        with mmap.mmap(descriptor, 0, access=mmap.ACCESS_READ) as data:
            found = _scan(data, size, key, visit)
            _check_header(path, data[: len(key.header)], key)
            return found
    finally:
        os.close(descriptor)


def _scan(data: Any, size: int, key: Key, visit: Callable[[Record], None]) -> Scan:
    at = end = min(len(key.header), size)
    damaged = 0
    sessions: list[str] = []
    while at < size:
        read = decode(data, at, key.outputs, key.seed)
        if read is None:
            following = data.find(MAGIC, at + 1)
            at = following if following >= 0 else size
            continue
        record, after = read
        damaged += at - end
        at = end = after
        if record.status is Status.SESSION:
            sessions.append(record.message)
        elif record.case < key.count:
            visit(record)
    return Scan(damaged + size - end, end, tuple(sessions), size)


def _check_header(path: Path, header: bytes, key: Key) -> None:
    """Refuse the journal of another study; a damaged header is no loss, the records are bound to it too."""
    whole = len(header) == len(key.header) and header != key.header
    if whole and struct.unpack("<I", header[-4:])[0] == zlib.crc32(header[:-4]):
        if header[8:40] == key.study:
            allowed = "the same cases"
            action = "Another version of scipy draws other samples: use the version that began the study."
        else:
            allowed = "a folder of this very study"
            action = "The study was changed since: choose another --output."
        raise refuse("output", path.parent, allowed, action)


class Journal:
    """A journal opened for appending, locked against a second writer.

    Parameters
    ----------
    path : file
    key : what it belongs to
    found : what ``scan`` found in it; anything after the last undamaged record is cut off

    Raises
    ------
    StoreError : it cannot be written, or another run writes to it or wrote to it since the scan
    """

    def __init__(self, path: Path, key: Key, found: Scan = NOTHING) -> None:
        self.path, self.key = path, key
        self._file = open_regular(path, os.O_RDWR | os.O_CREAT)
        try:
            self._lock()
            size = os.fstat(self._file).st_size
            if size != found.size:
                raise StoreError(
                    f"{path}: another run wrote to it just now. Run the same command with --resume."
                )
            self._end = max(found.end, len(key.header))
            os.ftruncate(self._file, min(self._end, size))
            os.lseek(self._file, 0, os.SEEK_SET)
            self._write(key.header)  # the same bytes again, unless they were damaged
            os.fsync(self._file)
        except OSError as error:
            os.close(self._file)
            if isinstance(error, StoreError):
                raise
            raise storage_failure(path, "write it", error) from error
        self._synced = time.monotonic()

    def _lock(self) -> None:
        if fcntl is None:  # pragma: no cover
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise StoreError(
                f"{self.path}: another run is writing to it. Wait for it, or choose another --output."
            ) from None

    def append(self, records: Iterable[Record]) -> None:
        """Write records; once this returns they survive the end of this process.

        Raises
        ------
        StoreError : they cannot be written; the journal then ends with the last whole record
        """
        block = b"".join(encode(record, self.key.outputs, self.key.seed) for record in records)
        try:
            os.lseek(self._file, self._end, os.SEEK_SET)
            self._write(block)
            if time.monotonic() - self._synced > SYNC_SECONDS:
                self.sync()
        except OSError as error:
            with contextlib.suppress(OSError):  # what cannot be cut off is found by its checksum
                os.ftruncate(self._file, self._end)
            if isinstance(error, StoreError):
                raise
            raise storage_failure(self.path, "write to it", error) from error
        self._end += len(block)

    def _write(self, block: bytes) -> None:
        view = memoryview(block)
        while view:
            view = view[os.write(self._file, view) :]

    def sync(self) -> None:
        """Make everything written so far survive a power failure.

        Raises
        ------
        StoreError : it cannot, or the file is no longer where it was, so that nobody would find its records
        """
        try:
            os.fsync(self._file)
        except OSError as error:
            raise storage_failure(self.path, "write to it", error) from error
        self._synced = time.monotonic()
        try:
            there = os.path.samestat(os.fstat(self._file), os.lstat(self.path))
        except OSError as error:
            there = not isinstance(error, FileNotFoundError)  # else nobody can say
        if not there:
            raise StoreError(
                f"{self.path} was moved, deleted or replaced while the sweep ran. If it was moved, go on "
                "there with --resume; else begin again in a new --output."
            )

    def close(self) -> None:
        """Write out and unlock."""
        try:
            self.sync()
        finally:
            os.close(self._file)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
