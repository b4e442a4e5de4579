"""The base of all stiffness models: what they read of a gear pair, their section, ramps and fits.

Sources: docs/theory/mesh_physics.md, "Stiffness of a tooth pair".
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from functools import partial
from typing import Annotated, Protocol

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial
from pydantic import Field

from lumped.errors import refuse
from lumped.fields.section import Section
from lumped.fields.units import Quantity
from lumped.gear_geometry.geometry import Geometry, Wheel
from lumped.path_function import PathFunction
from lumped.ranges import RangeViolation
from lumped.typing import FloatArray


class Material(Protocol):
    """Material of one gear, fields of ``pinion`` and ``gear`` in a parameter file: E [Pa], nu [-]."""

    youngs_modulus: float
    poisson_ratio: float


class Operation(Protocol):
    """Operating point, the fields of ``operating``: the torque driving the pinion [N m]."""

    pinion_torque: float


class MeshingPair(Protocol):
    """The part of a gear pair that stiffness models read; a ``GearPair`` has all of it."""

    @property
    def pinion(self) -> Material:
        """Material of the driving gear."""

    @property
    def gear(self) -> Material:
        """Material of the driven gear."""

    @property
    def wheels(self) -> tuple[Wheel, Wheel]:
        """Pinion and gear as the basic rack cuts them."""

    @property
    def operating(self) -> Operation:
        """Operating point."""

    @property
    def geometry(self) -> Geometry:
        """Geometry of the pair."""


#: Fields of the shape below the active flanks, of the bodies and the material; "gears" are both gears.
TOOTH_FORM = frozenset(
    {
        "basic_rack.dedendum_coefficient",
        "basic_rack.fillet_radius_coefficient",
        "gears.bore",
        "gears.youngs_modulus",
        "gears.poisson_ratio",
    }
)


class StiffnessModel(Section):
    """Base of the stiffness models: the section ``mesh.stiffness``, which computes its curve k(xi)."""

    @property
    def reads(self) -> frozenset[str]:
        """Fields of ``TOOTH_FORM`` on which the model depends, beside section, circles and torque."""
        return TOOTH_FORM

    @property
    def whole_mesh(self) -> bool:
        """Whether the curve is the stiffness of the whole mesh, used as given, and not of one tooth pair."""
        return False

    @property
    def words(self) -> str:
        """Words for a reader: whose stiffness it is, and by which model."""
        model: str = type(self).model_fields["model"].default
        return f"stiffness of one tooth pair, model {model}"

    @abstractmethod
    def curve(self, pair: MeshingPair) -> PathFunction:
        """Return the stiffness k_i(xi) of one tooth pair from A to D [N/m].

        Refuse parameters that do not fit.
        """

    def violations(self, pair: MeshingPair) -> tuple[RangeViolation, ...]:
        """Return the validity ranges of the model that a gear pair leaves.

        There is no warning: ordinary gears leave the range of the fillet foundation, and a warning at every
        point of a sweep would hide other warnings.
        """
        return ()

    def neighbours(self, pair: MeshingPair) -> tuple[PathFunction, ...]:
        """Return w_m(xi) [m/N], m = 1, 2, ...: how far a unit load on a pair moves the pair m pitches ahead.

        xi is the position of the pair behind. Without functions no pair moves another.
        """
        return ()

    def softening(self, pair: MeshingPair) -> float:
        """Return D in 1/k(T) = 1/k(T_0) - D ln(T/T_0) [m/N]; 0 where k does not depend on the load."""
        return 0.0


#: The field ``ramp_length`` of the stiffness models.
RampLength = Annotated[
    float,
    Quantity("mm", at_least=0),
    Field(description="length along the path over which a pair takes up its stiffness; 0 is a jump"),
]
#: Ramp in s from 0 to 1. The square of the cubic smoothstep, so that sqrt(k), and with it the damping
#: 2 zeta sqrt(k m_e), is analytic on the ramp too; it starts like s^4 and ends with zero slope.
RAMP = Polynomial([0.0, 0.0, 3.0, -2.0]) ** 2
#: Shortest ramp over half of the path of contact: rounding of positions is then below the fit's tolerance.
_SHORTEST = 2e-4
#: Fit error of a ramped function over its largest value.
_FIT_TOLERANCE = 1e-11


def check_ramp_length(ramp_length: float, low: float, high: float) -> None:
    """Refuse a ramp longer than half of the path of contact, or too short to be resolved."""
    half = 0.5 * (high - low)
    if ramp_length > half or 0.0 < ramp_length < _SHORTEST * half:
        raise refuse(
            "mesh.stiffness.ramp_length",
            f"{ramp_length * 1e3:g} mm",
            f"0, or {_SHORTEST * half * 1e3:.4f} to {half * 1e3:.4f} mm, half of the path of contact",
            "Shorten the ramp." if ramp_length > half else "Write 0 for a jump.",
        )


def ramped(function: PathFunction, ramp_length: float) -> PathFunction:
    """Multiply a function over the path of contact by the ramp at both ends, of this length [m].

    The inner ends of the ramps, where the curvature jumps, are switches of the result.
    """
    if ramp_length == 0.0:
        return function
    low, high = function.interval
    check_ramp_length(ramp_length, low, high)

    def product(xi: FloatArray) -> FloatArray:
        s = np.minimum(np.minimum(xi - low, high - xi) / ramp_length, 1.0)
        return np.asarray(function(xi) * RAMP(np.maximum(s, 0.0)), dtype=np.float64)

    inner = np.array([low + ramp_length, high - ramp_length])
    scale = float(np.abs(function(np.linspace(low, high, 257))).max())
    return PathFunction.fit(
        product,
        np.unique(np.concatenate([function.breaks, inner])),
        np.union1d(function.switches, inner),
        tolerance=_FIT_TOLERANCE * scale,
    )


#: Fit error over the largest value.
_TOLERANCE = 1e-10
#: Terms of the Chebyshev series over the path of contact that are tried.
_TERMS = (64, 128)


def fitted_series(function: Callable[[FloatArray], FloatArray], ends: tuple[float, float]) -> PathFunction:
    """Fit a function (n,) -> (n,), analytic over the path, by its Chebyshev series from few evaluations."""
    from lumped.path_values import series_at

    for terms in _TERMS:
        series = np.asarray(Chebyshev.interpolate(function, terms - 1, ends).coef, dtype=np.float64)
        tolerance = _TOLERANCE * float(np.abs(series_at(series, *ends, np.linspace(*ends, terms))).max())
        if np.abs(series[-terms // 8 :]).max() <= 0.1 * tolerance:
            return PathFunction.fit(partial(series_at, series, *ends), ends, tolerance=tolerance)
    return PathFunction.fit(function, ends, tolerance=tolerance)
