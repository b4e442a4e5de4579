"""Is every public name documented: meaning, arguments, units, source? Does it take a pair by name?"""

import dataclasses
import importlib
import inspect
import pkgutil
import re
import sys

import pytest

import lumped
from lumped.errors import ParameterError

PACKAGES = ("lumped", "multibody", "floquet", "validation")
#: Modules that hold no mathematics of gears, so that there is nothing to cite.
BOOKKEEPING = re.compile(
    r"lumped\.(errors|schema\.(assumed|pair|files))"
    r"|floquet\.engine\.chart"
    r"|validation\.(files|exchange|studies|plots|reporting|commands|interactive|check|reference_cases)\b.*"
    r"|validation\.verification\.(checks|evidence)"
)
SOURCE = re.compile(r"\beqs?\. |\bISO\b|\b(18|19|20)\d\d\b|docs/theory/\w+\.md")
UNIT = re.compile(
    r"\[[^\]]*\]|\bSI\b|\bunits?\b|dimensionless|relative|ratio|share|coefficient|number|in mesh cycles"
)


def public_names():
    """Objects that some package's or subpackage's __all__ names, each once."""
    found = {}
    for root in PACKAGES:
        package = importlib.import_module(root)
        modules = [package] + [
            importlib.import_module(info.name)
            for info in pkgutil.walk_packages(package.__path__, root + ".")
            if info.ispkg
        ]
        for module in modules:
            for name in getattr(module, "__all__", ()):
                thing = getattr(module, name)
                # A function that its package wraps is the same function elsewhere.
                found.setdefault(id(inspect.unwrap(thing)), (f"{module.__name__}.{name}", thing))
    return [pytest.param(thing, id=name) for name, thing in found.values()]


NAMES = public_names()
CALLABLES = [
    p for p in NAMES if inspect.isclass(p.values[0]) or inspect.isroutine(inspect.unwrap(p.values[0]))
]
FUNCTIONS = [p for p in CALLABLES if inspect.isfunction(inspect.unwrap(p.values[0]))]


def text_of(thing):
    """Docstring of a function or class, with those of the base classes."""
    if inspect.isclass(thing):
        own = [c for c in thing.__mro__ if c.__module__.split(".")[0] in PACKAGES]
        return "\n".join(inspect.getdoc(c) or "" for c in own)
    return inspect.getdoc(thing) or ""


def referred(text, thing):
    """The text and those of the public names it sends the reader to, ``see `name` ``."""
    texts = [text]
    for name in re.findall(r"`+([\w.]+)`+", text):
        owner, _, last = name.rpartition(".")
        for module in filter(None, (owner, thing.__module__, thing.__module__.split(".")[0])):
            try:
                other = getattr(importlib.import_module(module), last, None)
            except ImportError:
                continue
            if other is not None and other is not thing:
                texts.append(text_of(other) if callable(other) else "")
    return "\n".join(texts)


@pytest.mark.parametrize("thing", CALLABLES)
def test_has_a_meaning(thing):
    text = inspect.getdoc(thing) or ""
    assert len(text.split("\n")[0]) > 15
    assert not text.startswith(f"{thing.__name__}("), "pydantic's or dataclass' own signature is no docstring"


@pytest.mark.parametrize("thing", FUNCTIONS)
def test_every_argument_is_described(thing):
    parameters = [
        p.name
        for p in inspect.signature(thing).parameters.values()
        if p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)
    ]
    text = referred(text_of(thing), thing)
    for name in parameters:
        # One argument may be described by the sentence that says what the function does with it.
        entry = rf"(?m)^[\w, *]*\b{name}\b[\w, ]*( \([^)]*\))? :" if len(parameters) > 1 else r"\w"
        assert re.search(entry, text), f"{name} is not described"


@pytest.mark.parametrize("thing", [p for p in CALLABLES if dataclasses.is_dataclass(p.values[0])])
def test_every_attribute_is_described(thing):
    text = text_of(thing)
    for field in dataclasses.fields(thing):
        assert field.name.startswith("_") or re.search(rf"\b{field.name}\b", text), field.name


def _carries_numbers(thing):
    if inspect.isclass(thing):
        types = [str(f.type) for f in dataclasses.fields(thing)] if dataclasses.is_dataclass(thing) else []
    else:
        types = [str(inspect.signature(thing).return_annotation)]
    return any(re.search(r"\b(float|FloatArray|ComplexArray)\b", t) for t in types)


@pytest.mark.parametrize("thing", [p for p in CALLABLES if _carries_numbers(p.values[0])])
def test_numbers_have_units(thing):
    assert UNIT.search(text_of(thing)), "no unit, and nothing that says it has none"


@pytest.mark.parametrize("thing", CALLABLES)
def test_a_source_is_named(thing):
    module = sys.modules[inspect.unwrap(thing).__module__]  # where the function is defined
    if not BOOKKEEPING.fullmatch(module.__name__):
        assert SOURCE.search(text_of(thing) + (module.__doc__ or "")), f"name it in {module.__name__}"


@pytest.mark.parametrize("thing", FUNCTIONS)
def test_no_function_swallows_keywords(thing):
    """Without **options Python itself refuses an unknown keyword; those of new_pair are fields."""
    kinds = {p.kind for p in inspect.signature(thing).parameters.values()}
    assert inspect.Parameter.VAR_KEYWORD not in kinds or thing.__name__ == "new_pair"


def test_an_unknown_keyword_raises():
    pair = lumped.load_gear_pair("nasa_28_28")
    with pytest.raises(TypeError, match="cycle"):
        lumped.simulate(pair, cycle=3)
    with pytest.raises(lumped.ParameterError, match="pinion_sped"):
        pair.with_(operating__pinion_sped=1000.0)


ANNOTATIONS = ("AnyPair", "AnyPair | GearVariation", "GearPair | str | Path")


def taking_a_pair():
    for parameter in FUNCTIONS:
        function = inspect.unwrap(parameter.values[0])
        for name, argument in inspect.signature(function).parameters.items():
            # What takes a GearPair alone is called with one that has been read; further pairs have no name.
            if argument.kind is argument.VAR_POSITIONAL:
                continue
            if re.search(r"\bAnyPair\b|GearPair \|", str(argument.annotation)):
                yield pytest.param(function, name, str(argument.annotation), id=parameter.id)


TAKING = list(taking_a_pair())


@pytest.mark.parametrize(("function", "name", "annotation"), TAKING)
def test_what_is_no_pair_is_refused_by_name(function, name, annotation):
    if annotation not in ANNOTATIONS:
        assert function.__name__ in ("figure_records", "load_gear_pair"), annotation
        return
    others = {
        other: None
        for other, argument in inspect.signature(function).parameters.items()
        if argument.default is argument.empty and other != name
        if argument.kind is not argument.VAR_POSITIONAL
    }
    for value in (3, None, 2.5, ["nasa_28_28"], object()):
        with pytest.raises(ParameterError, match=r"pair = .*allowed a preset name"):
            function(**others, **{name: value})
    with pytest.raises(ParameterError, match="Did you mean 'nasa_28_28'"):
        function(**others, **{name: "nasa_2828"})


def test_there_are_many():
    assert len(NAMES) > 150
    assert len(TAKING) > 60
