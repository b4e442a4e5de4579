"""Tables of words that stand as TOML beside the code that gives them their numbers."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any


def read_table(folder: str, file: str) -> dict[str, Any]:
    """Read a TOML file of a package; the lines of every text in it are joined.

    ``folder``: package that the file is in; ``file``: its name.
    """
    found: dict[str, Any] = _joined(tomllib.loads((files(folder) / file).read_text(encoding="utf-8")))
    return found


def _joined(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _joined(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_joined(one) for one in value]
    return " ".join(value.split()) if isinstance(value, str) else value
