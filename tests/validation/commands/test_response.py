"""Does the command say where the pair jumps and what removes the jumps, and do the figures show it?"""

import json

import pytest
import xarray as xr

import floquet
import lumped
from validation.plots.contact_loss import response_figure
from validation.plots.of_result import plot

from .conftest import refused, run

PAIR = ["nasa_28_28", "--range", "12000..14000", "--law", "none"]
PAIR += ["--set", "mesh.relief=ignored", "--set", "mesh.contact=prescribed"]
SETTINGS = {
    "mesh.contact": "prescribed", "mesh.relief": "ignored", "friction.law": "none",
    "operating.speed_range": ["12000 rpm", "14000 rpm"],
}  # fmt: skip


@pytest.fixture(scope="module")
def branches():
    pair = lumped.load_gear_pair("nasa_28_28").with_(SETTINGS)
    return floquet.response_branches(pair, periods=[1], seeds=12)


def test_the_command_prints_the_jump_to_the_beats(branches, monkeypatch):
    """On running up the pair jumps at the fold to beats; speeds without a stable motion are named."""

    def branches_of_fixture(pair, speeds, periods, *, seeds, back_side, seconds, progress):
        assert pair == branches.pair
        assert seconds is None
        assert (speeds, [*periods], seeds, back_side) == (None, [1], 12, False)
        return branches

    monkeypatch.setattr(floquet, "response_branches", branches_of_fixture)
    done = run("response", *PAIR, "--periods", 1, "--seeds", 12, "--json")
    assert done.exit_code == 0, done.output
    response = json.loads(done.stdout)
    (fold,) = [b for b in response["bifurcations"] if b["kind"] == "fold"]
    (jump,) = [j for j in response["jumps"] if j["rising"]]
    assert jump["speed_rpm"] == pytest.approx(fold["speed_rpm"])
    assert jump["after"] == "beats"
    assert jump["dte_rms_after"] > 1.5 * jump["dte_rms"]
    ((low, _),) = response["gaps"]
    assert low == pytest.approx(fold["speed_rpm"])
    assert {one["kind"] for one in response["attractors"] if one["high_rpm"] == 14000.0} >= {"beats"}


def test_the_figure_shows_branches_jumps_and_the_operating_range(branches):
    response = branches
    figure = response_figure(response.dataset)
    top, bottom = figure.axes
    stable = [line for line in top.lines if line.get_linestyle() == "-"]
    assert len(stable) >= 2
    assert len(top.lines) > len(stable)
    (arrow,) = [text for text in top.texts if text.arrow_patch is not None]
    (jump,) = response.jumps
    assert arrow.xy == pytest.approx((jump.speed_rpm, 1e6 * jump.dte_rms_after))
    assert top.get_xlim() == pytest.approx((12000.0, 14000.0))
    assert len(bottom.lines) > 2
    assert len(plot(response.dataset).axes) == 2


MAPPED = ["nasa_28_28", "--range", "12900..15500", *PAIR[3:]]


def test_damping_removes_the_jump_at_the_cusp(tmp_path):
    """The two folds of the resonance meet at a damping ratio of 0.105 (docs/theory/orbits.md)."""
    data = tmp_path / "map.nc"
    axis = ["--map", "damping_ratio=0.1:0.11:2", "--set", "mesh.damping_ratio=0.1"]
    done = run("response", *MAPPED, *axis, "--speeds", 60, "--json", "-o", data)
    assert done.exit_code == 0, done.output
    response = json.loads(done.stdout)
    assert [(j["damping_ratio"], j["rising"]) for j in response["jumps"]] == [(0.1, False), (0.1, True)]
    (removed,) = response["removed_by"]
    assert removed["value"] == pytest.approx(0.1055, abs=2e-4)
    assert removed["error"] < 2e-4
    result = xr.open_dataset(data)
    between = [j["speed_rpm"] for j in response["jumps"]]
    row = result.sel(damping_ratio=0.1)
    several = row["speed_rpm"].where(row["motions"] > 1, drop=True)
    assert between[0] < several.min()
    assert several.max() < between[1]
    assert result["motions"].sel(damping_ratio=0.11).max() == 1
    assert len(plot(result).axes) == 3


def test_an_axis_that_the_pair_does_not_have_is_refused():
    for axis, text in (
        ("tip_relief", "tip relief that acts"),
        ("contact_ratio", "torque"),
        ("torque=1", "NAME"),
    ):
        assert text in refused("response", *MAPPED, "--map", axis)


def test_the_command_says_what_a_budget_left_open():
    """Too little time for one branch: no claim that there are no jumps."""
    done = run("response", *PAIR, "--periods", 1, "--seeds", 0, "--budget", 0.001)
    assert done.exit_code == 0, done.output
    assert "the time left open: 12000 to 14000 rpm" in done.stdout
    assert "one stable motion leads to the next" not in done.stdout
    assert refused("response", *PAIR, "--budget", 0)
