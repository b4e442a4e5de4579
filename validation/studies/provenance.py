"""What the last digits of a result depend on: code, versions, processor."""

from __future__ import annotations

import hashlib
import os
import platform
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import lumped
from lumped.elasticity.processor import processor

_PACKAGES = ("lumped", "multibody", "floquet", "validation")
_LIBRARIES = ("spurcheck", "numpy", "scipy", "numba", "llvmlite", "exudyn")
#: Settings of numba that change what it makes of the same source.
_COMPILER = ("NUMBA_DISABLE_JIT", "NUMBA_OPT", "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES")


class Provenance(NamedTuple):
    """Where a result comes from.

    Attributes
    ----------
    versions : of Python and the libraries, the machine type, and settings of the compiler where set
    code : hash of the source files of the four packages, which are the compiled kernels' source too
    processor : its name; processors of different types may differ in the last digits
    """

    versions: str
    code: str
    processor: str

    def same_code(self, other: Provenance) -> bool:
        """Tell whether the results of both may stand in one table."""
        return self[:2] == other[:2]


@cache
def provenance() -> Provenance:
    """Return the provenance of what this process computes."""
    parts = [f"python {platform.python_version()}"]
    parts += [f"{name} {metadata.version(name)}" for name in _LIBRARIES]
    parts += [platform.machine()] + [f"{name}={os.environ[name]}" for name in _COMPILER if name in os.environ]
    digest = hashlib.sha256()
    root = Path(lumped.__file__).parent.parent
    for path in sorted(file for name in _PACKAGES for file in (root / name).rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return Provenance(", ".join(parts), digest.hexdigest(), processor())
