"""Is the forced motion the periodic one: by closed forms, the general engine, the lumped model?"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from floquet import (
    PeriodicSystem,
    RankOneSystem,
    fast_multipliers,
    fast_periodic_motions,
    gear_block,
    gear_pair_system,
    periodic_motion,
    stability_chart,
)
from floquet.rank_one.system import Gains
from lumped import load_gear_pair, steady_state
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
    absolute = gear_pair_system(pair, "absolute")
    with pytest.raises(NumericalError, match="rigid"):
        periodic_motion(absolute)


def test_times_outside_the_period_are_refused() -> None:
    with pytest.raises(ParameterError, match="times"):
        periodic_motion(PeriodicSystem(lambda t: [[-1.0]], 1.0), [1.5])


def random_system(rng: np.random.Generator) -> RankOneSystem:
    m, pieces = int(rng.integers(1, 4)), int(rng.integers(1, 4))
    v, metric = rng.normal(size=m), rng.uniform(0.5, 2.0, m)
    w = 0.3 * rng.normal(size=(pieces, m, 4))
    w[:, :, 0] += rng.uniform(0.5, 2.0) * v / metric
    phases = np.concatenate([[0.0], np.sort(rng.uniform(0.05, 0.95, pieces - 1)), [1.0]])
    gains = Gains(
        w=w,
        wd=0.05 * rng.normal(size=(pieces, m, 2)),
        f=rng.normal(size=(pieces, m, 3)),
        fr=rng.normal(size=(pieces, m, 2)),
        fit_errors=np.zeros((pieces, 4)),
    )
    return RankOneSystem(
        stiffness=rng.uniform(0.5, 4.0, m),
        damping=rng.uniform(0.05, 0.3, m),
        v=v,
        phases=phases,
        gains=gains,
        period=float(10.0 ** rng.uniform(-0.3, 1.3)),
        metric=metric,
    )


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8, 1e-12])
def test_compiled_motion_is_within_its_bound_of_the_engine(tolerance: float) -> None:
    rng = np.random.default_rng(31)
    for _ in range(25):
        system = random_system(rng)
        m = system.v.size
        fast = fast_periodic_motions(system, tolerance=tolerance, samples=16)
        times = system.period * np.arange(16) / 16
        slow = periodic_motion(system.to_periodic_system(), times, 1e-12)
        S = system.modal().state_matrix()
        difference = np.linalg.norm(np.linalg.solve(S, fast.initial[0] - slow.initial))
        size = fast.energy_norm[0]
        # 1e-9: the reference is good to 1e-12 of the flow, times |(I - M)^-1| and the coordinates (1e3).
        assert difference <= fast.errors[0] + 1e-9 * size
        assert fast.errors[0] < 1e6 * tolerance * size + 1e-9 * size  # not idle
        sampled = slow.states[:, :m] @ system.v
        assert (
            np.abs(fast.deflection[0] - sampled).max() <= 1e3 * fast.errors[0] + 1e-8 * np.abs(sampled).max()
        )


def test_factors_act_on_damping_and_forcing_rate() -> None:
    rng = np.random.default_rng(2)
    system = random_system(rng)
    scaled = replace(system.gains, wd=1.7 * system.gains.wd, fr=1.7 * system.gains.fr)
    expected = fast_periodic_motions(replace(system, gains=scaled)).initial
    assert np.allclose(fast_periodic_motions(system, damping_factors=1.7).initial, expected, rtol=1e-9)


def test_gear_pair_has_the_brake_torque_of_the_lumped_model() -> None:
    pair = load_gear_pair("nasa_28_28").with_(friction__law="benedict_kelley", mesh__relief="static")
    brake = float(steady_state(pair, samples_per_cycle=64).attrs["brake_torque"])
    # 1e-7: c near a pair's entry with relief is fitted to 1e-7 of its peak.
    assert fast_periodic_motions(gear_block(pair)).amplitude[0] == pytest.approx(brake, rel=1e-7)


def test_multiplier_at_one_is_refused() -> None:
    # One undamped oscillator, a whole number of turns per period: every motion is periodic, or none is.
    still = np.zeros((1, 1, 1))
    system = RankOneSystem(
        stiffness=np.array([4.0]),
        damping=np.zeros(1),
        v=np.ones(1),
        phases=np.array([0.0, 1.0]),
        gains=Gains(still, still, np.ones((1, 1, 1)), still, np.zeros((1, 4))),
        period=np.pi,
        metric=np.ones(1),
    )
    with pytest.raises(NumericalError, match=r"\+1"):
        fast_periodic_motions(system)
    with pytest.raises(NumericalError, match=r"\+1"):
        periodic_motion(system.to_periodic_system())


@pytest.mark.parametrize(("growth", "verdict"), [(-0.1, "stable"), (0.1, "unstable")])
def test_unstable_periodic_motion_says_so(growth: float, verdict: str) -> None:
    # x' = g x + cos t has a periodic solution for either sign of g; exp(2 pi g) is its multiplier.
    system = PeriodicSystem(lambda t: [[growth]], 2.0 * np.pi, b=lambda t: [np.cos(t)])
    motion = periodic_motion(system)
    assert motion.spectrum.verdict == verdict
    assert motion.spectrum.spectral_radius == pytest.approx(np.exp(2.0 * np.pi * growth), rel=1e-9)


def test_fast_motions_say_where_they_are_unstable() -> None:
    pair = load_gear_pair("nasa_28_28").with_(friction__law="none", mesh__damping_ratio=0.002)
    block = gear_block(pair)
    own = pair.operating.pinion_speed * 30 / np.pi
    speeds = np.array([9000.0, 17000.0, 13500.0])
    motion = fast_periodic_motions(block, block.period * own / speeds)
    chart = stability_chart(pair, {"speed_rpm": speeds})
    feedback = np.sort(np.abs(fast_multipliers(block, block.period * own / speeds).multipliers), axis=1)[
        :, -1
    ]
    assert motion.spectral_radius == pytest.approx(feedback, rel=1e-10)
    assert motion.verdict.tolist() == [1, -1, 1]  # 2w3/2 is open from 16300 to 17900 rpm
    assert chart.verdict.values.tolist() == [1, -1, 1]
