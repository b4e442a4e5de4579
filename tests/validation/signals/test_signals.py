"""Orders, averages, sidebands and indicators of signals that are known in closed form, and of pairs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

import lumped
from validation.signals import (
    difference,
    indicators,
    order_spectrum,
    residual,
    sidebands,
    synthetic_record,
    time_synchronous_average,
)

_WHEELS = [f"{gear}.{what}" for gear in ("pinion", "gear") for what in ("tip_relief", "tip_diameter")]
PAIR = lumped.load_gear_pair("nasa_28_28").with_(
    {"pinion.teeth": 21, "mesh.relief": "ignored", "centre_distance": None, **dict.fromkeys(_WHEELS)}
)
# 21 and 28: 84 mesh cycles, 4 and 3 turns
Z1 = PAIR.pinion.teeth
Z2 = PAIR.gear.teeth
CYCLES = 84
SAMPLES = 32


def result_of(signal: Callable[[np.ndarray], np.ndarray], cycles: int = CYCLES) -> xr.Dataset:
    """A result whose transmission error is a function of the mesh cycles since the begin."""
    count = cycles * SAMPLES
    u = np.arange(count) / SAMPLES
    variables = {"dte": ("time", signal(u), {"units": "m", "long_name": "transmission error"})}
    time = u * PAIR.geometry.mesh_period
    return xr.Dataset(variables, {"time": time}, {"parameters": PAIR.to_toml()})


def tone(order: float, size: float = 1.0, phase: float = 0.3) -> Callable[[np.ndarray], np.ndarray]:
    """A tone of the pinion's order."""
    return lambda u: size * np.cos(2.0 * np.pi * order * u / Z1 + phase)


def added(*parts: Callable[[np.ndarray], np.ndarray]) -> Callable[[np.ndarray], np.ndarray]:
    return lambda u: sum(part(u) for part in parts)


@pytest.mark.parametrize(("shaft", "order"), [("pinion", 7.0), ("gear", 7.0 * Z2 / Z1), ("mesh", 7.0 / Z1)])
@pytest.mark.parametrize("derivative", [0, 2])
def test_a_tone_has_one_order_on_each_shaft(shaft: str, order: float, derivative: int) -> None:
    spectrum = order_spectrum(result_of(tone(7, 3e-6)), shaft, derivative=derivative)
    hertz = 7 * PAIR.operating.pinion_speed / (2.0 * np.pi)
    loudest = spectrum.isel(order=int(np.argmax(spectrum["amplitude"].to_numpy())))
    assert float(loudest["order"]) == pytest.approx(order)
    assert float(loudest["frequency"]) == pytest.approx(hertz)
    assert float(loudest["amplitude"]) == pytest.approx(3e-6 * (2.0 * np.pi * hertz) ** derivative)
    rest = spectrum["amplitude"].to_numpy()[spectrum["order"].to_numpy() != float(loudest["order"])]
    assert rest.max() < 1e-9 * float(loudest["amplitude"])
    assert spectrum["amplitude"].attrs["units"] == {0: "m", 2: "m/s**2"}[derivative]


def test_amplitude_modulation_has_two_sidebands_of_half_its_depth() -> None:
    # (1 + h cos a) cos b = cos b + h/2 cos(b - a) + h/2 cos(b + a)
    def signal(u: np.ndarray) -> np.ndarray:
        return (1.0 + 0.4 * np.cos(2.0 * np.pi * 3 * u / Z1)) * np.cos(2.0 * np.pi * u)

    ratio = sidebands(result_of(added(signal, tone(2 * Z1, 0.5)))).ratio
    expected = np.zeros(11)
    expected[[2, 5, 8]] = 0.2, 1.0, 0.2
    np.testing.assert_allclose(ratio.sel(mesh_order=1), expected, atol=1e-12)
    np.testing.assert_allclose(ratio.sel(mesh_order=2), np.eye(11)[5], atol=1e-12)


