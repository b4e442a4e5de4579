"""`[shafts]` in the file means shafts in every function and command, unless springs are asked for.

Every public function that takes a pair has one row in ``calls``. It computes on the shafts by default, or it
refuses a pair with shafts and names ``supports``, or supports do not enter. A function without a row fails.
"""

import inspect
import json

import numpy as np
import pytest
import typer

import floquet
import lumped
import multibody
import validation
from lumped.errors import ParameterError
from lumped.model.periodic_system import on_springs, supports_of, with_supports, without_shafts
from tests.meta.calls import (
    COMPUTED,
    OF_FILES,
    OF_RESULTS,
    OF_SHAFTS,
    PUBLIC,
    REFUSED,
    SPEEDS,
    WITH_PAIRS,
    WITHOUT,
    numbers,
)
from tests.unlike_pairs import unlike_pair
from tests.validation.commands.conftest import run
from validation.cli import app


def _small():
    """The default pair on two short shafts in two bearings each, with few modes."""
    bearings = [{"position": z, "loa_stiffness": 2e8, "oloa_stiffness": 1.5e8} for z in (20, 120)]
    shaft = {"segments": [{"length": 140, "diameter": 30}], "gear_position": 70, "bearings": bearings}
    shafts = {"damping_ratio": 0.02, "max_frequency": 4000, "pinion": shaft, "gear": shaft}
    return lumped.load_gear_pair("nasa_28_28").with_(
        mesh__relief="ignored", mesh__contact="prescribed", mesh__damping_ratio=0.1, shafts=shafts
    )


SMALL = _small()
PAIRS = {"small": SMALL, "unlike": unlike_pair("contact_ratio_2_3_on_shafts")}


def _rows():
    return [*COMPUTED, *REFUSED, *OF_RESULTS, *OF_SHAFTS, *OF_FILES, *WITHOUT]


def test_every_function_that_takes_a_pair_has_one_row():
    assert sorted(_rows()) == WITH_PAIRS


@pytest.mark.parametrize("name", sorted({*COMPUTED, *REFUSED} - {"validation.studies.run_sweep"}))
def test_supports_are_a_keyword_whose_default_is_none(name):
    parameter = inspect.signature(PUBLIC[name]).parameters["supports"]
    assert parameter.default is None
    assert parameter.kind is inspect.Parameter.KEYWORD_ONLY
    assert "supports" in inspect.getdoc(PUBLIC[name])


@pytest.mark.parametrize("name", COMPUTED)
def test_shafts_of_the_file_hold_the_gears_by_default(name, tmp_path):
    call = COMPUTED[name]
    numbers_by_call = {}
    for number, arguments in enumerate(({}, {"supports": "shafts"}, {"supports": "springs"})):
        folder = tmp_path / str(number)
        folder.mkdir()
        numbers_by_call[number] = numbers(call(SMALL, folder, **arguments))
    assert numbers_by_call[0].size
    assert np.array_equal(numbers_by_call[0], numbers_by_call[1])
    assert numbers_by_call[0].shape != numbers_by_call[2].shape or not np.allclose(
        numbers_by_call[0], numbers_by_call[2], rtol=1e-6
    )


@pytest.mark.parametrize("name", COMPUTED)
def test_shafts_that_a_pair_does_not_have_are_refused(name, tmp_path):
    with pytest.raises(ParameterError) as caught:
        COMPUTED[name](without_shafts(SMALL), tmp_path, supports="shafts")
    assert caught.value.problems[0].field.endswith("supports")


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_done_on_shafts_says_so(name, tmp_path):
    call = REFUSED[name]
    for arguments in ({}, {"supports": "shafts"}):
        with pytest.raises(ParameterError) as caught:
            call(SMALL, tmp_path, **arguments)
        (problem,) = caught.value.problems
        assert problem.field == "supports"
        assert problem.value == arguments.get("supports", "left out for a pair with shafts")
        assert '"springs"' in problem.allowed
        assert problem.action == 'Give supports="springs".'
    (tmp_path / "other").mkdir()
    on_springs = numbers(call(SMALL, tmp_path, supports="springs"))
    assert on_springs.size
    assert np.array_equal(on_springs, numbers(call(without_shafts(SMALL), tmp_path / "other")))


