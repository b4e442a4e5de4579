"""Are the derivatives of the multipliers those of differences, of closed forms, and of similar systems?"""

from __future__ import annotations

import numpy as np
import pytest

from floquet import PeriodicSystem, gear_pair_multipliers
from floquet.engine.sensitivity import multiplier_derivatives, segment_time
from floquet.gear.axes import GEAR_AXES, operating_value, vary
from floquet.gear.sensitivity import gear_sensitivities
from lumped import load_gear_pair
from lumped.errors import NumericalError, ParameterError


@pytest.fixture(scope="module")
def pair():
    return load_gear_pair("nasa_28_28").with_(
        mesh__relief="ignored", friction__law="coulomb", friction__coefficient=0.05
    )


def unit(matrix: list[list[float]]):
    return lambda t: np.repeat(np.array(matrix)[None], t.size, axis=0)


def test_constant_oscillator_in_closed_form() -> None:
    # x'' + 2 c x' + w^2 x = 0: multiplier exp((-c + i wd) T), so d/dc = (-1 - i c/wd) T lambda and
    # d/d(w^2) = i T lambda/(2 wd).
    c, w, T = 0.1, 1.3, 2.0
    wd = np.sqrt(w**2 - c**2)
    value = np.exp((-c + 1j * wd) * T)
    system = PeriodicSystem(lambda t: [[0.0, 1.0], [-(w**2), -2 * c]], T)
    by_c = multiplier_derivatives(system, unit([[0.0, 0.0], [0.0, -2.0]]))
    by_k = multiplier_derivatives(system, unit([[0.0, 0.0], [-1.0, 0.0]]))
    assert by_c.multipliers[0] == pytest.approx(value, rel=1e-10)  # rtol
    assert by_c.derivatives[0] == pytest.approx((-1 - 1j * c / wd) * T * value, rel=1e-9)
    assert by_k.derivatives[0] == pytest.approx(1j * T / (2 * wd) * value, rel=1e-9)
    assert by_c.moduli[0] == pytest.approx(-T * abs(value), rel=1e-9)
    assert by_k.moduli[0] == pytest.approx(0.0, abs=1e-10)  # stiffness turns the multiplier, no more


def test_tiny_and_huge_parameters_lose_nothing() -> None:
    # The same derivative per N/m and per GN/m: the internal scaling must not show.
    system = PeriodicSystem(lambda t: [[0.0, 1.0], [-2.0 - np.cos(np.pi * t), -0.1]], 2.0)
    one = multiplier_derivatives(system, unit([[0.0, 0.0], [-1.0, 0.0]])).derivatives
    for factor in (1e-9, 1e9):
        scaled = multiplier_derivatives(system, unit([[0.0, 0.0], [-factor, 0.0]])).derivatives
        assert np.allclose(scaled / factor, one, rtol=1e-8)  # rtol 1e-10, conditioning of the multipliers


def test_segment_time_keeps_the_multipliers(known_system) -> None:
    rng = np.random.default_rng(5)
    B, S = rng.normal(size=(2, 3, 3))
    system, exact = known_system(0.5 * B, 0.45 * S, 4.0, "triangle")
    stretched = segment_time(system)
    derivative = multiplier_derivatives(stretched, lambda s: 0.0 * stretched.evaluate(s))
    expected = np.linalg.eigvals(exact)
    gap = np.abs(derivative.multipliers[:, None] - expected).min(axis=1)
    assert gap.max() < 1e-8 * np.abs(expected).max()  # rtol 1e-10 with conditioning
    assert (derivative.derivatives == 0.0).all()


def test_defective_multiplier_is_refused() -> None:
    double = PeriodicSystem(lambda t: [[-1.0, 1.0], [0.0, -1.0]], 1.0)
    with pytest.raises(NumericalError, match="defective"):
        multiplier_derivatives(double, unit([[0.0, 0.0], [1.0, 0.0]])).radius()


# Steps of the differences: in the tongue near 16700 rpm the radius bends within its width of 5 %, and at low
# speed within a few tenths of a percent, from one order of resonance to the next.
POINTS = {
    "stable": ({}, 4e-3),
    "in a tongue": ({"operating__pinion_speed": 16700, "mesh__damping_ratio": 0.01}, 1e-3),
    "low speed": ({"operating__pinion_speed": 1500, "mesh__damping_ratio": 0.005}, 1e-4),
}


