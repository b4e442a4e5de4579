"""Which speeds do charts cover: those of the user, and by default those around the operating speed?"""

import numpy as np
import pytest

from floquet.gear.axes import chart_axes, operating_rpm, speed_range, vary, with_point
from floquet.gear.chart import stability_chart
from lumped import load_gear_pair
from lumped.quasi_static.tooth_error import relief_error, relief_starts

PAIR = load_gear_pair("nasa_28_28")


@pytest.mark.parametrize("rpm", [0.37, 1450.0, 3000.0, 4875.0, 99_000.0, 150_000.0, 200_000.0])
def test_default_is_about_the_operating_speed_and_inside_the_schema(rpm):
    pair = PAIR.with_(operating__pinion_speed=rpm)
    low, high = speed_range(pair)
    assert 0.0 < low <= 0.11 * rpm
    assert rpm <= high <= 2.1 * rpm
    assert high == pytest.approx(min(2.0 * rpm, 200_000.0), rel=0.05)
    pair.with_(operating__speed_range=(low, high))  # the schema takes every speed of it
    assert float(f"{high:.2g}") == high


def test_the_range_of_the_user_is_kept_whatever_the_operating_speed():
    pair = PAIR.with_(operating__speed_range="200..3000")
    assert speed_range(pair) == pytest.approx((200.0, 3000.0), rel=1e-14)
    axes = chart_axes(pair, 5, 3)
    np.testing.assert_allclose(axes["speed_rpm"], [200.0, 900.0, 1600.0, 2300.0, 3000.0], rtol=1e-14)
    assert operating_rpm(pair) > 3000.0
    assert stability_chart(pair, axes)["spectral_radius"].shape == (5, 3)


def test_the_operating_point_is_a_node_where_it_is_within():
    nodes = np.linspace(0.0, 10.0, 6)
    np.testing.assert_allclose(with_point(nodes, 4.9), [0.0, 2.0, 4.9, 6.0, 8.0, 10.0])
    np.testing.assert_allclose(with_point(nodes, 11.0), nodes)


@pytest.mark.parametrize("ratio", [1.3, 1.9])
def test_relief_keeps_its_length_where_the_contact_ratio_changes(ratio):
    def reach(pair):
        """Lengths of the relieved ends of the path at A and D, over which the amount is reached."""
        g = pair.geometry
        lower, upper = relief_starts(pair)
        ends = relief_error(pair, np.array([g.L_XA, g.L_XD]))
        return lower - g.L_XA, g.L_XD - upper, *ends

    varied = vary(PAIR, {"contact_ratio": ratio}).pair
    assert varied.geometry.contact_ratio == pytest.approx(ratio, rel=1e-12)
    assert PAIR.mesh.relief == varied.mesh.relief == "static"
    np.testing.assert_allclose(reach(varied), reach(PAIR), rtol=1e-10)