def test_the_average_of_a_shaft_keeps_its_own_orders_only() -> None:
    of_pinion = tone(5, 2e-6)
    other = tone(5 * Z1 / Z2, 1e-6)
    average = time_synchronous_average(result_of(added(of_pinion, other)), variable="dte", derivative=0)
    u = average["turn"].to_numpy() * Z1
    np.testing.assert_allclose(average["average"], of_pinion(u), atol=1e-18)
    of_gear = time_synchronous_average(
        result_of(added(of_pinion, other)), "gear", variable="dte", derivative=0
    )
    np.testing.assert_allclose(of_gear["average"], other(of_gear["turn"].to_numpy() * Z2), atol=1e-18)


def test_errors_of_the_gear_leave_the_average_of_the_pinion_in_fixed_contacts_alone() -> None:
    # The hunting period brings every tooth of the gear to every tooth of the pinion: errors of zero mean
    # cancel where the motion is linear in them, and do not where a pair touches when its own gap closes.
    errors = np.sin(2.1 * np.arange(22)) * 20.0
    change = {}
    for contact, touch in (("prescribed", "linear"), ("loaded", "unilateral")):
        changes = {"gear.teeth": 22, "mesh.contact": contact, "centre_distance": None}
        pair = PAIR.with_(changes | {"pinion.deviations": {"index": [0.0] * Z1, "first_order": "steps"}})
        lists = {"index": list(errors - errors.mean()), "first_order": "steps"}
        healthy, deviated = (
            time_synchronous_average(
                lumped.steady_state(one, contact=touch, samples_per_cycle=8), variable="dte", derivative=0
            )["average"].to_numpy()
            for one in (pair, pair.with_({"gear.deviations": lists}))
        )
        change[contact] = np.abs(deviated - healthy).max() / np.ptp(healthy)
    assert change["prescribed"] < 1e-11
    assert change["loaded"] > 0.01


def test_residual_and_difference_lose_the_mesh_and_its_first_sidebands() -> None:
    parts = [lambda u: 0.0 * u + 7.0, *map(tone, (1, 4, Z1 - 1, Z1, 2 * Z1 + 1))]
    average = time_synchronous_average(result_of(added(*parts)), variable="dte", derivative=0)
    u = average["turn"].to_numpy() * Z1
    expected = added(tone(1), tone(Z1 - 1), tone(2 * Z1 + 1), tone(4))
    np.testing.assert_allclose(residual(average)["average"], expected(u), atol=1e-12)
    np.testing.assert_allclose(difference(average)["average"], added(tone(1), tone(4))(u), atol=1e-12)


def test_moments_of_a_sine_and_of_an_impulse_train() -> None:
    """Of a sine the fourth moment is 3/2, the sixth 5/2, of an impulse in n samples about n."""
    plain = result_of(added(tone(Z1), tone(4, 0.1)))
    beside = result_of(added(tone(Z1), tone(4, 0.1), tone(Z1 + 1, 0.3)))  # the difference leaves it out
    apart = indicators(beside, variable="dte", derivative=0).value.sel(indicator="M6A", record="pair")
    assert float(apart) == pytest.approx(2.5)
    indicator_values = indicators(plain, variable="dte", derivative=0).value.sel(record="pair")
    value = {
        name: float(indicator_values.sel(indicator=name)) for name in indicator_values["indicator"].to_numpy()
    }
    assert value["FM4"] == pytest.approx(1.5)
    assert value["M6A"] == pytest.approx(2.5)
    assert value["RMS"] == pytest.approx(np.sqrt(0.505))
    assert value["RMS_residual"] == pytest.approx(0.1 / np.sqrt(2))
    # The twin has no residual, so the mean variance is half of the tone's: 3/2 over 1/4.
    assert value["NA4"] == pytest.approx(6.0)
    # cos b + cos(2 b)/2 + 0.2 from -0.55 to 1.7: the variance is 5/8, the fourth moment 3/8 (1 + 1/16) + 3/8.
    mixed = added(lambda u: 0.0 * u + 0.2, tone(Z1, 1.0, 0.0), tone(2 * Z1, 0.5, 0.0))
    pure = indicators(result_of(mixed), variable="dte", derivative=0).value.sel(record="pair")
    expected = {"RMS": np.sqrt(0.665), "FM0": 1.5, "CrestFactor": 1.7 / np.sqrt(0.665), "Kurtosis": 1.98}
    for name, number in expected.items():
        assert float(pure.sel(indicator=name)) == pytest.approx(number, rel=5e-3), name
    struck = result_of(lambda u: tone(Z1)(u) + 0.01 * (np.mod(u, Z1) < 0.5 / SAMPLES))
    sharp = indicators(struck, variable="dte", derivative=0).value.sel(record="pair", indicator="FM4")
    assert 0.7 * Z1 * SAMPLES < float(sharp) < Z1 * SAMPLES


