"""`[shafts]` in the file means shafts in every function and command, unless springs are asked for.

Every public function that takes a pair has one row here. It computes on the shafts by default, or it refuses
a pair with shafts and names ``supports``, or supports do not enter. A function without a row fails.
"""

import dataclasses
import inspect
import json
from collections.abc import Mapping

import numpy as np
import pytest
import typer
import xarray as xr

import floquet
import lumped
import multibody
import validation
from lumped.errors import ParameterError
from lumped.model.periodic_system import LTVSystem, on_springs, supports_of, with_supports, without_shafts
from tests.meta.test_public_names import FUNCTIONS
from tests.unlike_pairs import unlike_pair
from tests.validation.commands.conftest import run
from tests.validation.measurements.synthetic import synthetic_measurement
from validation import exchange, measurements, studies
from validation.cli import app
from validation.interactive.results import Sampling

PUBLIC = {one.id: one.values[0] for one in FUNCTIONS}
#: Words of an annotation by which a function gets a pair, or what holds one.
_PAIRS = ("GearPair", "GearVariation", "AnyPair", "Study", "ResponseBranches")


def _takes_a_pair(function):
    signature = inspect.signature(function)
    return any(
        word in str(one.annotation) for one in signature.parameters.values() for word in _PAIRS
    ) or not {"pair", "supports"}.isdisjoint(signature.parameters)


WITH_PAIRS = sorted(name for name, function in PUBLIC.items() if _takes_a_pair(function))


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
SPEEDS = [2000.0, 2600.0]
ENDS = (2000.0, 2100.0)


def numbers(value):
    """All numbers of a result in one array, whatever holds them."""
    if isinstance(value, xr.Dataset):
        return numbers([value[name].to_numpy() for name in value.data_vars])
    if isinstance(value, xr.DataArray):
        return numbers(value.to_numpy())
    if isinstance(value, Mapping):
        return numbers(list(value.values()))
    if isinstance(value, (list, tuple)):
        return np.concatenate([np.zeros(0), *map(numbers, value)])
    if isinstance(value, floquet.PeriodicSystem):
        return numbers(value.evaluate(np.array([0.3]) * value.period))
    if isinstance(value, floquet.RankOneSystem):
        return numbers([value.stiffness, value.damping, value.v])
    if isinstance(value, LTVSystem):
        return numbers([value.constant, value.deflection])
    if isinstance(value, lumped.GearPair):
        return np.zeros(0)
    if dataclasses.is_dataclass(value):
        return numbers([getattr(value, field.name) for field in dataclasses.fields(value)])
    array = np.asarray(value)
    if array.dtype.kind not in "biufc":
        return np.zeros(0)
    array = array.astype(complex).ravel()
    return np.nan_to_num(np.concatenate([array.real, array.imag]), nan=-1.0)


def _study(pair, supports, folder):
    """Results of a study of two speeds."""
    settings = {"samples_per_cycle": 32} | ({} if supports is None else {"supports": supports})
    study = studies.load_study(
        {
            "name": "held",
            "gear_pair": pair.to_mapping(),
            "analysis": "lumped",
            "outputs": ["dte_rms"],
            "axes": [{"field": "operating.pinion_speed", "values": SPEEDS}],
            "settings": settings,
        }
    )
    studies.run_sweep(study, folder / "sweep", workers=0)
    return studies.read_results(folder / "sweep")


def _record(pair):
    """A record of tooth forces, whatever holds the gears of the pair that it is compared with."""
    truth = measurements.predict(without_shafts(pair), recurrence=7)
    return synthetic_measurement(truth, seed=1, engagements=10)


def _boundaries(pair, **held):
    undamped = pair.with_(mesh__damping_ratio=0.0)
    found = floquet.stability_boundaries(undamped, ENDS, nodes=20, orders=2, **held)
    return found, found.attrs["supports"] == "shafts"


