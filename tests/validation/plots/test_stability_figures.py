"""Do the figures of stability show what was computed, under the right names?"""

from itertools import combinations

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import QuadMesh
from matplotlib.contour import QuadContourSet

import spurcheck
from floquet import predicted_lines, stability_chart
from floquet.engine.multipliers import verdicts
from floquet.gear.chart import label_regions
from floquet.gear.tongues import campbell
from lumped import load_gear_pair
from lumped.errors import ParameterError
from validation.plots.stability import campbell_figure, label_above, pretty, stability_figure
from validation.plots.style import one_panel


@pytest.fixture(scope="module")
def pair():
    return load_gear_pair("nasa_28_28").with_(
        mesh__relief="ignored", friction__law="none", mesh__damping_ratio=0.01
    )


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
    point = {"speed_rpm": 7000.0, "damping_ratio": 0.01}
    figure = stability_figure(chart, point, label_regions(pair, chart), lines)
    assert {"2ω₃/2", "2ω₃/5", "operating point"} <= texts(figure)
    assert figure.axes[0].get_xlabel() == "pinion speed [rpm]"


def test_no_label_of_a_tongue_covers_another() -> None:
    # As many as there is room for, at the lines of theory, which crowd at low speed.
    pair = load_gear_pair("nasa_art_25_31")
    lines = sorted((speed, str(line)) for line, speed in predicted_lines(pair).items())[-40:]
    figure, ax = one_panel(3.2)
    ax.set_xlim(1000.0, 20000.0)
    label_above(ax, [label for _, label in lines], [x for x, _ in lines], [1.0] * len(lines))
    FigureCanvasAgg(figure).draw()
    names = {pretty(label) for _, label in lines}
    boxes = [t.get_window_extent() for t in figure.axes[0].texts if t.get_text() in names]
    assert len(boxes) == len(names) > 15
    assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))
    assert all(figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 for box in boxes)


def over_speed_and_damping(speeds, dampings, radius) -> xr.Dataset:
    dims = ("speed_rpm", "damping_ratio")
    data = {"spectral_radius": (dims, radius), "verdict": (dims, verdicts(radius, 1e-9 + 0.0 * radius))}
    axes = {"speed_rpm": speeds, "damping_ratio": dampings}
    return xr.Dataset(data, axes, {"certificate": "mixed"})


def test_a_large_chart_is_one_image_and_not_a_polygon_per_point() -> None:
    x = np.linspace(1000.0, 20000.0, 1000)
    y = np.linspace(0.0, 0.05, 500)
    radius = 0.9 + 0.15 * np.exp(-(((x[:, None] - 9000.0) / 500.0) ** 2) - (y / 0.01) ** 2)
    chart = over_speed_and_damping(x, y, radius)
    ax = stability_figure(chart, {"speed_rpm": 5000.0, "damping_ratio": 0.05}).axes[0]
    (image,) = ax.images
    assert image.get_array().shape == (500, 1000)
    # Nodes lie in the middle of their pixels.
    left_edge, right_edge, bottom, top = image.get_extent()
    assert (left_edge, right_edge) == pytest.approx((1000.0 - 9.51, 20000.0 + 9.51), abs=0.01)
    assert bottom == pytest.approx(-top + 0.05)
    assert not [c for c in ax.collections if isinstance(c, QuadMesh)]
    assert sum(len(c.get_paths()) for c in ax.collections) < 10
    # The boundary that is drawn is where the radius is one: exp(-s^2) = 2/3 on the axis.
    (line,) = [c for c in ax.collections if c.get_linewidths().max() == 1.0 and not c.filled]
    vertices = np.concatenate([path.vertices for path in line.get_paths()])
    assert vertices[:, 0].min() == pytest.approx(9000.0 - 500.0 * np.sqrt(np.log(1.5)), abs=5.0)
    assert vertices[:, 1].max() == pytest.approx(0.01 * np.sqrt(np.log(1.5)), abs=2e-5)


def test_what_is_undecided_is_dotted_and_not_hatched() -> None:
    radius = np.array([[0.9, 0.9, 0.9], [1.0 + 1e-10] * 3, [1.1, 1.1, 1.1]])
    chart = over_speed_and_damping(np.array([1e3, 2e3, 3e3]), np.array([0.0, 0.1, 0.2]), radius)
    ax = stability_figure(chart).axes[0]
    spans = {
        c.hatches[0]: np.concatenate([p.vertices for p in c.get_paths()])[:, 0]
        for c in ax.collections
        if isinstance(c, QuadContourSet) and c.filled
    }
    assert (spans["..."].min(), spans["..."].max()) == (1500.0, 2500.0)
    assert spans["////"].min() == pytest.approx(2500.0, abs=1.0)
    assert "dotted: undecided" in ax.figure.get_supxlabel()
    line = stability_figure(chart.isel(damping_ratio=0)).axes[0]
    assert line.get_lines()[1].get_xdata().tolist() == [2e3]