@pytest.mark.parametrize("name", list(GEAR_AXES))
@pytest.mark.parametrize("point", list(POINTS))
def test_every_gear_parameter_against_differences_of_the_radius(pair, point: str, name: str) -> None:
    changes, part = POINTS[point]
    here = pair.with_(**changes)
    result = gear_sensitivities(here, [name]).isel(parameter=0)
    value = operating_value(here, name)
    h = part * value
    radius = [
        gear_pair_multipliers(vary(here, {name: value + k * h}), 1e-10).spectral_radius
        for k in (-2, -1, 1, 2)
    ]
    difference = np.dot([1, -8, 8, -1], radius) / 12
    # Both for a change by h. The truncation of the difference goes with h^4; 1e-9 is left by the runs' rtol.
    assert float(result.derivative) * h == pytest.approx(difference, rel=2e-6, abs=1e-9)
    assert float(result.relative) == pytest.approx(float(result.derivative) * value, rel=1e-14)


def test_differences_approach_the_derivative_with_their_own_order(pair) -> None:
    here = pair.with_(**POINTS["low speed"][0])
    derivative = float(gear_sensitivities(here, ["speed_rpm"]).derivative[0])
    error = []
    for part in (1e-3, 5e-4, 2.5e-4):
        h = part * 1500.0
        radius = [
            gear_pair_multipliers(vary(here, {"speed_rpm": 1500.0 + k * h}), 1e-10).spectral_radius
            for k in (-2, -1, 1, 2)
        ]
        error.append(abs(np.dot([1, -8, 8, -1], radius) / (12 * h) - derivative))
    # The derivative is the limit: order 4 as long as the difference's own truncation is all there is.
    # 0.3: the next term of the truncation.
    assert np.log2(error[1] / error[2]) == pytest.approx(4.0, abs=0.3)
    assert error[0] > error[1] > error[2]


@pytest.mark.parametrize("law", ["xu_kahraman", "benedict_kelley", "smoothed_coulomb", "composite"])
def test_laws_that_vary_with_speed_and_load(pair, law: str) -> None:
    here = pair.with_(friction__law=law, friction__coefficient=None)
    result = gear_sensitivities(here, ["torque"]).isel(parameter=0)
    torque = operating_value(here, "torque")
    h = 2e-2 * torque  # torque acts weakly and smoothly
    radius = [gear_pair_multipliers(vary(here, {"torque": torque + k * h})).spectral_radius for k in (-1, 1)]
    # 1e-3: second-order difference with h = 2 %; 1e-10 is rtol.
    assert float(result.derivative) * h == pytest.approx((radius[1] - radius[0]) / 2, rel=1e-3, abs=1e-10)


def test_parameters_at_the_end_of_their_range(pair) -> None:
    # No friction, no mesh damping: one-sided differences of the coefficients.
    here = pair.with_(friction__coefficient=0.0, mesh__damping_ratio=0.0)
    result = gear_sensitivities(here, ["friction_coefficient", "damping_ratio"])
    for name, slope in zip(result.parameter.values, result.derivative.values, strict=True):
        h = 1e-5
        radius = [gear_pair_multipliers(vary(here, {name: k * h}), 1e-10).spectral_radius for k in (0, 1, 2)]
        forward = np.dot([-1.5, 2.0, -0.5], radius) / h
        # 1e-4: (second order in) h; absolute: rtol over h.
        assert slope == pytest.approx(forward, rel=1e-4, abs=1e-4)
        assert result.attrs["largest"] == "mesh"


def test_largest_multiplier_off_the_line_of_action(pair) -> None:
    # Bearings with hardly any damping in y only: |exp(s T)| = exp(-zeta w T), w = sqrt(K/m), in closed form.
    changes = {f"bearings.{g}.oloa_damping_ratio": 1e-4 for g in ("pinion", "gear")}
    here = pair.with_(changes)
    result = gear_sensitivities(here, ["bearing_stiffness", "speed_rpm"])
    assert result.attrs["largest"] == "oloa"
    radius = result.attrs["spectral_radius"]
    log = np.log(radius)  # -zeta sqrt(K/m) T: goes with sqrt(K) and with 1/speed
    assert result.relative.values == pytest.approx([0.5 * log * radius, -log * radius], rel=1e-6)  # step^4


def test_unknown_parameter_is_refused(pair) -> None:
    with pytest.raises(ParameterError, match="parameters = moon_phase"):
        gear_sensitivities(pair, ["moon_phase"])
