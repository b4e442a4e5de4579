"""Can a run hang, return nonsense in silence, swallow Ctrl-C or take arguments that make no sense?"""

import _thread
import itertools
import signal
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import lumped
import multibody
import multibody.run.integration
from lumped.model.averaged import modes
from multibody.contact.machine import machine
from multibody.contact.records import with_block
from multibody.run.model import CallBudget, _force_function, build
from multibody.run.setup import prepare

PAIR = lumped.load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed", mesh__relief="ignored")


def test_an_interrupt_inside_a_force_evaluation_comes_out_as_itself(monkeypatch):
    """exudyn wraps what a user function raises in an error of its own."""

    def interrupted(*_arguments):
        raise KeyboardInterrupt

    setup = prepare(PAIR)
    monkeypatch.setattr("multibody.run.integration.accelerations", lambda *_: np.zeros((1, 6)))
    monkeypatch.setattr("multibody.run.model.tooth_forces", interrupted)
    with pytest.raises(KeyboardInterrupt):
        setup.run(setup.edges(1), lambda *_: None)


def test_ctrl_c_stops_a_run():
    multibody.simulate(PAIR, 1)  # compiled before the clock runs
    # A shell starts a job in the background with the signal ignored, and the whole run would be waited for.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.5, _thread.interrupt_main)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            multibody.simulate(PAIR, 5000)
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("array_index", [1, 2])
def test_coordinates_or_rates_alone_that_are_not_finite_are_seen(monkeypatch, array_index):
    stored = multibody.run.integration.stored

    def spoilt(model):
        arrays = [np.array(one) for one in stored(model)]
        arrays[array_index][-1, 0] = np.nan
        return tuple(arrays)

    monkeypatch.setattr("multibody.run.integration.stored", spoilt)
    with pytest.raises(lumped.NumericalError, match="not finite"):
        multibody.simulate(PAIR, 1)


def test_an_impossible_state_raises_and_says_what_to_check():
    """Explicit solvers carry NaN forces through in silence; the model looks at every force."""
    state = np.zeros(12)
    state[[3, 5]] = -5e-3, -8e-3  # gear moved 5 mm towards the pinion: the base circles overlap
    with pytest.raises(lumped.NumericalError, match="not finite"):
        multibody.simulate(PAIR, 2, initial=state)


def test_runaway_step_sizes_are_capped(monkeypatch):
    monkeypatch.setattr("multibody.run.setup.CALL_LIMIT", 300)
    with pytest.raises(lumped.NumericalError, match="More than 300 force evaluations"):
        multibody.simulate(PAIR, 2)


def test_a_run_goes_on_where_exudyn_allows_no_error():
    """At tight tolerances steps were tried without end where a negative rate passed -atol/rtol."""
    pair = PAIR.with_(
        mesh__relief="static", mesh__contact="loaded", mesh__stiffness={"model": "energy"},
        operating__pinion_speed=52,
    )  # fmt: skip
    setup = prepare(pair, rtol=1e-10)
    setup.run(np.array([0.0, 0.48]) * setup.machine.period, lambda *_: None)
    assert setup.model.budget.calls < 100_000  # 75,000; the limit is 1.8 million


def test_a_repeated_state_is_evaluated_again_in_a_new_run():
    """The last stage of a step is the first of the next; a new run may have other parameters."""
    setup = prepare(PAIR, fidelity="linear")
    budget = CallBudget(100)
    p = setup.model.record
    t = 0.3 * setup.machine.period
    forces = _force_function(setup.model.flags, setup.model.packed, budget)
    state = setup.q.tolist(), [0.1] * 6
    before = forces(None, t, 0, *state)
    p.pair_law.damping *= 2.0
    assert forces(None, t, 0, *state) == before
    budget.watch(t, 0.0)
    assert forces(None, t, 0, *state) != before
    assert budget.calls == 3


@pytest.mark.parametrize("fidelity", ["linear", "exact"])
def test_a_force_that_turns_nan_on_the_way_stops_the_run(fidelity):
    """The stiffness is not finite where a tooth pair is at 0.3 to 0.5 of the mesh cycle.

    The run must stop at the first force that is not finite, not when the states are read afterwards.
    """
    setup = prepare(PAIR.with_(friction__law="none"), fidelity=fidelity)
    machine = setup.machine
    p = setup.machine.record
    assert len(machine.stiffness_table) == 1  # constant: make three pieces of it
    pieces = np.repeat(machine.stiffness_table, 3, axis=0)
    pieces[:-1, 1] = pieces[1:, 0] = p.geometry.L_XA + np.array([0.3, 0.5]) * p.geometry.pitch
    pieces[1, -1] = np.nan
    broken = replace(machine, packed=with_block(machine.packed, "stiffness", pieces))
    model = build(broken, setup.model.flags, 100_000)
    edges = np.array([0.0, 0.1, 0.9]) * broken.period
    visited = []
    with pytest.raises(lumped.NumericalError, match="not finite"):
        replace(setup, model=model).run(edges, lambda number, _: visited.append(number))
    assert visited == [0]
    assert model.budget.reason == "not finite"
    # 674 and 725 evaluations to there; the linear level would take 1617 to the end of the interval.
    assert model.budget.calls < 1000


