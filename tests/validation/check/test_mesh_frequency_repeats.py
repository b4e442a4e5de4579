"""Is the mesh frequency seen where another has orders in common, or the sampling rate is misstated?"""

from dataclasses import replace

import numpy as np
import pytest

import lumped
import spurcheck
from tests.validation.check.motions import lumped_motion
from tests.validation.check.sampled_motions import COULOMB, sampled
from validation.check.mesh_frequency import mesh_frequency


@pytest.fixture(scope="module")
def pair():
    """16 and 24 teeth: three mesh cycles at one gear's speed are two at the other's."""
    return lumped.load_gear_pair("fzg_c").with_({**COULOMB, "mesh.stiffness": {"model": "rectangular"}})


def curves_of(pair):
    """Six mesh cycles of the motion."""
    return sampled(lumped_motion(pair), ("dte", "x_p", "bearing_force_y_p"), cycles=6, per_cycle=311)


def test_speed_of_the_gear(pair):
    speed = pair.operating.pinion_speed * 30.0 / np.pi
    faster = pair.with_({"operating.pinion_speed": speed * 24 / 16})
    frequency = mesh_frequency(curves_of(faster), pair)
    assert frequency.factor == pytest.approx(1.5, rel=1e-3)
    assert "gear" in frequency.cause


def test_half_of_the_speed(pair):
    """pi/60 for pi/30: the mesh frequency is half, and all orders are those of that speed."""
    speed = pair.operating.pinion_speed * 30.0 / np.pi
    slower = pair.with_({"operating.pinion_speed": 0.5 * speed})
    frequency = mesh_frequency(curves_of(slower), pair)
    assert frequency.factor == pytest.approx(0.5, rel=1e-3)
    assert "pi/60" in frequency.cause


def test_a_motion_over_two_mesh_cycles_is_at_the_right_speed(pair):
    """A subharmonic of half of the size of the motion repeats in two cycles, as half of the speed would."""
    curves = curves_of(pair)
    cycles = curves.places / pair.geometry.mesh_period

    def with_subharmonic(channel):
        wave = 0.5 * np.std(channel.values) * np.sqrt(2.0) * np.cos(np.pi * cycles)
        return replace(channel, values=channel.values + wave)

    doubled = replace(curves, channels=tuple(map(with_subharmonic, curves.channels)))
    assert mesh_frequency(doubled, pair).factor == pytest.approx(1.0, abs=1e-3)


def test_sampling_rate_misstated(pair):
    curves = curves_of(pair)
    frequency = mesh_frequency(replace(curves, places=curves.places * 48.0 / 44.1), pair)
    assert frequency.factor == pytest.approx(44.1 / 48.0, rel=1e-3)
    assert "sampling rate" in frequency.cause


def test_the_true_frequency_stays(pair):
    assert mesh_frequency(curves_of(pair), pair).factor == pytest.approx(1.0, abs=1e-6)


def test_speed_of_the_gear_where_the_first_orders_carry_less_than_half(pair):
    """Pulses: the first six orders carry 44 % of the variation; the motion repeats at one frequency alone."""
    speed = pair.operating.pinion_speed * 30.0 / np.pi
    faster = pair.with_({"operating.pinion_speed": speed * 24 / 16})
    curves = curves_of(faster)
    cycles = curves.places / faster.geometry.mesh_period
    pulses = np.exp(-(((cycles % 1.0 - 0.5) / 0.015) ** 2))
    orders = np.abs(np.fft.rfft(pulses[: cycles.size // 6])) ** 2
    assert 0.3 < orders[1:7].sum() / orders[1:].sum() < 0.5
    pulsed = replace(curves, channels=(replace(curves.channels[0], values=pulses),))
    frequency = mesh_frequency(pulsed, pair)
    assert frequency.factor == pytest.approx(1.5, rel=1e-3)
    assert "gear" in frequency.cause
    assert mesh_frequency(pulsed, faster).factor == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("teeth", [(20, 80), (17, 51)])
def test_speed_of_the_gear_where_one_mesh_cycle_holds_several(teeth):
    """The ratio of the teeth is whole: the motion repeats in the mesh cycle of the pair, too."""
    ratio = teeth[1] / teeth[0]
    pair = spurcheck.new_pair(teeth, module=2, face_width=20, speed=1500 / ratio, torque=30)
    faster = pair.with_(operating__pinion_speed="1500 rpm")
    frequency = mesh_frequency(curves_of(faster), pair)
    assert frequency.factor == pytest.approx(ratio, rel=1e-3)
    assert "gear" in frequency.cause
    assert mesh_frequency(curves_of(faster), faster).factor == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(("teeth", "order", "first", "noise"), [
    ((17, 51), 3, 0.05, 0.0), ((16, 32), 2, 0.05, 0.0), ((16, 32), 2, 0.01, 0.04),
])  # fmt: skip
def test_a_resonance_of_a_higher_mesh_order_is_at_the_right_speed(teeth, order, first, noise):
    """The first order is small, as at a lightly damped resonance; it drifts, or has noise."""
    pair = spurcheck.new_pair(teeth, module=2, face_width=20, speed=500, torque=30)
    curves = curves_of(pair)
    cycles = 2.0 * np.pi * curves.places / pair.geometry.mesh_period
    wave = np.cos(order * cycles) + first * np.cos(cycles) + 0.003 * cycles
    wave += noise * np.random.default_rng(5).standard_normal(wave.size)
    resonant = replace(curves, channels=(replace(curves.channels[0], values=wave),))
    assert mesh_frequency(resonant, pair).cause == ""
