"""Do results and linear models read back as what they were, and are foreign files read within bounds?"""

from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
import scipy.io
import xarray as xr

import lumped
from lumped import ParameterError
from validation.exchange import read_netcdf, write_results, write_state_space


@pytest.fixture(scope="module")
def pair():
    return lumped.load_gear_pair("nasa_28_28")


@pytest.fixture(scope="module")
def result(pair):
    return lumped.simulate(pair, cycles=2, samples_per_cycle=16)


def test_matlab_file_has_every_variable_with_unit_and_dimensions(result, tmp_path):
    read = scipy.io.loadmat(write_results(result, tmp_path / "run.mat"), simplify_cells=True)
    for name, variable in result.variables.items():
        np.testing.assert_array_equal(read[name], variable.to_numpy())
        assert read["dimensions"][name] == ", ".join(variable.dims)
    assert read["units"]["dte"] == "m"
    assert read["long_names"]["mu"] == "friction coefficient, signed"
    assert read["attributes"]["parameters_sha256"] == result.attrs["parameters_sha256"]


def test_matlab_file_has_vectors_as_columns_and_complex_numbers(tmp_path):
    response = xr.Dataset({"dte": ("frequency", [1.0 + 2.0j, 3.0, -4.0j])})
    read = scipy.io.loadmat(write_results(response, tmp_path / "frf.mat"))
    assert read["dte"].shape == (3, 1)
    np.testing.assert_array_equal(read["dte"][:, 0], response["dte"].to_numpy())


def test_names_are_not_mangled(tmp_path):
    for name in ("2nd", "a b", "units", "x" * 64):
        with pytest.raises(ParameterError, match="letters, digits"):
            write_results(xr.Dataset({name: ("t", [1.0])}), tmp_path / "bad.mat")
    assert not (tmp_path / "bad.mat").exists()


def test_the_rigid_rotation_is_refused(pair, tmp_path):
    with pytest.raises(ParameterError, match="rigid rotation"):
        write_state_space(pair, tmp_path / "pair.mat", "full")


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
    "an array as coordinates": lambda f: (
        f.create_dataset("a", data=np.zeros(3)).attrs.create("coordinates", np.arange(3.0)),
        f.attrs.create("coordinates", np.arange(3.0)),
    ),
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


def test_names_and_texts_that_a_spreadsheet_would_run_are_made_inert(tmp_path):
    result = xr.Dataset({"=1+1": ("@row", ["-2", "@x", "plain"])}, coords={"@row": [0.0, 1.0, 2.0]})
    write_results(result, tmp_path / "a.csv")
    table = pd.read_csv(tmp_path / "a.csv")
    assert list(table.columns) == ["'@row [1]", "'=1+1 [1]"]
    assert table.iloc[:, 1].tolist() == ["'-2", "'@x", "plain"]
