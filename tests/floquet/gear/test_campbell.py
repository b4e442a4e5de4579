"""Does the Campbell diagram say what the multipliers say?"""

import numpy as np
import pytest

from floquet import gear_pair_multipliers, predicted_lines
from floquet.gear.campbell import campbell
from lumped import load_gear_pair
from lumped.errors import NumericalError, ParameterError
from lumped.model.averaged import modes


@pytest.fixture(scope="module")
def pair():
    return load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed", mesh__relief="ignored", friction__law="none", mesh__damping_ratio=0.005
    )


def test_frequencies_are_those_of_the_mean_system_between_the_tongues(pair) -> None:
    # Other bearings in y than in x, so that the modes off the line of action are told apart.
    pair = pair.with_({f"bearings.{g}.oloa_stiffness": 2e8 for g in ("pinion", "gear")})
    result = campbell(pair, [3000.0, 6200.0, 13500.0])
    along = [m for m in modes(pair) if max(abs(m.shape["y_p"]), abs(m.shape["y_g"])) < 1e-6]
    expected = np.array([m.natural_frequency for m in along])
    assert np.allclose(result.natural_frequency, expected, rtol=2e-3)  # damping of 5 % couples the modes
    # Parametric excitation shifts a frequency in second order of the stiffness variation (30 % here).
    assert np.allclose(result.frequency, result.natural_frequency, rtol=0.03)
    # The exponents are the logarithms of the multipliers, on whatever branch.
    for speed in result.speed_rpm.values:
        one = result.sel(speed_rpm=speed)
        found = gear_pair_multipliers(pair.with_(operating__pinion_speed=float(speed)))
        values = np.exp((-one.decay.values + 2j * np.pi * one.frequency.values) * found.period)
        gap = np.abs(values[:, None] - found.feedback).min(axis=1)
        assert gap.max() < 1e-7  # rtol 1e-9, angle of up to 100 rad
        assert float(one.spectral_radius) == pytest.approx(np.abs(found.feedback).max(), abs=1e-8)


def test_frequencies_lock_in_a_tongue(pair) -> None:
    # Inside 2w3/2 the third mode moves with twice half the mesh frequency, exactly: its multipliers are real.
    result = campbell(pair, [16700.0])
    assert float(result.frequency[0, 2]) == pytest.approx(16700 * 28 / 60, rel=1e-9)
    assert float(result.decay[0].min()) < 0.0


def test_lines_and_orders(pair) -> None:
    result = campbell(pair, np.linspace(4000.0, 18000.0, 3), mesh_orders=2, orders=3)
    assert result.mesh_frequency.values[1].tolist() == [11000 * 28 / 60, 2 * 11000 * 28 / 60]
    lines = {str(t): s for t, s in predicted_lines(pair, 3).items()}
    for label, speed in zip(result.label.values, result.line_speed.values, strict=True):
        assert lines[label] == speed
        assert 4000.0 <= speed <= 18000.0
    with pytest.raises(ParameterError, match="speeds_rpm"):
        campbell(pair, [2000.0, 1000.0])


def test_a_speed_at_which_a_mode_dies_out_in_one_cycle_is_no_row_of_nan() -> None:
    with pytest.raises(NumericalError, match=r"At 1\.5 rpm"):
        campbell(
            load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed", mesh__relief="ignored"), [1.5]
        )
