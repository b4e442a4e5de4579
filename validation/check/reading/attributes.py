"""Speed and torque that a result of this program states in its attributes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from lumped.errors import ParameterError
from lumped.fields.text_file import parse_toml


def text_of(value: Any) -> str:
    """Return a text that may be an array with one text, as MATLAB has it."""
    array = np.asarray(value)
    return str(array.ravel()[0]) if array.size == 1 else str(value)


def operating_point(attributes: Mapping[Any, Any], *, one_speed: bool) -> dict[str, Any]:
    """Return speed and torque that attributes state; the speed only for a result at ``one_speed``.

    The attribute "parameters" of a result of this program is a parameter file.
    """
    stated: dict[str, Any] = {}
    if "pinion_torque" in attributes:
        stated["pinion_torque"] = attributes["pinion_torque"]
    if one_speed and isinstance(attributes.get("pinion_speed"), str):
        stated["pinion_speed"] = attributes["pinion_speed"]
    if one_speed and "parameters" in attributes:
        speed = _speed(text_of(attributes["parameters"]))
        if isinstance(speed, (int, float, str)):
            stated["pinion_speed"] = speed if isinstance(speed, str) else f"{float(speed)!r} rpm"
    return stated


def _speed(parameters: str) -> Any:
    """Pinion speed of the text of a parameter file; None: there is none."""
    try:
        operating = parse_toml(parameters, "parameters").get("operating", {})
    except ParameterError:
        return None
    return operating.get("pinion_speed") if isinstance(operating, dict) else None
