"""Evidence about the program: figures that ``make evidence`` computed, and the source they are of."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

_OWN = ("lumped", "multibody", "floquet", "validation")
_SUFFIXES = frozenset({".py", ".toml", ".html", ".css", ".js"})


@cache
def source_hash() -> str:
    """SHA-256 over names and contents of the four packages' files: says more than a version does."""
    digest = hashlib.sha256()
    for package in _OWN:
        root = Path(str(resources.files(package)))
        for path in sorted(p for p in root.rglob("*") if p.suffix in _SUFFIXES):
            digest.update(f"{package}/{path.relative_to(root).as_posix()}\0".encode())
            digest.update(path.read_bytes() + b"\0")
    return digest.hexdigest()


@cache
def stored_evidence() -> Mapping[str, Any]:
    """Figures by kind of evidence, the day and the source of their computation: ``validation/evidence.json``.

    ``kinds`` has key, title and ``checks``, each subject, exact, value, limit and, of an order, theory.
    """
    text = resources.files("validation").joinpath("evidence.json").read_text(encoding="utf-8")
    found: Mapping[str, Any] = json.loads(text)
    return found
