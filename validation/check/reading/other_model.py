"""A model of somebody else that can be run: a Python function of the parameters of a pair."""

from __future__ import annotations

import importlib.util
import inspect
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from lumped.arguments import nearest, whole_number
from lumped.errors import ParameterError, refuse, shown
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from validation.check.curves import Curves, ValuesOverSpeed
from validation.check.reading.objects import read_object

#: Finest division of a step.
_MOST_REFINED = 1024


@dataclass(frozen=True)
class OtherModel:
    """A model of somebody else that can be run for any pair.

    The function gets the parameters of the pair as a nested mapping: the sections and names of a parameter
    file, numbers in the units of the file (``parameters["pinion"]["teeth"]``,
    ``parameters["operating"]["pinion_torque"]`` in N m). Three more sections are in SI: "geometry" with the
    fields of ``lumped.Geometry``, "bodies" with masses and inertias, and "si" with ``pinion_speed`` [rad/s],
    ``pinion_torque`` [N m], ``module`` [m] and ``pressure_angle`` [rad]. The function returns a
    mapping from names to arrays, a data frame or a dataset.

    Attributes
    ----------
    name : name of the function
    function : the function
    can_refine : whether the function has a keyword "refine", an integer by which it divides its step
    """

    name: str
    function: Callable[..., Any]
    can_refine: bool

    def curves(self, pair: GearPair, refine: int = 1) -> Curves | ValuesOverSpeed:
        """Run the model for a pair and read what it returns.

        Parameters
        ----------
        pair : the pair
        refine : number by which the model divides its step; 1: the step of the model

        Raises
        ------
        ParameterError : ``refine`` without a keyword of this name, an error inside the function, or a result
            that cannot be read
        """
        divided = whole_number("refine", refine, 1, _MOST_REFINED)
        if divided > 1 and not self.can_refine:
            action = "Write def f(parameters, refine=1), and divide the step by refine."
            raise refuse("refine", divided, "1 for a function without the keyword refine", action)
        keywords = {"refine": divided} if self.can_refine else {}
        try:
            result = self.function(parameters_of(pair), **keywords)
        except ParameterError:
            raise
        except Exception as error:
            why = f"{type(error).__name__}: {error}"
            action = "Run the function alone with the parameters of the pair, and correct it."
            raise refuse(self.name, why, "a function that runs", action) from error
        if result is None or callable(result):
            action = "Return {'time': t, 'dte': dte}."
            raise refuse(self.name, f"returns {shown(result)}", "a mapping from names to arrays", action)
        return read_object(result, pair, self.name)


def parameters_of(pair: GearPair) -> dict[str, Any]:
    """Return the parameters of a pair as a nested mapping; see ``OtherModel``."""
    return {
        **pair.to_mapping(),
        "geometry": _bare(asdict(pair.geometry)),
        "bodies": _bare(asdict(bodies_of(pair))),
        "si": {
            "pinion_speed": float(pair.operating.pinion_speed),
            "pinion_torque": float(pair.operating.pinion_torque),
            "module": float(pair.basic_rack.module),
            "pressure_angle": float(pair.basic_rack.pressure_angle),
        },
    }


def _bare(fields: dict[str, Any]) -> dict[str, Any]:
    """Numbers without the unit that a number of a pair carries."""
    return {name: float(value) if isinstance(value, float) else value for name, value in fields.items()}


def other_model(theirs: Any) -> OtherModel | None:
    """Return the model of a function, or of a text "path/to/model.py:function".

    None: the argument is neither, but a source of data.

    Raises
    ------
    ParameterError : the module cannot be imported, or has no such function
    """
    if isinstance(theirs, (str, Path)):
        path, separator, name = str(theirs).rpartition(":")
        if separator and path.lower().endswith(".py"):
            return _model(_of_module(Path(path), name), str(theirs))
        if str(theirs).lower().endswith(".py"):
            functions = _functions(_module(Path(theirs)))
            action = f"Type {theirs}:{functions[0]}" if functions else "Write a function f(parameters)."
            allowed = "the name of a function behind a colon"
            raise refuse("theirs", str(theirs), allowed, f"{action}. Functions: {', '.join(functions)}.")
        return None
    if callable(theirs) and not isinstance(theirs, type) and not hasattr(theirs, "data_vars"):
        return _model(theirs, getattr(theirs, "__name__", type(theirs).__name__))
    return None


def _model(function: Callable[..., Any], name: str) -> OtherModel:
    try:
        parameters = inspect.signature(function).parameters
    except (TypeError, ValueError):
        return OtherModel(name, function, False)
    required = [
        one.name
        for one in parameters.values()
        if one.default is one.empty and one.kind in (one.POSITIONAL_ONLY, one.POSITIONAL_OR_KEYWORD)
    ]
    required += [
        one.name for one in parameters.values() if one.default is one.empty and one.kind is one.KEYWORD_ONLY
    ]
    any_number = any(one.kind is one.VAR_POSITIONAL for one in parameters.values())
    if len([one for one in required if one != "refine"]) != 1 and not any_number:
        action = "Write def f(parameters), with defaults for all other arguments."
        raise refuse(
            name, f"arguments {', '.join(required) or 'none'}", "one argument, the parameters", action
        )
    return OtherModel(name, function, "refine" in parameters)


def _of_module(path: Path, name: str) -> Callable[..., Any]:
    module = _module(path)
    function = getattr(module, name, None)
    if not callable(function):
        functions = _functions(module)
        action = nearest(name, functions) or "Name one of these."
        allowed = f"one of {', '.join(functions)}" if functions else "a function of the module"
        raise refuse("theirs", f"{path}:{name}", allowed, action)
    return _in_folder(function, path.resolve().parent)


def _in_folder(function: Callable[..., Any], folder: Path) -> Callable[..., Any]:
    """Return the function so that it imports modules beside its own as it runs."""

    def wrapped(*arguments: Any, **keywords: Any) -> Any:
        with _importable(folder):
            return function(*arguments, **keywords)

    wrapped.__signature__ = inspect.signature(function)  # type: ignore[attr-defined]
    return wrapped


def _functions(module: ModuleType) -> list[str]:
    return [
        name
        for name, value in vars(module).items()
        if inspect.isfunction(value) and value.__module__ == module.__name__ and name[0] != "_"
    ]


@contextmanager
def _importable(folder: Path) -> Iterator[None]:
    """Let modules of a folder be imported."""
    sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        sys.path.remove(str(folder))


def _module(path: Path) -> ModuleType:
    """Import a module file."""
    if not path.is_file():
        raise refuse("theirs", path, "a Python file that exists", "Check the folder and the name.")
    spec = importlib.util.spec_from_file_location(f"their_model_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise refuse("theirs", path, "a Python file", "Name a file that ends in .py.")
    module = importlib.util.module_from_spec(spec)
    try:
        with _importable(path.resolve().parent):
            spec.loader.exec_module(module)
    except Exception as error:
        why = f"{type(error).__name__}: {error}"
        raise refuse("theirs", path, "a Python file that can be imported", f"Correct it: {why}.") from error
    return module