def test_what_is_neutral_has_circles_and_no_edge_but_that_of_unstable_nodes() -> None:
    """Its radius is 1 to rounding, above or below: that is no edge."""
    radius = np.array([[1.0 + 1e-13, 1.0 - 1e-13, 1.0 + 1e-13], [1.0 + 1e-13] * 3, [1.1, 1.1, 1.1]])
    chart = over_speed_and_damping(np.array([1e3, 2e3, 3e3]), np.array([0.0, 0.1, 0.2]), radius)
    chart["verdict"] = chart["verdict"].where(radius > 1.01, 2)
    ax = stability_figure(chart).axes[0]
    spans = {
        c.hatches[0]: np.concatenate([p.vertices for p in c.get_paths()])[:, 0]
        for c in ax.collections
        if isinstance(c, QuadContourSet) and c.filled
    }
    assert (spans["o"].min(), spans["o"].max()) == (1000.0, 2500.0)
    assert spans["////"].min() == pytest.approx(2500.0, abs=1.0)
    assert "..." not in spans
    words = ax.figure.get_supxlabel()
    assert "circles: neutral" in words
    assert "dotted" not in words


def test_uneven_axes_and_falling_ones_are_drawn_at_their_values() -> None:
    x = np.array([3000.0, 1000.0, 1100.0])
    y = np.array([0.01, 0.05, 0.0])
    values = np.array([[0.3, 0.4, 0.35], [0.1, 0.15, 0.12], [0.2, 0.28, 0.25]])
    ax = stability_figure(over_speed_and_damping(x, y, values)).axes[0]
    assert ax.figure.get_supxlabel() == "hatched: unstable; error bounds: partly proven"
    (mesh,) = [c for c in ax.collections if isinstance(c, QuadMesh)]
    rows = [[0.12, 0.25, 0.35], [0.1, 0.2, 0.3], [0.15, 0.28, 0.4]]
    assert np.allclose(mesh.get_array(), np.log(rows))  # growth of one period, y upwards
    assert ax.get_xlim() == (1000.0, 3000.0)


def test_an_operating_point_outside_the_chart_is_left_out(pair) -> None:
    chart = stability_chart(pair, {"speed_rpm": [6e3, 7e3, 8e3], "damping_ratio": [0.0, 0.01, 0.02]})
    inside, outside = (
        texts(stability_figure(chart, {"speed_rpm": 7e3, "damping_ratio": damping}))
        for damping in (0.01, 0.05)
    )
    assert "operating point" in inside
    assert "operating point" not in outside


def test_thin_regions_are_marked(pair) -> None:
    axes = {"speed_rpm": np.linspace(6000.0, 6500.0, 6), "damping_ratio": np.linspace(0.03, 0.05, 5)}
    chart = stability_chart(pair, axes)
    thin = {"width": [101.0, 500.0], "speed_rpm": [6100.0, 6300.0], "damping_ratio": [0.04, 0.04]}
    regions = {f"region_{name}": ("region", np.array(values)) for name, values in thin.items()}
    marked = stability_figure(chart.drop_dims("region").assign(regions))
    (cross,) = [line for line in marked.axes[0].lines if line.get_marker() == "x"]
    assert cross.get_xydata().tolist() == [[6100.0, 0.04]]


def test_campbell_diagram_marks_lines_and_the_operating_point(pair) -> None:
    figure = campbell_figure(campbell(pair, np.linspace(14000.0, 18000.0, 21)), operating_rpm=15000.0)
    assert {"2ω₃/2", "operating point", "1×"} <= texts(figure)
    assert "[rpm]" in figure.axes[1].get_xlabel()


PAIR = "nasa_28_28"
CHART = {"speed_rpm": np.linspace(3000.0, 9000.0, 7), "damping_ratio": np.linspace(0.005, 0.05, 5)}
RESULTS = {
    "simulate": lambda: spurcheck.simulate(PAIR, 2, samples_per_cycle=32),
    "steady state": lambda: spurcheck.steady_state(PAIR, samples_per_cycle=32),
    "multibody": lambda: spurcheck.multibody.simulate(PAIR, 1, samples_per_cycle=32),
    "sweep": lambda: spurcheck.speed_sweep(PAIR, CHART["speed_rpm"], samples_per_cycle=32),
    "chart": lambda: spurcheck.stability_chart(PAIR, CHART),
    "line": lambda: spurcheck.stability_chart(PAIR, {"speed_rpm": CHART["speed_rpm"]}),
    "campbell": lambda: spurcheck.campbell(PAIR, CHART["speed_rpm"]),
    "boundaries": lambda: spurcheck.stability_boundaries(
        PAIR, (3000.0, 9000.0), {"friction_coefficient": [0.0, 0.1]}
    ),
}


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_draws_itself(name, tmp_path):
    figure = spurcheck.plot(RESULTS[name]())
    figure.savefig(tmp_path / "figure.png")  # every axis has a label with a unit, see conftest.py
    assert figure.axes


def test_the_drawn_curve_is_the_result():
    result = RESULTS["steady state"]()
    curve = spurcheck.plot(result).axes[0].lines[0].get_ydata()
    assert np.ptp(curve) * 1e-6 == pytest.approx(np.ptp(result["dte"].to_numpy()), rel=1e-12)


def test_what_cannot_be_drawn_is_refused():
    with pytest.raises(ParameterError, match="a result of simulate"):
        spurcheck.plot(xr.Dataset({"x": ("y", [1.0])}))
    with pytest.raises(ParameterError, match=r"result\.sel"):
        spurcheck.plot(spurcheck.stability_chart(PAIR, {**CHART, "torque": [50.0, 60.0]}))
