"""Arrays of a NetCDF file by name, times in seconds."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import xarray as xr

from validation.check.reading.units import si_factor
from validation.files.hdf5 import check_hdf5
from validation.files.matlab import MOST_BYTES, check_size


def netcdf_arrays(path: Path, known: Callable[[str], bool]) -> dict[str, Any]:
    """Read the variables of a file, and its attribute ``period``.

    Coordinates without a meaning, such as the numbers of rows, are left out. The attribute "units" of times
    and of the period is converted to seconds.

    Parameters
    ----------
    path : .nc
    known : whether a name has a meaning

    Raises
    ------
    ValueError : a file that is damaged or too large
    ParameterError : a unit that is not one of time
    """
    arrays: dict[str, Any] = {}
    if h5py.is_hdf5(path):
        check_hdf5(path, MOST_BYTES // 8)
    with xr.open_dataset(path, decode_times=False) as file:
        check_size(sum(8 * variable.size for variable in file.variables.values()))
        for name, variable in file.variables.items():
            field = str(name)
            if field in file.data_vars or known(field):
                values = variable.to_numpy()
                unit = str(variable.attrs.get("units", "s"))
                is_time = field == "period" or field.endswith("_times")
                arrays[field] = values * si_factor(unit, "s", field) if is_time else values
        if "period" in file.attrs and "period" not in arrays:
            arrays["period"] = file.attrs["period"]
    return arrays
