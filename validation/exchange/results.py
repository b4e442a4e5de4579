"""Files for other programs: results as labelled datasets, linear models as state space."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from lumped.arguments import file_path, of_type
from lumped.errors import ParameterError, refuse, shown
from lumped.model.averaged import averaged_state_space
from lumped.model.periodic_system import Supports, on_springs
from lumped.model.supports import Form
from lumped.schema.files import AnyPair, load_gear_pair
from validation.files.hdf5 import check_hdf5
from validation.files.output import (
    COLUMN_DIMENSIONS,
    DATA_SUFFIXES,
    check_file,
    save_mat,
    whole_file,
    write_dataset,
)

STATE_SPACE_SUFFIXES = (".mat", ".npz")
_OURS = "a NetCDF file that spurcheck wrote"
#: Most numbers in a result file, 4 GB in memory.
_MOST_NUMBERS = 500_000_000
#: Most numbers for a byte of the file: compression makes 1032 bytes of zeros one byte.
_MOST_UNPACKED = 1100


def write_results(result: xr.Dataset, path: str | Path, *, force: bool = False) -> Path:
    """Write a dataset of spurcheck for another program, whole or not at all.

    Parameters
    ----------
    result : for example of ``lumped.simulate``; units stay as they are labelled
    path : file to write; .csv (one row per point of the axes, see ``one_table``), .nc (NetCDF 4) or .mat
        (MATLAB 5: one array per variable and axis, with the structs ``units``, ``long_names``, ``dimensions``
        and ``attributes``)
    force : overwrite an existing file

    Returns
    -------
    Path that was written

    Raises
    ------
    ParameterError : an unknown suffix, an existing file without ``force``, or a name MATLAB cannot have
    """
    of_type("result", result, xr.Dataset, "a dataset, as simulate returns it")
    path = check_file(file_path("path", path), DATA_SUFFIXES, force=force)
    if path.suffix.lower() == ".csv":
        result, _ = one_table(result)
        if not result.data_vars or not set(result.sizes) - set(COLUMN_DIMENSIONS):
            action = "Write .mat or .nc, which hold everything."
            raise refuse("result", "variables without an axis", "a table over at least one axis", action)
    write_dataset(result, path, new=not force)
    return path


def one_table(result: xr.Dataset) -> tuple[xr.Dataset, tuple[str, ...]]:
    """Return the part of a result that fits into one table, and the names of the other variables.

    The table is over the axes of the largest variable. A sweep, for example, has outputs over its axes, and
    error texts over its failures. Coordinates that are not axes become columns.
    """
    data = result.reset_coords([name for name in result.coords if name not in result.sizes])

    def axes(name: object) -> set[object]:
        return set(data[name].dims) - set(COLUMN_DIMENSIONS)

    largest = max(data.data_vars, key=lambda name: data[name].size, default=None)
    table_axes = axes(largest) if largest is not None else set()
    left_out = [name for name in data.data_vars if not axes(name) <= table_axes]
    table = data.drop_vars(left_out)
    return table.drop_dims(set(table.sizes) - table_axes - set(COLUMN_DIMENSIONS)), tuple(map(str, left_out))


def read_netcdf(path: str | Path) -> xr.Dataset:
    """Read a result file that spurcheck wrote.

    Parameters
    ----------
    path : .nc file

    Raises
    ------
    ParameterError : no such file, no NetCDF 4 file, or content that no result has
    """
    path = file_path("path", path)
    if not path.is_file():
        raise refuse("result", path, "a file that exists", "Check the path.")
    try:
        if h5py.is_hdf5(path):
            check_hdf5(path, _most_numbers(path))
        _check_content(path)
        # Times are seconds from the start, not dates; nothing is packed or masked.
        with xr.open_dataset(
            path, engine="h5netcdf", decode_times=False, mask_and_scale=False, phony_dims="sort"
        ) as opened:
            result = opened.load()
        for attributes in [result.attrs, *(variable.attrs for variable in result.variables.values())]:
            "".join(map(str, attributes.values())).encode()  # text that cannot be written is refused here
        return result
    except ParameterError:
        raise
    except Exception as error:  # noqa: BLE001  (readers raise anything of a damaged file)
        reason = f"It cannot be read ({shown(str(error))})."
        raise refuse("result", path, _OURS, reason) from None


def _most_numbers(path: Path) -> int:
    """Return the most numbers that a result file of this size can hold."""
    return min(_MOST_NUMBERS, _MOST_UNPACKED * path.stat().st_size)


def _check_content(path: Path) -> None:
    """Refuse a file with content that no result has, before any data are loaded.

    A small file may expand to terabytes, or may link to bytes of other files.
    """
    most_numbers = _most_numbers(path)
    numbers = 0
    with h5py.File(path) as file:
        for name in file:
            is_hard_link = isinstance(file.get(name, getlink=True), h5py.HardLink)
            item = file[name] if is_hard_link else None
            if not isinstance(item, h5py.Dataset) or item.is_virtual or item.external:
                raise refuse("result", path, _OURS, f"{shown(name)} is not a variable stored in this file.")
            if item.dtype.kind not in "biuf" and h5py.check_string_dtype(item.dtype) is None:
                raise refuse("result", path, _OURS, f"{shown(name)} holds no numbers and no text.")
            numbers += item.size or 0
            if numbers > most_numbers:
                raise refuse("result", path, _OURS, f"It claims to hold {numbers:.3g} numbers.")


def write_state_space(
    pair: AnyPair,
    path: str | Path,
    form: Form = "elastic",
    *,
    force: bool = False,
    supports: Supports | None = None,
) -> Path:
    """Write the time-averaged pair as a file of its matrices.

    ``sys = ss(A, B, C, D)`` in MATLAB; ``control.ss(f["A"], f["B"], f["C"], f["D"])`` or
    ``scipy.signal.StateSpace(...)`` of the same four in Python, with ``f = numpy.load(path)``.

    Parameters
    ----------
    pair : a validated gear pair
    path : .mat (MATLAB 5) or .npz (NumPy, without pickled objects)
    form : "elastic" (10 states) or "mesh" (6 states)
    force : overwrite an existing file
    supports : "springs", the only supports of this model; needed for a pair with shafts

    Returns
    -------
    Path that was written; besides A, B, C, D it holds the names ``inputs`` [N m], ``outputs`` [m], ``states``
    (cell arrays in MATLAB), ``gear_pair`` and ``parameters`` (TOML)

    Raises
    ------
    ParameterError : form "full", shafts, an unknown suffix, or an existing file without ``force``
    """
    pair = on_springs(load_gear_pair(pair), supports, "write_state_space")
    path = check_file(file_path("path", path), STATE_SPACE_SUFFIXES, force=force)
    plant = averaged_state_space(pair, form, supports="springs")
    matlab = path.suffix.lower() == ".mat"

    def names(labels: list[str]) -> np.ndarray[tuple[int], np.dtype[Any]]:
        return np.array(labels, dtype=object if matlab else np.str_)

    contents = {
        **{name: getattr(plant, name) for name in "ABCD"},
        **{f"{kind}s": names(getattr(plant, f"{kind}_labels")) for kind in ("input", "output", "state")},
        "gear_pair": pair.name,
        "parameters": pair.to_toml(),
    }
    with whole_file(path, new=not force) as temporary:
        if matlab:
            save_mat(contents, temporary)
        else:
            np.savez(temporary, **contents)
    return path
