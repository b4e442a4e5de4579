"""Finished blocks of the regression grid in a folder, so that an interrupted run goes on where it was."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any

import lumped
from lumped.errors import refuse
from validation.cross_check.agreement import FIDELITIES, QUANTITIES
from validation.cross_check.grid.point import GridPoint
from validation.files.output import write_text

Block = tuple[str, str, str]
_KEY = "grid.json"
_PACKAGES = ("lumped", "multibody", "validation")


class Checkpoint:
    """A folder with one JSON file per finished block, each written whole.

    Parameters
    ----------
    folder : made if missing
    grid : fields of the grid it belongs to

    Raises
    ------
    ParameterError : the folder belongs to another grid or to another state of the code, or it is no folder
        that can be written
    """

    def __init__(self, folder: Path, grid: Mapping[str, Any]) -> None:
        self.folder = folder
        key = json.loads(json.dumps(dict(grid) | {"code": _code(), "tables": [FIDELITIES, QUANTITIES]}))
        path = folder / _KEY
        try:
            folder.mkdir(parents=True, exist_ok=True)
            if not path.exists():
                write_text(path, json.dumps(key, indent=1) + "\n")
            known = _read(path)
        except OSError as error:
            reason = error.strerror or type(error).__name__
            raise refuse("checkpoint", folder, "a folder that can be written", f"{reason}.") from None
        if known != key:
            raise refuse(
                "checkpoint",
                folder,
                "the folder of the same grid and the same code",
                "Name another folder, or delete this one.",
            )

    def load(self, blocks: Iterable[Block]) -> dict[Block, list[GridPoint]]:
        """Points of all blocks that are finished; a file that cannot be read counts as not finished."""
        found = {}
        for block in blocks:
            data = _read(self._path(block))
            if isinstance(data, list):
                found[block] = [GridPoint.from_data(point) for point in data]
        return found

    def save(self, block: Block, points: Sequence[GridPoint]) -> None:
        """Keep a finished block."""
        write_text(self._path(block), json.dumps([point.to_data() for point in points]) + "\n")

    def _path(self, block: Block) -> Path:
        return self.folder / ("-".join(block) + ".json")


def _read(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, json.JSONDecodeError, UnicodeDecodeError):
        return None


def _code() -> str:
    """What the numbers depend on: versions, and the source of the three packages."""
    digest = sha256()
    root = Path(lumped.__file__).parent.parent
    for path in sorted(p for name in _PACKAGES for p in (root / name).rglob("*.py")):
        digest.update(path.read_bytes())
    return f"exudyn {version('exudyn')}, numpy {version('numpy')}, source {digest.hexdigest()[:16]}"
