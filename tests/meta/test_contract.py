"""Does every result say what it was made from, and does a tooth that is a femtometre off change any?

Every public function of the table in ``calls`` is called on five kinds of pair. A dataset that it returns or
holds carries the pair, its parameters and their hash, so that ``plot``, ``order_spectrum`` and
``write_results`` take it. What a function does not do for a kind is refused by name.
"""

import dataclasses
import functools
import inspect
import tomllib
import warnings
from collections.abc import Iterator
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
import xarray as xr

import floquet
import lumped
import spurcheck
from lumped.errors import LawRangeWarning, LikeTeethWarning, NumericalError, ParameterError
from lumped.labelling import parameters_hash
from lumped.model.periodic_system import LTVSystem, supports_of
from lumped.model.results import PlainMotion
from tests.meta.calls import CHANGES, COMPUTED, OF_SHAFTS, PUBLIC, REFUSED, WITHOUT, numbers
from tests.unlike_pairs import unlike_pair
from validation.exchange import read_netcdf
from validation.exchange import results as result_files

CALLS = {**COMPUTED, **REFUSED, **WITHOUT, **OF_SHAFTS}
#: Whole reports are tested where they stand; here they would take most of the time.
REPORT = "validation.report"


def _stated(name, **changes):
    """Return an unlike pair with known values only, so that no input is uncertain."""
    return unlike_pair(name).with_(**changes).with_(assumed={})


#: Kind of pair -> a pair of it.
KINDS = {
    "linear": _stated("rack_25_degrees_always_pushing"),
    "contact lost": _stated("larger_gear_drives_contact_lost"),
    "shafts": _stated("contact_ratio_2_3_on_shafts"),
    "own teeth": _stated(
        "unlike_teeth_finite_elements",
        gear__teeth=20,
        operating__speed_range=[1600.0, 1800.0],  # of the interactive page
        pinion__deviations={"index": [4.0, -3.0] + 18 * [0.0]},
        gear__deviations={"index": [2.0] + 18 * [0.0] + [5.0]},
    ),
    "prescribed": _stated("contact_ratio_1_1_large_shifts", mesh__contact="prescribed"),
}
#: Functions whose result is of the teeth as given; the others take them as alike.
AS_GIVEN = {
    "lumped.meeting_teeth", "lumped.run_up", "lumped.simulate", "lumped.speed_sweep", "lumped.static_sharing",
    "lumped.steady_state",
    "lumped.tooth_gaps", "multibody.simulate", "multibody.speed_sweep", "multibody.steady_state",
    "validation.check.check", "validation.predict", "validation.compare",
    "validation.studies.run_sweep", "validation.uncertainty",
}  # fmt: skip
#: (function, kind) -> field that the refusal names; "" where a computation has no answer.
NOT_DONE = {
    **{(name, "shafts"): "supports" for name in REFUSED},
    **{(name, kind): "supports" for name in OF_SHAFTS for kind in KINDS if kind != "shafts"},
    ("multibody.attribution", "contact lost"): "",
    ("multibody.attribution", "own teeth"): "fidelity",
    ("multibody.monodromy", "own teeth"): "fidelity",
}
#: Functions whose datasets have no figure of their own.
NO_FIGURE = {
    "lumped.losses.losses_of_laws", "lumped.meeting_teeth", "lumped.path_of_contact.friction_profile",
    "lumped.shaft_modes", "lumped.stiffness_components", "lumped.tooth_gaps",
    "multibody.attribution", "floquet.stability_boundaries", "floquet.stability_margins",
    "validation.calibrate.calibrate", "validation.check.check",
    "validation.studies.run_sweep", "validation.uncertainty", "validation.write_interactive_page",
}  # fmt: skip


def datasets(value: Any, path: str = "") -> Iterator[tuple[str, xr.Dataset]]:
    """All datasets that a result is or holds, with where they stand."""
    if isinstance(value, xr.Dataset):
        yield path, value
    elif isinstance(value, dict):
        for key, one in value.items():
            yield from datasets(one, f"{path}[{key}]")
    elif isinstance(value, (list, tuple)):
        for key, one in enumerate(value):
            yield from datasets(one, f"{path}[{key}]")
    elif dataclasses.is_dataclass(value) and not isinstance(value, lumped.GearPair):
        for field in dataclasses.fields(value):
            yield from datasets(getattr(value, field.name), f"{path}.{field.name}")
        for name in _properties(type(value), ("xr.Dataset",)):
            yield from datasets(getattr(value, name), f"{path}.{name}")


