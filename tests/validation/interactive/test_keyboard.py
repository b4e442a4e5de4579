"""Can the page be used by keyboard alone, and without a mouse, colours or scripts?"""

import numpy as np
import pytest

pytestmark = pytest.mark.slow

RIGHT = "\ue014"
LEFT = "\ue012"
UP = "\ue013"
DOWN = "\ue015"
PAGE_UP = "\ue00e"
HOME = "\ue011"
END = "\ue010"
TAB = "\ue004"
ORDER = [
    "skip", "axis", "slice", "damping", "speed", "Zoom in", "Zoom out", "Show all", "Operating point",
    "stability", "law", "sweep-speed", "Zoom in", "Zoom out", "Show all", "Operating point", "sweep",
]  # fmt: skip


@pytest.fixture
def page(browser, written):
    return browser.open(written)


def six_digits(values):
    return [float(f"{float(v):.6g}") for v in values]


def sentence(data, k, i, j):
    speed = float(data["speed_rpm"][j])
    damping = float(data["damping_ratio"][i])
    factor = float(data["bearing_factor"][k])
    radius = data["spectral_radius_over_bearing_factor"].to_numpy()[k, i, j]
    word = {1: "stable", -1: "unstable"}[int(data["verdict_over_bearing_factor"][k, i, j])]
    return (
        f"Cursor: {speed:.6g} rpm, mesh damping ratio {damping:.6g}, bearing stiffness factor {factor:.4g}: "
        f"largest multiplier {radius:.6f}, {word}."
    )


def start(data):
    """Indices of the operating point on the chart."""
    place = {"bearing_factor": 1.0, "damping_ratio": 0.016, "speed_rpm": 4875.0}
    return [int(np.argmin(np.abs(data[name].to_numpy() - value))) for name, value in place.items()]


def test_arrows_move_the_cursor_and_the_text_says_its_value(page, data):
    k, i, j = start(data)
    assert page.text("stability-text") == sentence(data, k, i, j)
    page.focus("stability")
    for key, (dk, di, dj) in {
        RIGHT: (0, 0, 1), DOWN: (0, -1, 0), LEFT: (0, 0, -1), UP: (0, 1, 0), PAGE_UP: (1, 0, 0),
    }.items():  # fmt: skip
        page.press(key)
        k = k + dk
        i = i + di
        j = j + dj
        assert page.text("stability-text") == sentence(data, k, i, j)
    page.press(END)
    assert page.text("stability-text") == sentence(data, k, i, data.sizes["speed_rpm"] - 1)
    page.press(RIGHT, PAGE_UP, PAGE_UP)  # the ends are ends
    k = data.sizes["bearing_factor"] - 1
    assert page.text("stability-text") == sentence(data, k, i, data.sizes["speed_rpm"] - 1)
    page.press(HOME, *[DOWN] * 8)
    assert page.text("stability-text") == sentence(data, k, 0, 0)


def test_tab_goes_through_controls_and_charts_in_reading_order(page):
    met = []
    for _ in ORDER:
        page.press(TAB)
        met.append(page.run("const e = document.activeElement; return e.id || e.className || e.textContent"))
        outline = page.run("return getComputedStyle(document.activeElement).outlineStyle")
        assert outline != "none", met[-1]
    assert met == ORDER


def test_keys_and_buttons_zoom_and_the_window_follows_the_cursor(page, data):
    speeds = data["speed_rpm"].to_numpy()
    full_range = six_digits(speeds[[0, -1]])

    def window():
        return page.drawn("stability-plot", "plot._fullLayout.xaxis.range")

    assert window() == full_range
    dampings = six_digits(data["damping_ratio"][[0, -1]])
    assert page.drawn("stability-plot", "plot._fullLayout.yaxis.range") == dampings
    page.focus("stability")
    page.press("+", "+")
    low, high = window()
    assert high - low == pytest.approx(0.25 * (full_range[1] - full_range[0]))
    assert low <= 4875.0 <= high
    page.choose("slice", 0)
    assert window() == [low, high]  # another slice keeps the zoom
    page.press(END)
    low, high = window()
    assert high == full_range[1]
    assert high - low == pytest.approx(0.25 * (full_range[1] - full_range[0]))
    page.press("0")
    assert window() == full_range
    page.run("document.querySelector('#stability-buttons button').click()")
    assert window()[1] - window()[0] == pytest.approx(0.5 * (full_range[1] - full_range[0]))


def test_every_control_has_a_name_and_room_for_a_finger(browser, written):
    page = browser.open(written, (390, 844))
    controls = page.run(
        "return Array.from(document.querySelectorAll('input, select, button'), e => {"
        "  const box = e.getBoundingClientRect();"
        "  return [(e.labels?.[0] ?? e).textContent.trim(), box.height, box.left, box.right]; })"
    )
    assert len(controls) == 14
    for name, height, left_edge, right_edge in controls:
        assert name
        assert height >= 24  # WCAG 2.2, 2.5.8 target size
        assert 0 <= left_edge < right_edge <= 390


@pytest.mark.parametrize("dark", [False, True])
def test_text_has_contrast(browser, written, dark):
    """WCAG 2.1, 1.4.3: 4.5 to 1, for the text of the page and of the charts."""
    page = browser.open(written, dark=dark)
    pairs = page.run(
        """
        const behind = e => { for (; e; e = e.parentElement) {
            const c = getComputedStyle(e).backgroundColor; if (!/, 0\\)$/.test(c)) return c; } };
        const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), found = [];
        while (walker.nextNode()) {
            const e = walker.currentNode.parentElement, text = walker.currentNode.data.trim();
            if (!text || !e.getClientRects().length || e.closest('script')) continue;
            const style = getComputedStyle(e);
            found.push([e.closest('svg') ? style.fill : style.color, behind(e), text]);
        }
        return found;"""
    )
    assert len(pairs) > 60
    for ink, paper, text in pairs:
        assert contrast(ink, paper) >= 4.5, (text, ink, paper)


def luminance(colour):
    parts = colour.strip().removeprefix("#")
    rgb = (
        [int(parts[k : k + 2], 16) for k in (0, 2, 4)]
        if colour.startswith("#")
        else [float(v) for v in colour[colour.index("(") + 1 : -1].split(",")[:3]]
    )
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in (c / 255 for c in rgb)]
    red, green, blue = linear
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one, other):
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_a_hostile_name_is_only_text(browser, hostile, attack):
    page = browser.open(hostile)
    assert page.console() == []
    name, description = attack
    assert page.run("return document.title") == f"Interactive charts: {name}"
    assert page.run("return document.querySelector('h1').textContent") == name
    assert page.run("return document.querySelector('h1 + p').textContent") == description
    assert page.run("return document.images.length") == 0
    assert page.run("return document.scripts.length") == 3  # data, Plotly, the page's own
    assert [url for url in page.requests() if not url.startswith("data:")] == [hostile.as_uri()]
