"""What a record is to a fit: numbers with their noise, the same numbers of a motion, and errors of the model.

Sources: docs/how_to/calibrate.md, "What is compared".
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.prediction.motion import Prediction
from validation.signals.fitted import Fitted

#: A number is unexplained where more than this share of the size of its channel is left over.
LEFT_OVER = 0.05


class Loading(NamedTuple):
    """How one error of the model acts on the data of a record.

    Attributes
    ----------
    key : errors of different records with the same key are correlated
    places : places of the acted data in the record
    factors : (places, terms) change of the data for each term of the error: one term, or real and imaginary
        part
    """

    key: tuple[str, ...]
    places: tuple[int, ...]
    factors: FloatArray


class Unexplained(NamedTuple):
    """A measured number that no value of the inputs explains.

    Attributes
    ----------
    record, channel : their names
    place : what of the channel: a mesh order, or a speed
    measured, fitted : amplitudes, or values over speed, in the unit of the channel
    rest : size of the difference over the largest order of the channel, or over the measured value
    words : sentence
    """

    record: str
    channel: str
    place: str
    measured: float
    fitted: float
    rest: float
    words: str


class Data(Protocol):
    """A record at one speed and torque as data of a fit."""

    @property
    def name(self) -> str:
        """Name of the record."""

    @property
    def pair(self) -> GearPair:
        """The pair at the speed and torque of the record."""

    @property
    def words(self) -> str:
        """Name, speeds and torque of the record. Parts of one record have the same words."""

    @property
    def quantities(self) -> frozenset[str]:
        """Quantities that are recorded."""

    @property
    def values(self) -> FloatArray:
        """(n,) data."""

    @property
    def noise(self) -> FloatArray:
        """(n, n) covariance of the data by noise and numerics."""

    @property
    def scales(self) -> FloatArray:
        """(n,) size of the channel of each number: differences count in parts of it."""

    @property
    def samples(self) -> int:
        """Samples in a mesh cycle of a motion from which the data are predicted."""

    @property
    def shifts(self) -> int:
        """Number of shifts in time that are free: 1 of curves, 0 of values over speed."""

    @property
    def noise_shares(self) -> list[float]:
        """Standard deviation of the noise of each channel, as a share of its size."""

    @property
    def loadings(self) -> list[Loading]:
        """Errors of a model with the discrepancy level 1."""

    def predicted(self, prediction: Prediction) -> tuple[FloatArray, FloatArray]:
        """Return the data that a prediction gives, and (n, shifts) their slopes by the shift."""

    def fitted(self, fitted: FloatArray) -> Fitted:
        """Return the first channel beside fitted data (n,)."""

    def unexplained(self, fitted: FloatArray, count: int) -> Iterator[Unexplained]:
        """Numbers, out of ``count``, in which fitted data (n,) miss the record by more than its noise."""


def first_channel(records: Sequence[Data], fitted: FloatArray) -> Fitted:
    """Return the first channel of the first record beside fitted data (n,) of all records.

    A sweep is one record.
    """
    words = records[0].words
    parts = []
    start = 0
    for one in records:
        size = one.values.size
        if one.words == words:
            parts.append(one.fitted(fitted[start : start + size]))
        start += size
    joined = [np.concatenate([part[j] for part in parts]) for j in range(4)]
    return Fitted(joined[0], joined[1], joined[2], joined[3], parts[0].words, parts[0].unit, parts[0].axis)


def few_speeds(records: Sequence[Data], most: int) -> list[int]:
    """Return places of records with at most ``most`` speeds of each sweep, evenly spaced; curves all stay."""
    places: dict[str, list[int]] = {}
    for place, one in enumerate(records):
        places.setdefault(one.words, []).append(place)
    kept = []
    for parts in places.values():
        few = np.round(np.linspace(0, len(parts) - 1, min(most, len(parts)))).astype(int)
        kept += [parts[j] for j in few]
    return sorted(kept)


def names_of(records: Sequence[Data]) -> str:
    """Return the names of records with their speeds and torques."""
    return ", ".join(words_of(records))


def words_of(records: Sequence[Data]) -> list[str]:
    """Return the words of each record; parts of one record have them once."""
    return list(dict.fromkeys(one.words for one in records))
