"""CONTRIBUTING.md as a page: its links lead to files of the repository, which are no part of the site."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

_FILE = Path(__file__).resolve().parents[2] / "CONTRIBUTING.md"
_LINK = re.compile(r"\[([^\]]*)\]\((?![a-z]+:)[^)\s]+\)")


def _read(app: Sphinx, docname: str, source: list[str]) -> None:
    if docname == "contributing/index":
        app.env.note_dependency(str(_FILE))
        source[0] = _LINK.sub(r"\1", _FILE.read_text(encoding="utf-8"))


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the hook."""
    app.connect("source-read", _read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
