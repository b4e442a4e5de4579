"""Is a function of a Python file a family of systems, and is any other function refused?"""

import numpy as np
import pytest
import xarray as xr

from floquet import monodromy
from lumped.errors import ParameterError
from tests.evidence.floquet.reference_systems import meissner_trace
from tests.validation.commands.conftest import run
from validation.any_system import read_family, spectrum_dataset
from validation.plots.stability import multipliers_figure

SOURCE = """
import floquet
import family_tools


def meissner(delta=1.3, depth=0.4, period=2):
    steps = floquet.PiecewisePolynomial([0.0, period / 2, period], [[family_tools.plus(depth)], [-depth]])
    return floquet.from_second_order(1.0, 0.0, floquet.PeriodicMatrix(delta, (steps, 1.0)), period)


def without(delta):
    return meissner(delta)


def text(delta="1"):
    return meissner()


def nothing(delta=1.0):
    return delta


def failing(delta=1.0):
    return 1.0 / (delta - delta)
"""


@pytest.fixture(autouse=True)
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "family.py").write_text(SOURCE)
    (tmp_path / "family_tools.py").write_text("def plus(x):\n    return x\n")


def test_a_function_is_a_family_of_its_arguments():
    family = read_family("family.py:meissner")
    assert dict(family.defaults) == {"delta": 1.3, "depth": 0.4, "period": 2.0}
    assert set(family.axes) == set(family.defaults)
    for values, expected in (
        ({}, meissner_trace(1.3, 0.4, 2.0)),
        ({"delta": 2.2, "period": 4.0}, meissner_trace(2.2, 0.4, 4.0)),
    ):
        matrix = monodromy(family.system(**values)).matrix
        assert np.trace(matrix) == pytest.approx(expected, abs=1e-10)
    assert read_family("rotor.npz") is None


def test_the_command_draws_a_chart_of_the_arguments(tmp_path):
    printed = run("floquet", "family.py:meissner")
    assert (printed.exit_code, "stable (neutral)" in printed.stdout) == (0, True)
    axes = ("--axis", "delta=0.5:5:10", "--axis", "depth=0:0.4:3")
    printed = run("floquet", "family.py:meissner", *axes, "-o", "chart.nc", "-o", "chart.png")
    assert "chart: 30 points" in printed.stdout
    assert (tmp_path / "chart.png").stat().st_size > 5000
    with xr.open_dataset(tmp_path / "chart.nc", engine="h5netcdf") as chart:
        for point in chart.stack(point=("delta", "depth")).transpose("point", ...)["point"].to_numpy():
            trace = meissner_trace(*point, 2.0)
            verdict = int(chart["verdict"].sel(delta=point[0], depth=point[1]))
            assert verdict == (-1 if abs(trace) > 2.0 else 2)


def test_a_refined_chart_has_the_verdicts_of_the_whole_one(tmp_path):
    axes = ("--axis", "delta=0.5:20:65", "--axis", "depth=0.02:0.45:33")
    for extra in ((), ("--refine",)):
        printed = run("floquet", "family.py:meissner", *axes, *extra, "-o", f"chart{len(extra)}.nc")
    assert "% of the points are computed" in printed.stdout
    charts = [xr.open_dataset(tmp_path / f"chart{k}.nc", engine="h5netcdf") for k in (0, 1)]
    unstable = [chart["verdict"].to_numpy() < 0 for chart in charts]
    assert (unstable[0] == unstable[1]).all()
    assert unstable[0].any()


def test_processes_read_the_file_of_the_function_again(tmp_path):
    axes = ("--axis", "delta=0.5:5:7", "--axis", "depth=0:0.4:3")
    for workers in (1, 2):
        run("floquet", "family.py:meissner", *axes, "--workers", workers, "-o", f"chart{workers}.csv")
    assert (tmp_path / "chart1.csv").read_bytes() == (tmp_path / "chart2.csv").read_bytes()


@pytest.mark.parametrize(("delta", "red"), [(1.3, 0), (2.45, 1)])
def test_the_figure_marks_multipliers_outside_the_circle_and_no_rounding(delta, red):
    """On the circle by proof, though rounding puts the modulus beside 1; and between two edges."""
    spectrum = spectrum_dataset(monodromy(read_family("family.py:meissner").system(delta=delta)))
    assert (spectrum.attrs["verdict"] == "unstable") == bool(red)
    spectrum["modulus"][:] += 1e-15 * (not red)
    spectrum["multipliers"][:] *= 1.0 + 1e-15 * (not red)
    left, right = multipliers_figure(spectrum).axes
    outside = [line for line in left.lines if "above 1" in str(line.get_label())]
    assert sum(len(line.get_xdata()) for line in outside) == red
    growth = np.concatenate([line.get_ydata() for line in right.lines if len(line.get_xdata()) < 3])
    assert (max(abs(growth)) > 0.0) == bool(red)


@pytest.mark.parametrize(("arguments", "word"), [
    (["family.py"], "Type family.py:meissner"),
    (["family.py:meisner"], "Did you mean 'meissner'"),
    (["family.py:without"], "family.py:without: delta = no default"),
    (["family.py:text"], "a number as default"),
    (["family.py:nothing"], "returns floquet.PeriodicSystem"),
    (["family.py:failing"], "ZeroDivisionError"),
    (["other.py:meissner"], "a Python file that exists"),
    (["family.py:meissner", "--axis", "frequency=1:2:3"], "one of delta, depth, period"),
    (["family.py:meissner", "--refine", "--axis", "delta=1:2:3"], "with two --axis"),
    (["family.py:meissner", "--period", "3"], "leave it out"),
    (["family.py:meissner", "--between", "cubic"], "leave it out"),
])  # fmt: skip
def test_another_function_is_refused(arguments, word):
    result = run("floquet", *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert word in " ".join(result.stderr.split())


def test_a_refusal_of_the_system_is_that_of_the_function():
    with pytest.raises(ParameterError, match="breaks"):
        read_family("family.py:meissner").system(period=-1.0)
