"""Test of an HDF5 file in a second process, before this process reads the file.

The HDF5 library trusts the bytes of a file. One wrong byte can end the process that reads, and another can
make it read for ever, without a point at which Python could stop it. So a second process with a time limit
reads everything that a reader could ask for: names, attributes, dimensions and values.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

#: Time of the second process [s]: for its start, and for each megabyte of the file.
_PATIENCE = 20.0
_PATIENCE_PER_MEGABYTE = 1.0
#: Program of the second process. Where it meets an exception, the reader in this process meets the same one,
#: and refuses the file in words. Values are read where the variables claim less than the limit.
_READER = """
import sys, h5netcdf, h5py
most = int(sys.argv[2])
def read_attributes(item):
    for name in item.attrs:
        item.attrs[name]
try:
    with h5py.File(sys.argv[1]) as file:
        items = [file[name] for name in file if isinstance(file.get(name, getlink=True), h5py.HardLink)]
        items = [item for item in items if isinstance(item, h5py.Dataset)]
        read_attributes(file)
        for item in items:
            read_attributes(item)
        stored = [item for item in items if not item.is_virtual and not item.external]
        if sum(item.size or 0 for item in stored) <= most:
            for item in stored:
                item[()]
    with h5netcdf.File(sys.argv[1], phony_dims="sort") as file:
        for variable in file.variables.values():
            variable.dimensions, dict(variable.attrs)
except Exception:
    pass
"""


def check_hdf5(path: Path, most_numbers: int) -> None:
    """Read an HDF5 file in a second process with a time limit.

    Parameters
    ----------
    path : an HDF5 file
    most_numbers : values are read where the variables of the file claim no more numbers than this

    Raises
    ------
    ValueError : the file ends the process that reads, or keeps the process busy beyond the time limit
    """
    command = [sys.executable, "-P", "-c", _READER, str(path), str(most_numbers)]
    patience = _PATIENCE + _PATIENCE_PER_MEGABYTE * path.stat().st_size / 1e6
    try:
        run = subprocess.run(command, capture_output=True, check=False, timeout=patience)
    except subprocess.TimeoutExpired:
        raise ValueError(f"it is damaged: the HDF5 library still reads it after {patience:.0f} s") from None
    if run.returncode:
        raise ValueError("it is damaged: it ends the process that reads it")
