"""Does the regression grid tell agreement, a broken rule, invalid points and failures apart?"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import multibody
from lumped import NumericalError, ParameterError
from validation.cli import app
from validation.cross_check.compared_motions import BLUNT
from validation.cross_check.grid import point
from validation.cross_check.grid.point import GridPoint, compare_point
from validation.cross_check.grid.run import (
    COMPARED,
    SCALING_TOLERANCE,
    SEPARATED,
    STICKING,
    Grid,
    crosscheck_grid,
)
from validation.cross_check.grid.summary import failures, law_of_torque, outside_tolerance, summarise_grid
from validation.files.output import write_dataset
from validation.plots.grid import grid_figure

SMALL = Grid(
    presets=("nasa_28_28",),
    laws=("coulomb", "xu_kahraman"),
    stiffness=("smooth",),
    speeds=(0.3, 1.0, 1.7),
)


@pytest.fixture(scope="module")
def result():
    found = crosscheck_grid(SMALL, workers=0)
    found["status"] = found["status"].astype("U40")  # room for other states
    return found


def test_models_agree_and_obey_the_law_of_torque(result):
    found = summarise_grid(result)
    assert found.verdict == "confirmed"
    assert found.points == 12
    assert found.compared + found.separated + found.sticking + found.failed == found.points
    assert (found.failed, found.sticking, found.outside) == (0, 0, 0)
    assert found.linear < 0.1  # of 1e-6: integration at 1e-9 leaves far less
    # What finite motions do is foreseen: a few per cent of it are left.
    assert 0.0 < found.left < 0.1 * found.whole
    # Law I with smooth stiffness at both speeds where its teeth stay together.
    assert found.scaled == 2
    assert found.scaling < SCALING_TOLERANCE
    dte = result["largest"].sel(fidelity="exact", quantity="dte")
    assert float(dte.sel(found.worst)) == found.largest == float(dte.max())


def test_points_beyond_contact_loss_are_judged_with_teeth_that_push_only(result, monkeypatch):
    status = result["status"].sel(preset="nasa_28_28")
    # 1.7 times 4875 rpm lies near a resonance where the linear model's loads turn negative.
    parted = result.sel(speed=1.7, torque=1.0)
    assert float(parted["load_min"].max()) < 0
    assert (status == COMPARED).all()
    assert summarise_grid(result).parted == int((result["load_min"] < 0.0).sum())
    assert float((parted["difference"] / parted["limit"]).max()) < 0.2
    assert np.isnan(law_of_torque(result).sel(speed=1.7)).all()
    monkeypatch.setattr(point, "parted_orbit", lambda pair: None)  # as where it beats
    separated = compare_point(Grid().pair("nasa_28_28", "coulomb", "rectangular", 1.7, 1.0), 32)
    assert separated.status == SEPARATED
    assert np.isnan(separated.judged).all()


def test_a_point_where_friction_holds_the_teeth_is_compared_but_not_judged(result, monkeypatch):
    """The lumped model alone says where that is (test_finite_motion); here it says so of any point."""
    true = point.finite_motion
    monkeypatch.setattr(
        point, "finite_motion", lambda *a, **k: dataclasses.replace(true(*a, **k), settled=False)
    )
    held = compare_point(Grid().pair("nasa_28_28", "coulomb", "smooth", 0.3, 0.25), 32)
    assert held.status == STICKING
    # The equations are the same all the same.
    assert (held.judged[0] < held.limit[0]).all()
    assert np.isfinite(held.judged).all()
    wrong = result.copy(deep=True)
    at = {"law": "coulomb", "speed": 0.3, "torque": 1.0}
    wrong["status"].loc[at] = STICKING
    wrong["difference"].loc[at | {"fidelity": "exact"}] = 1.0
    wrong["total"].loc[at | {"fidelity": "exact"}] = 1.0
    wrong["largest"].loc[at | {"fidelity": "exact", "quantity": "dte"}] = 7.0
    found = summarise_grid(wrong)
    assert found.verdict == "confirmed"
    assert (found.sticking, found.scaled) == (1, 1)
    assert outside_tolerance(wrong) == ()
    # The law of torque needs both torques judged: of a pair whose lower torque is held nothing is asked.
    lower = result.copy(deep=True)
    lower["status"].loc[{"law": "coulomb", "speed": 0.3, "torque": 0.25}] = STICKING
    assert int(law_of_torque(lower).notnull().sum()) == 1
    # It is the worst point, and named, but not among the judged.
    assert found.largest == 7.0
    assert found.largest_judged < 1.0
    assert {k: found.worst[k] for k in at} == at


def test_a_difference_that_does_not_fall_with_torque_breaks_the_law(result):
    wrong = result.copy(deep=True)
    wrong["ratio"] = wrong["ratio"] / 4.0  # as a mistake in geometry would: the same share at every torque
    assert summarise_grid(wrong).verdict == "not confirmed"
    assert int(law_of_torque(wrong).notnull().sum()) == 2


def test_reversed_sliding_breaks_the_first_order_law_as_expected():
    """Law IV at 0.3 of the 50/50 pair's speed: vibration turns sliding near P, over a length of its own."""
    names = ("kahraman_blankenship_50_50",), ("smoothed_coulomb",), ("smooth",)
    grid = Grid(*names, (0.3,), (1.0, 0.25), samples=64)
    found = crosscheck_grid(grid, workers=0)
    assert abs(float(found["ratio"].max()) - 1.0) > 0.3
    # What is left of the difference is a share of it below 5 %, so of the ratio of two below 10 %.
    assert float(law_of_torque(found).max()) == pytest.approx(1.0, abs=0.1)
    assert summarise_grid(found).verdict != "not confirmed"