def _properties(owner: type, annotations: tuple[str, ...]) -> list[str]:
    """Return the names of the public properties with one of the return annotations."""
    names = []
    for name, member in inspect.getmembers(owner):
        function = member.fget if isinstance(member, property) else None
        if isinstance(member, functools.cached_property):
            function = member.func
        if function is not None and not name.startswith("_"):
            annotation = inspect.signature(function).return_annotation
            if annotation in annotations:
                names.append(name)
    return names


def changed(name: str, pair: lumped.GearPair) -> lumped.GearPair:
    """The pair as the call of the table varies it."""
    return pair.with_(CHANGES[name]) if name in CHANGES else pair


def _options(name: str, kind: str) -> dict[str, str]:
    """Contact is lost in the lumped model where it is unilateral."""
    takes = "contact" in inspect.signature(PUBLIC[name]).parameters
    return {"contact": "unilateral"} if kind == "contact lost" and takes else {}


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """Return a function: (name of a public function, kind of pair) -> result or refusal, computed once."""
    results = {}

    def of(name, kind):
        if (name, kind) not in results:
            folder = tmp_path_factory.mktemp("call")
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", LawRangeWarning)
                warnings.simplefilter("ignore", LikeTeethWarning)
                try:
                    value = CALLS[name](KINDS[kind], folder, **_options(name, kind))
                except (ParameterError, NumericalError) as error:
                    value = error
            results[name, kind] = value
        return results[name, kind]

    return of


NAMES = sorted(CALLS.keys() - {REPORT})


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", NAMES)
def test_a_function_returns_a_result_or_names_what_it_refuses(result, name, kind):
    outcome = result(name, kind)
    if (name, kind) in NOT_DONE:
        field = NOT_DONE[name, kind]
        assert isinstance(outcome, ParameterError if field else NumericalError)
        assert {one.field for one in getattr(outcome, "problems", ())} == ({field} if field else set())
    else:
        assert not isinstance(outcome, Exception), outcome


def _expected(name, kind, outcome):
    """Return the pair of a result. A comparison with a record is at the operating point of the record."""
    pair = changed(name, KINDS[kind])
    if name == "validation.check.check":
        at_record = outcome.pair
        ours = pair.to_mapping()
        theirs = at_record.to_mapping()
        for key in ("operating", "sources", "assumed"):
            for data in (ours, theirs):
                data.pop(key, None)
        assert theirs == ours
        return at_record
    return pair


def file_form(data: xr.Dataset) -> tuple[Any, ...]:
    """What decides how a dataset is written: names, dimensions and types of variables and attributes."""

    def attributes(attrs: dict[Any, Any]) -> tuple[Any, ...]:
        arrays = {key: np.asarray(one) for key, one in attrs.items()}
        return tuple((key, type(attrs[key]), one.dtype.kind, one.ndim) for key, one in arrays.items())

    def kinds(one: xr.Variable) -> set[type]:
        return {type(value) for value in one.values.flat} if one.dtype == object else set()

    variables = tuple(
        (name, one.dims, one.dtype, frozenset(kinds(one)), 0 in one.shape, attributes(one.attrs))
        for name, one in data.variables.items()
    )
    return variables, attributes(data.attrs)


@pytest.fixture(scope="module")
def read_forms():
    """Forms of datasets that were written and read: one of each form."""
    return set()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", NAMES)
def test_every_dataset_says_what_it_was_made_from(result, name, kind, tmp_path, read_forms, monkeypatch):
    # The process that reads first guards against damaged files; each file costs it half a second.
    monkeypatch.setattr(result_files, "check_hdf5", lambda *_: None)
    outcome = result(name, kind)
    if isinstance(outcome, Exception):
        return
    pair = _expected(name, kind, outcome)
    for number, (path, data) in enumerate(datasets(outcome)):
        attributes = data.attrs
        made_with = spurcheck.load_gear_pair(tomllib.loads(attributes["parameters"]))
        assert made_with == pair or (attributes["teeth"] == "alike" and made_with == pair.healthy), path
        assert attributes["parameters_sha256"] == parameters_hash(made_with), path
        assert attributes["gear_pair"] == pair.name, path
        unlike_teeth = kind == "own teeth" and name in AS_GIVEN
        assert attributes["teeth"] == ("as given" if unlike_teeth else "alike"), path
        if "supports" in inspect.signature(PUBLIC[name]).parameters or name.endswith("run_sweep"):
            assert attributes["supports"] == supports_of(pair, None), path
        if "time" in data.dims:
            _check_motion(name, data, _options(name, kind))
        form = file_form(data)
        if form in read_forms:
            continue
        read_forms.add(form)
        file = tmp_path / f"{number}.nc"
        spurcheck.write_results(data, file)
        compared_keys = (
            "parameters",
            "parameters_sha256",
            "gear_pair",
            "teeth",
            "supports",
            "contact",
            "fidelity",
        )
        read = read_netcdf(file).attrs
        assert {key: read[key] for key in compared_keys if key in attributes} == {
            key: attributes[key] for key in compared_keys if key in attributes
        }


