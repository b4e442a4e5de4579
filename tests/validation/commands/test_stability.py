"""Does spurcheck stability write what it promises for every view and axis, and refuse the rest early?"""

import numpy as np
import pytest
import xarray as xr

import lumped
from floquet import gear_pair_multipliers

from .conftest import refused as refused_command
from .conftest import run as command

SPEEDS = ("--axis", "speed_rpm=15000:18500:12")
TONGUE = ("--law", "none", "--set", "mesh.damping_ratio=0.01", "--set", "mesh.relief=ignored")
TONGUE += ("--set", "mesh.contact=prescribed")


def run(*arguments):
    return command("stability", *arguments)


def refused(*arguments):
    return refused_command("stability", *arguments)


def opened(path) -> xr.Dataset:
    with xr.open_dataset(path, engine="h5netcdf") as data:
        return data.load()


@pytest.mark.parametrize("axis", [
    "damping_ratio=0:0.05:3", "friction_coefficient=0:0.1:3", "torque=20:80:3",
    "stiffness_variation=0.5:1.5:3", "contact_ratio=1.3:1.8:3", "bearing_stiffness=5e7:2e8:3",
])  # fmt: skip
def test_every_axis_makes_a_chart_over_speed(tmp_path, axis):
    data = tmp_path / "chart.nc"
    picture = tmp_path / "chart.png"
    drawn = ("-o", picture) if axis.startswith("torque") else ()
    result = run("--law", "coulomb", *SPEEDS, "--axis", axis, "-o", data, *drawn)
    assert result.exit_code == 0, result.stderr
    chart = opened(data)
    radius = chart["spectral_radius"]
    worst = radius.isel(radius.argmax(...))
    assert f"multiplier {float(worst):.6f} at speed_rpm {float(worst['speed_rpm']):.5g}, " in result.stdout
    assert radius.sizes == {"speed_rpm": 12, axis.split("=")[0]: 3}
    assert {"spectral_radius", "error", "verdict", "proven", "known", "region_width"} <= set(chart.data_vars)
    assert chart["speed_rpm"].attrs["units"] == "rpm"
    assert not drawn or picture.read_bytes().startswith(b"\x89PNG")


def test_a_pair_without_damping_is_neutral_and_accepted():
    bearings = [f"bearings.{g}.{d}_damping_ratio" for g in ("pinion", "gear") for d in ("loa", "oloa")]
    undamped = [word for name in ("mesh.damping_ratio", *bearings) for word in ("--set", f"{name}=0")]
    contact = ("--set", "mesh.contact=prescribed")
    result = run("--law", "none", *undamped, *contact)
    assert result.exit_code == 0, result.stdout + result.stderr
    assert "stable (neutral): on the unit circle, proven" in result.stdout
    result = run("--law", "coulomb", *undamped, *contact)
    assert result.exit_code == 1
    assert "neutral" not in result.stdout


def test_chart_and_traced_boundaries_are_in_one_file(tmp_path):
    path = tmp_path / "chart.nc"
    picture = tmp_path / "chart.pdf"
    axes = (*SPEEDS, "--axis", "damping_ratio=0:0.04:5")
    result = run(*TONGUE, *axes, "--tongues", "-o", path, "-o", picture)
    assert result.exit_code == 0, result.stderr
    chart = opened(path)
    assert list(chart["label"].to_numpy()) == ["2w3/2"]
    # 2.7 %, measured when the pair was chosen.
    assert float(chart["critical_damping"][0]) == pytest.approx(0.027, abs=1e-3)
    assert f"{float(chart['critical_damping'][0]):.6f}" in result.stdout
    # The chart and the traced edges say the same at every node.
    tongue = chart.isel(tongue=0)
    for i, damping in enumerate(chart["damping_ratio"].to_numpy()):
        edges = [
            np.interp(damping, tongue["tongue_damping"], tongue[e]) for e in ("tongue_lower", "tongue_upper")
        ]
        inside = (chart["speed_rpm"] > edges[0]) & (chart["speed_rpm"] < edges[1])
        inside &= damping < float(tongue["critical_damping"])
        assert np.array_equal(inside, chart["verdict"].isel(damping_ratio=i) == -1)
    assert picture.read_bytes().startswith(b"%PDF")