def test_a_speed_that_would_take_for_ever_is_refused_before_work_starts(monkeypatch):
    started = time.process_time()
    with pytest.raises(lumped.ParameterError, match=r"pinion_speed = 1 rpm: allowed at least 37\..* rpm"):
        multibody.steady_state(PAIR.with_(operating__pinion_speed=1))
    assert time.process_time() - started < 2.0
    # The cap on force evaluations grows with what a slow pair needs.
    monkeypatch.setattr("multibody.run.setup.CALL_LIMIT", 10_000)
    run = multibody.simulate(PAIR.with_(operating__pinion_speed=40), 1)
    assert run.attrs["force_evaluations"] > 10_000


@pytest.mark.parametrize("name", lumped.preset_names())
def test_fastest_vibration_is_bounded_from_above_and_closely(name):
    """Against the modes of the time-averaged lumped equations, whose mesh is softer by less than half."""
    pair = lumped.load_gear_pair(name).with_(mesh__contact="prescribed")
    numbers = machine(pair)
    fastest = max(mode.natural_frequency for mode in modes(pair)) * numbers.period
    assert 1.0 < numbers.vibrations_per_cycle / fastest < np.sqrt(2.0)


def test_nothing_is_written_to_the_console(capfd):
    multibody.simulate(PAIR, 2)
    with pytest.raises(lumped.NumericalError):
        multibody.simulate(PAIR, 2, initial=1e200 * np.arange(12))
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(("options", "field"), [
    ({"cycles": 0}, "cycles"),
    ({"cycles": 2.5}, "cycles"),
    ({"cycles": True}, "cycles"),
    ({"fidelity": "rigid"}, "fidelity"),
    ({"rtol": 0.1}, "rtol"),
    ({"rtol": float("nan")}, "rtol"),
    ({"samples_per_cycle": 2}, "samples_per_cycle"),
    ({"initial": "hot"}, "initial"),
    ({"initial": np.zeros(6)}, "initial"),
    ({"effects": {"gravity"}}, "effects"),
    ({"effects": "contact_loss"}, "effects"),
    ({"effects": {"contact_loss": "no"}}, "effects.contact_loss"),
    ({"effects": 5}, "effects"),
    ({"effects": [["contact_loss"]]}, "effects"),
    ({"effects": {"entry_shift"}, "fidelity": "linear"}, "effects"),
    ({"friction_velocity": -1.0}, "friction_velocity"),
    ({"friction_velocity": float("nan")}, "friction_velocity"),
])  # fmt: skip
def test_arguments_without_sense_are_refused(options, field):
    with pytest.raises(lumped.ParameterError, match=field):
        multibody.simulate(PAIR, **options)


@pytest.mark.parametrize(("call", "field"), [
    (lambda: multibody.power_balance(PAIR, 0), "cycles"),
    (lambda: multibody.power_balance(PAIR, 2.5), "cycles"),
    (lambda: multibody.speed_sweep(PAIR, []), "speeds_rpm"),
    (lambda: multibody.speed_sweep(PAIR, [3000], cycles=0), "cycles"),
    (lambda: multibody.speed_sweep(PAIR, [3000], settle=-5), "settle"),
    (lambda: multibody.simulate(PAIR.with_(operating__pinion_torque=1e7), 1), "pinion_torque"),
])  # fmt: skip
def test_calls_without_sense_are_refused(call, field):
    """A balance over no cycle closes; a run in which flanks meet the next tooth looks like any other."""
    with pytest.raises(lumped.ParameterError, match=field):
        call()


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


@pytest.mark.parametrize("moment", ["running", "writing"])
def test_an_interrupted_command_leaves_no_half_written_file(moment, tmp_path, monkeypatch):
    from typer.testing import CliRunner

    from validation.cli import app

    if moment == "running":
        integrate = multibody.run.integration._run
        count = itertools.count()

        def run(*arguments):
            if next(count) > 10:
                raise KeyboardInterrupt
            return integrate(*arguments)

        monkeypatch.setattr("multibody.run.integration._run", run)
    else:
        write_bytes = Path.write_bytes

        def write(path, content):
            write_bytes(path, bytes(content)[:100])
            raise KeyboardInterrupt

        monkeypatch.setattr(Path, "write_bytes", write)
    command = ["simulate", "nasa_28_28", "--model", "multibody", "--cycles", "3"]
    result = CliRunner().invoke(app, [*command, "-o", str(tmp_path / "run.nc")])
    assert result.exit_code == 130
    assert list(tmp_path.iterdir()) == []