def _check_motion(name, data, options):
    """Check that a motion states contact or fidelity, and that the spectrum states the pair."""
    if "contact" in inspect.signature(PUBLIC[name]).parameters:
        assert data.attrs["contact"] == options.get("contact", "linear")
    if data.attrs["model"] == "multibody":
        assert data.attrs["fidelity"] in ("linear", "exact")
    else:
        assert data.attrs["contact"] in ("linear", "unilateral")
    cycle = spurcheck.load_gear_pair(tomllib.loads(data.attrs["parameters"])).geometry.mesh_period
    times = data["time"].to_numpy()
    if round(times[-1] / cycle * 1e6) % 1_000_000 == 0:  # a run ends with the first time of the next cycle
        data = data.isel(time=slice(-1))
    spectrum = spurcheck.order_spectrum(data)
    assert spectrum.attrs["parameters"] == data.attrs["parameters"]
    mean = float(spectrum["amplitude"].sel(order=0))
    if name == "lumped.run_up":  # over the angle, not over time
        return
    assert mean == pytest.approx(abs(float(data["dte"].mean())), rel=1e-9)


@pytest.mark.filterwarnings("ignore::lumped.errors.LikeTeethWarning")
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", NAMES)
def test_every_dataset_has_its_figure(result, name, kind):
    found = result(name, kind)
    if isinstance(found, Exception):
        return
    for path, data in datasets(found):
        if name in NO_FIGURE and "time" not in data.dims:  # a motion in a result has the figure of a motion
            with pytest.raises(ParameterError, match="result"):
                spurcheck.plot(data)
        else:
            figure = spurcheck.plot(data)
            assert figure.axes, path
            plt.close(figure)


@pytest.mark.parametrize("name", NAMES)
def test_every_result_has_a_short_text(result, name):
    """At the prompt a result takes at most twenty lines; xarray and NumPy have texts of their own."""
    outcome = result(name, "linear")
    if isinstance(outcome, (xr.Dataset, xr.DataArray, np.ndarray, list)):  # a list is arrays of the table
        return
    text = repr(outcome)
    assert len(text.splitlines()) <= 20, text[:3000]
    assert len(text) <= 2500, text[:3000]


#: Pair with like teeth and contact loss, whose teeth meet again after few cycles.
HEALTHY = _stated("larger_gear_drives_contact_lost", pinion__teeth=44)
FIRST_ORDERS = ("steps", "eccentricity")
#: What no deviation moves in proportion: errors of the methods, and the energy that is left by rounding.
OF_THE_METHOD = ("error", "mesh_jump", "closure", "residual", "seconds", "unsettled", "settings")
#: Functions about the numbers of the teeth, or about the deviations themselves.
OF_THE_TEETH = {"lumped.meeting_teeth", "lumped.revolution", "lumped.tooth_gaps"}
#: Function -> numbers that count teeth or cycles, or are of the whole period, as pairs of teeth meet.
COUNTS = {
    "floquet.revolution_multipliers": (".cycles", ".multipliers", ".rates"),
    "lumped.static_sharing": (".pinion_tooth", ".gear_tooth", ".largest_load"),
    "validation.predict": (".mesh_cycles",),
    # The curves are others; teeth that differ have no motion of the second program.
    "validation.check.check": (
        ".problem",
        ".second",
        ".channels",
        ".misfit",
        ".discrepancy",
        ".agrees",
        ".nearer",
    ),
}


def leaves(value: Any, path: str = "") -> dict[str, Any]:
    """Numbers and arrays of a result by name; of a dataset its variables, to be repeated over cycles."""
    if isinstance(value, PlainMotion):
        value = value.dataset
    if isinstance(value, xr.Dataset):
        found = {f"{path}.{name}": one for name, one in value.data_vars.items()}
        return found | {f"{path}@{key}": one for key, one in value.attrs.items() if isinstance(one, float)}
    if isinstance(value, (floquet.PeriodicSystem, floquet.RankOneSystem, LTVSystem)):
        return {path: numbers(value)}
    if isinstance(value, lumped.GearPair):
        return {}
    if isinstance(value, dict):
        return {k: v for key, one in value.items() for k, v in leaves(one, f"{path}[{key}]").items()}
    if isinstance(value, (list, tuple)):
        return {k: v for n, one in enumerate(value) for k, v in leaves(one, f"{path}[{n}]").items()}
    if dataclasses.is_dataclass(value):
        kinds = ("float", "bool", "FloatArray", "ComplexArray", "dict[str, float]", "xr.Dataset")
        names = [field.name for field in dataclasses.fields(value)] + _properties(type(value), kinds)
        return {k: v for name in names for k, v in leaves(getattr(value, name), f"{path}.{name}").items()}
    array = np.asarray(value)
    return {path: array} if array.dtype.kind in "bifc" else {}


