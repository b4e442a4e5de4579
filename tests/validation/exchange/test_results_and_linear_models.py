"""Do results and linear models read back as what they were, in the programs they are for?"""

import csv

import numpy as np
import pytest
import scipy.io
import xarray as xr

import lumped
from lumped import ParameterError
from lumped.model.averaged import modes
from validation.exchange import write_results, write_state_space


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


def test_netcdf_and_csv_read_back(result, tmp_path):
    with xr.open_dataset(write_results(result, tmp_path / "run.nc"), engine="h5netcdf") as read:
        np.testing.assert_array_equal(read["normal_load"], result["normal_load"])
        assert read["dte"].attrs["units"] == "m"
    with write_results(result, tmp_path / "run.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    np.testing.assert_array_equal([float(row["dte [m]"]) for row in rows], result["dte"].to_numpy())


def test_files_are_not_overwritten_and_names_not_mangled(result, tmp_path):
    path = write_results(result, tmp_path / "run.mat")
    with pytest.raises(ParameterError, match="--force"):
        write_results(result, path)
    with pytest.raises(ParameterError, match=r"\.nc, \.csv, \.mat"):
        write_results(result, tmp_path / "run.xlsx")
    for name in ("2nd", "a b", "units", "x" * 64):
        with pytest.raises(ParameterError, match="letters, digits"):
            write_results(xr.Dataset({name: ("t", [1.0])}), tmp_path / "bad.mat")
    assert not (tmp_path / "bad.mat").exists()


def test_the_state_space_file_has_the_modes_of_the_pair_and_names(pair, tmp_path):
    read = scipy.io.loadmat(write_state_space(pair, tmp_path / "pair.mat"), simplify_cells=True)
    values = np.linalg.eigvals(read["A"])
    frequencies = np.sort(np.abs(values[values.imag > 0])) / (2 * np.pi)
    # eigenvalues of one 10 x 10 matrix, computed twice by the same algorithm on the same bits
    np.testing.assert_allclose(frequencies, [m.natural_frequency for m in modes(pair)], rtol=1e-9)
    assert list(read["inputs"]) == ["torque_pinion", "torque_gear"]
    assert list(read["outputs"]) == ["dte", "x_p", "x_g"]
    assert len(read["states"]) == 10
    assert read["B"].shape == (10, 2)
    assert read["gear_pair"] == "nasa_28_28"


def test_the_rigid_rotation_is_refused(pair, tmp_path):
    with pytest.raises(ParameterError, match="rigid rotation"):
        write_state_space(pair, tmp_path / "pair.mat", "full")
