"""Which speeds do charts cover: those of the user, and by default those around the operating speed?"""

import numpy as np
import pytest

from floquet import gear_pair_multipliers, predicted_lines
from floquet.gear.axes import chart_axes, operating_rpm, speed_range, vary, with_point
from floquet.gear.chart import stability_chart
from floquet.gear.tongues import campbell
from lumped import load_gear_pair
from lumped.errors import NumericalError, ParameterError
from lumped.model.averaged import modes
from lumped.quasi_static.tooth_error import relief_error, relief_starts
from tests.unlike_pairs import unlike_pair

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


@pytest.mark.parametrize("ratio", [1.3, 1.85])  # from 1.9 on the tips would cut into the fillets
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


@pytest.fixture(scope="module")
def pair():
    return unlike_pair("larger_gear_drives_contact_lost").with_(
        mesh__contact="prescribed", friction__law="none", mesh__damping_ratio=0.005
    )


def test_frequencies_are_those_of_the_mean_system_between_the_tongues(pair) -> None:
    result = campbell(pair, [3500.0, 6500.0, 13500.0])
    along = [m for m in modes(pair) if max(abs(m.shape["y_p"]), abs(m.shape["y_g"])) < 1e-6]
    expected = np.array([m.natural_frequency for m in along])
    assert np.allclose(result.natural_frequency, expected, rtol=2e-3)  # damping of 5 % couples the modes
    # Parametric excitation shifts a frequency in second order of the stiffness variation (30 % here).
    assert np.allclose(result.frequency, result.natural_frequency, rtol=0.03)
    # The exponents are the logarithms of the multipliers, on whatever branch.
    for speed in result.speed_rpm.values:
        one = result.sel(speed_rpm=speed)
        multipliers = gear_pair_multipliers(pair.with_(operating__pinion_speed=float(speed)))
        values = np.exp((-one.decay.values + 2j * np.pi * one.frequency.values) * multipliers.period)
        gap = np.abs(values[:, None] - multipliers.feedback).min(axis=1)
        assert gap.max() < 1e-7  # rtol 1e-9, angle of up to 100 rad
        assert float(one.spectral_radius) == pytest.approx(np.abs(multipliers.feedback).max(), abs=1e-8)


def test_frequencies_lock_in_a_tongue(pair) -> None:
    # Inside 2w3/2 the third mode moves with twice half the mesh frequency, exactly: its multipliers are real.
    result = campbell(pair, [16600.0])
    third = 2
    assert float(result.frequency[0, third]) == pytest.approx(16600 * 43 / 60, rel=1e-9)
    assert float(result.decay[0].min()) < 0.0


def test_lines_and_orders(pair) -> None:
    result = campbell(pair, np.linspace(4000.0, 18000.0, 3), mesh_orders=2, orders=3)
    assert result.mesh_frequency.values[1].tolist() == [11000 * 43 / 60, 2 * 11000 * 43 / 60]
    lines = {str(t): s for t, s in predicted_lines(pair, 3).items()}
    for label, speed in zip(result.label.values, result.line_speed.values, strict=True):
        assert lines[label] == speed
        assert 4000.0 <= speed <= 18000.0
    with pytest.raises(ParameterError, match="speeds_rpm"):
        campbell(pair, [2000.0, 1000.0])


def test_a_speed_at_which_a_mode_dies_out_in_one_cycle_is_no_row_of_nan() -> None:
    with pytest.raises(NumericalError, match=r"At 1\.5 rpm"):
        campbell(unlike_pair("contact_ratio_1_1_large_shifts").with_(mesh__contact="prescribed"), [1.5])
