"""A folder of results is written whole or not at all, and what else lies in it stays.

Every folder that is written holds the list of its own files (``CONTENTS``). Only those are replaced later,
and only if they are still as they were written: everything else is the user's.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from lumped.errors import StorageError, refuse
from validation.files.output import not_writable

#: Value of "format" in report.json, by which an earlier report is recognised.
FORMAT = "spurcheck-report"
#: Version of the layout of report.json; a change that breaks readers raises it.
FORMAT_VERSION = 1
#: File in each folder that names the files written there.
CONTENTS = "contents.json"
#: Beginning of the names of folders that exist only while results are written.
_WORKING = ".spurcheck-"


@dataclass(frozen=True)
class Kind:
    """What a folder holds.

    Attributes
    ----------
    file : JSON file that every folder of this kind has
    format : its value of "format"
    noun : for messages
    """

    file: str
    format: str
    noun: str


REPORT = Kind("report.json", FORMAT, "report")
MEASUREMENT = Kind("measurement.json", "spurcheck-measurement", "evaluation of a record")


def check_target(out: Path, *, force: bool, kind: Kind = REPORT) -> Path:
    """Return the absolute output folder after refusing one that must not be written.

    Parameters
    ----------
    out : folder, new or empty
    force : also accept one that holds earlier results of this kind
    kind : what is to be written

    Raises
    ------
    ParameterError : a file, a folder with content that is not to be replaced, or a place that is not writable
    """
    target = Path(os.path.abspath(out))
    if target.is_symlink():
        raise refuse("output", out, "a folder", "This is a link: name the folder itself.")
    if target.exists() and not target.is_dir():
        raise refuse("output", out, "a folder", "This is a file; choose another name.")
    if target.is_dir() and _content(target):
        if not force:
            raise refuse(
                "output",
                out,
                "a new or empty folder",
                f"It is not empty: choose another folder, or give --force to replace an earlier {kind.noun}.",
            )
        changed = [
            name for name, digest in _written(target, kind).items() if not _as_written(target / name, digest)
        ]
        if changed:
            raise refuse(
                "output",
                target / changed[0],
                "files as they were written",
                "It was changed since: move it elsewhere, or choose another folder.",
            )
    return target


@contextmanager
def whole_folder(out: Path, *, force: bool, kind: Kind = REPORT) -> Iterator[Path]:
    """Give an empty folder to write into, and put its files into ``out`` at the end.

    On any failure, interruption included, nothing is left behind and earlier results stay as they were.

    Raises
    ------
    ParameterError : see ``check_target``; or a new file has the name of one that is not of this program
    StorageError : the disk is full, or the place cannot be written any more
    """
    target = check_target(out, force=force, kind=kind)
    created = _make_parents(target)
    try:
        temporary = _working_folder(target, "partial")
        try:
            temporary.chmod(0o755)  # mkdtemp makes it private; a report is to be read
            yield temporary
            _list_contents(temporary, kind)
            check_target(target, force=force, kind=kind)  # something may have appeared there meanwhile
            if target.exists():
                _put(temporary, target, kind)
            else:
                temporary.rename(target)
        except StorageError:
            raise
        except OSError as error:
            raise StorageError.of(target, error) from error
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    except BaseException:
        for folder in created:
            _remove_if_empty(folder)
        raise


def _working_folder(target: Path, purpose: str) -> Path:
    """Make a folder on the same disk: in the target where there is one, which may be a disk of its own."""
    place = target if target.is_dir() else target.parent
    try:
        return Path(tempfile.mkdtemp(prefix=_WORKING, suffix=f".{purpose}", dir=place))
    except OSError as error:
        raise not_writable(target, error) from None


def _put(temporary: Path, target: Path, kind: Kind) -> None:
    """Move all files into the target; on a failure put back what was there."""
    earlier = [*_written(target, kind), CONTENTS] if _content(target) else []
    new = [path.relative_to(temporary).as_posix() for path in _files(temporary)]
    for name in new:
        if name not in earlier and os.path.lexists(target / name):
            action = "A file of the results has this name: move yours elsewhere, or choose another folder."
            raise refuse("output", target / name, "names that the results do not need", action)
    old = _working_folder(target, "old")
    moved: list[tuple[Path, Path]] = []
    try:
        for name in earlier:
            if (target / name).exists():
                moved.append(_move(target / name, old / name))
        for name in new:
            moved.append(_move(temporary / name, target / name))
    except BaseException:
        for here, there in reversed(moved):
            _move(there, here)
        raise
    finally:
        shutil.rmtree(old, ignore_errors=True)
    for folder in sorted({(target / name).parent for name in earlier} - {target}, reverse=True):
        _remove_if_empty(folder)


def _move(here: Path, there: Path) -> tuple[Path, Path]:
    there.parent.mkdir(parents=True, exist_ok=True)
    here.replace(there)
    return here, there


def _files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if not path.is_dir())


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _list_contents(folder: Path, kind: Kind) -> None:
    """Write the list of the files in a folder into it."""
    files = {path.relative_to(folder).as_posix(): _digest(path) for path in _files(folder)}
    data = {"format": kind.format, "files": files}
    (folder / CONTENTS).write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")


def _written(folder: Path, kind: Kind) -> Mapping[str, str]:
    """Files that an earlier run wrote into a folder -> their SHA-256.

    Raises
    ------
    ParameterError : the folder does not say so, or holds something else
    """
    files: object = None
    with suppress(OSError, ValueError, RecursionError):
        data = json.loads((folder / CONTENTS).read_text(encoding="utf-8"))
        if isinstance(data, dict) and data.get("format") == kind.format:
            files = data.get("files")
    if not isinstance(files, dict) or not all(
        _inside(name) and isinstance(d, str) for name, d in files.items()
    ):
        raise refuse(
            "output",
            folder,
            f"a new or empty folder, or an earlier {kind.noun}",
            f"It has no list of such files ({CONTENTS}), so nothing in it is replaced: choose another.",
        )
    return files


def _inside(name: object) -> bool:
    """Whether a name of the list stays in the folder."""
    return (
        isinstance(name, str) and bool(name) and not Path(name).is_absolute() and ".." not in Path(name).parts
    )


def _as_written(path: Path, digest: str) -> bool:
    """Whether a file is gone, or still holds what was written."""
    try:
        return not os.path.lexists(path) or (not path.is_symlink() and _digest(path) == digest)
    except OSError:
        return False


def _make_parents(target: Path) -> list[Path]:
    """Make missing parents; return those made, deepest first."""
    missing = [parent for parent in target.parents if not parent.exists()]
    made: list[Path] = []
    try:
        for parent in reversed(missing):
            parent.mkdir()
            made.insert(0, parent)
    except OSError as error:
        for folder in made:
            _remove_if_empty(folder)
        raise not_writable(target, error) from None
    return made


def _remove_if_empty(folder: Path) -> None:
    with suppress(OSError):
        folder.rmdir()


def _content(folder: Path) -> bool:
    try:
        return any(not path.name.startswith(_WORKING) for path in folder.iterdir())
    except OSError as error:
        raise not_writable(folder, error) from None
