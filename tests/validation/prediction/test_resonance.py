"""Is the resonance that is named the nearest one that matters? All crossings are looked at in turn."""

import math

import numpy as np
import pytest

import lumped
from floquet.gear.axes import speed_range
from tests.unlike_pairs import unlike_pair
from validation.exchange.new_pair_file import new_pair
from validation.prediction.resonance import nearest_resonance

PAIRS = {
    "third order": lambda: new_pair("25/103", 3.0, 30, 1500, 100),
    "second order": lambda: new_pair("23/81", 2.0, 20, 14_000, 30),
    "far": lambda: new_pair(
        "17/40", 0.5, 5, 3000, 0.02, {"gears.youngs_modulus": 3.0, "gears.density": 1400}
    ),
    "unlike": lambda: unlike_pair("rack_25_degrees_always_pushing"),
}


def amplitude(pair, rpm, order):
    """Amplitudes of an order in the mesh force and in the bearing forces of both gears [N]."""
    motion = lumped.steady_state(pair.at_speed(float(rpm)), samples_per_cycle=128, supports="springs")

    def order_amplitude(values):
        phase = 2.0 * np.pi * order * np.arange(values.size) / values.size
        return 2.0 * abs(np.mean(values * np.exp(1j * phase)))

    mesh = order_amplitude(motion["normal_load"].sum("pair").to_numpy())
    bearings = [
        math.hypot(*(order_amplitude(motion[f"bearing_force_{line}_{gear}"].to_numpy()) for line in "xy"))
        for gear in "pg"
    ]
    return np.array([mesh, *bearings])


@pytest.mark.parametrize("name", PAIRS)
def test_no_nearer_crossing_of_an_order_is_amplified(name):
    pair = PAIRS[name]()
    low, high = speed_range(pair)
    resonance = nearest_resonance(pair, (low, high))
    operating_rpm = pair.operating.pinion_speed * 30.0 / math.pi
    static = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    assert resonance is not None
    nearer = [
        (speed, order)
        for frequency in lumped.natural_frequencies(pair, supports="springs")
        for order in range(1, 11)
        if low <= (speed := 60.0 * frequency / (order * pair.pinion.teeth)) <= high
        and abs(math.log(speed / operating_rpm)) < abs(math.log(resonance.speed_rpm / operating_rpm)) - 1e-9
    ]
    for speed, order in [*nearer, (resonance.speed_rpm, resonance.order)]:
        before, there, after = (amplitude(pair, factor * speed, order) for factor in (0.9, 1.0, 1.1))
        counts = (there >= 0.05 * static) & (there >= 0.6 * (before + after))
        assert counts.any() == ((speed, order) == (resonance.speed_rpm, resonance.order)), (speed, order)
    assert resonance.near == (abs(operating_rpm / resonance.speed_rpm - 1.0) <= 0.05)


def test_orders_beyond_the_first_and_the_mode_are_told():
    resonance = nearest_resonance(PAIRS["second order"](), (1400.0, 28_000.0))
    assert (resonance.order, resonance.mode) == (2, "mesh mode")
    assert nearest_resonance(PAIRS["second order"](), (13_999.0, 14_001.0)) is None
