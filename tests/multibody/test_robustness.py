"""Can a run hang, return nonsense in silence, swallow Ctrl-C or take arguments that make no sense?"""

from __future__ import annotations

import _thread
import threading

import numpy as np
import pytest

import lumped
import multibody

PAIR = lumped.load_gear_pair("nasa_28_28")


def test_ctrl_c_stops_a_run():
    """exudyn wraps what a user function raises; the interrupt must come out as itself."""
    multibody.simulate(PAIR, 1)  # compiled before the clock runs
    timer = threading.Timer(0.5, _thread.interrupt_main)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            multibody.simulate(PAIR, 5000)
    finally:
        timer.cancel()


def test_an_impossible_state_raises_and_says_what_to_check():
    """Explicit solvers carry NaN forces through in silence; the model looks at every force."""
    state = np.zeros(12)
    state[2], state[3] = 0.0, -5e-3  # gear moved 5 mm towards the pinion: the base circles overlap
    state[5] = -8e-3
    with pytest.raises(lumped.NumericalError, match="not finite"):
        multibody.simulate(PAIR, 2, initial=state)


def test_runaway_step_sizes_are_capped(monkeypatch):
    monkeypatch.setattr("multibody.setup.CALL_LIMIT", 300)
    with pytest.raises(lumped.NumericalError, match="More than 300 force evaluations"):
        multibody.simulate(PAIR, 2)


def test_a_failed_run_leaves_the_next_one_alone():
    with pytest.raises(lumped.NumericalError):
        multibody.simulate(PAIR, 2, initial=np.full(12, 1e200))
    run = multibody.simulate(PAIR, 1)
    assert np.isfinite(run["dte"]).all()


def test_nothing_is_written_to_the_console(capfd):
    multibody.simulate(PAIR, 2)
    with pytest.raises(lumped.NumericalError):
        multibody.simulate(PAIR, 2, initial=np.full(12, 1e200))
    captured = capfd.readouterr()
    assert captured.out == ""
    assert captured.err == ""


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"cycles": 0}, "cycles"),
        ({"fidelity": "rigid"}, "fidelity"),
        ({"rtol": 0.1}, "rtol"),
        ({"rtol": float("nan")}, "rtol"),
        ({"samples_per_cycle": 2}, "samples_per_cycle"),
        ({"initial": "hot"}, "initial"),
        ({"initial": np.zeros(6)}, "initial"),
        ({"effects": {"gravity"}}, "effects"),
        ({"effects": "contact_loss"}, "effects"),
        ({"effects": {"contact_loss"}, "fidelity": "linear"}, "effects"),
        ({"friction_velocity": -1.0}, "friction_velocity"),
        ({"friction_velocity": float("nan")}, "friction_velocity"),
    ],
)
def test_arguments_without_sense_are_refused(options, field):
    with pytest.raises(lumped.ParameterError, match=field):
        multibody.simulate(PAIR, **options)


def test_output_times_do_not_change_the_motion():
    """The grid is read off the integrator's own dense output: 64 and 1024 samples see the same curve."""
    coarse, fine = (multibody.simulate(PAIR, 3, samples_per_cycle=n) for n in (64, 1024))
    for name in ("dte", "dte_dot", "normal_load", "mu"):
        np.testing.assert_array_equal(coarse[name], fine[name][..., ::16])


def test_dense_output_has_the_integrators_accuracy():
    """Halfway between its own steps the run is as close to a tight reference as the steps themselves."""
    reference = multibody.simulate(PAIR, 2, fidelity="linear", rtol=1e-12, samples_per_cycle=1000)
    run = multibody.simulate(PAIR, 2, fidelity="linear", rtol=1e-8, samples_per_cycle=1000)
    scale = float(np.ptp(reference["dte"].to_numpy()))
    error = np.abs(run["dte"] - reference["dte"]).to_numpy() / scale
    assert error.max() < 1e-7
    assert np.isfinite(run.to_array()).all()
