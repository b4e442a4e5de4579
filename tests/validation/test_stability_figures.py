"""Do the figures of stability show what was computed, under the right names?"""

from __future__ import annotations

import numpy as np
import pytest
from typer.testing import CliRunner

from floquet import predicted_lines, stability_chart
from floquet.gear_campbell import campbell, multiplier_paths
from floquet.gear_tongues import critical_damping, label_regions
from lumped import load_gear_pair
from validation.cli import app
from validation.plots.campbell import campbell_figure
from validation.plots.multiplier_paths import multiplier_paths_figure
from validation.plots.tongue_chart import critical_damping_figure, pretty, tongue_chart_figure


@pytest.fixture(scope="module")
def pair():
    return load_gear_pair("nasa_28_28").with_(friction__law="none", mesh__damping_ratio=0.01)


def texts(figure) -> set[str]:
    return {text.get_text() for ax in figure.axes for text in ax.texts}


def test_labels_are_written_as_in_print() -> None:
    assert pretty("2w3/5") == "2ω₃/5"
    assert pretty("(w1+w3)/2") == "(ω₁+ω₃)/2"
    assert pretty("2w12/1") == "2ω₁₂"


def test_tongues_are_named_in_the_chart(pair) -> None:
    axes = {"speed_rpm": np.linspace(6000.0, 18000.0, 121), "damping_ratio": np.linspace(0.0, 0.03, 7)}
    chart = stability_chart(pair, axes)
    lines = {str(t): s for t, s in predicted_lines(pair).items()}
    figure = tongue_chart_figure(
        chart,
        "damping_ratio",
        label_regions(pair, chart),
        lines,
        point=(7000.0, 0.01),
        operating_range=(6e3, 8e3),
    )
    assert {"2ω₃/2", "2ω₃/5", "operating point", "operating range"} <= texts(figure)
    assert figure.axes[0].get_xlabel() == "pinion speed [rpm]"


def test_campbell_diagram_marks_lines_and_range(pair) -> None:
    figure = campbell_figure(
        campbell(pair, np.linspace(14000.0, 18000.0, 21)), operating_rpm=15000.0, operating_range=(14e3, 16e3)
    )
    assert {"2ω₃/2", "operating point", "operating range", "1×"} <= texts(figure)
    assert "[rpm]" in figure.axes[1].get_xlabel()


def test_paths_leave_the_unit_circle_in_the_tongue(pair) -> None:
    figure = multiplier_paths_figure(
        multiplier_paths(pair, "speed_rpm", np.linspace(15000, 18000, 61)), 16000.0
    )
    left, right = figure.axes[:2]
    assert left.get_xlim()[1] > 1.1
    assert "pinion speed [rpm]" in right.get_xlabel()


def test_critical_damping_is_drawn_for_every_closed_tongue(pair) -> None:
    tips = critical_damping(pair, (15000.0, 18000.0), damping_ratios=(0.0, 0.02, 0.08), orders=3)
    assert {"2ω₃/2", "this pair"} <= texts(critical_damping_figure(tips, 0.01))


def test_command_names_the_tongues(tmp_path) -> None:
    path = tmp_path / "chart.svg"
    result = CliRunner().invoke(
        app,
        ["stability", "--tongues", "--law", "none", "--axis", "speed_rpm=15000:18500:36", "--axis",
         "damping_ratio=0:0.03:5", "-o", str(path)],
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    assert "2w3/2" in result.output
    assert path.read_bytes().startswith(b"<?xml")
