"""Is A(t) from a file of each kind the matrix that was written, and is anything else refused by its name?"""

import json

import numpy as np
import pandas as pd
import pytest
import scipy.io
import xarray as xr

from floquet import PeriodicSystem, from_second_order, monodromy, sampled_matrix
from lumped.errors import ParameterError
from tests.validation.commands.conftest import run
from validation.any_system import read_matrices

T = 0.4
#: Rotor with three states and no symmetry; positions and a rate in different units.
MEAN = np.array([[-0.2, 1.0, 0.0], [-300.0, -0.5, 40.0], [0.3, -2.0, -15.0]])
WAVE = np.array([[0.0, 0.0, 0.6], [80.0, 0.1, 0.0], [0.0, -1.0, 0.0]])
TIMES = np.linspace(0.0, T, 33)


def A(times):
    return MEAN + np.cos(2.0 * np.pi * np.asarray(times) / T)[:, None, None] * WAVE


def columns(times=TIMES, heading="A_{}_{}", time="t"):
    entries = {heading.format(i + 1, j + 1): A(times)[:, i, j] for i in range(3) for j in range(3)}
    return pd.DataFrame({time: times, **entries})


def write(path, times=TIMES, **more):
    values = A(times)
    if path.suffix == ".npz":
        np.savez(path, A_times=times, A_samples=values, **more)
    elif path.suffix == ".mat":
        scipy.io.savemat(path, {"A_times": times, "A_samples": np.moveaxis(values, 0, -1), **more})
    elif path.suffix == ".nc":
        data = xr.Dataset({"A_samples": (("A_times", "row", "column"), values)}, {"A_times": times})
        data["row"] = [1, 2, 3]
        data.attrs.update(more)
        data.to_netcdf(path, engine="h5netcdf")
    else:
        columns(times).to_csv(path, index=False)
    return path


@pytest.mark.parametrize("suffix", [".npz", ".mat", ".nc", ".csv"])
@pytest.mark.parametrize("between", ["linear", "cubic", "steps"])
def test_every_format_is_the_table_in_python(tmp_path, suffix, between):
    expected = monodromy(PeriodicSystem(sampled_matrix(TIMES, A(TIMES), between=between), T))
    model = read_matrices(write(tmp_path / f"a{suffix}"), between=between)
    assert model.period == T
    np.testing.assert_allclose(monodromy(model.system()).matrix, expected.matrix, rtol=1e-12)


@pytest.mark.parametrize("suffix", [".npz", ".mat", ".nc", ".csv"])
def test_the_period_of_the_file_or_of_the_reader_closes_the_table(tmp_path, suffix):
    """Without the last row, whose time is the end of the period."""
    open_rows = TIMES[:-1]
    stated = {} if suffix == ".csv" else {"period": T}
    model = read_matrices(write(tmp_path / f"a{suffix}", open_rows, **stated), period=T)
    closed = read_matrices(write(tmp_path / f"b{suffix}"))
    np.testing.assert_allclose(
        monodromy(model.system()).matrix, monodromy(closed.system()).matrix, rtol=1e-12
    )
    with pytest.raises(ParameterError, match="Name the period"):
        read_matrices(write(tmp_path / f"c{suffix}", open_rows))
    for period, word in ((0.3, "at least"), (0.9, "up to the end of the period")):
        with pytest.raises(ParameterError, match=word):
            read_matrices(write(tmp_path / f"d{suffix}", open_rows), period=period)
    if stated:
        with pytest.raises(ParameterError, match=r"0\.5 s: allowed 0\.4 s, that of the file"):
            read_matrices(tmp_path / f"a{suffix}", period=0.5)


def test_times_in_milliseconds_are_converted(tmp_path):
    milliseconds = columns(time="time [ms]")
    milliseconds["time [ms]"] *= 1e3
    milliseconds.to_csv(tmp_path / "a.csv", index=False)
    assert read_matrices(tmp_path / "a.csv").period == pytest.approx(T)
    data = xr.Dataset({"A_samples": (("A_times", "row", "column"), A(TIMES))}, {"A_times": 1e3 * TIMES})
    data["A_times"].attrs["units"] = "ms"
    data.to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    assert read_matrices(tmp_path / "a.nc").period == pytest.approx(T)


