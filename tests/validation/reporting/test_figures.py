"""Is each curve of the report the result that it is labelled with, in the unit of its axis?"""

import base64
import re

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from lumped.labelling import labelled_dataset
from validation.plots.axes import draw_curves, drawn, label_axis, scale_of
from validation.plots.prediction import budget_figure, orders_figure, over_speed_figure, overlay_figure
from validation.plots.style import one_panel


def curve(values, unit, name="a result", x_unit="rpm"):
    return labelled_dataset(
        {"y": ("x", np.asarray(values, float), unit, name)},
        {"x": (np.arange(len(values), dtype=float), x_unit, "the place")},
    )


def test_an_axis_is_labelled_and_scaled_by_the_result():
    _, ax = one_panel(2.0)
    draw_curves(ax, curve([1e-6, 4e-6, 2e-6], "m", "transmission error"), ["y"])
    assert (ax.get_ylabel(), ax.get_xlabel()) == ("transmission error [µm]", "the place [rpm]")
    np.testing.assert_allclose(drawn(ax, "y"), [[0.0, 1.0, 2.0], [1.0, 4.0, 2.0]])
    assert ax.lines[0].get_label() == "transmission error"


@pytest.mark.parametrize(("unit", "shown", "factor"), [("1", "-", 1.0), ("%", "%", 1.0), ("N", "kN", 1e3)])
def test_units_with_and_without_prefix(unit, shown, factor):
    assert scale_of(curve([1200.0, 4800.0], unit)["y"]) == (factor, shown)


def test_results_of_two_units_cannot_share_an_axis():
    _, ax = one_panel(2.0)
    with pytest.raises(ValueError, match="different units"):
        label_axis(ax, "y", curve([1.0], "m")["y"], curve([1.0], "N")["y"])


def test_every_picture_is_in_the_page_with_its_table(written):
    names = [f for chapter in written.document["chapters"].values() for f in chapter.get("figures", [])]
    files = {path.stem for path in (written.folder / "figures").glob("*.svg")}
    assert set(names) <= files
    assert len(files) <= 14
    for name in files:
        data = base64.b64encode((written.folder / "figures" / f"{name}.svg").read_bytes()).decode()
        assert data in written.page, name
        table = pd.read_csv(written.folder / "tables" / f"figure_{name}.csv")
        assert len(table) > 0


def test_the_figures_show_the_saved_results(written):
    tables = written.folder / "tables"
    second, prediction = written.data("second_program"), written.data("prediction")
    overlay = pd.read_csv(tables / "figure_overlay.csv")
    np.testing.assert_allclose(overlay["prediction [m]"].max(), prediction["dte"].max().item(), rtol=1e-3)
    np.testing.assert_allclose(overlay["second [m]"].max(), second["dte"].max().item(), rtol=1e-3)
    difference = overlay["second [m]"] - overlay["prediction [m]"]
    np.testing.assert_allclose(overlay["difference [m]"], difference, atol=1e-15)
    assert np.abs(difference).max() > 1e-9, "curves of two models differ"
    sweep = written.data("sweep")
    over = pd.read_csv(tables / "figure_over_speed.csv")
    np.testing.assert_array_equal(over["speed_rpm"], sweep["speed"].to_numpy())
    shown = over["linear [m]"].to_numpy()
    kept = np.isfinite(shown)
    np.testing.assert_allclose(shown[kept], sweep["dte_peak_to_peak"].to_numpy()[kept], rtol=1e-12)
    holds = (sweep["spectral_radius"] <= 1.0) & (sweep["normal_load_min"] > 0.0)
    np.testing.assert_array_equal(kept, holds.to_numpy())
    dte = pd.read_csv(tables / "figure_transmission_error.csv")
    np.testing.assert_allclose(dte["dte [m]"], prediction["dte"].to_numpy(), rtol=1e-12)
    forces = pd.read_csv(tables / "figure_tooth_forces.csv")
    np.testing.assert_allclose(forces["mesh_force [N]"], prediction["normal_load"].sum("pair"), rtol=1e-12)


def speeds_data():
    speed = np.linspace(1000.0, 2000.0, 5)
    return labelled_dataset(
        {
            "linear": ("speed_rpm", np.linspace(1e-6, 5e-6, 5), "m", "peak to peak"),
            "pulling": ("speed_rpm", np.array([np.nan, np.nan, 2.5e-6, np.nan, np.nan]), "m", "pulls"),
            "low": ("speed_rpm", np.linspace(0.5e-6, 4e-6, 5), "m", "5 %"),
            "high": ("speed_rpm", np.linspace(2e-6, 6e-6, 5), "m", "95 %"),
        },
        {"speed_rpm": (speed, "rpm", "pinion speed")},
    )