#: Function -> call that gives its numbers, of a pair with ``supports`` where they are given; on the shafts of
#: a pair that has them by default. ``folder`` is empty.
COMPUTED = {
    "lumped.natural_frequencies": lambda pair, folder, **held: lumped.natural_frequencies(pair, **held),
    "lumped.periodic_system": lambda pair, folder, **held: lumped.periodic_system(pair, **held),
    "lumped.run_up": lambda pair, folder, **held: lumped.run_up(pair, ENDS, 0.01, **held),
    "lumped.simulate": lambda pair, folder, **held: lumped.simulate(pair, 2, samples_per_cycle=16, **held),
    "lumped.speed_sweep": lambda pair, folder, **held: lumped.speed_sweep(pair, SPEEDS, **held),
    "lumped.steady_state": lambda pair, folder, **held: lumped.steady_state(pair, **held),
    "multibody.attribution": lambda pair, folder, **held: multibody.attribution(pair, **held),
    "multibody.simulate": lambda pair, folder, **held: multibody.simulate(
        pair, 1, samples_per_cycle=8, **held
    ),
    "multibody.steady_state": lambda pair, folder, **held: multibody.steady_state(
        pair, samples_per_cycle=8, **held
    ),
    "floquet.gear_block": lambda pair, folder, **held: floquet.gear_block(pair, **held),
    "floquet.gear_pair_multipliers": lambda pair, folder, **held: floquet.gear_pair_multipliers(pair, **held),
    "floquet.gear_pair_system": lambda pair, folder, **held: floquet.gear_pair_system(pair, **held),
    "floquet.predicted_lines": lambda pair, folder, **held: floquet.predicted_lines(pair, 2, **held),
    "floquet.revolution_multipliers": lambda pair, folder, **held: floquet.revolution_multipliers(
        pair, **held
    ),
    "floquet.stability_boundaries": lambda pair, folder, **held: _boundaries(pair, **held),
    "floquet.stability_chart": lambda pair, folder, **held: floquet.stability_chart(
        pair, {"speed_rpm": SPEEDS}, **held
    ),
    "validation.dynamic_factor": lambda pair, folder, **held: validation.dynamic_factor(pair, **held),
    "validation.predict": lambda pair, folder, **held: validation.predict(pair, **held).cycle,
    "validation.report": lambda pair, folder, **held: _page_one(pair, folder, **held),
    "validation.uncertainty": lambda pair, folder, **held: validation.uncertainty(
        pair.with_(uncertainty={"mesh.damping_ratio": "+- 10 %"}), 16, **held
    ),
    "validation.exchange.compare_matrices": lambda pair, folder, **held: exchange.compare_matrices(
        pair, np.eye(2), 1e9 * np.array([[2.0, -1.0], [-1.0, 1.0]]), **held
    ),
    "validation.measurements.evaluate": lambda pair, folder, **held: (
        measurements.evaluate(_record(pair), pair, shift=0.0, **held).points
    ),
    "validation.measurements.predict": lambda pair, folder, **held: measurements.predict(pair, **held).cycle,
    "validation.studies.run_sweep": lambda pair, folder, supports=None: _study(pair, supports, folder),
}
#: Function -> call; refused for a pair with shafts unless springs are asked for.
REFUSED = {
    "multibody.monodromy": lambda pair, folder, **held: multibody.monodromy(pair, fidelity="linear", **held),
    "multibody.power_balance": lambda pair, folder, **held: multibody.power_balance(pair, 1, **held),
    "multibody.speed_sweep": lambda pair, folder, **held: multibody.speed_sweep(
        pair, SPEEDS[:1], settle=0, cycles=1, samples_per_cycle=8, **held
    ),
    "floquet.campbell": lambda pair, folder, **held: floquet.campbell(pair, SPEEDS, **held),
    "floquet.jump_map": lambda pair, folder, **held: floquet.jump_map(
        pair, {"speed_rpm": SPEEDS, "torque": [60.0]}, (1,), **held
    ),
    "floquet.long_run": lambda pair, folder, **held: floquet.long_run(
        pair, settle_cycles=1, cycles=64, **held
    ),
    "floquet.periodic_orbit": lambda pair, folder, **held: floquet.periodic_orbit(pair, **held),
    "floquet.response_branches": lambda pair, folder, **held: (
        floquet.response_branches(pair, ENDS, (1,), seeds=0, **held).dataset
    ),
    "floquet.stability_margins": lambda pair, folder, **held: floquet.stability_margins(pair, ENDS, **held),
    "validation.crosscheck": lambda pair, folder, **held: (
        validation.crosscheck(pair, cycles=6, samples_per_cycle=32, fidelities=("linear",), **held).lumped
    ),
    "validation.write_interactive_page": lambda pair, folder, **held: _page(pair, folder, **held),
    "validation.exchange.write_state_space": lambda pair, folder, **held: _matrices(pair, folder, **held),
}
#: Functions that take a result, which names its supports.
OF_RESULTS = {
    "floquet.jumps_removed_by",
    "floquet.label_regions",
    "multibody.motion_balance",
    "validation.validity_flags",
}
#: Functions that describe the shafts themselves.
OF_SHAFTS = {"lumped.condensed_bearings", "lumped.shaft_modes"}
#: Functions that return, read or write a pair with all its values.
OF_FILES = {
    "lumped.load_gear_pair",
    "lumped.quasi_static.with_tip_relief",
    "validation.exchange.write_rexs",
    "validation.studies.load_study",
}
#: Function -> call of its numbers, in which supports do not enter: geometry, stiffness, friction, statics.
WITHOUT = {
    name: lambda pair, name=name: PUBLIC[name](pair)
    for name in (
        "lumped.bodies", "lumped.geometry", "lumped.meeting_teeth", "lumped.mesh_cycle",
        "lumped.mesh_elements", "lumped.mesh_stiffness", "lumped.revolution",
        "lumped.static_transmission_error", "lumped.stiffness_components", "lumped.tooth_gaps",
        "lumped.losses.iso_14179_mesh_loss", "lumped.losses.iso_14179_of", "lumped.losses.loss_factor",
        "lumped.losses.losses_of_laws", "lumped.losses.ohlendorf_of", "lumped.losses.quasi_static_losses",
        "lumped.path_of_contact.contact_path", "lumped.path_of_contact.friction_path_function",
        "lumped.path_of_contact.friction_profile", "lumped.path_of_contact.law_range_violations",
        "lumped.path_of_contact.pair_stiffness",
    )
}  # fmt: skip
WITHOUT |= {
    "lumped.optimal_relief": lambda pair: lumped.optimal_relief(pair),
    "lumped.plane_compliance": lambda pair: lumped.plane_compliance(pair),
    "lumped.static_sharing": lambda pair: lumped.static_sharing(pair),
    "lumped.quasi_static.mesh_positions": lambda pair: PUBLIC["lumped.quasi_static.mesh_positions"](pair),
}


