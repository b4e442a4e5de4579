"""Working folders of runs that were killed: how a run marks its folder, and when the next run removes it.

A run locks a file in its working folder. The system ends the lock with the process, however the process ends.
So a folder whose lock is free belongs to nobody. A folder without this file is never touched: it is being
made, or is not ours.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

#: Beginning of the name of a working folder, beside the folder of results.
PREFIX = ".spurcheck-"
#: File that the run locks. Its text is the name of the folder of results.
_LOCK = "lock"
#: Earlier results, which were moved here to be replaced.
EARLIER = "old"


def working_folder(target: Path) -> Path:
    """Make an empty folder beside ``target``, and lock it until this process ends.

    Raises OSError : the folder cannot be made
    """
    folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=target.parent))
    try:
        import fcntl
    except ImportError:  # Windows
        return folder
    # The lock is taken before the file has its name: no other run sees a file that is not locked yet.
    unnamed = folder / f"{_LOCK}.new"
    descriptor = os.open(unnamed, os.O_RDWR | os.O_CREAT, 0o600)
    with suppress(OSError):  # a file system without locks
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        os.write(descriptor, os.fsencode(target.name))
        unnamed.rename(folder / _LOCK)
    _locks[folder] = descriptor
    return folder


#: Folders that this process has locked, and the descriptors of the locks.
_locks: dict[Path, int] = {}


def remove_working_folder(folder: Path) -> None:
    """Remove a folder of ``working_folder`` and its lock."""
    shutil.rmtree(folder, ignore_errors=True)
    descriptor = _locks.pop(folder, None)
    if descriptor is not None:
        os.close(descriptor)


def remove_abandoned(parent: Path) -> None:
    """Remove working folders in ``parent`` whose process has ended.

    Earlier results in such a folder go back to their place if nothing is there: the run was killed between
    the two steps by which results are replaced.
    """
    try:
        import fcntl
    except ImportError:  # Windows
        return
    for folder in parent.glob(f"{PREFIX}*"):
        if folder in _locks or folder.is_symlink():
            continue
        with suppress(OSError):  # no lock, in use, or not ours
            descriptor = os.open(folder / _LOCK, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0))
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                target = parent / Path(os.fsdecode(os.read(descriptor, 4096))).name
                if (folder / EARLIER).is_dir() and not os.path.lexists(target):
                    (folder / EARLIER).rename(target)
                shutil.rmtree(folder, ignore_errors=True)
            finally:
                os.close(descriptor)
