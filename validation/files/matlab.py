"""MATLAB 5 files: labelled datasets and named arrays."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lumped.errors import refuse

if TYPE_CHECKING:
    import xarray as xr

#: Longest name of a MATLAB variable.
_LONGEST_NAME = 63


def mat_contents(result: xr.Dataset) -> dict[str, Any]:
    """Return the variables of the MATLAB file of a dataset.

    Parameters
    ----------
    result : any labelled dataset

    Returns
    -------
    one array per variable and axis, and the structs ``units``, ``long_names``, ``dimensions`` and
    ``attributes``

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


def save_mat(contents: Mapping[str, Any], path: Path) -> None:
    """Write a MATLAB 5 file. Vectors become columns, as MATLAB has them."""
    import scipy.io

    scipy.io.savemat(path, dict(contents), appendmat=False, long_field_names=True, oned_as="column")
