"""Friction and stiffness of the user: functions, arrays and columns become tables of a parameter file."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from lumped.arguments import real_array
from lumped.errors import refuse, shown
from lumped.fields.tables import table_of
from lumped.friction.base import ContactPath
from lumped.friction.table import COEFFICIENT, TABLE
from lumped.gear_geometry.geometry import Geometry
from lumped.stiffness.table import STIFFNESS
from lumped.typing import FloatArray

#: What a friction function may read, by the names of its arguments, all SI.
CONTACT = (
    "xi",
    "radius",
    "sliding_velocity",
    "entraining_velocity",
    "slide_to_roll",
    "hertz_pressure",
    "film_thickness",
    "film_parameter",
)
_GEOMETRY = ("xi", "radius", "slide_to_roll")
#: Intervals on either side of the pitch point, and over a mesh cycle.
_SIDE = 60
_CYCLE = 240
_GIVE = "a name, a function, a 1-D array, or columns with units in their names"


def is_own(path: str, value: object) -> bool:
    """Whether a value of a field is a law of the user, to be sampled."""
    if path not in ("friction.law", "mesh.stiffness"):
        return False
    if isinstance(value, str):
        return path == "mesh.stiffness"
    array = isinstance(value, int | float | list | tuple) or hasattr(value, "__array__")
    array = array or hasattr(value, "columns")
    return callable(value) or array or (isinstance(value, Mapping) and "model" not in value)


def own_friction(path: ContactPath, law: object) -> dict[str, Any]:
    """Fields of a pair for a friction law of the user, sampled at the operating point."""
    name = "table"
    field = "friction.law"
    if isinstance(law, (int, float)):
        numerals: dict[float, str] = dict(enumerate(("I", "II", "III", "IV", "V"), 1))
        numeral = numerals.get(law)
        constant = "For a constant mu give law = 'coulomb' and friction.coefficient = 0.05."
        raise refuse(field, law, _GIVE, f"Law {law} is written '{numeral}'." if numeral else constant)
    made_at: dict[str, Any] = {
        "speed": path.omega_pinion * 30.0 / math.pi,
        "unit_load": path.unit_load * 1e-3,
    }
    if callable(law):
        name = _name(law)
        reads = _arguments(law, field, CONTACT)
        # Denser towards P, where most laws change fastest.
        share = np.linspace(0.0, 1.0, _SIDE + 1) ** 3
        xi = np.append(
            path.L_XP - share[::-1] * (path.L_XP - path.L_XA), path.L_XP + share[1:] * (path.L_XD - path.L_XP)
        )
        contact = {key: xi if key == "xi" else getattr(path, key)(xi) for key in reads}
        values = _sampled(law, contact, field)
        if set(reads) <= set(_GEOMETRY):
            made_at = {}
    elif (columns := _columns(law)) is not None:
        table = table_of(columns, COEFFICIENT, field, "columns")
        return {"friction.table": {"name": name} | table | made_at, "friction.law": TABLE}
    else:
        values = _array(field, law)
        xi = np.linspace(path.L_XA, path.L_XD, values.size)
    table = {"name": name, "points": (xi * 1e3).tolist(), "coefficient": values.tolist()}
    return {"friction.table": table | made_at, "friction.law": TABLE}


def own_stiffness(g: Geometry, stiffness: object) -> dict[str, Any]:
    """The field of a pair with a stiffness of the user."""
    field = "mesh.stiffness"
    if isinstance(stiffness, str):
        return {field: {"model": stiffness}}
    if isinstance(stiffness, (int, float)):
        stiffness = np.full(5, float(stiffness))
    phase = np.linspace(0.0, 1.0, _CYCLE + 1)
    table: dict[str, Any] = {"kind": "total", "axis": "phase"}
    if callable(stiffness):
        (argument,) = _arguments(stiffness, field, ("phase", "xi"), only_one=True)
        points = phase
        if argument == "xi":
            points = np.linspace(g.L_XA, g.L_XD, _CYCLE + 1)
            table = {"kind": "pair", "axis": "position_mm"}
        values = _sampled(stiffness, {argument: points}, field)
        table["points"] = (points * 1e3 if argument == "xi" else points).tolist()
        table["stiffness"] = values.tolist()
    elif (columns := _columns(stiffness)) is not None:
        table = table_of(columns, STIFFNESS, field, "columns")
        table["kind"] = "total" if table["axis"] == "phase" else "pair"
    else:
        values = _array(field, stiffness)
        table |= {"points": np.linspace(0.0, 1.0, values.size).tolist(), "stiffness": values.tolist()}
    return {field: {"model": "table"} | table}


def _name(function: Callable[..., object]) -> str:
    name = getattr(function, "__name__", "<lambda>")
    return "function" if name == "<lambda>" else name[:60]


def _columns(value: object) -> dict[str, FloatArray] | None:
    """Columns by name of a mapping or a data frame; None for anything else."""
    if not isinstance(value, Mapping) and not hasattr(value, "columns"):
        return None
    names = value if isinstance(value, Mapping) else value.columns
    return {str(name): real_array(str(name), value[name]) for name in names}  # type: ignore[index]


def _array(field: str, value: object) -> FloatArray:
    values = real_array(field, value)
    if values.ndim != 1 or values.size < 4:
        raise refuse(field, f"an array of shape {values.shape}", _GIVE, "Give at least four values in a row.")
    return values


def _arguments(
    function: Callable[..., object], field: str, names: tuple[str, ...], only_one: bool = False
) -> tuple[str, ...]:
    """Names of the arguments of a function without a default. All names must be in ``names``."""
    try:
        parameters = [*inspect.signature(function).parameters.values()]
    except (TypeError, ValueError):  # some compiled functions have none
        parameters = []
    needed = tuple(p.name for p in parameters if p.default is p.empty)
    if not needed or set(needed) - set(names) or (only_one and len(needed) > 1):
        value = f"{_name(function)}({', '.join(needed)})"
        count = "one of" if only_one else "any of"
        allowed = f"a function whose arguments are called {count} {', '.join(names)}"
        raise refuse(field, value, allowed, "Name each argument after what it is, in SI units.")
    return needed


def _sampled(function: Callable[..., object], columns: dict[str, FloatArray], field: str) -> FloatArray:
    """Values of a function, called with one number for each argument."""
    values = []
    for row in zip(*(column.tolist() for column in columns.values()), strict=True):
        call = dict(zip(columns, row, strict=True))
        try:
            values.append(float(function(**call)))  # type: ignore[arg-type]
        except Exception as error:
            where = ", ".join(f"{key} = {value:.4g}" for key, value in call.items())
            action = f"With {where} it raises {type(error).__name__}: {shown(str(error))}."
            raise refuse(field, _name(function), "a function that returns one number", action) from error
    return real_array(field, values)
