"""Result files: NetCDF, CSV or MATLAB files of a dataset. A file is written completely or not at all."""

from __future__ import annotations

import errno
import io
import os
import re
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from lumped.errors import ParameterError, StorageError, refuse

if TYPE_CHECKING:
    import h5py
    import xarray as xr

#: Name of the scale of a dimension without coordinate, as the NetCDF-4 specification requires.
_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable. %9d"
#: Longest name of a MATLAB variable.
_LONGEST_NAME = 63
#: What to do where the folder in which the program runs was deleted.
WORKING_FOLDER_DELETED = "The working folder was deleted: change to a folder that exists."
DATA_SUFFIXES = (".nc", ".csv", ".mat")
FIGURE_SUFFIXES = (".png", ".svg", ".pdf")
#: Dimensions that become columns of a CSV file; all others become rows.
COLUMN_DIMENSIONS = ("pair", "multiplier", "law", "variant", "input")


def check_file(path: Path, suffixes: tuple[str, ...], *, force: bool) -> Path:
    """Return the path of an output file. A path that cannot or must not be written is refused."""
    if path.suffix.lower() not in suffixes:
        allowed = "a name ending in " + ", ".join(suffixes)
        raise refuse("output", path, allowed, "The suffix chooses the format.")
    if path.is_dir():
        raise refuse("output", path, "a file", "This is a folder; add a file name.")
    if os.path.lexists(path) and not force:  # also a link to nothing
        raise refuse("output", path, "a new file", "It exists: choose another name, or give --force.")
    if not path.parent.is_dir():
        raise refuse(
            "output", path, "a file in a folder that exists", f"Make the folder {path.parent} first."
        )
    try:
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise not_writable(path, error) from None
    return path


def working_folder_deleted() -> bool:
    """Return whether the folder in which the program runs was deleted: then no relative path has a place."""
    try:
        os.getcwd()
    except FileNotFoundError:
        return True
    return False


def not_writable(path: Path, error: OSError) -> ParameterError:
    """Return the refusal of a file or folder that cannot be written."""
    if not path.is_absolute() and working_folder_deleted():
        return refuse("output", path, "a place that exists", WORKING_FOLDER_DELETED)
    reason = error.strerror or type(error).__name__
    action = f"It cannot be written ({reason}): choose another."
    return refuse("output", path, "a place that can be written", action)


@contextmanager
def whole_file(path: Path, *, new: bool = False) -> Iterator[Path]:
    """Yield a temporary file to write, in the folder of ``path``. At the end the file is renamed to ``path``.

    After a failure no temporary file remains, and an existing file is unchanged. With ``new``, a file that
    has appeared at ``path`` in the meantime is not replaced: a StorageError is raised.
    """
    temporary: Path | None = None
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=path.suffix, dir=path.parent)
        temporary = Path(name)
        os.close(handle)
        yield temporary
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)  # mkstemp makes it private
        if new and os.path.lexists(path):
            raise FileExistsError(errno.EEXIST, "a file of this name appeared meanwhile")
        temporary.replace(path)
    except StorageError:
        raise
    except OSError as error:
        raise StorageError.of(path, error) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str, *, new: bool = False) -> None:
    """Write a text file completely or not at all. ``new``: as in ``whole_file``."""
    with whole_file(path, new=new) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_dataset(result: xr.Dataset, path: Path, *, new: bool = False) -> None:
    """Write a dataset as NetCDF, CSV or MATLAB file; the suffix decides. ``new``: as in ``whole_file``."""
    with whole_file(path, new=new) as temporary:
        if path.suffix.lower() == ".csv":
            _write_csv(result, temporary)
        elif path.suffix.lower() == ".mat":
            save_mat(mat_contents(result), temporary)
        else:
            _write_netcdf(result, temporary)


def _write_netcdf(result: xr.Dataset, path: Path) -> None:
    ready = _real(result)
    ready.attrs = {key: _attribute(value) for key, value in result.attrs.items()}
    for name, variable in result.variables.items():
        if variable.dtype == bool:  # NetCDF has no booleans
            ready[name] = variable.astype(np.int8)
    # HDF5 ends the process if the disk is full. So HDF5 writes to memory, and Python writes to the disk.
    content = io.BytesIO()
    _write_netcdf4(ready, content)
    path.write_bytes(content.getbuffer())


