"""Does the command list the jumps and what removes them, and does the figure show them?"""

from __future__ import annotations

import json

import pytest
import xarray as xr
from typer.testing import CliRunner

from validation.cli import app
from validation.plots.of_result import plot

PAIR = ["nasa_28_28", "--law", "none", "--set", "mesh.relief=ignored", "--range", "12900..15500"]


def test_damping_removes_the_jump_at_the_cusp(tmp_path):
    """The two folds of the resonance meet at a damping ratio of 0.105 (docs/theory/orbits.md)."""
    data = tmp_path / "map.nc"
    axis = ["--axis", "damping_ratio=0.1:0.11:2", "--set", "mesh.damping_ratio=0.1"]
    done = CliRunner().invoke(app, ["jumps", *PAIR, *axis, "--speeds", "60", "--json", "-o", str(data)])
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert [(j["damping_ratio"], j["rising"]) for j in found["jumps"]] == [
        (0.1, False),
        (0.1, True),
    ]
    (removed,) = found["removed_by"]
    assert removed["value"] == pytest.approx(0.1055, abs=2e-4)
    assert removed["error"] < 2e-4
    result = xr.open_dataset(data)
    between = [j["speed_rpm"] for j in found["jumps"]]
    row = result.sel(damping_ratio=0.1)
    several = row["speed_rpm"].where(row["motions"] > 1, drop=True)
    assert between[0] < several.min()
    assert several.max() < between[1]
    assert result["motions"].sel(damping_ratio=0.11).max() == 1
    figure = plot(result)
    left, right, _ = figure.axes
    assert left.get_xlim() == right.get_xlim() == (12900.0, 15500.0)
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"several motions: jumps", "jump, running up", "jump, running down"} < set(words)
    marked = sorted(line.get_xdata()[0] for line in left.lines)
    assert marked == pytest.approx(between)


def test_an_axis_that_the_pair_does_not_have_is_refused():
    for axis, text in (
        ("tip_relief", "tip relief that acts"),
        ("contact_ratio", "torque"),
        ("torque=1", "NAME"),
    ):
        done = CliRunner().invoke(app, ["jumps", *PAIR, "--axis", axis])
        assert done.exit_code == 2
        assert text in done.output
