"""Is each curve of the report the result that it is labelled with, in the unit of its axis?"""

import base64
import re

import numpy as np
import pandas as pd
import pytest

from lumped.labelling import labelled_dataset
from validation.plots.axes import label_axis, scale_of
from validation.plots.prediction import over_speed_figure
from validation.plots.style import one_panel


def curve(values, unit, name="a result", x_unit="rpm"):
    return labelled_dataset(
        {"y": ("x", np.asarray(values, float), unit, name)},
        {"x": (np.arange(len(values), dtype=float), x_unit, "the place")},
    )


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
    for kind, first in (("Figure", len(files) - len(names) + 1), ("Table", 1)):
        numbers = list(map(int, re.findall(rf"<b>{kind} (\d+)</b>", written.page)))
        assert numbers == list(range(first, first + len(numbers)))
    for name in files:
        data = base64.b64encode((written.folder / "figures" / f"{name}.svg").read_bytes()).decode()
        assert data in written.page, name
        table = pd.read_csv(written.folder / "tables" / f"figure_{name}.csv")
        # Of stability the regions, where there are some: the chart is in stability.nc.
        assert len(table) > 0 or name == "stability_chart"


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
