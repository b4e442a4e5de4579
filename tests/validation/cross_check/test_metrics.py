"""Do the comparison metrics give their closed forms?"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lumped import NumericalError, ParameterError
from validation.cross_check import metrics

TURNS = 7
SAMPLES = 64
PHASE = np.arange(TURNS * SAMPLES) * (2 * np.pi / SAMPLES)
# Sums of 448 rounded terms of size one: a few hundred ulp.
ROUNDING = 1e-13


@given(shift=st.floats(0.0, np.pi), size=st.floats(1e-9, 1e9))
def test_shifted_sine_has_phase_error_shift_over_pi_and_no_magnitude_error(shift, size):
    result = metrics.sprague_geers(size * np.sin(PHASE + shift), size * np.sin(PHASE))
    assert result.magnitude == pytest.approx(0.0, abs=ROUNDING)
    assert result.phase == pytest.approx(shift / np.pi, abs=ROUNDING)


@given(scale=st.floats(1e-3, 1e3))
def test_scaled_history_has_magnitude_error_scale_minus_one_and_no_phase_error(scale):
    reference = np.sin(PHASE) + 0.3 * np.cos(3 * PHASE)
    result = metrics.sprague_geers(scale * reference, reference)
    assert result.magnitude == pytest.approx(scale - 1.0, abs=ROUNDING * max(scale, 1.0))
    assert result.phase == pytest.approx(0.0, abs=ROUNDING)
    assert result.comprehensive == pytest.approx(abs(scale - 1.0), abs=ROUNDING * max(scale, 1.0))


def test_phase_error_resolves_shifts_far_below_the_root_of_rounding():
    # arccos(1 - x) could not: it loses everything below sqrt(eps) = 1.5e-8.
    shift = 1e-12
    result = metrics.sprague_geers(np.sin(PHASE) + shift * np.cos(PHASE), np.sin(PHASE))
    assert result.phase == pytest.approx(shift / np.pi, rel=1e-3)  # 1e-16/1e-12 of rounding in the input


@given(
    mean=st.floats(-10, 10),
    amplitude=st.floats(0.1, 10),
    order=st.integers(1, 20),
    phase=st.floats(-3.1, 3.1),
)
def test_orders_recover_a_harmonic(mean, amplitude, order, phase):
    found = metrics.mesh_orders(mean + amplitude * np.cos(order * PHASE + phase), SAMPLES, 25)
    expected = np.zeros(26)
    expected[0], expected[order] = mean, amplitude
    np.testing.assert_allclose(found.amplitude, expected, atol=20 * ROUNDING)
    assert found.phase[order] == pytest.approx(phase, abs=1e3 * ROUNDING)


def test_what_is_not_periodic_with_the_mesh_is_not_counted_in_the_orders():
    found = metrics.mesh_orders(np.cos(2 * PHASE) + np.cos(PHASE / TURNS), SAMPLES, 5)
    np.testing.assert_allclose(found.amplitude, [0, 0, 1, 0, 0, 0], atol=ROUNDING)


@pytest.mark.parametrize(
    ("first", "second", "expected"), [(3.0, -3.0, 6.0 - 2 * np.pi), (0.5, 0.2, 0.3), (-np.pi, 0.0, np.pi)]
)
def test_phase_difference_wraps(first, second, expected):
    assert metrics.phase_difference(first, second) == pytest.approx(expected)


def test_meaningless_comparisons_are_refused():
    with pytest.raises(ParameterError):
        metrics.sprague_geers(np.ones(5), np.ones(6))
    with pytest.raises(NumericalError):
        metrics.sprague_geers(np.ones(5), np.zeros(5))
    with pytest.raises(NumericalError):
        metrics.sprague_geers(np.array([1.0, np.nan]), np.array([1.0, 2.0]))


@pytest.mark.parametrize(
    ("size", "orders"), [(SAMPLES + 1, 5), (SAMPLES, SAMPLES // 2), (0, 3), (SAMPLES, 0)]
)
def test_orders_need_whole_cycles_and_enough_samples(size, orders):
    with pytest.raises(ParameterError):
        metrics.mesh_orders(np.ones(size), SAMPLES, orders)
