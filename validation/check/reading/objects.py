"""Objects of Python that are data: mappings, data frames, datasets."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lumped.errors import refuse, shown
from lumped.schema.pair import GearPair
from validation.check.curves import Curves, ValuesOverSpeed
from validation.check.reading.arrays import table_of_frame, table_of_mapping
from validation.check.reading.datasets import table_of_dataset
from validation.check.reading.interpretation import interpreted
from validation.check.reading.places_of_pairs import with_labels
from validation.check.reading.table import Table

_ALLOWED = (
    "a mapping from names to arrays, a pandas.DataFrame, an xarray.Dataset, a function f(parameters), or the "
    "path of a file"
)


def read_object(theirs: Any, pair: GearPair, name: str = "theirs") -> Curves | ValuesOverSpeed:
    """Return the curves of an object that is data.

    Raises
    ------
    ParameterError : an object of another kind, or one whose names or values cannot be used
    """
    if isinstance(theirs, (Curves, ValuesOverSpeed)):
        return theirs
    return interpreted(with_labels(table_of_object(theirs, name), pair), pair)


def table_of_object(theirs: Any, name: str) -> Table:
    """Return the table of an object that is data."""
    import pandas as pd
    import xarray as xr

    if isinstance(theirs, xr.DataArray):
        return table_of_dataset(theirs.to_dataset(name=theirs.name or name), name)
    if isinstance(theirs, xr.Dataset):
        return table_of_dataset(theirs, name)
    if isinstance(theirs, pd.DataFrame):
        return table_of_frame(theirs, name)
    if isinstance(theirs, Mapping):
        return table_of_mapping(theirs, name)
    if getattr(getattr(theirs, "dtype", None), "names", None):  # a record array
        return table_of_mapping({str(field): theirs[field] for field in theirs.dtype.names}, name)
    raise refuse("theirs", shown(theirs), _ALLOWED, "Write {'time': t, 'dte': dte}.")