@pytest.mark.parametrize("name", WITHOUT)
def test_supports_do_not_enter_elsewhere(name):
    pair = PAIRS["unlike"]
    assert np.array_equal(numbers(WITHOUT[name](pair)), numbers(WITHOUT[name](without_shafts(pair))))


def test_results_name_their_supports():
    chart = floquet.stability_chart(SMALL, {"speed_rpm": SPEEDS}, supports="springs")
    assert chart.attrs["supports"] == "springs"
    assert isinstance(floquet.label_regions(SMALL, chart), list)
    on_shafts = multibody.steady_state(SMALL, samples_per_cycle=8)
    assert on_shafts.attrs["supports"] == "shafts"
    with pytest.raises(ParameterError, match="supports"):
        multibody.motion_balance(SMALL, on_shafts)
    springs = floquet.gear_pair_multipliers(SMALL, supports="springs")
    motion = lumped.steady_state(SMALL, supports="shafts")
    with pytest.raises(ParameterError, match="on springs"):
        validation.validity_flags(SMALL, motion, springs)
    with pytest.raises(ParameterError, match="those of the variation"):
        floquet.gear_block(springs.variation, supports="shafts")


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_springs_are_the_pair_without_its_shafts(pair):
    pair = pair.with_(
        uncertainty={"shafts.pinion.bearings.0.loa_stiffness": "+- 10 %", "mesh.damping_ratio": "+- 10 %"}
    )
    bare = without_shafts(pair)
    assert bare.shafts is None
    assert dict(bare.uncertainty) == {"mesh.damping_ratio": "+- 10 %"}
    assert without_shafts(bare) is bare
    assert with_supports(pair, None) is pair
    assert with_supports(pair, "springs") == bare == on_springs(pair, "springs", "this")
    assert supports_of(pair, None) == "shafts"
    assert supports_of(bare, None) == "springs"
    with pytest.raises(ParameterError, match="one of springs, shafts"):
        supports_of(pair, "walls")


#: Command -> arguments; on the shafts of a pair that has them by default.
COMPUTED_COMMANDS = {
    "simulate": ["--cycles", 1, "--json"],
    "stability": ["--json"],
}
#: Command -> arguments; refused for a pair with shafts unless springs are asked for.
REFUSED_COMMANDS = {
    "crosscheck": ["--cycles", 6],
    "export": ["-o", "pair.npz"],
    "interactive": [],
    "response": [],
    "stability": ["--tongues"],
}
#: Commands whose function is in the tables above, and is called with the option.
BY_FUNCTION = {"calibrate", "check", "compare", "report", "teeth", "uncertainty"}
#: Commands in which supports do not enter, or are in the file.
WITHOUT_COMMANDS = {"floquet", "init", "presets", "reference", "sweep"}


def _options():
    group = typer.main.get_command(app)
    return {name: {o for p in one.params for o in p.opts} for name, one in group.commands.items()}


def test_every_command_has_a_row():
    rows = {*COMPUTED_COMMANDS, *REFUSED_COMMANDS, *BY_FUNCTION, *WITHOUT_COMMANDS}
    assert rows == set(_options())
    for name, options in _options().items():
        assert ("--supports" in options) == (name not in WITHOUT_COMMANDS), name


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("held") / "small.toml"
    path.write_text(SMALL.to_toml())
    return path


@pytest.mark.parametrize("name", COMPUTED_COMMANDS)
def test_commands_take_the_shafts_of_the_file(name, file):
    default, shafts, springs = (
        json.loads(run(name, file, *COMPUTED_COMMANDS[name], *held).stdout)
        for held in ((), ("--supports", "shafts"), ("--supports", "springs"))
    )
    assert default == shafts
    assert default["supports"] == "shafts"
    assert springs["supports"] == "springs"
    assert springs.items() != default.items()


@pytest.mark.parametrize("name", REFUSED_COMMANDS)
def test_commands_say_what_cannot_be_done_on_shafts(name, file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for held in ((), ("--supports", "shafts")):
        found = run(name, file, *REFUSED_COMMANDS[name], *held)
        assert found.exit_code == 2
        assert found.stdout == ""
        assert "--supports" in found.stderr
        assert "Give --supports springs" in found.stderr
    assert not list(tmp_path.iterdir())
