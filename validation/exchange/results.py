"""Results for other programs: CSV, NetCDF and MATLAB files of a labelled dataset, and back from NetCDF."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from lumped.errors import refuse, shown
from validation.files.output import COLUMN_DIMENSIONS, DATA_SUFFIXES, check_file, write_dataset


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
    path = check_file(Path(path), DATA_SUFFIXES, force=force)
    if path.suffix.lower() == ".csv":
        result, _ = one_table(result)
    write_dataset(result, path)
    return path


def one_table(result: xr.Dataset) -> tuple[xr.Dataset, tuple[str, ...]]:
    """Return what fits into one table, that over the axes with the most points, and what does not.

    A sweep, for example, has outputs over its axes, and beside them error texts over its failures.

    Parameters
    ----------
    result : any labelled dataset

    Returns
    -------
    the dataset of the table, with the coordinates that are no axes as columns; names of what was left out
    """
    loose = result.reset_coords([name for name in result.coords if name not in result.sizes])

    def axes(name: object) -> set[object]:
        return set(loose[name].dims) - set(COLUMN_DIMENSIONS)

    largest = max(loose.data_vars, key=lambda name: loose[name].size, default=None)
    kept = axes(largest) if largest is not None else set()
    left_out = [name for name in loose.data_vars if not axes(name) <= kept]
    table = loose.drop_vars(left_out)
    return table.drop_dims(set(table.sizes) - kept - set(COLUMN_DIMENSIONS)), tuple(map(str, left_out))


def read_netcdf(path: str | Path) -> xr.Dataset:
    """Read a result file that spurcheck wrote.

    Parameters
    ----------
    path : .nc file

    Raises
    ------
    ParameterError : no such file, or no NetCDF 4 file
    """
    path = Path(path)
    if not path.is_file():
        raise refuse("result", shown(str(path)), "a file that exists", "Check the path.")
    try:
        # Times are seconds from the start, not dates.
        with xr.open_dataset(path, engine="h5netcdf", decode_times=False) as opened:
            return opened.load()
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        reason = f"It cannot be read ({shown(str(error))})."
        raise refuse("result", shown(str(path)), "a NetCDF file that spurcheck wrote", reason) from None
