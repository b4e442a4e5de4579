"""Does the page show the data file's values in a real browser, by mouse, slider and keyboard?"""

import itertools

import numpy as np
import pytest

pytestmark = pytest.mark.slow
VERDICTS = {1: "stable", 0: "undecided", -1: "unstable"}
NODES = [(0, 0, 0), (1, 3, 12), (2, 5, 30), (0, 2, 20)]
AXES = ["bearing_factor", "friction_coefficient"]


@pytest.fixture
def page(browser, written):
    """Every test chooses what it looks at, so the page is loaded once."""
    return browser.keep(written)


def chart(data, key):
    return data[f"spectral_radius_over_{key}"].transpose(key, "damping_ratio", "speed_rpm").to_numpy()


def six_digits(values):
    return [None if np.isnan(v) else float(f"{v:.6g}") for v in np.asarray(values, dtype=float)]


@pytest.mark.parametrize(
    ("size", "dark"), [((1280, 900), False), ((1280, 900), True), ((390, 844), False), ((320, 640), False)]
)
def test_it_loads_without_a_word_on_the_console_and_without_network(browser, written, size, dark):
    page = browser.open(written, size, dark=dark)
    page.drawn("stability-plot", "1")
    assert page.console() == []
    assert [url for url in page.requests() if not url.startswith("data:")] == [written.as_uri()]
    width, window = page.run("return [document.documentElement.scrollWidth, innerWidth]")
    assert window == size[0]
    assert width <= window  # nothing to scroll sideways


def test_hover_over_the_chart_shows_the_data_file(page, data):
    inside = [np.array([20.0, -20.0]), np.array([1e-3, -1e-3])]
    ends = [
        data[name].to_numpy()[[0, -1]] + step
        for name, step in zip(("speed_rpm", "damping_ratio"), inside, strict=True)
    ]
    for key, (k, i, j) in itertools.product(AXES, NODES):
        page.choose("axis", AXES.index(key))
        page.choose("slice", k)
        page.drawn("stability-plot", "1")
        speed = float(data["speed_rpm"][j])
        damping = float(data["damping_ratio"][i])
        # Half a step inside where the node lies on the edge of the axes.
        lines = page.hover(
            "stability-plot", float(np.clip(speed, *ends[0])), float(np.clip(damping, *ends[1]))
        )
        verdict = VERDICTS[int(data[f"verdict_over_{key}"].to_numpy()[k, i, j])]
        assert lines == [
            f"{speed:.6g} rpm",
            f"damping ratio {damping:.6g}",
            f"largest multiplier {chart(data, key)[k, i, j]:.6f}",
            verdict,
        ]


def test_the_slider_shows_every_slice_of_the_data_file(page, data):
    for key in AXES:
        page.choose("axis", AXES.index(key))
        values = chart(data, key)
        assert len({values[k].tobytes() for k in range(3)}) == 3  # else the slider could be stuck unseen
        for k in range(3):
            page.choose("slice", k)
            page.choose("damping", 1)
            shown = page.drawn("stability-plot", "plot.data[0].z.map(row => Array.from(row))")
            np.testing.assert_array_equal(np.float32(shown), np.float32(np.round(values[k], 6)))
            cut = page.run("return Array.from(document.getElementById('stability-plot').data[5].y)")
            np.testing.assert_array_equal(np.float32(cut), np.float32(np.round(values[k, 1], 6)))
            dots = page.run("const p = document.getElementById('stability-plot').data[2]; return [p.x, p.y]")
            unstable = data[f"verdict_over_{key}"].to_numpy()[k] != 1
            rows, columns = np.nonzero(unstable)
            assert dots[0] == six_digits(data["speed_rpm"].to_numpy()[columns])
            assert dots[1] == six_digits(data["damping_ratio"].to_numpy()[rows])
            assert f"{float(data[key][k]):.4g}" in page.text("slice-value")
        assert unstable.any()


def test_a_law_shows_its_response_of_the_data_file(page, data):
    panels = {"y": "dte_peak_to_peak", "y2": "y_p_peak_to_peak", "y3": "lowest_load"}
    for index, law in enumerate(data["law"].to_numpy()):
        page.choose("law", index)
        one = data.sel(law=law)
        for axis, variable in panels.items():
            shown = page.drawn(
                "sweep-plot", f"plot.data.filter(t => t.yaxis === '{axis}' && t.mode === 'lines').at(-1).y"
            )
            factor = 1.0 if variable == "lowest_load" else 1e6
            assert shown == six_digits(factor * one[variable].to_numpy()), (law, variable)
