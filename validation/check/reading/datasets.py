"""Datasets of xarray and NetCDF files become a table."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from lumped.errors import ParameterError, refuse, shown
from validation.check.quantities import QUANTITIES
from validation.check.reading.attributes import operating_point
from validation.check.reading.meaning import abscissa_of
from validation.check.reading.places_of_pairs import heading_of_place
from validation.check.reading.table import Column, Table, listed, numbers_of
from validation.files.hdf5 import check_hdf5
from validation.files.matlab import MOST_BYTES

if TYPE_CHECKING:
    import xarray as xr


def table_of_dataset(data: xr.Dataset, name: str) -> Table:
    """Make a table of a dataset over one dimension, and over "pair" for quantities of tooth pairs.

    Units are those of the attribute "units". Results of this program also state speed and torque.
    """
    dimension = _dimension(data)
    columns = []
    unused = []
    for key, variable in data.variables.items():
        heading = str(key)
        unit = variable.attrs.get("units")
        unit = str(unit) if unit is not None else None
        numbers = numbers_of(variable.to_numpy()) if variable.dtype.kind in "iufcb" else None
        if variable.dims == (dimension,) and numbers is not None:
            columns.append(Column(heading, numbers, unit))
        elif set(variable.dims) == {dimension, "pair"} and numbers is not None and _of_pair(heading):
            rows = variable.transpose("pair", dimension).to_numpy()
            columns += [
                Column(heading_of_place(heading, place), np.asarray(row, dtype=np.float64), unit)
                for place, row in enumerate(rows)
            ]
        elif variable.dims not in ((), ("pair",)):
            unused.append(heading)
    remarks = (f"Not over {dimension} alone, and not used: {listed(unused)}.",) if unused else ()
    return Table(
        name,
        tuple(columns),
        operating_point(data.attrs, one_speed="speed" not in data.sizes),
        remarks=remarks,
    )


def _of_pair(name: str) -> bool:
    return name == "position" or (name in QUANTITIES and QUANTITIES[name].of_tooth_pair)


def _dimension(data: xr.Dataset) -> str:
    """Dimension of the abscissa."""
    named = [str(dim) for dim in data.sizes if abscissa_of(str(dim)) is not None]
    if named:
        return named[0]
    others = [str(dim) for dim in data.sizes if str(dim) != "pair"]
    if len(others) == 1:
        return others[0]
    sizes = ", ".join(f"{dim}: {size}" for dim, size in data.sizes.items())
    action = "Name the dimension of the samples 'time', 'order' or 'speed'."
    raise refuse("theirs", f"dimensions {sizes}", "a dimension 'time', 'order' or 'speed'", action)


def read_netcdf_table(path: Path, field: str) -> Table:
    """Read a NetCDF file. A file whose variables claim more than ``MOST_BYTES`` is refused before."""
    import xarray as xr

    try:
        _check_links(path)
        options: dict[str, Any] = {"engine": "scipy"}
        if h5py.is_hdf5(path):
            options = {"engine": "h5netcdf", "phony_dims": "sort"}
        with xr.open_dataset(path, decode_times=False, mask_and_scale=False, **options) as opened:
            if opened.nbytes > MOST_BYTES:
                raise ValueError(f"it claims to hold {opened.nbytes:.3g} bytes")
            data = opened.load()
    except ParameterError:
        raise
    except Exception as error:  # noqa: BLE001  (readers raise anything of a damaged file)
        why = f"It cannot be read ({shown(str(error), 120)}). Write it again: dataset.to_netcdf(...)."
        raise refuse(field, path, "a NetCDF file", why) from None
    return table_of_dataset(data, path.stem)


def _check_links(path: Path) -> None:
    """Refuse variables of an HDF5 file whose values are in another file."""
    if not h5py.is_hdf5(path):
        return
    check_hdf5(path, MOST_BYTES // 8)
    with h5py.File(path) as file:
        for key in file:
            if not isinstance(file.get(key, getlink=True), h5py.HardLink):
                raise ValueError(f"{key} is a link")
            item = file[key]
            if isinstance(item, h5py.Dataset) and (item.is_virtual or item.external):
                raise ValueError(f"{key} is stored in another file")
