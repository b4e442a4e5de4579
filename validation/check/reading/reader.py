"""Read curves of another model or of a record, whatever the source is."""

from __future__ import annotations

import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from lumped.arguments import file_path, nearest
from lumped.errors import ParameterError, refuse, shown
from lumped.schema.pair import GearPair
from validation.check.curves import Curves, ValuesOverSpeed
from validation.check.reading.arrays import table_of_mapping
from validation.check.reading.datasets import read_netcdf_table
from validation.check.reading.description import Description, curves_of_description, read_description
from validation.check.reading.fmu import read_fmu
from validation.check.reading.interpretation import interpreted
from validation.check.reading.objects import read_object
from validation.check.reading.other_model import other_model
from validation.check.reading.places_of_pairs import with_labels
from validation.check.reading.table import Table
from validation.check.reading.text_table import ANY_LAYOUT, Layout, read_text_table
from validation.check.reading.workbook import read_workbook
from validation.files.matlab import check_size, matlab_arrays

#: Endings of files of text with columns.
TEXT_SUFFIXES = (".csv", ".txt", ".tsv", ".tab", ".dat", ".asc", ".lvm", ".prn", ".out", ".res")
#: Endings of all files that are read.
SUFFIXES = (*TEXT_SUFFIXES, ".xlsx", ".mat", ".nc", ".npz", ".toml", ".fmu", ".py:function")
#: Endings of files of other programs -> what to do.
_ELSEWHERE = {
    ".xls": "Save the sheet as .xlsx or .csv.",
    ".xlsm": "Save the sheet as .xlsx or .csv.",
    ".ods": "Save the sheet as .xlsx or .csv.",
    ".mf4": "Export the channels as .csv or .mat.",
    ".mdf": "Export the channels as .csv or .mat.",
    ".tdms": "Export the channels as .csv or .mat.",
    ".uff": "Export the channels as .csv or .mat.",
    ".slx": "Run the model, and save its signals: save('out.mat', '-struct', 'out', '-v7').",
    ".m": "Run the script, and save its signals: save('out.mat', 't', 'dte', '-v7').",
    ".json": "Save a .csv, or call spurcheck.check(pair, json.load(file)).",
    ".npy": "Save the columns by name: numpy.savez('x.npz', time=t, dte=dte).",
    ".pkl": "Save a .csv: frame.to_csv('x.csv').",
    ".parquet": "Save a .csv, or call spurcheck.check(pair, pandas.read_parquet(file)).",
    ".h5": "Save a NetCDF or MATLAB file, or call spurcheck.check(pair, {'time': t, 'dte': dte}).",
}


def read(theirs: Any, pair: GearPair, *, name: str | None = None) -> Curves | ValuesOverSpeed:
    """Read curves, or values over speed, in SI.

    Parameters
    ----------
    theirs : path of a text, .xlsx, .mat, .nc, .npz, .fmu or .toml file; a mapping from names to arrays, a
        data frame, a dataset; a function of the parameters of the pair, or "model.py:function", which is run
    pair : the gear pair; its tooth numbers turn angles into mesh cycles
    name : short name of the source; default the name of the file or function

    Returns
    -------
    The curves; ``remarks`` says which units were assumed and which columns are not used

    Raises
    ------
    ParameterError : a source that is not recognised; the text says what to type
    """
    model = other_model(theirs)
    if model is not None:
        curves = model.curves(pair)
    elif isinstance(theirs, (str, Path)):
        curves = _read_file(file_path("theirs", theirs), pair)
    else:
        curves = read_object(theirs, pair)
    return curves if name is None else replace(curves, name=name)


def _read_file(path: Path, pair: GearPair) -> Curves | ValuesOverSpeed:
    try:
        if path.suffix.lower() == ".toml":
            return _read_described(path, pair)
        return interpreted(with_labels(_table(path, pair, "theirs"), pair), pair)
    except ParameterError as error:
        source = error.source or str(path)
        raise ParameterError(list(error.problems), source) from None


def _read_described(path: Path, pair: GearPair) -> Curves | ValuesOverSpeed:
    description = read_description(path, "theirs")
    data = path.parent / description.data
    try:
        return curves_of_description(description, _table(data, pair, "data", description), pair)
    except ParameterError as error:
        raise ParameterError(list(error.problems), str(data)) from None


def _table(path: Path, pair: GearPair, field: str, description: Description | None = None) -> Table:
    """Return the columns of a file."""
    suffix = path.suffix.lower()
    if suffix in TEXT_SUFFIXES:
        layout = Layout(description.delimiter, description.decimal) if description else ANY_LAYOUT
        return read_text_table(path, layout, field=field)
    if suffix not in SUFFIXES or suffix == ".toml":
        allowed = "a name ending in " + ", ".join(SUFFIXES)
        action = _ELSEWHERE.get(suffix) or nearest(suffix, SUFFIXES) or "Save a .csv file."
        raise refuse(field, path, allowed, action)
    if not path.is_file():
        raise refuse(field, path, "a file that exists", "Check the folder and the name.")
    if suffix == ".xlsx":
        return read_workbook(path, field)
    if suffix == ".mat":
        return _matlab_table(path, field)
    if suffix == ".nc":
        return read_netcdf_table(path, field)
    if suffix == ".fmu":
        return read_fmu(path, pair, field, _variables(description))
    return _numpy_table(path, field)


def _variables(description: Description | None) -> tuple[str, ...]:
    """Variables of an FMU that a description names."""
    if description is None:
        return ()
    return tuple(column for column in description.columns if column != "time")


def _matlab_table(path: Path, field: str) -> Table:
    try:
        arrays = matlab_arrays(path)
    except Exception as error:  # noqa: BLE001  (readers raise anything of a damaged file)
        action = f"Save it again: save('x.mat', 't', 'dte', '-v7'). ({shown(str(error), 120)})"
        raise refuse(field, path, "a .mat file of arrays", action) from None
    if not arrays and arrays.unreadable:
        raise refuse(
            field, f"objects {', '.join(map(shown, arrays.unreadable))}", "arrays and structures",
            "Take the arrays out: t = ts.Time; dte = ts.Data; save('x.mat', 't', 'dte', '-v7').",
        )  # fmt: skip
    remarks: tuple[str, ...] = ()
    if arrays.unreadable:
        remarks = (f"Objects of MATLAB that are not read: {', '.join(map(shown, arrays.unreadable))}.",)
    return table_of_mapping(arrays, path.stem, remarks)


def _numpy_table(path: Path, field: str) -> Table:
    try:
        with zipfile.ZipFile(path) as archive:
            check_size(sum(member.file_size for member in archive.infolist()))
        with np.load(path, allow_pickle=False) as file:
            return table_of_mapping(dict(file), path.stem)
    except ParameterError:
        raise
    except Exception as error:  # noqa: BLE001  (readers raise anything of a damaged file)
        action = f"Save it again: numpy.savez('x.npz', time=t, dte=dte). ({shown(str(error), 120)})"
        raise refuse(field, path, "a .npz file of arrays", action) from None
