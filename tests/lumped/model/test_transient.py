"""Does the transient keep its order across the switches, start where it says and land on its grid?"""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from lumped import (
    NumericalError,
    ParameterError,
    geometry,
    mesh_cycle,
    periodic_system,
    simulate,
    steady_state,
)
from lumped.model.equations import COORDINATES
from lumped.model.solution import static_deflection
from lumped.model.steady import periodic_cycle, sample_times
from tests.unlike_pairs import unlike_pair

STATES = (*COORDINATES, *(f"{n}_dot" for n in COORDINATES))


def states(run):
    return np.stack([run[name].to_numpy() for name in STATES], axis=1)


@pytest.mark.parametrize("samples", [8, 37])
def test_every_sample_is_filled_whatever_the_grid(published, samples):
    """Samples of a coarse run are those of a fine one: none is skipped, doubled or shifted at a switch."""
    fine = simulate(published, 2, samples_per_cycle=10 * samples)
    coarse = simulate(published, 2, samples_per_cycle=samples)
    a = states(fine)[::10]
    b = states(coarse)
    assert np.isfinite(b).all()
    # Same solution, other output points: dense output has the accuracy of the steps.
    assert (np.abs(a - b) / np.abs(a).max(axis=0)).max() < 1e-7


def test_samples_at_the_very_bits_of_the_switches(coulomb_pair, monkeypatch):
    """A grid that holds every switch bit for bit: none of its samples is lost between two segments."""
    switches = mesh_cycle(coulomb_pair).switch_times

    def with_switches(period, samples):
        return np.union1d(sample_times(period, samples), switches)

    plain = states(simulate(coulomb_pair, 2, samples_per_cycle=8))
    monkeypatch.setattr("lumped.model.solution.sample_times", with_switches)
    run = simulate(coulomb_pair, 2, samples_per_cycle=8)
    assert run.sizes["time"] == 2 * (8 + switches.size) + 1
    period = geometry(coulomb_pair).mesh_period
    on_grid = np.abs(np.mod(run["time"].to_numpy() / period * 8 + 0.5, 1.0) - 0.5) < 1e-9
    difference = np.abs(states(run)[on_grid] - plain) / np.abs(plain).max(axis=0)
    assert difference.max() < 1e-7  # accuracy of the dense output
    between = states(run)[~on_grid]
    # Displacements move by no more than their rates allow since the sample before.
    before = states(run)[np.flatnonzero(~on_grid) - 1]
    steps = run["time"].to_numpy()[~on_grid] - run["time"].to_numpy()[np.flatnonzero(~on_grid) - 1]
    fastest = np.abs(plain[:, 6:]).max(axis=0)
    assert np.all(np.abs(between - before)[:, :6] <= 3 * fastest * steps[:, None] + 1e-12)


@pytest.mark.parametrize("name", ["larger_gear_drives_contact_lost", "contact_ratio_2_3_on_shafts"])
def test_an_adaptive_method_between_the_switches_finds_the_same(name):
    """scipy's DOP853 on x' = A(t) x + b(t), started anew at every switch, is of another family."""
    pair = unlike_pair(name).with_(shafts=None)  # where a pair touches follows from the load
    run = simulate(pair, 2, samples_per_cycle=16)
    system = periodic_system(pair, "full")
    state = states(run)[0]
    scale = np.abs(states(run)).max(axis=0)
    brake = periodic_cycle(pair, 8).brake_torque  # by moments, as the equations have it
    for _ in range(2):
        for low, high in itertools.pairwise(system.cycle.edges):
            inside = 1e-11 * system.period  # values at a switch are those behind it

            def rate(t, x, ends=(low + inside, high - inside)):
                t = np.clip(t, *ends)
                return system.A(t) @ x + system.b(t, brake)

            state = solve_ivp(rate, (low, high), state, method="DOP853", rtol=1e-10, atol=1e-12 * scale).y[
                :, -1
            ]
    assert (np.abs(states(run)[-1] - state) / scale).max() < 1e-7


def test_static_start(published):
    run = simulate(published, 1, samples_per_cycle=8)
    start = states(run)[0]
    np.testing.assert_array_equal(start, static_deflection(periodic_system(published, "full")))
    assert np.all(start[6:] == 0.0)
    k = mesh_cycle(published).mean_stiffness
    force = published.operating.pinion_torque / published.geometry.base_radius_pinion
    assert float(run["dte"][0]) * k == pytest.approx(force, rel=1e-12)


def test_static_start_carries_the_given_brake(published):
    """With a brake torque given, the mean load is the brake's, not the one of the nominal pinion torque."""
    pair = published.with_(operating__brake_torque=20.0, friction__law="none")
    run = simulate(pair, 1, samples_per_cycle=8)
    g = geometry(pair)
    k = mesh_cycle(pair).mean_stiffness
    assert float(run["dte"][0]) * k == pytest.approx(20.0 / g.base_radius_gear, rel=1e-9)


def test_progress_is_reported(coulomb_pair):
    seen = []
    simulate(coulomb_pair, 4, samples_per_cycle=8, progress=seen.append)
    assert seen == [0.25, 0.5, 0.75, 1.0]


class TestArguments:
    @pytest.mark.parametrize("cycles", [0, -1, 100_001, 2.5, math.nan, math.inf, True, "3", None])
    def test_cycles(self, nasa, cycles):
        with pytest.raises(ParameterError, match=r"^cycles.*1 to 100000"):
            simulate(nasa, cycles)

    @pytest.mark.parametrize("samples", [7, 0, -8, 65537, 100.5, math.nan, True, "64", None])
    def test_samples(self, nasa, samples):
        with pytest.raises(ParameterError, match=r"samples_per_cycle.*8 to 65536"):
            simulate(nasa, 1, samples_per_cycle=samples)
        if samples is None:  # the default of the periodic motion, which depends on its period
            return
        with pytest.raises(ParameterError, match=r"samples_per_cycle.*8 to 65536"):
            steady_state(nasa, samples_per_cycle=samples)

    @pytest.mark.parametrize(
        "initial", ["rest", "", None, 3.0, [0.0] * 11, [[0.0] * 12], [math.nan] * 12, ["a"] * 12, [None] * 12]
    )
    def test_initial(self, nasa, initial):
        with pytest.raises(ParameterError, match="initial"):
            simulate(nasa, 1, initial=initial)

    def test_a_speed_at_which_a_cycle_would_take_minutes(self, nasa):
        with pytest.raises(NumericalError, match=r"mesh cycle of .* steps .* raise the speed"):
            simulate(nasa.with_(operating__pinion_speed=1e-3))
