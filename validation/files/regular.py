"""Files of a store: regular, never through a symbolic link, replaced at once or not at all."""

from __future__ import annotations

import contextlib
import os
import stat
from collections.abc import Iterator
from pathlib import Path

from lumped.errors import SpurcheckError

_NO_LINK = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)


class StoreError(SpurcheckError, OSError):
    """The store cannot be read or written; what it holds is kept, and the text says how to go on."""


def storage_failure(path: Path, doing: str, error: OSError) -> StoreError:
    """Return the error for a failed file operation, with what to do next."""
    reason = error.strerror or str(error)
    return StoreError(
        f"{path}: cannot {doing}: {reason}. What was computed so far is kept; "
        "free space or restore the permission, then run the same command with --resume."
    )


def open_regular(path: Path, flags: int) -> int:
    """Open a regular file itself, not what a link of that name points to.

    Raises
    ------
    StoreError : it cannot be opened, or is a link, a directory, a pipe or a device
    """
    try:
        # Without O_NONBLOCK a pipe of that name would block for ever.
        descriptor = os.open(path, flags | _NO_LINK | getattr(os, "O_NONBLOCK", 0), 0o644)
    except OSError as error:
        if path.is_symlink():
            raise StoreError(
                f"{path} is a symbolic link; a store only uses files of its own. Remove it."
            ) from None
        raise storage_failure(path, "open it", error) from error
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise StoreError(f"{path} is not a regular file; a store only uses files of its own. Remove it.")
    return descriptor


@contextlib.contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Write a file completely or not at all: yields a new file beside ``path`` that then takes its place.

    A link named ``path`` is replaced, not followed. On failure the old file stays and the new one is removed.

    Raises
    ------
    StoreError : the file cannot be written
    """
    part = path.with_name(f".{path.name}.part")
    try:
        with contextlib.suppress(FileNotFoundError):
            part.unlink()  # left by a run that was killed
        os.close(open_regular(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL))
        yield part
        with part.open("rb+") as file:
            os.fsync(file.fileno())
        os.replace(part, path)
        sync_folder(path.parent)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink()
        if isinstance(error, StoreError):
            raise
        raise storage_failure(path, "write it", error) from error
    except BaseException:
        with contextlib.suppress(OSError):
            part.unlink()
        raise


def sync_folder(folder: Path) -> None:
    """Make a new name in a folder survive a power failure, where the system can."""
    if os.name != "posix":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_text(path: Path, text: str) -> None:
    """Write a text file completely or not at all."""
    with replaced(path) as part:
        part.write_text(text, encoding="utf-8")


def read_bytes(path: Path, limit: int) -> bytes:
    """Read a regular file of at most ``limit`` bytes."""
    descriptor = open_regular(path, os.O_RDONLY)
    with os.fdopen(descriptor, "rb") as file:
        data = file.read(limit + 1)
    if len(data) > limit:
        raise StoreError(f"{path} is larger than {limit} bytes, which no store writes. Remove it.")
    return data