def _page_one(pair, folder, **held):
    """Numbers of page 1 of a quick report."""
    written = validation.report(pair, folder / "report", quick=True, force=True, **held)
    return [row.value for row in written.first.numbers]


def _page(pair, folder, **held):
    """Numbers of a coarse interactive page."""
    sampling = Sampling(speeds=3, dampings=2, slices=2, sweep_speeds=3)
    page = validation.write_interactive_page(pair, folder / "page.html", sampling=sampling, **held)
    return exchange.read_netcdf(page.with_suffix(".nc"))


def _matrices(pair, folder, **held):
    path = exchange.write_state_space(pair, folder / "pair.npz", **held)
    with np.load(path) as file:
        return [file[name] for name in "ABCD"]


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
    found = {}
    for number, held in enumerate(({}, {"supports": "shafts"}, {"supports": "springs"})):
        folder = tmp_path / str(number)
        folder.mkdir()
        found[number] = numbers(call(SMALL, folder, **held))
    assert found[0].size
    assert np.array_equal(found[0], found[1])
    assert found[0].shape != found[2].shape or not np.allclose(found[0], found[2], rtol=1e-6)


@pytest.mark.parametrize("name", COMPUTED)
def test_shafts_that_a_pair_does_not_have_are_refused(name, tmp_path):
    with pytest.raises(ParameterError) as caught:
        COMPUTED[name](without_shafts(SMALL), tmp_path, supports="shafts")
    assert caught.value.problems[0].field.endswith("supports")


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_done_on_shafts_says_so(name, tmp_path):
    call = REFUSED[name]
    for held in ({}, {"supports": "shafts"}):
        with pytest.raises(ParameterError) as caught:
            call(SMALL, tmp_path, **held)
        (problem,) = caught.value.problems
        assert problem.field == "supports"
        assert problem.value == held.get("supports", "left out for a pair with shafts")
        assert '"springs"' in problem.allowed
        assert problem.action == 'Give supports="springs".'
    (tmp_path / "other").mkdir()
    asked = numbers(call(SMALL, tmp_path, supports="springs"))
    assert asked.size
    assert np.array_equal(asked, numbers(call(without_shafts(SMALL), tmp_path / "other")))


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
BY_FUNCTION = {"report", "uncertainty", "teeth"}
#: Commands in which supports do not enter, or are in the file.
WITHOUT_COMMANDS = {"floquet", "init", "presets", "sweep"}


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
