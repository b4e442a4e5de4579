"""A family of periodic systems: a function of its parameters in a file of Python.

Sources: docs/theory/floquet.md; docs/tutorial/own_system.md.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from floquet import PeriodicSystem
from floquet.engine.chart import ChartAxis
from lumped.arguments import of_type
from lumped.errors import SpurcheckError, refuse, shown
from validation.files.python_functions import named_function

_FORM = "f(stiffness=1.0, depth=0.2)"


@dataclass(frozen=True, eq=False)
class FunctionFamily:
    """A function whose arguments are the parameters of a periodic system.

    Attributes
    ----------
    name : "path/to/file.py:function"
    function : parameters by name -> `floquet.PeriodicSystem`
    defaults : parameters -> values where no value is named, in the units [SI] of the function
    """

    name: str
    function: Callable[..., Any]
    defaults: Mapping[str, float]

    @property
    def axes(self) -> Mapping[str, ChartAxis]:
        """What a chart can vary: the arguments of the function."""
        return {name: ChartAxis("1", name.replace("_", " ")) for name in self.defaults}

    def system(self, **parameters: float) -> PeriodicSystem:
        """Return the system with parameters of these values, the others at their defaults.

        Raises
        ------
        ParameterError : the function fails, or returns anything but a `floquet.PeriodicSystem`
        """
        try:
            result = self.function(**{**self.defaults, **parameters})
        except SpurcheckError:
            raise
        except Exception as error:
            why = f"{type(error).__name__}: {error}"
            action = "Run the function alone, and correct it."
            raise refuse(self.name, why, "a function that runs", action) from error
        wanted = "a function that returns floquet.PeriodicSystem or floquet.from_second_order"
        return of_type(self.name, result, PeriodicSystem, wanted)

    def __reduce__(self) -> tuple[Callable[[str], FunctionFamily | None], tuple[str]]:
        """Another process reads the file of the function again."""
        return read_family, (self.name,)

    def coarser(self) -> None:
        """See `PeriodicModel`: a function has no table."""
        return


def read_family(source: str) -> FunctionFamily | None:
    """Return the family that "path/to/file.py:function" names; None where the text names no Python file.

    Each argument of the function is a parameter with a number as its default: the point at which the system
    is judged where no chart is asked for.

    Raises
    ------
    ParameterError : no such file or function, or an argument without a number as its default
    """
    function = named_function("FILE", source, _FORM)
    if function is None:
        return None
    defaults: dict[str, float] = {}
    for one in inspect.signature(function).parameters.values():
        is_number = isinstance(one.default, (int, float)) and not isinstance(one.default, bool)
        if not is_number or one.kind is one.POSITIONAL_ONLY:
            value = "no default" if one.default is one.empty else shown(one.default)
            action = f"Write def {_FORM}."
            raise refuse(f"{source}: {one.name}", value, "a number as default", action)
        defaults[one.name] = float(one.default)
    return FunctionFamily(source, function, defaults)
