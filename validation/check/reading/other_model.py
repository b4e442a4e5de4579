"""A model of somebody else that can be run: a Python function of the parameters of a pair."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from lumped.arguments import whole_number
from lumped.errors import ParameterError, refuse, shown
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from validation.check.curves import Curves, ValuesOverSpeed
from validation.check.reading.objects import read_object
from validation.files.python_functions import named_function

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
        function = named_function("theirs", theirs, "f(parameters)")
        return None if function is None else _model(function, str(theirs))
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
