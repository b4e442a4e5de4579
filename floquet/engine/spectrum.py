"""Multipliers with their error bounds, and what follows from them.

Sources: docs/theory/floquet.md, "From the equations to a matrix".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np

from floquet.engine.multipliers import radii_with_bounds, verdicts
from lumped.typing import ComplexArray, FloatArray

Certificate = Literal["proven", "estimate"]
"""What an error is: a bound by a theorem, rounding included, or an estimate from samples."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Floquet multipliers of one periodic system.

    Attributes
    ----------
    multipliers : (n,) complex, largest modulus first
    multiplier_errors : (n,) bound on the error of each, see ``certificate``
    period : T [s]
    certificate : "proven" where the errors are bounds by a theorem, rounding included; "estimate" where they
        rest on samples
    """

    multipliers: ComplexArray
    multiplier_errors: FloatArray
    period: float
    certificate: Certificate = field(default="estimate", kw_only=True)

    @cached_property
    def _radius(self) -> tuple[float, float]:
        radius, error = radii_with_bounds(self.multipliers, self.multiplier_errors)
        return float(radius), float(error)

    @property
    def spectral_radius(self) -> float:
        """Largest |multiplier|."""
        return self._radius[0]

    @property
    def error(self) -> float:
        """Bound on the error of ``spectral_radius``, see ``certificate``."""
        return self._radius[1]

    @property
    def verdict(self) -> str:
        """One of "stable", "unstable", and "undecided" when ``spectral_radius`` +- ``error`` contains 1."""
        radius, error = (np.array(value) for value in self._radius)
        return ("undecided", "stable", "unstable")[int(verdicts(radius, error))]

    @property
    def exponents(self) -> ComplexArray:
        """log(multiplier)/T [1/s], (n,), principal branch; -inf for a multiplier that is zero."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self.multipliers.astype(complex)) / self.period)