def test_a_range_without_a_tongue_says_so_in_place_of_an_empty_table(tmp_path):
    picture = tmp_path / "none.png"
    speeds = ("--axis", "speed_rpm=1000:1500:2", "--axis", "bearing_stiffness=8e7:1.2e8:2")
    result = run("--view", "boundaries", *speeds, "-o", picture)
    assert result.exit_code == 0, result.stderr
    assert "no unstable speed from 1000 to 1500 rpm" in result.stdout
    assert "from, rpm" not in result.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_campbell_diagram(tmp_path):
    path = tmp_path / "view.nc"
    result = run("--view", "campbell", *TONGUE, *SPEEDS, "-o", path, "-o", tmp_path / "view.svg")
    assert result.exit_code == 0, result.stderr
    assert np.isfinite(opened(path)["frequency"]).all()


@pytest.mark.parametrize(("arguments", "expected"), [
    (("--axis", "speed_rpm=0:1000:5"), "--axis speed_rpm = 0 rpm: allowed > 0"),
    (("--axis", "damping_ratio=0:2:5"), "--axis damping_ratio = 1.5: allowed >= 0 and <= 1"),
    (("--axis", "speed_rpm=1:2:6000"), "count from 2 to 5000"),
    ((*SPEEDS, *SPEEDS), "--axis speed_rpm = set 2 times"),
    (("--view", "boundaries", *SPEEDS), "one axis other than speed_rpm"),
    (("--view", "campbell", "--axis", "torque=1:2:3"), "speed_rpm"),
    (("--axis", "torque=1:2:3", "--view", "boundaries", "--axis", "damping_ratio=0:0.1:2"), "speed_rpm"),
])  # fmt: skip
def test_what_cannot_be_shown_is_refused(arguments, expected):
    assert expected in refused(*arguments)


def test_nothing_is_written_where_a_view_fails(tmp_path):
    existing = tmp_path / "chart.nc"
    existing.write_text("mine")
    assert "--force" in refused(*SPEEDS, "-o", existing)
    three = (*SPEEDS, "--axis", "torque=20:30:2", "--axis", "damping_ratio=0:0.1:2")
    assert "one or two axes" in refused(*three, "-o", tmp_path / "new.nc", "-o", tmp_path / "chart.png")
    assert [p.name for p in tmp_path.iterdir()] == ["chart.nc"]
    assert existing.read_text() == "mine"


def test_stability_on_shafts(tmp_path, shafted_file):
    data = tmp_path / "chart.nc"
    on_shafts = ("--supports", "shafts")
    axis = ("--axis", "speed_rpm=9000:10000:2")
    result = run(shafted_file, *on_shafts, *axis, "-o", data)
    assert result.exit_code == 0, result.stderr
    chart = opened(data)
    assert chart.attrs["supports"] == "shafts"
    pair = lumped.load_gear_pair(shafted_file)
    exact = gear_pair_multipliers(pair, supports="shafts").spectral_radius
    assert f"{exact:.8f}" in result.stdout
    springs = gear_pair_multipliers(pair, supports="springs").spectral_radius
    assert abs(exact - springs) > 1e-3
    for arguments, expected in (
        (("--view", "campbell"), "--supports = shafts: allowed springs for --tongues and --view campbell"),
        (("--tongues",), "--view boundaries"),
        (("--axis", "bearing_stiffness=1e8:2e8:2"), "shafts.pinion.bearings"),
    ):
        assert expected in refused(shafted_file, *on_shafts, *arguments)
    assert "springs for a pair without [shafts]" in refused(*on_shafts)