def _write_netcdf4(result: xr.Dataset, content: IO[bytes]) -> None:
    """Write a dataset by h5py. The writer of xarray takes four times as long for many small variables.

    Dimension scales follow the NetCDF-4 format specification. Real numbers are compressed.
    """
    import h5py
    import xarray as xr

    encoded, attributes = xr.conventions.encode_dataset_coordinates(result)
    with h5py.File(content, "w", track_order=True) as file:
        file.attrs.update({str(name): value for name, value in attributes.items()})
        for number, (name, size) in enumerate(result.sizes.items()):
            if name in encoded:
                scale = _dataset(file, str(name), encoded.pop(name))
                scale.make_scale(str(name))
            else:
                scale = file.create_dataset(str(name), (size,), dtype=">f4")
                scale.make_scale(_NO_VARIABLE % size)
            scale.attrs["_Netcdf4Dimid"] = np.int32(number)
        for name, variable in encoded.items():
            stored_variable = _dataset(file, str(name), variable)
            for axis, dimension in enumerate(variable.dims):
                stored_variable.dims[axis].attach_scale(file[str(dimension)])


def _dataset(file: h5py.File, name: str, variable: xr.Variable) -> h5py.Dataset:
    values = variable.to_numpy()
    options = dict[str, Any]()
    if values.dtype.kind in "OU":
        values = values.astype(object)
        import h5py

        options["dtype"] = h5py.string_dtype()
    is_real = values.dtype.kind == "f"
    if is_real:
        options["fillvalue"] = np.nan
        if values.ndim:
            options |= {"compression": "gzip", "compression_opts": 4, "shuffle": True}
    stored_variable = file.create_dataset(name, data=values, track_order=True, **options)
    stored_variable.attrs.update({str(key): value for key, value in variable.attrs.items()})
    if is_real:
        stored_variable.attrs["_FillValue"] = np.array([np.nan], dtype=values.dtype)
    return stored_variable


def _real(result: xr.Dataset) -> xr.Dataset:
    """Split complex variables into real and imaginary part: NetCDF and CSV have no complex numbers."""
    ready = result.copy()
    for name, variable in result.data_vars.items():
        if np.iscomplexobj(variable):
            ready[f"{name}_real"] = (variable.dims, variable.to_numpy().real, variable.attrs)
            ready[f"{name}_imag"] = (variable.dims, variable.to_numpy().imag, variable.attrs)
            ready = ready.drop_vars([str(name)])
    return ready


def _attribute(value: Any) -> Any:
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, (list, tuple)):
        return "; ".join(map(str, value))
    return value


def _inert(texts: np.ndarray[Any, np.dtype[Any]]) -> np.ndarray[Any, np.dtype[Any]]:
    """Put an apostrophe before text that a spreadsheet would run as a formula."""
    safe = [f"'{t}" if str(t).startswith(("=", "+", "-", "@", "\t", "\r")) else t for t in texts]
    return np.array(safe, dtype=object)


def _write_csv(result: xr.Dataset, path: Path) -> None:
    """Write one row per point of the axes, and one column per variable and entry of ``COLUMN_DIMENSIONS``."""
    import pandas as pd

    # A CSV file has one table. The regions of a chart would be a second table.
    ready = _real(result.drop_dims("region", errors="ignore"))
    axes = [str(d) for d in ready.sizes if d not in COLUMN_DIMENSIONS]
    grid = np.meshgrid(*(ready[d].to_numpy() for d in axes), indexing="ij")
    columns: list[tuple[str, Any]] = [
        (f"{d} [{ready[d].attrs.get('units', '1')}]", v.ravel()) for d, v in zip(axes, grid, strict=True)
    ]
    for name, variable in ready.data_vars.items():
        unit = variable.attrs.get("units", "1")
        others = [str(d) for d in variable.dims if d in COLUMN_DIMENSIONS]
        expanded = variable.expand_dims({d: ready[d] for d in axes if d not in variable.dims}).transpose(
            *others, *axes
        )
        values = expanded.to_numpy().reshape(-1, grid[0].size)
        labels = [""]
        for d in others:
            labels_of_axis = ready[d].to_numpy() if d in ready.coords else np.arange(ready.sizes[d])
            labels = [f"{label}_{d}{k}" for label in labels for k in labels_of_axis]
        columns += [(f"{name}{label} [{unit}]", row) for label, row in zip(labels, values, strict=True)]
    # A result file from elsewhere may name a variable like a formula.
    headings = _inert(np.array([heading for heading, _ in columns], dtype=object))
    columns = [(heading, v) for heading, (_, v) in zip(headings, columns, strict=True)]
    table = pd.DataFrame({heading: _inert(v) if v.dtype.kind in "OU" else v for heading, v in columns})
    table.to_csv(path, index=False, na_rep="nan", lineterminator="\r\n", encoding="utf-8")


def mat_contents(result: xr.Dataset) -> dict[str, Any]:
    """Return an array per variable and axis, and structs units, long_names, dimensions, attributes."""
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
