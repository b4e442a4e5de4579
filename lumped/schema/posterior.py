"""The table ``[posterior]`` of a parameter file: possible machines that records leave, one value a machine.

The table has one list for each field that was fitted. The lists have the same length: entry j of all lists
together is machine j. The first machine is the best fit, and its values are those of the file. The values of
one machine belong together: records know combinations of inputs better than each input alone.
``validation.calibrate`` writes the table.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import BeforeValidator, PlainSerializer

from lumped.errors import FieldProblem, shown

#: Column of the table: path of a field, and one value for each machine.
Columns = tuple[tuple[str, tuple[float | str, ...]], ...]
#: Columns that start with this word have no field: errors of results by the model, as shares.
ERROR = "error."
#: Start of the source of a value that records know; their names follow.
FROM_RECORD = "from record "
#: Least and largest number of machines.
LEAST_MACHINES = 8
MOST_MACHINES = 1024


def _columns(value: object) -> object:
    """A table of lists as pairs in order. A table inside a table is a path without quotation marks."""
    if not isinstance(value, dict):
        return value
    pairs: dict[str, Any] = {}

    def walk(inside: dict[str, Any], prefix: str) -> None:
        for key, entry in inside.items():
            if isinstance(entry, dict):
                walk(entry, f"{prefix}{key}.")
            else:
                pairs[f"{prefix}{key}"] = tuple(entry) if isinstance(entry, list) else entry

    walk(value, "")
    return tuple(sorted(pairs.items()))


PosteriorTable = Annotated[
    Columns,
    BeforeValidator(_columns, json_schema_input_type=dict[str, list[float | str]]),
    PlainSerializer(
        lambda columns: {path: list(values) for path, values in columns},
        return_type=dict[str, list[float | str]],
    ),
]


def problems_of_columns(columns: Columns) -> Iterator[FieldProblem]:
    """Problems: lists of different lengths, too few machines, numbers that are not finite."""
    action = "Take the table as 'spurcheck calibrate' writes it, or delete it."
    lengths = {len(values) for _, values in columns}
    if len(lengths) > 1 or not all(LEAST_MACHINES <= one <= MOST_MACHINES for one in lengths):
        refused = f"lists of {', '.join(map(str, sorted(lengths)))} values"
        allowed = f"lists of one length, {LEAST_MACHINES} to {MOST_MACHINES}"
        yield FieldProblem("posterior", refused, allowed, action)
    for path, values in columns:
        bad = [one for one in values if isinstance(one, float) and not math.isfinite(one)]
        words = {isinstance(one, str) for one in values}
        if bad or len(words) > 1 or (path.startswith(ERROR) and words == {True}):
            allowed = "names only, or finite numbers only"
            yield FieldProblem(f"posterior.{path}", shown(repr(list(values[:3]))), allowed, action)
