"""Files of a store: plain files, one process at a time, failures in plain words."""

from __future__ import annotations

import contextlib
import os
import sqlite3
import stat
from collections.abc import Iterator
from pathlib import Path

from lumped.errors import SpurcheckError

try:
    import fcntl
except ImportError:  # pragma: no cover  (no advisory locks on this system)
    fcntl = None  # type: ignore[assignment]

STORE = "store.sqlite"


class StoreError(SpurcheckError, OSError):
    """The store cannot be read or written; what it holds is kept, and the text says how to go on."""


def storage_failure(path: Path, doing: str, error: Exception) -> StoreError:
    """Return the error for a failed file operation, with what to do next."""
    reason = getattr(error, "strerror", None) or str(error)
    return StoreError(
        f"{path}: cannot {doing}: {reason}. What was computed so far is kept; "
        "free space or restore the permission, then run the same command with --resume."
    )


@contextlib.contextmanager
def translated(path: Path, doing: str) -> Iterator[None]:
    """Give the errors of SQLite in the user's words."""
    try:
        yield
    except sqlite3.Error as error:
        if isinstance(error, sqlite3.OperationalError) and not str(error).startswith("no such"):
            raise storage_failure(path, doing, error) from error
        raise damaged(path, str(error)) from error


def damaged(path: Path, why: str) -> StoreError:
    """Return the error for a file that is no store that can be read."""
    reason = " ".join(why.split())
    return StoreError(
        f"{path} is damaged or no store: {reason}. It stays as it is. Put a copy back, rescue its cases with "
        f"the SQLite command `sqlite3 {path.name} .recover`, or begin again in a new --output."
    )


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other processes from writing to a folder; the lock ends with this process at the latest.

    Raises
    ------
    StoreError : another process has it, or the folder cannot be written
    """
    path = folder / ".lock"
    check_plain(path)
    try:
        lock = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o644)
    except OSError as error:
        raise storage_failure(path, "open it", error) from error
    try:
        if fcntl is not None:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError:
        text = "another run is writing to this folder. Wait for it, or choose another --output."
        raise StoreError(f"{folder}: {text}") from None
    finally:
        os.close(lock)


def check_plain(path: Path) -> None:
    """Refuse a link, folder, pipe or device in the place of a file of the store: nothing is followed."""
    for name in (path.name, f"{path.name}-wal", f"{path.name}-shm", f"{path.name}-journal"):
        try:
            mode = os.lstat(path.with_name(name)).st_mode
        except OSError:
            continue
        if not stat.S_ISREG(mode):
            kind = "a symbolic link" if stat.S_ISLNK(mode) else "not a regular file"
            raise StoreError(
                f"{path.with_name(name)} is {kind}; a store only uses files of its own. Remove it."
            )