@pytest.mark.parametrize("sharp_fails", [False, True])
def test_a_motion_that_the_integrator_cannot_follow_sharply_is_compared_with_a_blunter_friction(
    monkeypatch, sharp_fails
):
    """Law III at low speed and torque; with a change of sign over 0.01 m/s y is another, as foreseen."""
    pair = Grid().pair("kahraman_blankenship_50_50", "xu_kahraman", "smooth", 0.3, 0.25)
    motion = multibody.steady_state

    def fail(*arguments, friction_velocity, fidelity, **options):
        if sharp_fails and friction_velocity < BLUNT:
            raise NumericalError("The steps keep shrinking.")
        return motion(*arguments, friction_velocity=friction_velocity, fidelity=fidelity, **options)

    monkeypatch.setattr(multibody, "steady_state", fail)
    point = compare_point(pair, 32)
    assert point.status == COMPARED
    assert (point.judged <= point.limit).all()
    assert (point.total > 100.0 * point.limit)[1, 3:5].all() == sharp_fails


def test_the_ratio_is_the_fall_of_the_difference_over_that_of_the_torque(result):
    dte = result["largest"].sel(fidelity="exact", quantity="dte")
    full, quarter = (dte.sel(torque=t, drop=True) for t in (1.0, 0.25))
    np.testing.assert_allclose(result["ratio"].sel(torque=1.0), full / quarter / 4.0)
    assert result["ratio"].sel(torque=0.25).isnull().all()
    judged = result["ratio_judged"]
    assert judged.sel(law="coulomb").all()
    assert not judged.sel(law="xu_kahraman").any()  # its coefficient depends on torque


def test_disagreeing_equations_are_not_confirmed_even_where_sliding_sticks(result):
    wrong = result.copy(deep=True)
    wrong["status"].loc[{"law": "coulomb", "speed": 0.3, "torque": 1.0}] = STICKING
    at = {"law": "coulomb", "speed": 0.3, "torque": 1.0, "fidelity": "linear", "quantity": "x_p"}
    wrong["difference"].loc[at] = 1e-3
    assert summarise_grid(wrong).verdict == "not confirmed"


def test_an_exact_quantity_outside_its_tolerance_is_not_confirmed(result):
    limits = result.copy(deep=True)
    limits["difference"] = limits["limit"] * 0.5
    assert summarise_grid(limits).verdict == "confirmed"
    assert outside_tolerance(limits) == ()
    at = {"law": "xu_kahraman", "speed": 1.0, "torque": 1.0, "fidelity": "exact"}
    limits["difference"].loc[at | {"quantity": "y_p"}] = 2.0 * limits["limit"].sel(at | {"quantity": "y_p"})
    near = at | {"torque": 0.25, "quantity": "x_p"}
    limits["difference"].loc[near] = 3.0 * limits["limit"].sel(near)
    found = summarise_grid(limits)
    assert found.verdict == "not confirmed"
    assert (found.outside, found.exact) == (2, pytest.approx(3.0))
    first, second = outside_tolerance(limits)
    assert (first.quantity, first.point["torque"]) == ("x_p", 0.25)
    assert (second.quantity, second.point["law"], second.point["speed"]) == ("y_p", "xu_kahraman", 1.0)
    assert second.left == pytest.approx(2.0 * second.limit)
    assert second.whole == float(limits["total"].sel(at | {"quantity": "y_p"}).item())


def test_a_transmission_error_that_is_another_motion_is_not_confirmed(result):
    """Judged by the whole difference: a prediction that follows it does not make the lumped motion right."""
    wrong = result.copy(deep=True)
    at = {"law": "xu_kahraman", "speed": 1.0, "torque": 1.0, "fidelity": "exact", "quantity": "dte"}
    wrong["total"].loc[at] = 0.49
    assert summarise_grid(wrong).verdict == "confirmed"
    wrong["total"].loc[at] = 0.51
    assert summarise_grid(wrong).verdict == "not confirmed"


