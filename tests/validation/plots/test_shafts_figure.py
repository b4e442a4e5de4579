"""Are shafts, gears and bearings drawn where they are, to scale?"""

import numpy as np
import pytest
from matplotlib.patches import Rectangle

import lumped
from validation.plots.shafts import shafts_figure
from validation.plots.style import save


def shaft(**changes):
    bearing = {"loa_stiffness": 2e8, "oloa_stiffness": 1e8}
    return {
        "segments": [{"length": 80, "diameter": 30}, {"length": 60, "diameter": 24, "bore": 8}],
        "gear_position": 110,
        "bearings": [bearing | {"position": 10}, bearing | {"position": 70}],
    } | changes


def test_side_view(tmp_path):
    motor = {"position": 0, "inertia": 0.01, "coupling_stiffness": 1e4}
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        shafts={"damping_ratio": 0.01, "pinion": shaft(), "gear": shaft(gear_position=40), "motor": motor}
    )
    figure = shafts_figure(pair)
    save(figure, tmp_path / "shafts.png")
    (view,) = figure.axes
    boxes = [tuple(np.round(p.get_bbox().bounds, 6)) for p in view.patches if isinstance(p, Rectangle)]
    g = pair.geometry
    for box in ((0, -15, 80, 30), (70, 1e3 * g.centre_distance - 15, 80, 30), (80, -12, 60, 24)):
        assert any(np.allclose(box, found, atol=1e-5) for found in boxes)
    face, tip = 1e3 * pair.pinion.face_width, 1e3 * g.tip_radius_pinion
    gears = [box for box in boxes if box[2:] == pytest.approx((face, 2 * tip))]
    assert [box[0] for box in gears] == pytest.approx([110 - face / 2] * 2)  # the faces meet
    assert view.get_aspect() == 1.0
