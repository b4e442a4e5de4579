"""Periodic systems as read from a file, with what a chart varies.

Sources: docs/theory/floquet.md, "A matrix as a table"; docs/how_to/any_system.md.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol

import numpy as np

from floquet import FourierSeries, PeriodicMatrix, PeriodicSystem, SecondOrderSystem, from_second_order
from floquet.engine.chart import ChartAxis
from floquet.engine.coefficients import Coefficient
from floquet.engine.matrix_table import MatrixTable
from lumped.typing import FloatArray

_FREQUENCY = ChartAxis("Hz", "frequency of the variation", low=0.0, open_low=True)
_VARIATION = ChartAxis("1", "factor on the periodic terms", low=0.0)
_DAMPING = ChartAxis("1", "factor on C", low=0.0)


class PeriodicModel(Protocol):
    """A periodic system that a chart can vary."""

    @property
    def axes(self) -> Mapping[str, ChartAxis]:
        """What a chart can vary: name -> unit, plain name and range."""
        ...

    @property
    def system(self) -> Callable[..., PeriodicSystem]:
        """Parameters out of ``axes`` by name -> the system; the other parameters are those of the file."""
        ...

    def coarser(self) -> PeriodicModel | None:
        """Return the model with every second row of its tables; None where no table can lose rows."""
        ...


@dataclass(frozen=True, eq=False)
class SystemAt:
    """Parameters at a node of a chart -> the system of a model; other processes can receive it."""

    model: PeriodicModel

    def __call__(self, point: Mapping[str, float]) -> PeriodicSystem:
        """Return the system at a node."""
        return self.model.system(**point)


class Harmonic(NamedTuple):
    """Harmonic term of a matrix: ``amplitude`` (n, n) times "cos" or "sin" of order ``order``."""

    wave: str
    order: int
    amplitude: FloatArray


@dataclass(frozen=True, eq=False)
class MatrixOfTime:
    """A matrix with periodic terms.

    Attributes
    ----------
    constant : (n, n)
    harmonics : harmonic terms
    table : a table that is added; None: there is none
    samples : whether the table has values at times, so that a reader chooses what lies between them
    """

    constant: FloatArray
    harmonics: tuple[Harmonic, ...] = ()
    table: MatrixTable | None = None
    samples: bool = False

    def matrix(self, period: float, variation: float, factor: float = 1.0) -> PeriodicMatrix:
        """Return the matrix with a period [s], a factor on what differs from its mean, a factor on all."""
        terms: list[tuple[Coefficient, FloatArray]] = []
        for harmonic in self.harmonics:
            unit = [0.0] * (harmonic.order - 1) + [1.0]
            cosines, sines = (unit, ()) if harmonic.wave == "cos" else ((), unit)
            wave = FourierSeries(period, 0.0, cosines, sines)
            terms.append((wave, variation * factor * harmonic.amplitude))
        constant = self.constant
        if self.table is not None:
            table = self.table.matrix(period, variation)
            constant_of_table, *patterns = table.matrices
            terms += [(f, factor * B) for f, B in zip(table.functions, patterns, strict=True)]
            if constant.any():  # two constants are two terms, because their sum would be rounded
                terms.append((FourierSeries(period, 1.0), factor * constant_of_table))
            else:
                constant = constant_of_table
        return PeriodicMatrix(factor * constant, *terms)

    def coarser(self) -> MatrixOfTime | None:
        """Return the matrix with every second row of its table; None where its table cannot lose rows."""
        table = None if self.table is None else self.table.coarser()
        return None if table is None else replace(self, table=table)


@dataclass(frozen=True, eq=False)
class FirstOrderModel:
    """x' = A(t) x, as read from a file.

    Attributes
    ----------
    A : the matrix
    period : [s]
    """

    A: MatrixOfTime
    period: float

    @property
    def axes(self) -> Mapping[str, ChartAxis]:
        """See `PeriodicModel`."""
        return {"frequency": _FREQUENCY, "variation": _VARIATION}

    @property
    def sampled(self) -> bool:
        """Whether a matrix is known by samples."""
        return self.A.samples

    def system(self, *, frequency: float | None = None, variation: float = 1.0) -> PeriodicSystem:
        """See `PeriodicModel`; ``frequency`` None: that of the file."""
        T = 1.0 / frequency if frequency else self.period
        return PeriodicSystem(self.A.matrix(T, variation), T)

    def coarser(self) -> FirstOrderModel | None:
        """See `PeriodicModel`."""
        A = self.A.coarser()
        return None if A is None else replace(self, A=A)


@dataclass(frozen=True, eq=False)
class SecondOrderModel:
    """M x'' + (C(t) + Omega G) x' + K(t) x = 0, Omega = 2 pi/period, as read from a file.

    Attributes
    ----------
    M, G : (n, n)
    C, K : matrices with periodic terms
    period : [s]
    """

    M: FloatArray
    C: MatrixOfTime
    G: FloatArray
    K: MatrixOfTime
    period: float

    @property
    def axes(self) -> Mapping[str, ChartAxis]:
        """See `PeriodicModel`."""
        return {"frequency": _FREQUENCY, "variation": _VARIATION, "damping": _DAMPING}

    @property
    def sampled(self) -> bool:
        """Whether a matrix is known by samples."""
        return self.C.samples or self.K.samples

    def system(
        self, *, frequency: float | None = None, variation: float = 1.0, damping: float = 1.0
    ) -> SecondOrderSystem:
        """See `PeriodicModel`; ``frequency`` None: that of the file."""
        T = 1.0 / frequency if frequency else self.period
        C = self.C.matrix(T, variation, damping)
        gyroscopic = 2.0 * np.pi / T * self.G
        constant, *matrices = C.matrices
        C = PeriodicMatrix(constant + gyroscopic, *zip(C.functions, matrices, strict=True))
        return from_second_order(self.M, C, self.K.matrix(T, variation), T)

    def coarser(self) -> SecondOrderModel | None:
        """See `PeriodicModel`."""
        C, K = self.C.coarser(), self.K.coarser()
        return None if C is None and K is None else replace(self, C=C or self.C, K=K or self.K)
