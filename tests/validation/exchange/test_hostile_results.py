"""Result files that spurcheck did not write: read within bounds, or refused by what they hold."""

from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
import xarray as xr

from lumped import ParameterError
from validation.exchange import read_netcdf, write_results


def _elsewhere(f):
    """A file whose bytes nobody wants to find in a table."""
    path = Path(f.filename).with_name("secret")
    path.write_bytes(np.arange(3.0).tobytes())
    with h5py.File(path.with_suffix(".h5"), "w") as other:
        other["a"] = np.arange(3.0)
    return path


def _virtual(f):
    layout = h5py.VirtualLayout(shape=(3,), dtype="f8")
    layout[:] = h5py.VirtualSource(_elsewhere(f).with_suffix(".h5"), "a", shape=(3,))
    f.create_virtual_dataset("a", layout)


UNREADABLE = {
    "external storage": lambda f: f.create_dataset("a", (3,), "f8", external=[(_elsewhere(f), 0, 24)]),
    "an external link": lambda f: f.__setitem__(
        "a", h5py.ExternalLink(_elsewhere(f).with_suffix(".h5"), "a")
    ),
    "a virtual dataset": _virtual,
    "gigabytes in a kilobyte": lambda f: f.create_dataset("a", (4 * 10**8,), "f8", chunks=(10**6,)),
    "terabytes as coordinate": lambda f: f.create_dataset("a", (10**12,), "f8", chunks=(10**6,)).make_scale(),
    "text in no encoding": lambda f: f.attrs.create("a", b"\xff", dtype=h5py.string_dtype()),
    "terabytes in a small file": lambda f: f.create_dataset("a", shape=(10**12,), dtype="f8", chunks=(1000,)),
    "records": lambda f: f.create_dataset("a", data=np.zeros(3, dtype=[("x", "f8"), ("y", "i4")])),
    "references": lambda f: f.create_dataset("a", data=np.array([f.ref], dtype=h5py.ref_dtype)),
    "ragged rows": lambda f: f.create_dataset("a", shape=(2,), dtype=h5py.vlen_dtype(np.int32)),
}


@pytest.mark.parametrize("content", UNREADABLE.values(), ids=UNREADABLE)
def test_what_no_result_holds_is_refused_before_it_is_loaded(tmp_path, content):
    path = tmp_path / "foreign.nc"
    with h5py.File(path, "w") as file:
        content(file)
    with pytest.raises(ParameterError, match=r"foreign\.nc"):
        read_netcdf(path)


@pytest.mark.parametrize("values", [xr.Dataset(), xr.Dataset({"a": 3.0})], ids=["nothing", "a single number"])
def test_a_table_needs_an_axis(tmp_path, values):
    with pytest.raises(ParameterError, match="axis"):
        write_results(values, tmp_path / "a.csv")
    assert list(tmp_path.iterdir()) == []


def test_packing_attributes_of_strangers_are_not_followed(tmp_path):
    path = tmp_path / "a.nc"
    with h5py.File(path, "w") as file:
        file.create_dataset("a", data=np.arange(3.0)).attrs["scale_factor"] = "abc"
    assert read_netcdf(path)["a"].to_numpy().tolist() == [0.0, 1.0, 2.0]


def test_names_and_texts_that_a_spreadsheet_would_run_are_made_inert(tmp_path):
    result = xr.Dataset({"=1+1": ("@row", ["-2", "@x", "plain"])}, coords={"@row": [0.0, 1.0, 2.0]})
    write_results(result, tmp_path / "a.csv")
    table = pd.read_csv(tmp_path / "a.csv")
    assert list(table.columns) == ["'@row [1]", "'=1+1 [1]"]
    assert table.iloc[:, 1].tolist() == ["'-2", "'@x", "plain"]