@pytest.mark.parametrize(("heading", "options"), [
    ("A_{}_{}", {}), ("A{}{}", {}), ("A({},{})", {}), ("A[{},{}]", {"sep": ";"}), ("a{}{}", {}),
    ("A_{}_{} [-]", {"sep": "\t"}), ("A_{}_{}", {"sep": ";", "decimal": ","}),
])  # fmt: skip
def test_columns_of_any_program(tmp_path, heading, options):
    columns(heading=heading, time="t [s]").iloc[:, ::-1].to_csv(tmp_path / "a.csv", index=False, **options)
    model = read_matrices(tmp_path / "a.csv")
    np.testing.assert_allclose(model.system().A(TIMES), A(TIMES), rtol=1e-12, atol=1e-12)


def test_columns_of_numpy(tmp_path):
    table = columns()
    np.savetxt(tmp_path / "a.csv", table.to_numpy(), delimiter=",", header=",".join(table.columns))
    np.testing.assert_allclose(read_matrices(tmp_path / "a.csv").system().A(TIMES), A(TIMES), atol=1e-9)


def test_constant_part_harmonics_and_steps_add_up(tmp_path):
    """A constant beside a table whose own constant part is not zero: two terms, whose sum is not rounded."""
    steps = np.stack([np.eye(3), 2.0 * np.eye(3)])
    np.savez(tmp_path / "a.npz", A=MEAN, A_cos_1=WAVE, A_times=[0.0, 0.1, T], A_values=steps, period=T)
    model = read_matrices(tmp_path / "a.npz")
    places = np.array([0.03, 0.2, 0.37])
    expected = A(places) + np.where(places < 0.1, 1.0, 2.0)[:, None, None] * np.eye(3)
    np.testing.assert_allclose(model.system().A(places), expected, rtol=1e-12)
    slower = model.system(frequency=1.0 / (2.0 * T), variation=0.5)
    # The mean of the steps is 1.75: half of what differs from it stays.
    expected = A(np.array([0.03])) - 0.5 * (A(np.array([0.03])) - MEAN)
    expected = expected + (1.75 - 0.5 * 0.75) * np.eye(3)
    np.testing.assert_allclose(slower.A(np.array([0.06])), expected, rtol=1e-12)


def test_samples_of_stiffness_without_damping_are_neutral(tmp_path):
    times = np.linspace(0.0, T, 41)
    K = np.array([[300.0, -100.0], [-100.0, 400.0]])
    samples = K + np.cos(2 * np.pi * times / T)[:, None, None] * np.diag([9.0, 4.0])
    samples[-1] = samples[0]
    np.savez(tmp_path / "k.npz", M=np.diag([1.0, 2.0]), K_times=times, K_samples=samples)
    model = read_matrices(tmp_path / "k.npz", between="cubic")
    assert model.period == T
    result = monodromy(model.system())
    assert result.verdict == "neutral"
    fine = sampled_matrix(times, samples, between="cubic")
    direct = monodromy(from_second_order(np.diag([1.0, 2.0]), np.zeros((2, 2)), fine, T))
    np.testing.assert_array_equal(result.matrix, direct.matrix)


FIELDS = {"A_times": TIMES, "A_samples": A(TIMES)}