def test_the_picture_over_speed_has_curve_band_and_operating_speed():
    ax = over_speed_figure(speeds_data(), 1500.0).axes[0]
    np.testing.assert_allclose(drawn(ax, "linear")[1], [1.0, 2.0, 3.0, 4.0, 5.0])
    band = ax.collections[0].get_paths()[0].vertices
    assert band[:, 1].max() == pytest.approx(6.0)
    assert any(line.get_xdata()[0] == 1500.0 for line in ax.lines if len(line.get_xdata()) == 2)
    assert "1500 rpm" in [text.get_text() for text in ax.texts]
    (dotted,) = (line for line in ax.lines if line.get_label() == "linear, a tooth pair pulls")
    assert dotted.get_ydata()[2] == pytest.approx(2.5)


def test_motions_that_the_pair_cannot_have_do_not_set_the_scale():
    data = speeds_data()
    data["pulling"] = data["pulling"] * 200.0
    motions = {
        "motion": ("motion_speed_rpm", np.array([9e-6, 300e-6]), "m", "peak to peak"),
        "motion_stable": ("motion_speed_rpm", np.array([1.0, 0.0]), "1", "stable"),
        "jump_from": ("jump_speed_rpm", np.empty(0), "m", "before"),
        "jump_to": ("jump_speed_rpm", np.empty(0), "m", "after"),
    }
    axes = {
        "motion_speed_rpm": (np.array([1200.0, 1400.0]), "rpm", "pinion speed"),
        "jump_speed_rpm": (np.empty(0), "rpm", "pinion speed"),
    }
    ax = over_speed_figure(data.merge(labelled_dataset(motions, axes)), 1500.0).axes[0]
    assert 9.0 < ax.get_ylim()[1] < 15.0


def test_the_picture_over_speed_names_only_what_it_draws():
    data = speeds_data()
    data["linear"] = data["linear"] * np.nan
    words = [text.get_text() for text in over_speed_figure(data, 1500.0).axes[0].get_legend().get_texts()]
    assert words == ["5 to 95 % of the samples", "linear, a tooth pair pulls"]


def test_the_picture_of_orders_has_bars_and_ranges():
    order = np.arange(1, 4)
    data = labelled_dataset(
        {
            "amplitude": ("order", np.array([10.0, 30.0, 20.0]), "N", "force on the pinion bearings"),
            "low": ("order", np.array([5.0, 20.0, 10.0]), "N", "5 %"),
            "high": ("order", np.array([15.0, 60.0, 30.0]), "N", "95 %"),
        },
        {"order": (order, "1", "mesh order")},
        {"mesh_frequency": 459.2},
    )
    ax = orders_figure(data).axes[0]
    assert [bar.get_height() for bar in ax.patches] == pytest.approx([10.0, 30.0, 20.0])
    ends = [segment[:, 1].tolist() for segment in ax.collections[0].get_segments()]
    assert ends == [[5.0, 15.0], [20.0, 60.0], [10.0, 30.0]]
    assert "459.2 Hz" in ax.get_xlabel()
    assert ax.get_ylabel() == "force on the pinion bearings [N]"


def test_the_picture_of_the_budget_says_what_is_not_known():
    data = labelled_dataset(
        {"share": ("row", np.array([1e-6, np.nan, 20.0]), "%", "error, share of the peak to peak")},
        {"row": (["a", "b", "c"], "1", "error")},
        {"names": ["numerical error", "measurement", "inputs"]},
    )
    ax = budget_figure(data).axes[0]
    words = [text.get_text() for text in ax.texts]
    assert words == ["1e-06 %", "not known", "20 %"]
    assert [bar.get_width() for bar in ax.patches][2] == pytest.approx(20.0)
    assert ax.get_xscale() == "log"


def test_the_overlay_draws_both_curves_and_their_difference():
    data = xr.merge(
        [
            curve([1e-6, 2e-6, 1e-6], "m", n, "mesh cycles").rename(y=k, x="cycle")
            for k, n in (("prediction", "prediction"), ("second", "second program"), ("difference", "d"))
        ]
    )
    top, bottom = overlay_figure(data).axes
    assert [line.get_label() for line in top.lines] == ["prediction", "second program"]
    assert re.fullmatch(r"difference \[µm\]", bottom.get_ylabel())
