"""Does every result say what it was made from, and does a tooth that is a femtometre off change any?

Every public function of the table in ``calls`` is called on five kinds of pair. A dataset that it returns or
holds carries the pair, its parameters and their hash, so that ``plot``, ``order_spectrum`` and
``write_results`` take it. What a function does not do for a kind is refused by name.
"""

import dataclasses
import functools
import inspect
import sys
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


#: Shafts whose vibrations fade within few revolutions: that long takes the motion of teeth that differ.
FADING = {
    "shafts.damping_ratio": 0.06,
    "shafts.max_frequency": 3000.0,
    "shafts.motor.coupling_damping": 3.0,
    "shafts.load.coupling_damping": 8.0,
}
#: Kind of pair -> a pair of it. Teeth meet again soon, and laws are quick ones, so that calls are short.
KINDS = {
    "linear": _stated("rack_25_degrees_always_pushing", friction={"law": "coulomb", "coefficient": 0.05}),
    "contact lost": _stated("larger_gear_drives_contact_lost", pinion__teeth=44),
    "shafts": _stated("contact_ratio_2_3_on_shafts", pinion__teeth=30, gear__teeth=60).with_(FADING),
    "own teeth": _stated(
        "unlike_teeth_finite_elements",
        gear__teeth=20,
        operating__speed_range=[1600.0, 1800.0],  # of the interactive page
        pinion__deviations={"index": [4.0, -3.0] + 18 * [0.0]},
        gear__deviations={"index": [2.0] + 18 * [0.0] + [5.0]},
    ),
    "prescribed": _stated("contact_ratio_1_1_large_shifts", gear__teeth=45, mesh__contact="prescribed"),
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


def _prescribed_on_shafts():
    """A pair of another rack and another stiffness on shafts, which another pair has."""
    shafts = KINDS["shafts"].to_mapping()["shafts"]
    teeth = {"gear.teeth": 46, "mesh.contact": "prescribed", "friction": {"law": "iso_14179"}}
    return _stated("rack_25_degrees_always_pushing").with_(teeth | {"shafts": shafts})


@dataclasses.dataclass(frozen=True)
class Form:
    """A contact and supports: pair with like teeth, its kind in ``KINDS``, and which tooth is off and how."""

    pair: lumped.GearPair
    kind: str
    gear: str
    tooth: int
    first_orders: tuple[str, ...]

    def late_by_a_femtometre(self, first_order):
        """The pair with one tooth that is late."""
        index = [0.0] * getattr(self.pair, self.gear).teeth
        index[self.tooth] = 1e-9
        return self.pair.with_({f"{self.gear}.deviations": {"index": index, "first_order": first_order}})


FIRST_ORDERS = ("steps", "eccentricity")
#: Contact and supports -> pairs that are unlike each other. The results of a kind for like teeth are there.
FORMS = {
    "loaded on springs": Form(KINDS["contact lost"], "contact lost", "pinion", 0, FIRST_ORDERS),
    "prescribed on springs": Form(KINDS["prescribed"], "prescribed", "gear", 7, ("eccentricity",)),
    "loaded on shafts": Form(KINDS["shafts"], "shafts", "pinion", 11, ("eccentricity",)),
    "prescribed on shafts": Form(_prescribed_on_shafts(), "", "gear", 5, ("steps",)),
}
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


def _compared(name, found):
    """What is compared: of samples that vary inputs, among them the teeth, those with the inputs as given."""
    if name == "validation.uncertainty":
        return {key: one for key, one in found.attrs.items() if key.startswith("given_")}
    if name == "validation.compare":
        return {key: one for key, one in found.data_vars.items() if key.endswith("_given")}
    if isinstance(found, lumped.GearPair):  # the only results that are pairs have other bearings
        return found.to_mapping()["bearings"]
    return found


def _computed(name, pair, folder, contact):
    """Result or refusal; of samples one."""
    options = {} if contact is None else {"contact": contact}
    with warnings.catch_warnings(), pytest.MonkeyPatch.context() as patch:
        warnings.simplefilter("ignore", LawRangeWarning)
        warnings.simplefilter("ignore", LikeTeethWarning)
        for module in SAMPLED.values():
            patch.setattr(sys.modules[module], "whole_number", lambda *_: 1)
        try:
            return CALLS[name](pair, folder, **options)
        except (ParameterError, NumericalError) as error:
            return error


@pytest.fixture(scope="module")
def like(result, tmp_path_factory):
    """Function: the result of a public function for like teeth; computed once, with those of the kinds."""

    @functools.cache
    def of(form, name, contact):
        kind = FORMS[form].kind
        if kind and contact in (None, _options(name, kind).get("contact", "linear")):
            return result(name, kind)
        return _computed(name, FORMS[form].pair, tmp_path_factory.mktemp("like"), contact)

    return of


def _contacts(name):
    """Values of the argument ``contact``; None where a function has no such argument."""
    return ("linear", "unilateral") if "contact" in inspect.signature(PUBLIC[name]).parameters else (None,)


#: Functions that draw samples -> module. Compared are results with the inputs as given: one sample is drawn.
SAMPLED = {
    name: name.replace(".", ".prediction.") for name in ("validation.compare", "validation.uncertainty")
}
#: What takes teeth as alike does not see how their errors are given.
FEMTOMETRES = [
    (form, name, first_order, contact)
    for form, one in FORMS.items()
    for name in sorted(CALLS.keys() - {REPORT, *OF_THE_TEETH})
    for first_order in (one.first_orders if name in AS_GIVEN - SAMPLED.keys() else one.first_orders[:1])
    for contact in _contacts(name)
]
#: Functions and forms for which teeth that differ are refused, by whatever amount.
OF_LIKE_TEETH = {
    ("multibody.attribution", "loaded on springs"),
    ("multibody.attribution", "loaded on shafts"),
    ("multibody.monodromy", "loaded on springs"),
    ("multibody.monodromy", "prescribed on springs"),
}


@pytest.mark.filterwarnings("ignore::lumped.errors.LikeTeethWarning")
@pytest.mark.parametrize(("form", "name", "first_order", "contact"), FEMTOMETRES)
def test_a_femtometre_moves_no_result_by_a_millionth(like, form, name, first_order, contact, tmp_path):
    own = _computed(name, FORMS[form].late_by_a_femtometre(first_order), tmp_path, contact)
    if (name, form) in OF_LIKE_TEETH:
        assert [one.field for one in own.problems] == ["fidelity"]
        return
    expected = like(form, name, contact)
    if name in (REFUSED if FORMS[form].pair.shafts else OF_SHAFTS):
        assert [one.field for one in own.problems] == ["supports"]
        assert str(own) == str(expected)
        return
    for outcome in (expected, own):
        assert not isinstance(outcome, Exception), outcome
    expected, own = (_compared(name, outcome) for outcome in (expected, own))
    assert leaves(expected) or own == expected == ()  # no friction law is out of its range
    assert moved(expected, own, COUNTS.get(name, ()), MOVED_BY_STEPS.get(name, MOVED)) == {}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("first_order", FIRST_ORDERS)
def test_multipliers_of_a_revolution_are_those_of_a_cycle_many_times(form, first_order):
    pair = FORMS[form].late_by_a_femtometre(first_order)
    found = floquet.revolution_multipliers(pair)
    one = floquet.gear_pair_multipliers(FORMS[form].pair).multipliers
    cycles = getattr(pair, FORMS[form].gear).teeth
    assert found.cycles == cycles
    size = np.abs(one**cycles).max()
    for value in found.multipliers:
        assert np.abs(one**cycles - value).min() < 1e-6 * size
