"""Output folders. A folder is written completely or not at all, and replaces only an earlier report.

Every output folder contains a list of the files written there (``CONTENTS``). A folder with any other file is
not replaced.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from lumped.errors import StorageError, refuse
from validation.files.abandoned import EARLIER, remove_abandoned, remove_working_folder, working_folder
from validation.files.output import not_writable

#: Value of "format" in report.json; marks an earlier report.
FORMAT = "spurcheck-report"
#: Version of the layout of report.json. The number rises with every change that breaks programs that read it.
FORMAT_VERSION = 3
#: File in each folder that names the files written there.
CONTENTS = "contents.json"


def check_target(out: Path, *, force: bool) -> Path:
    """Return the absolute path of the output folder. A folder that must not be written is refused.

    The folder must be new or empty. With ``force`` the folder may contain an earlier report and nothing else.
    """
    try:
        target = Path(os.path.abspath(out))
    except FileNotFoundError as error:
        raise not_writable(out, error) from None
    if target.is_symlink():
        raise refuse("output", out, "a folder", "This is a link: name the folder itself.")
    if target.exists() and not target.is_dir():
        raise refuse("output", out, "a folder", "This is a file; choose another name.")
    present_files = _files(target)
    if present_files and not force:
        action = "It is not empty: choose another folder, or give --force to replace an earlier report."
        raise refuse("output", out, "a new or empty folder", action)
    if present_files and (foreign_files := sorted(present_files - _written(target))):
        action = "This file is not of it: move it elsewhere, or choose another folder."
        raise refuse("output", target / foreign_files[0], "nothing but an earlier report", action)
    return target


@contextmanager
def whole_folder(out: Path, *, force: bool) -> Iterator[Path]:
    """Yield an empty folder to write into. At the end the folder is renamed to ``out``.

    After a failure or an interruption no temporary files remain, and earlier results are unchanged. Folders
    of killed runs are removed first.
    """
    remove_abandoned(check_target(out, force=force).parent)
    target = check_target(out, force=force)
    missing = [parent for parent in target.parents if not parent.exists()]
    work: Path | None = None
    try:
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            work = working_folder(target)
        except OSError as error:
            raise not_writable(target, error) from None
        new = work / "new"
        old = work / EARLIER
        new.mkdir()
        try:
            yield new
            contents = {"format": FORMAT, "files": sorted(_files(new))}
            (new / CONTENTS).write_text(json.dumps(contents, indent=1) + "\n", encoding="utf-8")
            check_target(target, force=force)  # something may have appeared there meanwhile
            if target.exists():
                target.rename(old)
            try:
                new.rename(target)
            except BaseException:
                if old.exists():
                    old.rename(target)
                raise
        except StorageError:
            raise
        except OSError as error:
            raise StorageError.of(target, error) from error
    finally:
        if work is not None:
            remove_working_folder(work)
        for folder in missing:
            with suppress(OSError):  # a folder that is not empty stays
                folder.rmdir()


def _files(folder: Path) -> set[str]:
    """Return the names of all files below a folder. Empty if the folder does not exist."""
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if not path.is_dir()}


def _written(folder: Path) -> set[str]:
    """Return the files that an earlier run wrote into a folder. A folder without their list is refused."""
    with suppress(OSError, ValueError, RecursionError, TypeError, KeyError):
        data = json.loads((folder / CONTENTS).read_text(encoding="utf-8"))
        if data["format"] == FORMAT:
            return {CONTENTS, *map(str, data["files"])}
    action = f"It has no list of such files ({CONTENTS}), so nothing in it is replaced: choose another."
    raise refuse("output", folder, "a new or empty folder, or an earlier report", action)
