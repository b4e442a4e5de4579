"""Results for other programs: CSV, NetCDF and MATLAB files of a labelled dataset."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
import xarray as xr

from lumped.errors import refuse
from validation.output import check_file, whole_file, write_dataset

SUFFIXES = (".csv", ".nc", ".mat")
#: Longest name of a MATLAB variable.
_LONGEST_NAME = 63


def write_results(result: xr.Dataset, path: str | Path, *, force: bool = False) -> Path:
    """Write a dataset of spurcheck for another program, whole or not at all.

    Parameters
    ----------
    result : for example of ``lumped.simulate``; units stay SI
    path : file to write; .csv (one row per point of the axes), .nc (NetCDF 4) or .mat (MATLAB 5: one array
        per variable and axis, with the structs ``units``, ``long_names``, ``dimensions`` and ``attributes``)
    force : overwrite an existing file

    Returns
    -------
    Path that was written

    Raises
    ------
    ParameterError : an unknown suffix, an existing file without ``force``, or a name MATLAB cannot have
    """
    path = check_file(Path(path), SUFFIXES, force=force)
    if path.suffix.lower() == ".mat":
        write_mat(mat_contents(result), path)
    else:
        write_dataset(result, path)
    return path


def mat_contents(result: xr.Dataset) -> dict[str, Any]:
    """Return the variables of the MATLAB file of a dataset.

    Parameters
    ----------
    result : any labelled dataset

    Raises
    ------
    ParameterError : a variable whose name MATLAB cannot have
    """
    contents: dict[str, Any] = {}
    about: dict[str, dict[str, Any]] = {"units": {}, "long_names": {}, "dimensions": {}}
    for key, variable in result.variables.items():
        name = str(key)
        contents[name] = np.asarray(variable.to_numpy())
        about["units"][name] = str(variable.attrs.get("units", "1"))
        about["long_names"][name] = str(variable.attrs.get("long_name", name))
        about["dimensions"][name] = ", ".join(map(str, variable.dims))
    taken = sorted(about.keys() & contents.keys())
    bad = [n for n in contents if not re.fullmatch(r"[A-Za-z]\w*", n, re.ASCII) or len(n) > _LONGEST_NAME]
    if taken or bad:
        allowed = "letters, digits, underscores; none of " + ", ".join(about)
        raise refuse("variable", ", ".join(taken + bad), allowed, "Rename it with Dataset.rename.")
    attributes = {
        str(key): value if isinstance(value, (int, float)) else str(value)
        for key, value in result.attrs.items()
        if re.fullmatch(r"[A-Za-z]\w*", str(key), re.ASCII) and len(str(key)) <= _LONGEST_NAME
    }
    return {**contents, **about, "attributes": attributes}


def write_mat(contents: Mapping[str, Any], path: Path) -> None:
    """Write a MATLAB 5 file, whole. Vectors become columns, as MATLAB has them."""
    with whole_file(path) as temporary:
        scipy.io.savemat(temporary, dict(contents), appendmat=False, long_field_names=True, oned_as="column")