def test_a_healthy_pair_has_no_residual_unless_noise_is_stated() -> None:
    healthy = lumped.steady_state(PAIR, samples_per_cycle=SAMPLES)
    quiet = indicators(healthy)
    assert np.isnan(quiet.value.sel(indicator=["FM4", "M6A", "NA4"])).all()
    level = 1e-3 * float(quiet.value.sel(indicator="RMS", record="pair"))
    noisy = indicators(healthy, noise_floor=level, seed=3).value
    # White Gaussian noise has the fourth moment 3, with a standard error of sqrt(24/n) = 0.19 here.
    np.testing.assert_allclose(noisy.sel(indicator="FM4"), 3.0, atol=0.8)


def test_a_record_gives_its_motion_back_whatever_its_speed_does() -> None:
    motion = result_of(added(tone(Z1, 2e-6), tone(3, 1e-6)), cycles=CYCLES)
    record = synthetic_record(motion, 40, variable="dte", derivative=0, speed_change=0.1)
    turns = record["pinion_turns"].to_numpy()
    speed = np.gradient(turns, record["time"].to_numpy())
    assert speed[-1] / speed[0] == pytest.approx(1.1, rel=1e-3)
    average = time_synchronous_average(record, variable="signal", derivative=0)
    expected = added(tone(Z1, 2e-6), tone(3, 1e-6))(average["turn"].to_numpy() * Z1)
    np.testing.assert_allclose(average["average"], expected, atol=2e-9)
    # Without the tachometer the change of speed smears the mesh tone over many orders.
    smeared = order_spectrum(record.drop_vars("pinion_turns"), "pinion", variable="signal")
    assert float(smeared["amplitude"].max()) < 0.5 * 2e-6


def test_averaging_divides_noise_by_the_root_of_the_turns() -> None:
    motion = result_of(tone(Z1, 0.0))
    record = synthetic_record(motion, 400, variable="dte", derivative=0, noise=1.0, seed=5)
    average = time_synchronous_average(record, variable="signal", derivative=0)["average"]
    assert float(average.std()) == pytest.approx(1.0 / 20.0, rel=0.1)


@pytest.mark.parametrize(("call", "message"), [
    (lambda d: order_spectrum(d, "wheel"), "shaft"),
    (lambda d: order_spectrum(d, variable="x"), "variable"),
    (lambda d: order_spectrum(d.isel(time=slice(0, -3))), "whole number of mesh cycles"),
    (lambda d: order_spectrum(d.isel(time=[0, 1, 2, 4, 5, 6, 7, 8, 9])), "even distances"),
    (lambda d: residual(d), "time_synchronous_average"),
    (lambda d: synthetic_record(d, 10**6, variable="dte"), "samples"),
])  # fmt: skip
def test_what_cannot_be_analysed_is_refused(call, message: str) -> None:
    with pytest.raises(lumped.ParameterError, match=message):
        call(result_of(tone(1)))
