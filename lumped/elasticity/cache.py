"""Results that are kept between runs in the user's cache folder.

A result is a file of numbers, named after everything that its digits depend on: what was computed, source and
libraries of what computes it, processor, threads of BLAS. Files appear whole or not at all, so runs side by
side do no harm; one that cannot be read is computed again, and a folder that cannot be written is done
without.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache
from importlib import metadata
from pathlib import Path

import numpy as np
from platformdirs import user_cache_path

from lumped.elasticity.processor import blas_threads, processor
from lumped.typing import FloatArray


def kept(inputs: bytes, compute: Callable[[], dict[str, FloatArray]]) -> dict[str, FloatArray]:
    """Return what ``compute`` returns, from the cache folder where it has been computed before.

    Parameters
    ----------
    inputs : everything that the result depends on apart from source, libraries and machine
    compute : arrays of finite numbers by name
    """
    key = hashlib.sha256(_made_by() + blas_threads().encode() + b"\0" + inputs)
    path = user_cache_path("spurcheck", appauthor=False) / "elasticity" / f"{key.hexdigest()}.npz"
    # Whatever is wrong with a file, its numbers are not needed.
    with contextlib.suppress(Exception), path.open("rb") as stream, np.load(stream) as file:
        found = {name: file[name] for name in file.files}
        if found.pop("whole").item() == _sum(found):
            return found
    result = compute()
    with contextlib.suppress(OSError):
        _write(path, result)
    return result


def _write(path: Path, result: dict[str, FloatArray]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            np.savez(file, whole=np.array(_sum(result)), **result)  # type: ignore[arg-type]
        os.replace(name, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(name)
        raise


def _sum(result: dict[str, FloatArray]) -> str:
    parts = (name.encode() + result[name].tobytes() for name in sorted(result))
    return hashlib.sha256(b"".join(parts)).hexdigest()


@cache
def _made_by() -> bytes:
    files = sorted(Path(__file__).parent.glob("*.py"))
    machine = [metadata.version("numpy"), metadata.version("scipy"), processor()]
    return hashlib.sha256(b"".join(file.read_bytes() for file in files) + repr(machine).encode()).digest()
