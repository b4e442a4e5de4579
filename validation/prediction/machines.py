"""The possible machines that records leave, as one uncertain input; errors of results by the model.

A file that ``calibrate`` wrote has the table ``[posterior]``: one row of values for each machine. A row is
taken as a whole, because records know combinations of inputs better than each input alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from lumped.errors import refuse
from lumped.schema.assumed import Value
from lumped.schema.pair import GearPair, field_values
from lumped.schema.posterior import ERROR
from validation.prediction.uncertain_input import Input, Part

#: Name of the input.
RECORDS = "records"
#: Results of which the table has errors: the error of the model, as a share of the result.
ERRORS = ("dte_peak_to_peak", "dynamic_factor", "bearing_rms")
#: Two numbers of a file that differ by less than this share are equal.
_EQUAL = 1e-9
#: Percentiles that the range of a field states.
_ENDS = (0.05, 0.95)


def machines_left(pair: GearPair) -> Input | None:
    """Return the machines of ``[posterior]`` as one input; None: the pair has no such table.

    A field whose value was changed since the records were fitted is left out, as a value that was chosen. The
    first machine is the best fit, the values of the file; the share of the input runs over the other ones.
    """
    columns = dict(pair.posterior)
    for path in columns:
        if path.startswith(ERROR) and path.removeprefix(ERROR) not in ERRORS:
            allowed = " or ".join(f"{ERROR}{name}" for name in ERRORS)
            raise refuse(f"posterior.{path}", "unknown key", allowed, "Delete the line.")
    values = field_values(pair)
    fields = [
        path
        for path, column in columns.items()
        if not path.startswith(ERROR) and _same(values.get(path), column[0])
    ]
    if not fields:
        return None
    count = len(columns[fields[0]])
    rows = tuple(tuple((path, columns[path][j]) for path in columns if path in fields) for j in range(count))
    errors = tuple(
        (path.removeprefix(ERROR), tuple(map(float, column)))
        for path, column in columns.items()
        if path.startswith(ERROR)
    )
    parts = tuple(_part(path, columns[path]) for path in fields)
    written = f"{count - 1} machines of the records"
    reason = "possible machines with which the pair moves as in the records; their values belong together"
    return Input(RECORDS, parts, (), "1", written, reason, rows, errors)


def _same(value: Value | None, first: Value) -> bool:
    """Whether a field still has the value of the best fit."""
    if isinstance(value, (int, float)) and isinstance(first, (int, float)) and not isinstance(value, bool):
        return math.isclose(value, first, rel_tol=_EQUAL, abs_tol=1e-15)
    return value == first


def _part(path: str, column: tuple[float | str, ...]) -> Part:
    """A field with the range of its values, from 5 to 95 % of the machines."""
    numbers = sorted(one for one in column[1:] if isinstance(one, (int, float)))
    if not numbers:
        return Part(path)
    low, high = (numbers[min(int(share * len(numbers)), len(numbers) - 1)] for share in _ENDS)
    return Part(path, float(low), float(high))


def errors_of(changes: Iterable[tuple[Input, float]]) -> dict[str, float]:
    """Return result -> error of the model in a machine, as a share of the result; empty: none known."""
    return {name: error for one, share in changes for name, error in one.errors_at(share).items()}


def with_errors(numbers: Mapping[str, float], errors: Mapping[str, float]) -> dict[str, float]:
    """Return the numbers of a prediction with the errors of the model.

    The error of the dynamic factor D acts on its distance from 1, the factor of a quasi-static mesh; the
    tooth load moves in proportion to D, and the smallest mesh force with the distance of that force from the
    mean one.
    """
    result = dict(numbers)
    result["dte_peak_to_peak"] *= 1.0 + errors.get("dte_peak_to_peak", 0.0)
    result["bearing_rms"] *= 1.0 + errors.get("bearing_rms", 0.0)
    if error := errors.get("dynamic_factor", 0.0):
        factor = result["dynamic_factor"]
        result["dynamic_factor"] = 1.0 + (factor - 1.0) * (1.0 + error)
        result["tooth_load"] *= result["dynamic_factor"] / factor
        result["least_force"] = max(1.0 - (1.0 - result["least_force"]) * (1.0 + error), 0.0)
    return result