def test_a_failed_model_is_recorded_with_its_reason(monkeypatch):
    def fail(*_, **__):
        raise NumericalError("No periodic motion.")

    monkeypatch.setattr(multibody, "steady_state", fail)
    one = Grid(("nasa_28_28",), ("coulomb",), ("smooth",), (1.0,), (1.0,))
    found = crosscheck_grid(one, workers=0)
    assert summarise_grid(found).failed == 1
    [(point, reason)] = failures(found)
    assert reason == "NumericalError: No periodic motion."
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


def test_the_heat_maps_show_every_point_and_mark_those_not_judged(result):
    shown = result.copy(deep=True)
    shown["status"].loc[{"law": "coulomb", "speed": 0.3, "torque": 1.0}] = STICKING
    shown["status"].loc[{"speed": 1.7, "torque": 0.25}] = SEPARATED
    figure = grid_figure(shown)
    above, below = figure.axes[:2]
    largest = shown["largest"].sel(fidelity="exact", quantity="dte").to_numpy().ravel()
    np.testing.assert_array_equal(np.ma.filled(above.images[0].get_array(), np.nan).ravel(), largest)
    use = (shown["difference"] / shown["limit"]).sel(fidelity="exact").max("quantity")
    use = use.where(shown["status"] == COMPARED).to_numpy().ravel()
    np.testing.assert_array_equal(np.ma.filled(below.images[0].get_array(), np.nan).ravel(), use)
    marked = {c.get_label(): len(c.get_offsets()) for c in above.collections if c.get_label()}
    counts = summarise_grid(shown)
    assert counts.sticking == 1
    assert counts.separated == 2
    assert marked["teeth separate"] == counts.separated
    assert marked["friction may hold the teeth"] == counts.sticking


def test_an_interrupted_grid_goes_on_where_it_was(result, monkeypatch, tmp_path):
    """The third point is interrupted; what was finished before is not computed again."""
    grid = Grid(("nasa_28_28",), ("coulomb", "xu_kahraman", "none"), ("smooth",), (1.0,), (1.0,), samples=32)
    calls = []

    def point(pair, samples):
        calls.append(pair.friction.law)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return GridPoint(COMPARED, 0.5, 2.0 + len(calls))

    monkeypatch.setattr("validation.cross_check.grid.run.compare_point", point)
    with pytest.raises(KeyboardInterrupt):
        crosscheck_grid(grid, workers=0, checkpoint=tmp_path / "kept")
    kept = len(calls) - 1
    found = crosscheck_grid(grid, workers=0, checkpoint=tmp_path / "kept")
    assert set(calls[kept + 1 :]) == {"coulomb", "xu_kahraman", "none"} - set(calls[: found.attrs["resumed"]])
    assert found.attrs["resumed"] > 0
    assert (found["status"] == COMPARED).all()
    assert found["difference"].isnull().all()


def test_a_checkpoint_of_another_grid_is_refused(monkeypatch, tmp_path):
    monkeypatch.setattr("validation.cross_check.grid.run.compare_point", lambda *_: GridPoint(COMPARED))
    one = Grid(("fzg_c",), ("none",), ("smooth",), (1.0,), (1.0,))
    crosscheck_grid(one, workers=0, checkpoint=tmp_path)
    with pytest.raises(ParameterError, match="this very"):
        crosscheck_grid(dataclasses.replace(one, samples=64), workers=0, checkpoint=tmp_path)
    with pytest.raises(ParameterError, match="checkpoint"):
        crosscheck_grid(one, workers=0, checkpoint=tmp_path / "store.sqlite")


def _run(*arguments):
    return CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "200", "NO_COLOR": "1"})


@pytest.mark.parametrize("suffix", [".csv", ".nc", ".svg"])
def test_the_command_prints_a_table_and_writes_data_or_the_heat_map(result, monkeypatch, tmp_path, suffix):
    monkeypatch.setattr("validation.cross_check.grid.run.crosscheck_grid", lambda **_: result)
    path = tmp_path / f"grid{suffix}"
    shown = _run("crosscheck", "--grid", "-o", path)
    assert shown.exit_code == 0, shown.output
    assert "12 points" in shown.stdout
    assert "12 judged" in shown.stdout
    assert summarise_grid(result).verdict in shown.stdout
    assert path.stat().st_size > 1000


def test_options_of_a_single_pair_have_no_place_beside_the_grid():
    assert _run("crosscheck", "--checkpoint", "kept").exit_code == 2
    for arguments in (["fzg_c"], ["--speed", "100"], ["--set", "mesh.damping_ratio=0.1"]):
        refused = _run("crosscheck", "--grid", *arguments)
        assert refused.exit_code == 2
        assert "--grid" in refused.stderr
