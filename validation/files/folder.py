"""A folder of results is written whole or not at all."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from lumped.errors import ParameterError, refuse

#: Value of "format" in report.json, by which an earlier report is recognised.
FORMAT = "spurcheck-report"
#: Version of the layout of report.json; a change that breaks readers raises it.
FORMAT_VERSION = 1


@dataclass(frozen=True)
class Kind:
    """What a folder holds, by which an earlier one is recognised before it is replaced.

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
FIGURES = Kind("figures.json", "spurcheck-figures", "set of figures")
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
        target = Path(os.path.realpath(target))
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
        if not is_report(target, kind):
            raise refuse(
                "output",
                out,
                f"a new or empty folder, or an earlier {kind.noun}",
                "It holds something else, which --force does not delete: choose another folder.",
            )
    return target


def is_report(folder: Path, kind: Kind = REPORT) -> bool:
    """Whether a folder holds earlier results of a kind, told by its JSON file."""
    try:
        data = json.loads((folder / kind.file).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(data, dict) and data.get("format") == kind.format


@contextmanager
def whole_folder(out: Path, *, force: bool, kind: Kind = REPORT) -> Iterator[Path]:
    """Give an empty folder beside ``out`` to write into, and put it in place of ``out`` at the end.

    On any failure, interruption included, nothing is left behind and earlier results stay as they were.

    Raises
    ------
    ParameterError : see ``check_target``
    """
    target = check_target(out, force=force, kind=kind)
    created = _make_parents(target)
    try:
        try:
            temporary = Path(
                tempfile.mkdtemp(prefix=f".{target.name}.", suffix=".partial", dir=target.parent)
            )
        except OSError as error:
            raise _not_writable(out, error) from None
        try:
            temporary.chmod(0o755)  # mkdtemp makes it private; a report is to be read
            yield temporary
            _exchange(temporary, target, force=force, kind=kind)
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    except BaseException:
        for folder in created:
            _remove_if_empty(folder)
        raise


def _exchange(temporary: Path, target: Path, *, force: bool, kind: Kind) -> None:
    check_target(target, force=force, kind=kind)  # something may have appeared there meanwhile
    if not target.exists():
        temporary.rename(target)
        return
    old = Path(tempfile.mkdtemp(prefix=f".{target.name}.", suffix=".old", dir=target.parent)) / "report"
    try:
        target.rename(old)
        try:
            temporary.rename(target)
        except BaseException:
            old.rename(target)
            raise
    finally:
        shutil.rmtree(old.parent, ignore_errors=True)


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
        raise _not_writable(target, error) from None
    return made


def _remove_if_empty(folder: Path) -> None:
    try:
        folder.rmdir()
    except OSError:
        return


def _content(folder: Path) -> bool:
    try:
        return any(folder.iterdir())
    except OSError as error:
        raise _not_writable(folder, error) from None


def _not_writable(out: Path, error: OSError) -> ParameterError:
    reason = error.strerror or type(error).__name__
    return refuse(
        "output", out, "a place that can be written", f"It cannot be written ({reason}): choose another."
    )
