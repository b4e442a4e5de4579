"""Is there room for all words around the panels of a figure?"""

from itertools import combinations

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from validation.plots.style import legend_above, legend_outside, new_figure


def test_no_word_lies_over_another_panel_or_beside_the_figure():
    figure, axes = new_figure(2, 2, height=4.0, width_ratios=(2.0, 1.0))
    for number, ax in enumerate(axes.flat):
        line = ax.plot([0.0, 1.0], [0.0, 10.0 ** (5 * (number == 0))], label="a name of some length")
        ax.set(xlabel="time [s]", ylabel="first line of words\nand load [N]")
    legend_above(axes[1, 0], 1)
    legend_outside(figure, line, 1)
    figure.colorbar(axes[1, 1].scatter([0.0], [0.0], c=[1.0]), ax=axes[1, 1], label="radius [-]")
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw_without_rendering()
    boxes = [ax.get_tightbbox(renderer) for ax in figure.axes]
    boxes.append(figure.legends[0].get_window_extent(renderer))
    (left, bottom), (right, top) = figure.bbox.min - 0.5, figure.bbox.max + 0.5
    assert all(left < box.x0 and box.x1 < right and bottom < box.y0 and box.y1 < top for box in boxes)
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
    labels = [ax.yaxis.label.get_window_extent(renderer) for ax in axes[:, 0]]
    assert labels[0].x0 == pytest.approx(labels[1].x0, abs=0.5)  # in line beside the longer ticks
    assert labels[0].x1 < min(tick.get_window_extent(renderer).x0 for tick in axes[0, 0].get_yticklabels())
    assert axes[0, 0].bbox.width > 0.45 * figure.bbox.width


def test_panels_keep_a_fifth_of_a_figure_that_is_too_small_for_its_words():
    """matplotlib refuses panels without height: "bottom cannot be >= top"."""
    figure, axes = new_figure(2, 1, height=0.8)
    for ax in axes[:, 0]:
        ax.set(xlabel="words\nof\nfour\nlines", ylabel="load [N]")
    legend_outside(figure, axes[0, 0].plot([0.0, 1.0], [0.0, 1.0], label="name"), 1)
    figure.draw_without_rendering()
    upper, lower = (ax.bbox for ax in axes[:, 0])
    assert upper.height + lower.height == pytest.approx(0.2 * figure.bbox.height, rel=1e-9)
    assert lower.y1 < upper.y0