#: A femtometre moves results by less than this share of themselves.
MOVED = 1e-6
#: Runs with adaptive steps, whose tolerance is 1e-8 of a state: the elastic energy of the mesh is the small
#: difference of states, 1e-5 of the work done, and its last digits follow the steps.
MOVED_BY_STEPS = {"multibody.power_balance": 5e-6}


def _repeated(like: Any, own: Any) -> tuple[Any, Any]:
    """Both as arrays, the first over the cycles of the second."""
    if isinstance(own, xr.DataArray):
        own = own.transpose(*like.dims).to_numpy()
        like = like.to_numpy()
    like = np.asarray(like)
    own = np.asarray(own)
    return np.tile(like, [b // a if a else 1 for a, b in zip(like.shape, own.shape, strict=True)]), own


def moved(like: Any, own: Any, counts: tuple[str, ...] = (), limit: float = MOVED) -> dict[str, float]:
    """Name of what differs by more than ``limit`` of itself -> by how much."""
    before = leaves(like)
    after = leaves(own)
    found = {}
    for name, value in before.items():
        of_the_method = any(word in name.replace("transmission_error", "") for word in OF_THE_METHOD)
        if of_the_method or name.startswith(counts):
            continue
        if name not in after:
            found[name] = np.nan
            continue
        a, b = _repeated(value, after[name])
        if a.shape != b.shape or a.dtype.kind not in "bifc":
            if a.shape != b.shape:
                found[name] = np.inf
            continue
        if not a.size:
            continue
        a, b = (np.nan_to_num(one.astype(complex), nan=-1.0) for one in (a, b))
        largest = np.abs(a).max()
        span = np.abs(a - a.ravel()[0]).max()
        size = span if span > 1e-9 * largest else largest
        difference = np.abs(a - b).max()
        if difference > limit * size:
            found[name] = float(difference / size) if size else np.inf
    return found


def _numbers_as_given(name, found):
    """Of samples that vary inputs, among them the teeth, the result with the inputs as given."""
    if name == "validation.uncertainty":
        return {key: one for key, one in found.attrs.items() if key.startswith("given_")}
    if name == "validation.compare":
        return {key: one for key, one in found.data_vars.items() if key.endswith("_given")}
    return found


@pytest.fixture(scope="module")
def like(tmp_path_factory):
    """Function: the result of a public function for like teeth; computed once."""

    @functools.cache
    def of(name):
        return _computed(name, HEALTHY, tmp_path_factory.mktemp("like"))

    return of


def _computed(name, pair, folder):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        warnings.simplefilter("ignore", LikeTeethWarning)
        return _numbers_as_given(name, CALLS[name](pair, folder))


#: What takes teeth as alike does not see how their errors are given.
FEMTOMETRES = [
    (name, first_order)
    for name in sorted(CALLS.keys() - {REPORT, *OF_SHAFTS, *OF_THE_TEETH})
    for first_order in (FIRST_ORDERS if name in AS_GIVEN else FIRST_ORDERS[:1])
]


@pytest.mark.filterwarnings("ignore::lumped.errors.LikeTeethWarning")
@pytest.mark.parametrize(("name", "first_order"), FEMTOMETRES)
def test_a_femtometre_moves_no_result_by_a_millionth(like, name, first_order, tmp_path):
    index = [1e-9] + [0.0] * (HEALTHY.pinion.teeth - 1)
    pair = HEALTHY.with_({"pinion.deviations": {"index": index, "first_order": first_order}})
    if field := NOT_DONE.get((name, "own teeth")):
        with pytest.raises(ParameterError, match=field):
            _computed(name, pair, tmp_path)
        return
    found = _computed(name, pair, tmp_path)
    assert moved(like(name), found, COUNTS.get(name, ()), MOVED_BY_STEPS.get(name, MOVED)) == {}


@pytest.mark.parametrize("first_order", FIRST_ORDERS)
def test_multipliers_of_a_revolution_are_those_of_a_cycle_many_times(first_order):
    index = [1e-9] + [0.0] * (HEALTHY.pinion.teeth - 1)
    pair = HEALTHY.with_({"pinion.deviations": {"index": index, "first_order": first_order}})
    found = floquet.revolution_multipliers(pair)
    one = floquet.gear_pair_multipliers(HEALTHY).multipliers
    assert found.cycles == 44
    size = np.abs(one**44).max()
    for value in found.multipliers:
        assert np.abs(one**44 - value).min() < 1e-6 * size
