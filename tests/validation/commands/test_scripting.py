"""Can a script use the commands: JSON alone on stdout, silence, messages that name what was typed?"""

import json

import pytest
from typer.testing import CliRunner

import lumped
from validation.cli import app
from validation.cross_check import comparison


def run(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def test_simulate_prints_its_numbers():
    result = run("simulate", "--json", "--cycles", 3, "--samples", 64)
    numbers = json.loads(result.stdout)
    # Extremes between samples are computed: the range of a far finer history, not of the 64 samples.
    last = lumped.simulate("nasa_28_28", 3, samples_per_cycle=4096).isel(time=slice(-4096, None))
    assert numbers["dte_peak_to_peak"] == pytest.approx(float(last.dte.max() - last.dte.min()), rel=1e-4)
    assert (result.exit_code, numbers["gear_pair"], numbers["model"]) == (0, "nasa_28_28", "lumped")


def test_loads_are_those_of_the_response_over_speed():
    """With loaded contact pairs begin their contact gradually: what must press is all of them together."""
    speed = lumped.load_gear_pair("fzg_c").operating.pinion_speed.to("rpm")
    for form in ("prescribed", "loaded"):
        pair = lumped.load_gear_pair("fzg_c").with_(mesh__contact=form)
        result = run("simulate", "fzg_c", "--set", f"mesh.contact={form}", "--json", "--steady")
        numbers, sweep = json.loads(result.stdout), lumped.speed_sweep(pair, [speed], samples_per_cycle=256)
        for name in ("normal_load_max", "normal_load_min"):
            assert numbers[name] == pytest.approx(float(sweep[name][0]), rel=1e-6)


def test_stability_and_crosscheck_print_their_verdicts(monkeypatch):
    # The variant is judged in tests/validation/cross_check.
    monkeypatch.setitem(comparison.crosscheck.__kwdefaults__, "variant", False)
    stable = json.loads(run("stability", "--json").stdout)
    assert (stable["verdict"], stable["margin"]) == ("stable", 1.0 - stable["spectral_radius"])
    check = run("crosscheck", "--json", "--cycles", 6, "--samples", 64)
    data = json.loads(check.stdout)
    assert (data["verdict"], check.exit_code) == ("agrees", 0)
    assert data["agreements"]


@pytest.mark.parametrize("command", [("simulate", "--cycles", 2), ("stability",)])
def test_quiet_is_silent(command):
    result = run(*command, "--quiet")
    assert (result.exit_code, result.output) == (0, "")
    assert json.loads(run(*command, "-q", "--json").output)
    refused = run(*command, "-q", "--speed", -5)
    assert refused.exit_code == 2
    assert refused.stderr.startswith("error:")
    assert run(*command).stdout, "silence ends with the command"
