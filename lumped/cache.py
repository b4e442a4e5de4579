"""Files that are stored between runs: results of finite elements, compiled code.

The name of a file is a hash of everything on which its content depends. A file begins with a checksum and
gets its name when it is complete. So a kill, a full disk or parallel runs leave no wrong file.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import os
import platform
import tempfile
from collections.abc import Callable, Iterable
from functools import cache
from importlib import metadata
from pathlib import Path

import numpy as np
from platformdirs import user_cache_path

from lumped.typing import FloatArray


def cached(
    folder: str, sources: Iterable[Path], inputs: bytes, compute: Callable[[], dict[str, FloatArray]]
) -> dict[str, FloatArray]:
    """Return the arrays that ``compute`` returns, from the user's cache folder where they are stored.

    ``inputs`` is everything on which the arrays depend beside the source files, libraries and the machine. If
    the folder cannot be written, nothing is stored.
    """
    key = hashlib.sha256(_made_by(tuple(sources)) + blas_threads().encode() + b"\0" + inputs).hexdigest()
    path = cache_folder() / folder / f"{key}.npz"
    if (content := read_whole(path)) is not None:
        with np.load(io.BytesIO(content)) as file:
            return {name: file[name] for name in file.files}
    result = compute()
    stream = io.BytesIO()
    np.savez(stream, **result)  # type: ignore[arg-type]
    with contextlib.suppress(OSError):
        write_whole(path, stream.getvalue())
    return result


def cache_folder() -> Path:
    """Return the user's cache folder; for a user without a home, a folder that cannot be made."""
    try:
        folder = user_cache_path("spurcheck", appauthor=False)
    except RuntimeError:
        folder = Path()
    return folder if folder.is_absolute() else Path(os.devnull, "no-home-folder")


def read_whole(path: Path) -> bytes | None:
    """Return content that ``write_whole`` has stored; None where it is missing or damaged."""
    try:
        stored = path.read_bytes()
    except OSError:
        return None
    return stored[32:] if hashlib.sha256(stored[32:]).digest() == stored[:32] else None


def write_whole(path: Path, content: bytes) -> None:
    """Store content with its checksum. The file gets its name when it is complete."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(hashlib.sha256(content).digest() + content)
        os.replace(name, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(name)
        raise


@cache
def _made_by(sources: tuple[Path, ...]) -> bytes:
    machine = [metadata.version("numpy"), metadata.version("scipy"), processor()]
    return hashlib.sha256(b"".join(path.read_bytes() for path in sources) + repr(machine).encode()).digest()


@cache
def processor() -> str:
    """Name of the processor, which decides the instructions of BLAS and compilers, and so the rounding."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def blas_threads() -> str:
    """Number of threads of OpenBLAS, by the settings that OpenBLAS reads when it is loaded.

    The number decides how large products are cut, and so their rounding.
    """
    for name in ("OPENBLAS_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS"):
        if os.environ.get(name):
            return os.environ[name]
    return str(cores())


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
