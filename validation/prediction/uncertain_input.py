"""What an uncertain input is: the fields that it moves, and their values at a share of the distribution."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Part:
    """A field that an input moves.

    Attributes
    ----------
    field : path of the field
    low, high : ends of the range in the unit of the parameter file; NaN: the input is a choice between names
    geometric : whether the distribution is uniform over the logarithm of the value
    levels : number of values that the field takes, each in the middle of an equal part of the range; 0: all
        values
    """

    field: str
    low: float = math.nan
    high: float = math.nan
    geometric: bool = False
    levels: int = 0

    def at(self, share: float) -> float:
        """Return the value below which a share of the distribution lies, in file units."""
        if self.field.endswith(".seed"):
            return int(self.low + (self.high - self.low) * share)
        if self.levels:
            share = (min(int(share * self.levels), self.levels - 1) + 0.5) / self.levels
        if self.geometric:
            return float(self.low * (self.high / self.low) ** share)
        return self.low + (self.high - self.low) * share


@dataclass(frozen=True)
class Input:
    """An uncertain input. One input may move several fields together.

    Attributes
    ----------
    field : name of the input: the path of the field, or a common name such as ``bearings.pinion.stiffness``
    parts : fields that the input moves
    choices : names between which the input chooses; empty: the input is a number
    unit : unit in the parameter file
    written : range as the file or the default states it
    reason : reason and source of the range
    rows : machines of which the input takes one as a whole, field -> value as pairs; the first one is the
        pair as given. Empty: the input has a range or choices
    errors : result -> error of the model in each machine of ``rows``, as a share of the result, as pairs
    """

    field: str
    parts: tuple[Part, ...]
    choices: tuple[str, ...]
    unit: str
    written: str
    reason: str
    rows: tuple[tuple[tuple[str, float | str], ...], ...] = ()
    errors: tuple[tuple[str, tuple[float, ...]], ...] = ()

    @property
    def low(self) -> float:
        """Lower end of the first field."""
        return self.parts[0].low

    @property
    def high(self) -> float:
        """Upper end of the first field."""
        return self.parts[0].high

    def at(self, share: float) -> float | str:
        """Return the value of the first field below which a share of the distribution lies, in file units."""
        if self.rows:
            return float(self._row(share))
        if self.choices:
            return self.choices[min(int(share * len(self.choices)), len(self.choices) - 1)]
        return self.parts[0].at(share)

    def changes(self, share: float) -> dict[str, Any]:
        """Return the fields with their values at a share of the distribution, for ``GearPair.with_``."""
        if self.rows:
            return dict(self.rows[self._row(share)])
        if self.choices:
            name = self.at(share)
            return {self.field: {"model": name} if self.field == "mesh.stiffness" else name}
        return {part.field: part.at(share) for part in self.parts}

    def errors_at(self, share: float) -> dict[str, float]:
        """Return result -> error of the model at a share of the distribution; empty: no error is known."""
        return {name: values[self._row(share)] for name, values in self.errors}

    def range_of(self, part: Part) -> str:
        """Return the range of a field in words: as it is written, for machines of records their values."""
        if not self.rows:
            return self.written
        if math.isnan(part.low):
            names = dict.fromkeys(str(dict(row)[part.field]) for row in self.rows[1:])
            return " or ".join(names)
        return f"{part.low:.4g} .. {part.high:.4g}, by records"

    def _row(self, share: float) -> int:
        """Number of the machine at a share; machine 0, the pair as given, stands beside the distribution."""
        others = len(self.rows) - 1
        return 1 + min(int(share * others), others - 1)
