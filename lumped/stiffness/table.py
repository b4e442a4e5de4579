"""Tabulated stiffness: interpolation of a pair's curve, or of a total curve shared out to the pairs.

Sources: monotone piecewise cubics, Fritsch and Carlson, SIAM Journal on Numerical Analysis 17 (1980) 238-246.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, ValidationInfo, model_validator

from lumped.errors import NumericalError, ParameterError, refuse
from lumped.fields.tables import check_points, positions, spline, uncovered, with_file
from lumped.gear_geometry.geometry import Geometry
from lumped.path_function import PathFunction, shifted
from lumped.stiffness.base import (
    MeshingPair,
    RampLength,
    StiffnessModel,
    check_ramp_length,
    ramped,
)
from lumped.stiffness.energy import READS, energy_curve
from lumped.typing import FloatArray

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

#: Name and unit of the column in a file.
STIFFNESS = ("stiffness", "N/m")
#: Largest stiffness of a spur gear mesh that is taken for real [N/m].
_LARGEST = 1e12


#: Largest gap between points, over a mesh cycle, across which a curve is still called sampled.
_LARGEST_GAP = 0.25
_FIT_TOLERANCE = 1e-10
#: Positions closer than this fraction of a base pitch are one.
_SAME = 1e-9
#: Rounding of positions over a base pitch, several times over.
_ROUNDING = 1e-12


class TableStiffness(StiffnessModel):
    """Tabulated stiffness: of one pair over the path of contact, or of all pairs over a mesh cycle.

    That of all pairs, ``kind = "total"``, is load over transmission error of the whole mesh and is used as
    given: contact is prescribed, and tip and root relief are part of it (docs/theory/mesh_physics.md).
    """

    model: Literal["table"] = "table"
    kind: Literal["pair", "total"] = Field(
        "pair",
        description="pair: stiffness of one tooth pair from A to D; total: of the whole mesh over a "
        "mesh cycle, load over transmission error, used as given",
    )
    axis: Literal["position_mm", "roll_angle_deg", "phase"] = Field(
        description="what 'points' are: distance from X [mm], pinion roll angle [deg], or cycles after A [1]"
    )
    points: tuple[float, ...] = Field(
        min_length=4, max_length=100_000, description="increasing abscissae, in the unit of 'axis'"
    )
    stiffness: tuple[float, ...] = Field(
        min_length=4, max_length=100_000, description="stiffness at the points [N/m]"
    )
    interpolation: Literal["monotone", "cubic"] = Field(
        "monotone",
        description="monotone (no overshoot, continuous slope) or cubic spline (continuous curvature)",
    )
    ramp_length: RampLength = 0.0

    @model_validator(mode="before")
    @classmethod
    def _read_file(cls, data: Any, info: ValidationInfo) -> Any:
        """Replace ``file = "curve.csv"`` by its contents; a relative path is beside the parameter file."""
        return with_file(data, info, STIFFNESS)

    @model_validator(mode="after")
    def _checked(self) -> Self:
        action = "Check the unit and the sign; leave out points without contact."
        check_points(self.points, self.stiffness, STIFFNESS, _LARGEST, action)
        return self

    @property
    def whole_mesh(self) -> bool:
        """Whether the curve is the sum of all pairs over a mesh cycle."""
        return self.kind == "total"

    @property
    def words(self) -> str:
        """Whose stiffness is given, with its least and largest value."""
        low, high = (
            f"{value:.4g}".replace("e+0", "e") for value in (min(self.stiffness), max(self.stiffness))
        )
        size = low if low == high else f"{low} to {high}"
        return (
            f"stiffness of {'the whole mesh' if self.whole_mesh else 'one tooth pair'}, as given: {size} N/m"
        )

    @property
    def reads(self) -> frozenset[str]:
        """The tooth form where a total is shared out; nothing for the curve of one pair."""
        return READS if self.whole_mesh else frozenset()

    def curve(self, pair: MeshingPair) -> PathFunction:
        """By interpolation of the table [N/m].

        A total curve is shared out so that the sum over the pairs in contact is the table: each pair gets the
        part that its potential-energy stiffness has in the sum of theirs.
        """
        g = pair.geometry
        position = self._positions(g)
        stiffness = np.array(self.stiffness)
        if not self.whole_mesh:
            return ramped(_pair_curve(position, stiffness, self, g), self.ramp_length)
        check_ramp_length(self.ramp_length, g.L_XA, g.L_XD)
        return _shared(_total_curve(position, stiffness, self, g), self.ramp_length, pair)

    def total(self, geometry: Geometry, phase: FloatArray) -> FloatArray:
        """Stiffness of the whole mesh at phases of any shape, in mesh cycles after A, from the table [N/m].

        The curve of each pair is made from it; here nothing is shared out, so that checks can hold the sum of
        the pairs against it. Only for ``kind = "total"``.
        """
        curve = _total_curve(self._positions(geometry), np.array(self.stiffness), self, geometry)
        place = np.mod(np.asarray(phase, dtype=np.float64), 1.0) * geometry.base_pitch
        return np.asarray(curve(place), dtype=np.float64)

    def _positions(self, g: Geometry) -> FloatArray:
        """Points as xi [m]."""
        if self.axis == "phase":
            return np.asarray(g.L_XA + np.array(self.points) * g.base_pitch, dtype=np.float64)
        return positions(self.points, self.axis, g.base_radius_pinion)


def _pair_curve(x: FloatArray, y: FloatArray, model: TableStiffness, geometry: Geometry) -> PathFunction:
    low = geometry.L_XA
    high = geometry.L_XD
    if problem := uncovered(x, low, high, "mesh.stiffness.points"):
        raise ParameterError([problem])
    _check_gaps(np.diff(np.clip(x, low, high)).max(), geometry)
    poly = spline(x, y, model.interpolation)
    inner = x[(x > low) & (x < high)]
    breaks = np.array([low, *inner, high])
    piece = np.clip(np.searchsorted(poly.x, breaks[:-1], side="right") - 1, 0, poly.c.shape[1] - 1)
    return _positive(
        PathFunction(breaks, shifted(poly.c[:, piece], breaks[:-1] - poly.x[piece]), np.empty(0))
    )


def _total_curve(x: FloatArray, y: FloatArray, model: TableStiffness, geometry: Geometry) -> PPoly:
    """Periodic interpolant of the total stiffness over xi, one period from A, wrapped around."""
    period = geometry.base_pitch
    phase = np.mod(x - geometry.L_XA, period)
    order = np.argsort(phase, kind="stable")
    phase = phase[order]
    y = y[order]
    same = np.diff(phase, append=phase[0] + period) <= _SAME * period
    if same.any():  # several periods, or both ends of one: equal phases must agree
        next_value = np.roll(y, -1)
        if np.any(np.abs(y - next_value)[same] > 1e-3 * y[same]):
            raise refuse(
                "mesh.stiffness.stiffness",
                "different values at the same phase",
                f"a curve with the period {period * 1e3:.4f} mm (one base pitch)",
                "Check the axis and unit, or give one period only.",
            )
        phase = phase[~same]
        y = y[~same]
    _check_gaps(np.diff(phase, append=phase[0] + period).max(), geometry)
    # Periodic by repetition: the middle copy of three is what an infinite table gives.
    tiled = np.concatenate([phase - period, phase, phase + period])
    return spline(tiled, np.tile(y, 3), model.interpolation)


def _shared(total: PPoly, ramp_length: float, pair: MeshingPair) -> PathFunction:
    geometry = pair.geometry
    low = geometry.L_XA
    high = geometry.L_XD
    period = geometry.base_pitch
    shifts = np.arange(1 - geometry.pairs, geometry.pairs) * period
    weight = ramped(energy_curve(pair), ramp_length)

    def share(xi: FloatArray) -> FloatArray:
        part = weight(xi) / sum(weight(xi + shift) for shift in shifts)
        return np.asarray(total(np.mod(xi - low, period)) * part, dtype=np.float64)

    ramps = [low + ramp_length, high - ramp_length] if ramp_length > 0.0 else []
    breaks, switches = _neighbour_breaks([low, high, *ramps], low + total.x, geometry)
    scale = float(np.abs(total.c[-1]).max())
    return _positive(PathFunction.fit(share, breaks, switches, tolerance=_FIT_TOLERANCE * scale))


def _neighbour_breaks(
    switches: ArrayLike, knots: ArrayLike, geometry: Geometry
) -> tuple[FloatArray, FloatArray]:
    """Breaks and switches [m] of a function of a pair and its neighbours over the path of contact.

    ``switches`` are where one pair alone jumps or has a kink, A and D among them, ``knots`` where it passes
    to its next piece. No break is within rounding of another.
    """
    g = geometry
    same = _SAME * geometry.base_pitch
    shifts = np.arange(1 - g.pairs, g.pairs) * g.base_pitch

    def within(positions: ArrayLike) -> FloatArray:
        copies = np.unique(np.add.outer(np.asarray(positions), shifts))
        copies = copies[(copies > g.L_XA + same) & (copies < g.L_XD - same)]
        return copies[np.diff(copies, prepend=-np.inf) > same]

    jumps = within(switches)
    joints = within(knots)
    apart = np.abs(np.subtract.outer(joints, jumps)).min(axis=1, initial=np.inf) > same
    return np.unique(np.concatenate([[g.L_XA, g.L_XD], jumps, joints[apart]])), jumps


def _check_gaps(gap: float, geometry: Geometry) -> None:
    # Positions are sums of lengths: a quarter of a cycle may come out longer by their rounding.
    if gap > (_LARGEST_GAP + _ROUNDING) * geometry.base_pitch:
        raise refuse(
            "mesh.stiffness.points",
            f"a gap of {gap / geometry.base_pitch:.3f} mesh cycles",
            f"<= {_LARGEST_GAP:g} mesh cycles between points, over the whole curve",
            "Sample the curve more densely, or check the axis and unit.",
        )


def _positive(k: PathFunction) -> PathFunction:
    low, high = k.interval
    lowest = float(k(np.linspace(low, high, 4001)[1:-1]).min())
    if lowest < 0.0:
        raise NumericalError(
            f"The interpolated stiffness falls to {lowest:.3g} N/m: use interpolation = 'monotone' or more "
            "points."
        )
    return k
