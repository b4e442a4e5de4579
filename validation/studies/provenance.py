"""What the last digits of a result depend on: code, versions, processor."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import lumped

_PACKAGES = ("lumped", "multibody", "floquet", "validation")


class Provenance(NamedTuple):
    """Where a result comes from.

    Attributes
    ----------
    versions : of Python and the libraries, and the machine type
    code : hash of the source files of the four packages
    """

    versions: str
    code: str


@cache
def provenance() -> Provenance:
    """Return the provenance of what this process computes."""
    names = ("spurcheck", "numpy", "scipy", "numba", "exudyn")
    parts = [f"{name} {metadata.version(name)}" for name in names]
    digest = hashlib.sha256()
    root = Path(lumped.__file__).parent.parent
    for path in sorted(file for name in _PACKAGES for file in (root / name).rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    versions = ", ".join([f"python {platform.python_version()}", *parts, platform.machine()])
    return Provenance(versions, digest.hexdigest())


def processor() -> str:
    """Return the name of the processor; processors of different types may differ in the last digits."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
