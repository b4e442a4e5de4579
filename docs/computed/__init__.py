"""Pages and figures that code writes when the site is built: no number on them is typed.

Each writer returns one file below ``docs/_generated``. They are computed again only when a source file of the
packages or of this folder has changed.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx

DOCS = Path(__file__).resolve().parents[1]
GENERATED = DOCS / "_generated"
_PACKAGES = ("lumped", "multibody", "floquet", "validation", "reproductions")
_SOURCES = (*_PACKAGES, "docs/computed", "docs/tutorial", "docs/verification", "tests/evidence")


def writers() -> Mapping[str, Callable[[], str]]:
    """File name -> what writes its text."""
    from computed import (
        agreement,
        answers,
        calibration,
        diagrams,
        elasticity,
        errata,
        faults,
        figures,
        interface,
        mutants,
        own_system,
        paper,
        rankings,
        reference_cases,
        schema,
        vaishya_singh,
        verification,
    )

    return {
        name: function
        for module in (
            verification,
            faults,
            mutants,
            own_system,
            answers,
            agreement,
            errata,
            paper,
            vaishya_singh,
            rankings,
            calibration,
            reference_cases,
            schema,
            interface,
            diagrams,
            figures,
            elasticity,
        )
        for name, function in module.FILES.items()
    }


def state() -> str:
    """Digest of everything that the files depend on."""
    digest = hashlib.sha256(importlib.metadata.version("spurcheck").encode())
    for folder in _SOURCES:
        for path in sorted((DOCS.parent / folder).rglob("*")):
            if (
                path.suffix in {".py", ".toml", ".json", ".csv", ".js", ".html", ".css"}
                or path.name == "own_system.md"
            ):
                digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()


def write_files(folder: Path = GENERATED) -> bool:
    """Write all files that are not up to date; return whether any had to be written."""
    stamp, now = folder / ".state", state()
    if stamp.exists() and stamp.read_text() == now:
        return False
    (folder / "pages").mkdir(parents=True, exist_ok=True)
    stamp.unlink(missing_ok=True)
    for name, write in writers().items():
        (folder / name).write_text(write(), encoding="utf-8")
    stamp.write_text(now)
    return True


def _on_build(app: Sphinx) -> None:
    from sphinx.util import logging

    if write_files():
        logging.getLogger(__name__).info("computed pages written to %s", GENERATED.name)


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the files before Sphinx reads its sources."""
    app.connect("builder-inited", _on_build, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
