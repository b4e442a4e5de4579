"""Arrays of a MATLAB file, read in a second process."""

from __future__ import annotations

import io
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
from numpy.typing import NDArray

#: Most bytes that the arrays of a file may take: matrices of some thousand states.
MOST_BYTES = 500_000_000
#: Seconds after which the second process is ended.
_PATIENCE = 300.0
#: Program of the second process, because one wrong byte can end the process that reads. Its address space is
#: bounded: the size inside a structure is not known before it is read. Sparse matrices become full. A field
#: of a structure gets the name "structure.field", the field of member 2 of an array of structures
#: "structure_2.field". MATLAB stores version 7.3 as HDF5, with all dimensions turned round. The names of
#: arrays begin with "=", the names of objects that nothing but MATLAB reads with "?".
_READER = """
import io, sys, numpy, scipy.io
try:
    import resource
    resource.setrlimit(resource.RLIMIT_AS, (6_000_000_000, resource.getrlimit(resource.RLIMIT_AS)[1]))
except ImportError:
    pass
arrays = {}
numbers = [b"", b"double", b"single", b"logical"]
numbers += [b"%sint%d" % (sign, bits) for sign in (b"", b"u") for bits in (8, 16, 32, 64)]
def add(name, value, depth=0):
    if type(value).__name__ in ("MatlabOpaque", "MatlabFunction"):
        text = value.ravel()[0]["s0"] if value.dtype.names and "s0" in value.dtype.names else name
        arrays["?" + (text.decode() if isinstance(text, bytes) else str(text))] = numpy.zeros(0)
        return
    value = value.toarray() if hasattr(value, "toarray") else numpy.asarray(value)
    if depth > 8:
        raise ValueError("its structures are nested too deeply")
    if value.dtype.names:
        members = value.ravel()
        for number, member in enumerate(members, 1):
            for field in value.dtype.names:
                add(f"{name}{'_%d' % number if members.size > 1 else ''}.{field}", member[field], depth + 1)
    elif value.dtype.kind == "O" and value.size == 1:
        add(name, value.ravel()[0], depth + 1)
    elif value.dtype.kind in "biufcSU":
        arrays["=" + name] = value
    else:
        arrays["?" + name] = numpy.zeros(0)
def add_hdf5(name, item, depth=0):
    import h5py
    if isinstance(item, h5py.Group):
        for key in item:
            if key[0] != "#":
                add_hdf5(f"{name}.{key}" if name else key, item[key], depth + 1)
        return
    kind = item.attrs.get("MATLAB_class", b"")
    if kind == b"char":
        arrays["=" + name] = numpy.array("".join(map(chr, item[()].T.ravel())))
    elif item.dtype.names == ("real", "imag"):
        arrays["=" + name] = (item["real"] + 1j * item["imag"]).T
    elif kind in numbers and item.dtype.kind in "biuf" and not item.attrs.get("MATLAB_empty", 0):
        if item.size > int(sys.argv[2]) // 8:
            raise ValueError(f"it claims to hold {8 * item.size:.3g} bytes")
        arrays["=" + name] = item[()].T
    else:
        arrays["?" + name] = numpy.zeros(0)
with open(sys.argv[1], "rb") as file:
    is_hdf5 = b"MATLAB 7.3" in file.read(128)
if is_hdf5:
    import h5py
    with h5py.File(sys.argv[1]) as file:
        add_hdf5("", file)
else:
    for name, value in scipy.io.loadmat(sys.argv[1]).items():
        if name[0] != "_":
            add(name, value)
content = io.BytesIO()
numpy.savez(content, **arrays)
sys.stdout.buffer.write(content.getbuffer())
"""


class MatlabArrays(dict[str, NDArray[Any]]):
    """Numbers and texts of a MATLAB file by name; field of a structure: "structure.field".

    Attributes
    ----------
    unreadable : names of objects that no other program reads, such as a ``timeseries``
    """

    def __init__(self, arrays: dict[str, NDArray[Any]], unreadable: tuple[str, ...]) -> None:
        super().__init__(arrays)
        self.unreadable = unreadable


def matlab_arrays(path: Path) -> MatlabArrays:
    """Read the arrays of a .mat file of any version since 4, structures included.

    Raises
    ------
    ValueError : the file is damaged, or its arrays take more than ``MOST_BYTES``; the text says which
    """
    with path.open("rb") as file:
        is_hdf5 = b"MATLAB 7.3" in file.read(128)
    if not is_hdf5:
        check_size(sum(8 * math.prod(shape) for _, shape, _ in scipy.io.whosmat(path)))
    command = [sys.executable, "-P", "-c", _READER, str(path), str(MOST_BYTES)]
    try:
        run = subprocess.run(command, capture_output=True, check=False, timeout=_PATIENCE)
    except subprocess.TimeoutExpired:
        raise ValueError(f"reading it takes more than {_PATIENCE:.0f} s") from None
    if run.returncode:
        *_, last_line = run.stderr.decode(errors="replace").strip().split("\n")
        raise ValueError(last_line or "it is damaged")
    with np.load(io.BytesIO(run.stdout), allow_pickle=False) as file:
        arrays = {name[1:]: file[name] for name in file if name[0] == "="}
        return MatlabArrays(arrays, tuple(name[1:] for name in file if name[0] == "?"))


def check_size(bytes_of_arrays: int) -> None:
    """Raise ValueError where the arrays of a file take more than ``MOST_BYTES``.

    A small compressed file can unfold to gigabytes.
    """
    if bytes_of_arrays > MOST_BYTES:
        raise ValueError(f"it claims to hold {bytes_of_arrays:.3g} bytes")
