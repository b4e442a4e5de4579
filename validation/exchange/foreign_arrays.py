"""Arrays in a file of NumPy or MATLAB from elsewhere, read by a process of its own with limits.

A damaged .mat file can end the process that reads it, and a small file can unfold to gigabytes.
"""

from __future__ import annotations

import io
import math
import os
import subprocess
import sys
import zipfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

#: Largest file, and the most bytes of its arrays: matrices of some thousand states.
_MOST_BYTES = 500_000_000
#: Memory that the process may take, scipy included, where the system has such limits.
_MOST_MEMORY = 4_000_000_000
_MOST_SECONDS = 120.0


def read_arrays(path: Path) -> dict[str, np.ndarray[Any, np.dtype[Any]]]:
    """Return the arrays of a .npz or .mat file by name; sparse matrices are full ones.

    Raises ValueError with the reason where it cannot be read.
    """
    if path.stat().st_size > _MOST_BYTES:
        raise ValueError(f"it is larger than {_MOST_BYTES:.1g} bytes")
    try:
        run = subprocess.run(
            [sys.executable, "-P", __file__, str(path.absolute())],
            capture_output=True,
            check=False,
            timeout=_MOST_SECONDS,
            env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
        )
    except subprocess.TimeoutExpired:
        raise ValueError(f"reading it takes more than {_MOST_SECONDS:g} s") from None
    if run.returncode < 0 or run.returncode > 1:
        raise ValueError("it is damaged and ends the reader")
    if run.returncode:
        lines = run.stderr.decode(errors="replace").split("\n")
        raise ValueError(next((line for line in reversed(lines) if line.strip()), "unknown")[:120])
    with np.load(io.BytesIO(run.stdout), allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def _main(path: str) -> None:
    """Write the arrays to stdout in NumPy's format."""
    try:
        import resource
    except ImportError:  # no such limits on Windows
        pass
    else:
        with suppress(ValueError, OSError):  # macOS has the names, and refuses some of the limits
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            resource.setrlimit(resource.RLIMIT_AS, (_MOST_MEMORY, _MOST_MEMORY))
    found = _numpy(path) if path.lower().endswith(".npz") else _matlab(path)
    content = io.BytesIO()
    np.savez(content, **found)  # objects become pickles, which the other side refuses
    sys.stdout.buffer.write(content.getbuffer())


def _numpy(path: str) -> dict[str, Any]:
    with zipfile.ZipFile(path) as archive:
        _check_size(sum(member.file_size for member in archive.infolist()))
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def _matlab(path: str) -> dict[str, Any]:
    import scipy.io

    _check_size(sum(8 * math.prod(shape) for _, shape, _ in scipy.io.whosmat(path)))
    found = scipy.io.loadmat(path)
    # Sparse matrices, as finite-element programs save them, become full ones.
    return {
        name: value.toarray() if hasattr(value, "toarray") else value
        for name, value in found.items()
        if not name.startswith("__")
    }


def _check_size(wanted: int) -> None:
    if wanted > _MOST_BYTES:
        raise ValueError(f"it claims to hold {wanted:.3g} bytes")


if __name__ == "__main__":
    try:
        _main(sys.argv[1])
    except Exception as error:  # noqa: BLE001
        sys.exit(f"{type(error).__name__}: {error}".splitlines()[0])