@pytest.mark.parametrize(("change", "field", "word"), [
    ({"A_sample": A(TIMES)}, "A_sample", "A_samples"),
    ({"M": np.eye(3)}, "A_times, A_samples", "beside M"),
    ({"A_times": None}, "A_times", "Save both"),
    ({"A_samples": None}, "A_samples or A_values", "missing"),
    ({"A_values": A(TIMES[:-1])}, "A_samples or A_values", "both"),
    ({"A_samples": A(TIMES[:-1])}, "A_samples", "(33, 3, 3)"),
    ({"A_samples": A(TIMES)[:, :2]}, "A_samples", "(33, 2, 2)"),
    ({"A_samples": np.moveaxis(A(TIMES), 0, -1)}, "A_samples", "numpy.moveaxis(A_samples, -1, 0)"),
    ({"t": TIMES}, "t", "Name times A_times"),
    ({"A": A(TIMES)}, "A", "A_samples with A_times"),
    ({"A": np.eye(2)}, "A", "(3, 3)"),
    ({"A_times": None, "A_samples": None}, "A", "M and K"),
    ({"A_times": None, "A_samples": None, "A": np.eye(2)}, "period", "missing"),
    ({"A_times": TIMES[::-1]}, "A_times", "Sort the rows"),
])  # fmt: skip
def test_a_wrong_field_is_refused_by_its_name(tmp_path, change, field, word):
    np.savez(tmp_path / "bad.npz", **{k: v for k, v in (FIELDS | change).items() if v is not None})
    with pytest.raises(ParameterError, match=r"bad\.npz") as refused:
        read_matrices(tmp_path / "bad.npz")
    assert refused.value.problems[0].field == field
    assert word in str(refused.value)


def test_tables_with_different_periods_are_refused(tmp_path):
    times = np.linspace(0.0, T, 5)
    ones = np.ones((5, 1, 1))
    np.savez(tmp_path / "two.npz", M=1.0, K_times=times, K_samples=ones, C_times=1.5 * times, C_samples=ones)
    with pytest.raises(ParameterError, match=r"period = 0\.4 s of one table: allowed 0\.6 s"):
        read_matrices(tmp_path / "two.npz")


@pytest.mark.parametrize(("change", "field", "word"), [
    ({"A_3_2": None}, "A_3_2", "no column"),
    ({"t": None}, "t", "missing"),
    ({"A_0_1": 0.0}, "A_0_1", "rows and columns from 1"),
    ({"stiffness": 0.0}, "stiffness", "A_1_1, A_1_2"),
    ({"A31": 0.0}, "A31", "two columns"),
    ({"A_4_4 [1/ms]": 0.0}, "A_4_4 [1/ms]", "SI units"),
    ({"A_4_4": 0.0}, "A_1_4, A_2_4, A_3_4, A_4_1, A_4_2, A_4_3", "also those that are 0"),
])  # fmt: skip
def test_a_wrong_column_is_refused_by_its_name(tmp_path, change, field, word):
    table = columns()
    for name, value in change.items():
        table = table.drop(columns=name) if value is None else table.assign(**{name: value})
    table.to_csv(tmp_path / "bad.csv", index=False)
    with pytest.raises(ParameterError, match=r"bad\.csv") as refused:
        read_matrices(tmp_path / "bad.csv")
    assert refused.value.problems[0].field == field
    assert word in str(refused.value)


def test_a_cell_without_a_number_is_refused(tmp_path):
    table = columns().astype(object)
    table.iloc[4, 3] = "n/a"
    table.to_csv(tmp_path / "bad.csv", index=False)
    with pytest.raises(ParameterError, match="row 5"):
        read_matrices(tmp_path / "bad.csv")


def test_the_command_says_what_the_samples_leave_out_and_draws_the_multipliers(tmp_path):
    file = write(tmp_path / "a.csv")
    printed = run("floquet", file, "--between", "cubic", "-o", tmp_path / "m.png", "-o", tmp_path / "m.nc")
    assert printed.exit_code == 0
    words = " ".join(printed.stdout.split())
    assert "with every second sample the multipliers change by up to" in words
    assert "frequencies are known up to multiples of 1/period, 2.5 Hz" in words
    assert (tmp_path / "m.png").stat().st_size > 5000
    exact = monodromy(read_matrices(file, between="cubic").system())
    with xr.open_dataset(tmp_path / "m.nc", engine="h5netcdf") as written:
        np.testing.assert_allclose(written["growth_rate"], exact.exponents.real)
        np.testing.assert_allclose(written["frequency"], abs(exact.exponents.imag) / (2 * np.pi), atol=1e-12)
        assert written["frequency"].attrs["units"] == "Hz"
    run("floquet", file, "--between", "cubic", "-o", tmp_path / "m.csv")
    assert len(pd.read_csv(tmp_path / "m.csv")) == 3
    data = json.loads(run("floquet", file, "--between", "cubic", "--json").stdout)
    np.testing.assert_allclose(data["growth_rates"], exact.exponents.real)
