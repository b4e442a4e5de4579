"""Tables of words that stand as TOML beside the code that gives them their numbers."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any


def rows(folder: str, file: str, table: str) -> list[dict[str, Any]]:
    """Rows of a table, the lines of every text joined.

    Parameters
    ----------
    folder : package that the file is in
    file, table : their names
    """
    found = tomllib.loads((files(folder) / file).read_text(encoding="utf-8"))[table]
    return [{k: " ".join(v.split()) if isinstance(v, str) else v for k, v in row.items()} for row in found]
