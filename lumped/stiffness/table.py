"""Tabulated stiffness: interpolation of a pair's curve, or of a total curve shared out to the pairs.

Sources: monotone piecewise cubics, Fritsch and Carlson, SIAM Journal on Numerical Analysis 17 (1980) 238-246.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, ValidationInfo, model_validator
from scipy.interpolate import CubicSpline, PchipInterpolator, PPoly

from lumped.errors import NumericalError, refuse, shown
from lumped.fields.text_file import read_text
from lumped.fields.units import to_si
from lumped.gear_geometry.geometry import Geometry
from lumped.path_function import PathFunction, shifted
from lumped.stiffness.base import MeshingPair, RampLength, StiffnessModel, check_ramp_length, ramped
from lumped.stiffness.energy import energy_curve
from lumped.typing import FloatArray

#: Column -> (axis of the table, unit of its numbers).
_COLUMNS = {
    "stiffness": ("stiffness", "N/m"),
    "position": ("position_mm", "mm"),
    "roll_angle": ("roll_angle_deg", "deg"),
    "phase": ("phase", "1"),
}
_HEADER = re.compile(r"(\w+)\s*(?:\[([^\]]*)\])?")
_FORMAT = "a header such as 'position [mm], stiffness [N/um]', then one row of two numbers per point"
_MAX_BYTES = 10_000_000
#: Largest stiffness of a spur gear mesh that is taken for real [N/m].
_LARGEST = 1e12


def read_stiffness_table(file: object, folder: str | Path = ".") -> dict[str, object]:
    """Read a stiffness table: ``axis``, ``points`` and ``stiffness`` as the schema takes them.

    The file has a header with a column ``position``, ``roll_angle`` or ``phase`` and a column ``stiffness``,
    each with its unit in brackets (none for phase), in any order; lines that start with # are comments.
    """
    if not isinstance(file, str):
        raise refuse("file", file, "the name of a CSV file", "Write the name as text.")
    path = Path(folder) / file
    text = read_text(path, _MAX_BYTES, kind="CSV file")
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if len(lines) < 2:
        raise refuse("file", path, _FORMAT, "Give two columns and at least four rows.")
    names, units = _header(lines[0], path)
    try:
        columns = np.loadtxt(lines[1:], delimiter=",", quotechar='"', comments=None, ndmin=2).T
        first, second = columns.tolist()
    except ValueError as error:
        raise refuse("file", path, _FORMAT, f"A row is no pair of numbers: {shown(str(error))}.") from None
    table: dict[str, object] = {}
    for name, unit, values in zip(names, units, (first, second), strict=True):
        axis, stated = _COLUMNS[name]
        factor = _factor(unit, stated, name, path)
        scaled = tuple(value * factor for value in values)
        table |= {"stiffness": scaled} if name == "stiffness" else {"axis": axis, "points": scaled}
    return table


def check_stiffness_table(points: Sequence[float], stiffness: Sequence[float]) -> None:
    """Refuse unequal lengths, points that do not increase, stiffness not finite and positive."""
    if len(points) != len(stiffness):
        allowed = f"one per point, {len(points)}"
        raise refuse("stiffness", f"{len(stiffness)} values", allowed, "Complete the table.")
    for before, point in itertools.pairwise(points):
        if not point > before:
            action = "Sort the rows and remove repeated points."
            raise refuse("points", f"{point:g} after {before:g}", "increasing", action)
    for value in stiffness:
        if not 0.0 < value <= _LARGEST:
            action = "Check the unit and the sign; leave out points without contact."
            raise refuse("stiffness", f"{value:g} N/m", f"> 0 and <= {_LARGEST:g} N/m", action)


def _header(line: str, path: Path) -> tuple[list[str], list[str]]:
    """Names and units of the two columns."""
    matches = [_HEADER.fullmatch(cell.strip(' 	"')) for cell in line.split(",")]
    names = [match[1].lower() for match in matches if match]
    if not len(matches) == len(set(names)) == 2 or "stiffness" not in names or not {*names} <= {*_COLUMNS}:
        raise refuse("file", path, _FORMAT, f"The header is '{shown(line)}'.")
    return names, [match[2] or "" for match in matches if match]


def _factor(unit: str, stated: str, column: str, path: Path) -> float:
    """Number of stated units in one unit of the file."""
    if stated == "1":
        if unit.strip() not in ("", "1"):
            raise refuse("file", path, "phase without a unit, in mesh cycles", f"It has the unit [{unit}].")
        return 1.0
    try:
        return to_si(f"1 {unit}", stated) / to_si(1.0, stated)
    except ValueError as error:
        raise refuse("file", path, f"{column} with its unit in brackets", f"{error}.") from None


#: A pair's table may miss the ends of the path of contact by this fraction of the path; it is then continued
#: with its end value's polynomial.
_END_GAP = 0.02
#: Largest gap between points, over a mesh cycle, across which a curve is still called sampled.
_LARGEST_GAP = 0.25
_FIT_TOLERANCE = 1e-10
#: Positions closer than this fraction of a base pitch are one.
_SAME = 1e-9


class TableStiffness(StiffnessModel):
    """Tabulated stiffness: of one pair over the path of contact, or of all pairs over a mesh cycle."""

    model: Literal["table"] = "table"
    kind: Literal["pair", "total"] = Field(
        "pair", description="stiffness of one pair from A to D, or sum of all pairs over one mesh cycle"
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
        if not isinstance(data, dict) or "file" not in data:
            return data
        folder = (info.context or {}).get("folder", ".")
        return {key: value for key, value in data.items() if key != "file"} | read_stiffness_table(
            data["file"], folder
        )

    @model_validator(mode="after")
    def _checked(self) -> Self:
        check_stiffness_table(self.points, self.stiffness)
        return self

    def curve(self, pair: MeshingPair) -> PathFunction:
        """By interpolation of the table [N/m].

        A total curve is shared out so that the sum over the pairs in contact is the table: each pair gets the
        part that its potential-energy stiffness has in the sum of theirs.
        """
        g = pair.geometry
        position, stiffness = _positions(self, g), np.array(self.stiffness)
        if self.kind == "pair":
            return ramped(_pair_curve(position, stiffness, self, g), self.ramp_length)
        check_ramp_length(self.ramp_length, g.L_XA, g.L_XD)
        return _shared(_total_curve(position, stiffness, self, g), self.ramp_length, pair)


def _positions(model: TableStiffness, geometry: Geometry) -> FloatArray:
    """Points of the table as xi [m]."""
    points = np.array(model.points)
    if model.axis == "position_mm":
        return np.asarray(points * 1e-3, dtype=np.float64)
    if model.axis == "roll_angle_deg":
        return np.asarray(np.deg2rad(points) * geometry.base_radius_pinion, dtype=np.float64)
    return np.asarray(geometry.L_XA + points * geometry.base_pitch, dtype=np.float64)


def _spline(x: FloatArray, y: FloatArray, interpolation: str) -> PPoly:
    spline = PchipInterpolator(x, y) if interpolation == "monotone" else CubicSpline(x, y)
    return PPoly(spline.c, spline.x)


def _pair_curve(x: FloatArray, y: FloatArray, model: TableStiffness, geometry: Geometry) -> PathFunction:
    low, high = geometry.L_XA, geometry.L_XD
    allowed = _END_GAP * (high - low)
    if x[0] > low + allowed or x[-1] < high - allowed:
        raise refuse(
            "mesh.stiffness.points",
            f"{x[0] * 1e3:.4f} to {x[-1] * 1e3:.4f} mm from X",
            f"at least {low * 1e3:.4f} to {high * 1e3:.4f} mm, A to D",
            "Extend the table, or check its axis and unit.",
        )
    _check_gaps(np.diff(np.clip(x, low, high)).max(), geometry)
    poly = _spline(x, y, model.interpolation)
    inner = x[(x > low) & (x < high)]
    breaks = np.array([low, *inner, high])
    left = np.clip(np.searchsorted(poly.x, breaks[:-1], side="right") - 1, 0, poly.c.shape[1] - 1)
    return _positive(PathFunction(breaks, shifted(poly.c[:, left], breaks[:-1] - poly.x[left]), np.empty(0)))


def _total_curve(x: FloatArray, y: FloatArray, model: TableStiffness, geometry: Geometry) -> PPoly:
    """Periodic interpolant of the total stiffness over xi, one period from A, wrapped around."""
    period = geometry.base_pitch
    phase = np.mod(x - geometry.L_XA, period)
    order = np.argsort(phase, kind="stable")
    phase, y = phase[order], y[order]
    same = np.diff(phase, append=phase[0] + period) <= 1e-9 * period
    if same.any():  # several periods, or both ends of one: equal phases must agree
        following = np.roll(y, -1)
        if np.any(np.abs(y - following)[same] > 1e-3 * y[same]):
            raise refuse(
                "mesh.stiffness.stiffness",
                "different values at the same phase",
                f"a curve with the period {period * 1e3:.4f} mm (one base pitch)",
                "Check the axis and unit, or give one period only.",
            )
        phase, y = phase[~same], y[~same]
    _check_gaps(np.diff(phase, append=phase[0] + period).max(), geometry)
    # Periodic by repetition: the middle copy of three is what an infinite table gives.
    tiled = np.concatenate([phase - period, phase, phase + period])
    return _spline(tiled, np.tile(y, 3), model.interpolation)


def _shared(total: PPoly, ramp_length: float, pair: MeshingPair) -> PathFunction:
    geometry = pair.geometry
    low, high, period = geometry.L_XA, geometry.L_XD, geometry.base_pitch
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
    g, same = geometry, _SAME * geometry.base_pitch
    shifts = np.arange(1 - g.pairs, g.pairs) * g.base_pitch

    def within(positions: ArrayLike) -> FloatArray:
        moved = np.unique(np.add.outer(np.asarray(positions), shifts))
        moved = moved[(moved > g.L_XA + same) & (moved < g.L_XD - same)]
        return moved[np.diff(moved, prepend=-np.inf) > same]

    jumps, joints = within(switches), within(knots)
    apart = np.abs(np.subtract.outer(joints, jumps)).min(axis=1, initial=np.inf) > same
    return np.unique(np.concatenate([[g.L_XA, g.L_XD], jumps, joints[apart]])), jumps


def _check_gaps(gap: float, geometry: Geometry) -> None:
    if gap > _LARGEST_GAP * geometry.base_pitch:
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
