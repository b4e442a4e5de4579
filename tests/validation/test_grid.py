"""Does the regression grid tell agreement, a broken rule, invalid points and failures apart?"""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import multibody
from lumped import NumericalError, ParameterError
from validation.cli import app
from validation.grid import COMPARED, SCALING_TOLERANCE, SEPARATED, STICKING, Grid, crosscheck_grid
from validation.grid_summary import failures, law_of_torque, summarise_grid
from validation.output import write_dataset
from validation.plots.grid import grid_figure

SMALL = Grid(
    presets=("nasa_28_28",),
    laws=("coulomb", "xu_kahraman"),
    stiffness=("smooth",),
    speeds=(0.3, 1.0, 1.7),
)


@pytest.fixture(scope="module")
def result():
    return crosscheck_grid(SMALL, workers=1)


def test_models_agree_and_obey_the_law_of_torque(result):
    found = summarise_grid(result)
    assert found.verdict in ("confirmed", "bounded")
    assert found.points == 12
    assert found.failed == 0
    assert found.linear < 0.1  # of 1e-6: integration at 1e-9 leaves far less
    # Law I with smooth stiffness at nominal speed: the one place here where nothing sticks or separates.
    assert found.scaled == 1
    assert found.scaling < SCALING_TOLERANCE
    dte = result["largest"].sel(fidelity="exact", quantity="dte")
    assert float(dte.sel(found.worst)) == found.largest


def test_points_beyond_the_lumped_model_are_named_and_not_judged(result):
    status = result["status"].sel(preset="nasa_28_28")
    # 1.7 times 4875 rpm lies near a resonance where the lumped loads turn negative.
    assert set(np.unique(status.sel(speed=1.7, torque=1.0))) == {SEPARATED}
    assert float(result["load_min"].sel(speed=1.7, torque=1.0).max()) < 0
    assert result["difference"].sel(speed=1.7, torque=1.0).isnull().all()
    # Coulomb's jump of friction at the pitch point can hold slow teeth; law III has no jump there.
    assert (status.sel(law="coulomb", speed=0.3, torque=1.0) == STICKING).all()
    assert (status.sel(law="xu_kahraman", speed=0.3, torque=1.0) == COMPARED).all()


def test_a_difference_that_does_not_fall_with_torque_breaks_the_law(result):
    wrong = result.copy(deep=True)
    wrong["ratio"] = wrong["ratio"] / 4.0  # as a mistake in geometry would: the same share at every torque
    assert summarise_grid(wrong).verdict == "not confirmed"
    assert int(law_of_torque(wrong).notnull().sum()) == 1


def test_disagreeing_equations_are_not_confirmed_even_where_sliding_sticks(result):
    wrong = result.copy(deep=True)
    at = {"law": "coulomb", "speed": 0.3, "torque": 1.0, "fidelity": "linear", "quantity": "x_p"}
    wrong["difference"].loc[at] = 1e-3
    assert summarise_grid(wrong).verdict == "not confirmed"


def test_an_exact_quantity_outside_its_tolerance_bounds_the_verdict(result):
    limits = result.copy(deep=True)
    limits["difference"] = limits["limit"] * 0.5
    assert summarise_grid(limits).verdict == "confirmed"
    at = {"law": "xu_kahraman", "speed": 1.0, "torque": 1.0, "fidelity": "exact", "quantity": "y_p"}
    limits["difference"].loc[at] = 2.0 * limits["limit"].sel(at)
    found = summarise_grid(limits)
    assert found.verdict == "bounded"
    assert found.outside == 1


def test_a_failed_model_is_recorded_with_its_reason(monkeypatch):
    def fail(*_, **__):
        raise NumericalError("No periodic motion.")

    monkeypatch.setattr(multibody, "steady_state", fail)
    one = Grid(("nasa_28_28",), ("coulomb",), ("smooth",), (1.0,), (1.0,))
    found = crosscheck_grid(one, workers=1)
    assert summarise_grid(found).failed == 1
    [(point, reason)] = failures(found)
    assert reason == "No periodic motion."
    assert point["stiffness"] == "smooth"


@pytest.mark.parametrize(
    "wrong", [{"laws": ()}, {"stiffness": ("soft",)}, {"torques": (0.25, 1.0)}, {"speeds": (1.0, 1.0)}]
)
def test_a_grid_without_sense_is_refused(wrong):
    with pytest.raises(ParameterError, match="grid"):
        Grid(**wrong)


def test_the_dataset_survives_a_file(result, tmp_path):
    path = tmp_path / "grid.nc"
    write_dataset(result, path)
    with xr.open_dataset(path, engine="h5netcdf") as again:
        assert summarise_grid(again.load()) == summarise_grid(result)


def test_the_heat_map_shows_every_point_and_marks_those_not_judged(result):
    figure = grid_figure(result)
    ax = figure.axes[0]
    assert ax.images[0].get_array().shape == (1, 12)
    marked = {
        c.get_label(): len(c.get_offsets()) for c in ax.collections if c.get_label() in (SEPARATED, STICKING)
    }
    counts = summarise_grid(result)
    assert marked == {SEPARATED: counts.separated, STICKING: counts.sticking}


def _run(*arguments):
    return CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "200", "NO_COLOR": "1"})


@pytest.mark.parametrize("suffix", [".csv", ".nc", ".svg"])
def test_the_command_prints_a_table_and_writes_data_or_the_heat_map(result, monkeypatch, tmp_path, suffix):
    causes = xr.Dataset(
        {kind: (("cause", "quantity"), [[0.25]]) for kind in ("alone", "without")},
        coords={"cause": ["entry_shift"], "quantity": ["dte"]},
    )
    monkeypatch.setattr("validation.grid.crosscheck_grid", lambda **_: result)
    monkeypatch.setattr("validation.grid_summary.explain", lambda *_: causes)
    path = tmp_path / f"grid{suffix}"
    shown = _run("crosscheck", "--grid", "-o", path)
    assert shown.exit_code == 0, shown.output
    assert "12 points" in shown.stdout
    assert "entry_shift" in shown.stdout
    assert summarise_grid(result).verdict in shown.stdout
    assert path.stat().st_size > 1000


def test_options_of_a_single_pair_have_no_place_beside_the_grid():
    for arguments in (["fzg_c"], ["--speed", "100"], ["--set", "mesh.damping_ratio=0.1"]):
        refused = _run("crosscheck", "--grid", *arguments)
        assert refused.exit_code == 2
        assert "--grid" in refused.stderr
