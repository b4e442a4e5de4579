"""The folder of a report is written whole or not at all, and replaces only an earlier report.

Every folder that is written holds the list of its own files (``CONTENTS``). A folder with any other file
in it is not replaced.
"""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from lumped.errors import StorageError, refuse
from validation.files.output import not_writable

#: Value of "format" in report.json, by which an earlier report is recognised.
FORMAT = "spurcheck-report"
#: Version of the layout of report.json; a change that breaks readers raises it.
FORMAT_VERSION = 3
#: File in each folder that names the files written there.
CONTENTS = "contents.json"


def check_target(out: Path, *, force: bool) -> Path:
    """Return the absolute output folder after refusing one that must not be written.

    It is new or empty; with ``force`` it may hold an earlier report and nothing else.
    """
    target = Path(os.path.abspath(out))
    if target.is_symlink():
        raise refuse("output", out, "a folder", "This is a link: name the folder itself.")
    if target.exists() and not target.is_dir():
        raise refuse("output", out, "a folder", "This is a file; choose another name.")
    found = _files(target)
    if found and not force:
        action = "It is not empty: choose another folder, or give --force to replace an earlier report."
        raise refuse("output", out, "a new or empty folder", action)
    if found and (others := sorted(found - _written(target))):
        action = "This file is not of it: move it elsewhere, or choose another folder."
        raise refuse("output", target / others[0], "nothing but an earlier report", action)
    return target


@contextmanager
def whole_folder(out: Path, *, force: bool) -> Iterator[Path]:
    """Give an empty folder to write into, and put it in the place of ``out`` at the end.
    On any failure, interruption included, nothing is left behind and earlier results stay as they were.
    """
    target = check_target(out, force=force)
    missing = [parent for parent in target.parents if not parent.exists()]
    work: Path | None = None
    try:
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            work = Path(tempfile.mkdtemp(prefix=".spurcheck-", dir=target.parent))
        except OSError as error:
            raise not_writable(target, error) from None
        new = work / "new"
        old = work / "old"
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
            shutil.rmtree(work, ignore_errors=True)
        for folder in missing:
            with suppress(OSError):  # of another one, and of what holds the report
                folder.rmdir()


def _files(folder: Path) -> set[str]:
    """Names of all files below a folder, none where there is no folder."""
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if not path.is_dir()}


def _written(folder: Path) -> set[str]:
    """Files that an earlier run wrote into a folder."""
    with suppress(OSError, ValueError, RecursionError, TypeError, KeyError):
        data = json.loads((folder / CONTENTS).read_text(encoding="utf-8"))
        if data["format"] == FORMAT:
            return {CONTENTS, *map(str, data["files"])}
    action = f"It has no list of such files ({CONTENTS}), so nothing in it is replaced: choose another."
    raise refuse("output", folder, "a new or empty folder, or an earlier report", action)
