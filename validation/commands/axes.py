"""Axes of charts and maps as the command line writes them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from validation.commands import options as opt

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from floquet.engine.chart import ChartAxis

_LARGEST_COUNT = 5000


def axis_values(text: str, known: Mapping[str, ChartAxis]) -> tuple[str, NDArray[np.float64]]:
    """Name and values of an axis written NAME=FROM:TO:COUNT.

    Parameters
    ----------
    text : what was written
    known : axes to choose from, name -> axis

    Raises
    ------
    ParameterError : an unknown name, or values that are no axis
    """
    import numpy as np

    from lumped.errors import ParameterError, refuse
    from lumped.fields.refusals import nearest

    name, separator, values = (part.strip() for part in text.partition("="))
    allowed = f"NAME=FROM:TO:COUNT with different ends and a count from 2 to {_LARGEST_COUNT}"
    example = "speed_rpm=1000:20000:80" if "speed_rpm" in known else f"{next(iter(known))}=1:2:80"
    wrong = refuse("--axis", text, allowed, f"For example --axis {example}.")
    *ends, many = values.split(":")
    if not separator or len(ends) != 2 or not many.strip().isdecimal():
        raise wrong
    if name not in known:
        advice = nearest(name, known) or "Choose one of them."
        raise refuse("--axis", name, "one of " + ", ".join(known), advice)
    low, high = sorted(number_in("--axis", end, known[name].units) for end in ends)
    if low == high or not 2 <= int(many) <= _LARGEST_COUNT:
        raise wrong
    found = np.linspace(low, high, int(many))
    try:
        known[name].check(name, found)
    except ParameterError as error:
        raise opt.by_option(error, {f"axes[{name!r}]": f"--axis {name}"}, "") from None
    return name, found


def axes_values(texts: list[str], known: Mapping[str, ChartAxis]) -> dict[str, NDArray[np.float64]]:
    """Axes by name, see `axis_values`; refuses a name that comes twice."""
    from lumped.errors import refuse

    grid: dict[str, NDArray[np.float64]] = {}
    for text in texts:
        name, values = axis_values(text, known)
        if name in grid:
            raise refuse("--axis", text, "an axis that is not there yet", f"{name} is given twice.")
        grid[name] = values
    return grid


def number_in(option: str, text: str, unit: str) -> float:
    """Number in a unit, of text that may carry another one of its kind.

    Parameters
    ----------
    option : name of the option, for the refusal
    text : what was written
    unit : in which the number is wanted

    Raises
    ------
    ParameterError : no finite number of that kind
    """
    from lumped.errors import refuse
    from lumped.fields.units import to_si, to_stated

    stated = unit.replace(" ", "*")
    try:
        number = to_stated(to_si(opt.value_of(text.strip()), stated), stated)
    except (ValueError, TypeError) as error:
        raise refuse(option, text, f"a number in {unit}", f"{error}.") from None
    if not math.isfinite(number):
        raise refuse(option, text, f"a number in {unit}", "Correct it.")
    return number
