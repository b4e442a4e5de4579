"""Is the forced motion the periodic one: by closed forms?"""

from __future__ import annotations

import numpy as np
import pytest

from floquet import PeriodicSystem, gear_pair_system, periodic_motion
from lumped import load_gear_pair
from lumped.errors import NumericalError, ParameterError


@pytest.mark.parametrize("rtol", [1e-4, 1e-7])
def test_the_initial_state_is_within_its_bound(rtol: float) -> None:
    # x' = -x + cos t: x = (cos t + sin t)/2.
    system = PeriodicSystem(lambda t: [[-1.0]], 2.0 * np.pi, b=lambda t: [np.cos(t)])
    motion = periodic_motion(system, rtol=rtol)
    bound = motion.initial_error * motion.scaling[0]
    assert abs(motion.initial[0] - 0.5) <= bound < 1e2 * rtol


def test_scalar_with_switched_coefficients() -> None:
    # x' = -a x + b, a and b constant on two halves of the period: x relaxes towards b/a on each half,
    # x1 = b1/a1 + (x0 - b1/a1) e1 at T/2 and x0 = b2/a2 + (x1 - b2/a2) e2.
    a, b = np.array([1.3, 0.4]), np.array([2.0, -1.0])
    system = PeriodicSystem(
        lambda t: [[-a[int(t > 1.0)]]], 2.0, (1.0,), b=lambda t: [b[int(t > 1.0)]]
    )  # halves of 1 s
    e, rest = np.exp(-a), b / a
    start = (rest[1] * (1 - e[1]) + e[1] * rest[0] * (1 - e[0])) / (1 - e[0] * e[1])
    middle = rest[0] + (start - rest[0]) * e[0]
    motion = periodic_motion(system, [0.0, 1.0])
    assert motion.states[:, 0] == pytest.approx([start, middle], rel=1e-9)  # rtol 1e-10
    assert motion.closure < 1e-9


def test_free_rigid_motion_is_refused() -> None:
    pair = load_gear_pair("nasa_28_28")
    absolute = gear_pair_system(pair, "full")
    with pytest.raises(NumericalError, match="rigid"):
        periodic_motion(absolute)


def test_times_outside_the_period_are_refused() -> None:
    with pytest.raises(ParameterError, match="times"):
        periodic_motion(PeriodicSystem(lambda t: [[-1.0]], 1.0), [1.5])


def test_multiplier_at_one_is_refused() -> None:
    # An undamped oscillator, a whole number of turns per period: every motion is periodic, or none is.
    oscillator = PeriodicSystem(lambda t: [[0.0, 1.0], [-4.0, 0.0]], np.pi, b=lambda t: [0.0, 1.0])
    with pytest.raises(NumericalError, match=r"\+1"):
        periodic_motion(oscillator)


@pytest.mark.parametrize(("growth", "verdict"), [(-0.1, "stable"), (0.1, "unstable")])
def test_unstable_periodic_motion_says_so(growth: float, verdict: str) -> None:
    # x' = g x + cos t has a periodic solution for either sign of g; exp(2 pi g) is its multiplier.
    system = PeriodicSystem(lambda t: [[growth]], 2.0 * np.pi, b=lambda t: [np.cos(t)])
    motion = periodic_motion(system)
    assert motion.spectrum.verdict == verdict
    assert motion.spectrum.spectral_radius == pytest.approx(np.exp(2.0 * np.pi * growth), rel=1e-9)
