"""Does the check of figures, which runs whenever a test saves one, find what is missing?"""

import pytest
from matplotlib.figure import Figure


def figure(xlabel, ylabel):
    drawn = Figure()
    axes = drawn.add_subplot()
    axes.plot([0.0, 1.0], [1e3, 1e9])
    axes.set(xlabel=xlabel, ylabel=ylabel, yscale="log")
    return drawn


def test_labels_with_units_pass(tmp_path):
    figure("pinion speed [rpm]", "stiffness [N/m]").savefig(tmp_path / "a.png")


@pytest.mark.parametrize(
    ("labels", "word"),
    [
        (("", "stiffness [N/m]"), "x axis has no label"),
        (("speed", "stiffness [N/m]"), "states no unit"),
        (("pinion speed [rpm]", "stiffness"), "states no unit"),
    ],
)
def test_missing_labels_and_units_are_found(labels, word, tmp_path):
    with pytest.raises(AssertionError, match=word):
        figure(*labels).savefig(tmp_path / "a.png")


def test_names_on_an_axis_need_no_unit(tmp_path):
    drawn = figure("law", "loss [%]")
    drawn.axes[0].set_xticks([0.0, 1.0], ["Coulomb", "Xu and Kahraman"])
    drawn.savefig(tmp_path / "a.png")
