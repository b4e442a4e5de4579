"""Paths of the multipliers of a gear pair in the complex plane as one parameter varies.

Sources: docs/theory/floquet.md, "From the equations to a matrix".
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from floquet.gear.axes import axis_coordinates, gear_axis, operating_rpm, vary
from floquet.gear.block import gear_block
from floquet.gear.friction_over_speed import depends_on_speed
from floquet.rank_one.batch import fast_monodromies
from floquet.rank_one.system import RankOneSystem
from lumped.arguments import real_number, real_numbers
from lumped.errors import refuse
from lumped.labelling import labelled_dataset
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import ComplexArray, FloatArray, Progress

if TYPE_CHECKING:
    import xarray as xr

# Largest turn [rad] of a mode of the mean system between two points that are joined: less than what would let
# a multiplier pass for its neighbour.
_TURN = 1.0
_HALVINGS = 10  # further ones, where multipliers come close to each other
# Most radians of integration over all points, about two minutes.
_EFFORT = 1e8


def multiplier_paths(
    pair: AnyPair,
    name: str,
    values: npt.ArrayLike,
    *,
    rtol: float = 1e-9,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Paths of the multipliers of the feedback block in the complex plane as one parameter varies.

    Two points are joined where every multiplier moves less than it is apart from the others, and no mode
    turns by more than 1 rad; else there are points between them, at most 1024 for each rad. A multiplier and
    its complex conjugate may change places where they meet on the real axis: which is which means nothing.

    Parameters
    ----------
    pair : the gear pair
    name : axis out of `GEAR_AXES`
    values : (k,) of the axis, increasing
    rtol : of the monodromy matrices
    progress : told the finished fraction

    Returns
    -------
    Dataset over the axis and ``path``: complex ``multipliers``, paths in the order of the first point; and
    ``certain``, whether a path is joined without doubt to the point before. It is not where multipliers of
    different pairs meet, or nearly so.

    Raises
    ------
    ParameterError : unknown axis, values that are not increasing, or speeds so low that the modes turn
        through millions of radians between two values
    """
    pair = load_gear_pair(pair)
    axis = gear_axis(name)
    points = real_numbers("values", values, increasing=True)
    axis.check(name, points)
    rtol = real_number("rtol", rtol, 1e-13, 1e-3)
    line = _Line(pair, name, rtol)
    effort = _effort(line, points)
    here = line.at(float(points[0]))
    here = here.arranged(np.argsort(-np.abs(here.multipliers), kind="stable"))
    paths, certain = [here.multipliers], [np.ones(here.multipliers.size, dtype=bool)]
    for done, (low, high) in enumerate(pairwise(points)):
        turn = np.abs(line.at(float(high)).angles - here.angles).max()
        halvings = math.ceil(math.log2(max(turn / _TURN, 1.0))) + _HALVINGS
        here, sure = line.follow(here, float(low), float(high), halvings)
        paths.append(here.multipliers)
        certain.append(sure)
        if progress is not None:
            progress(float(effort[done]))
    return labelled_dataset(
        {
            "multipliers": ((name, "path"), np.array(paths), "1", "Floquet multipliers"),
            "certain": ((name, "path"), np.array(certain), "1", "joined for certain"),
        },
        axis_coordinates({name: points}),
        {"title": f"multiplier paths of {pair.name}"},
    )


def _effort(line: _Line, points: FloatArray) -> FloatArray:
    """Share of the work that is done after each interval; refused where all of it has no end in sight."""
    angles = np.array([line.angles(float(value)).max() for value in points])
    radians = np.maximum(np.abs(np.diff(angles)) / _TURN, 1.0) * np.maximum(angles[1:], angles[:-1])
    total = np.cumsum(radians)
    if points.size > 1 and total[-1] > _EFFORT:
        worst = int(np.argmax(radians))
        raise refuse(
            line.name,
            f"{points[worst]:g} to {points[worst + 1]:g}",
            f"values between which the modes turn by less, {_EFFORT:g} rad of integration in all",
            f"They would take {total[-1]:.1e} rad: begin at a higher speed.",
        )
    return np.asarray(total / max(float(total[-1]) if total.size else 1.0, 1e-300))


class _Place(NamedTuple):
    """Multipliers (2m,) at one value of the parameter; angles (m,) [rad] by which modes turn in a period."""

    multipliers: ComplexArray
    angles: FloatArray

    def arranged(self, order: npt.NDArray[np.intp]) -> _Place:
        return _Place(self.multipliers[order], self.angles)


class _Line:
    """The feedback block along one axis."""

    def __init__(self, pair: GearPair, name: str, rtol: float) -> None:
        self.pair, self.name, self.tolerance = pair, name, 0.01 * rtol
        self.rpm = operating_rpm(pair)
        # Without laws that change with speed one block serves all speeds.
        self.block = gear_block(pair) if name == "speed_rpm" and not depends_on_speed(pair) else None

    def _system(self, value: float) -> tuple[RankOneSystem, float]:
        """The block and its period [s]."""
        if self.block is not None:
            return self.block, self.block.period * self.rpm / value
        block = gear_block(vary(self.pair, {self.name: value}))
        return block, block.period

    def angles(self, value: float) -> FloatArray:
        """By how much each mode of the mean system turns in a period [rad]."""
        block, period = self._system(value)
        return block.modal().omega * period

    def at(self, value: float) -> _Place:
        block, period = self._system(value)
        matrix = fast_monodromies(block, [period], tolerance=self.tolerance).matrices[0]
        return _Place(np.linalg.eigvals(matrix).astype(complex), block.modal().omega * period)

    def follow(
        self, here: _Place, low: float, high: float, halvings: int
    ) -> tuple[_Place, npt.NDArray[np.bool_]]:
        """Place at ``high`` in the order of that at ``low``, and for each path whether that is certain."""
        there = self.at(high)
        order, certain = joined(here.multipliers, there.multipliers)
        near = np.abs(there.angles - here.angles).max() <= _TURN
        if halvings == 0 or (near and certain.all()):
            return there.arranged(order), certain & near
        middle = 0.5 * (low + high)
        here, before = self.follow(here, low, middle, halvings - 1)
        there, after = self.follow(here, middle, high, halvings - 1)
        return there, before & after


def joined(here: ComplexArray, there: ComplexArray) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.bool_]]:
    """Which multiplier of ``there`` continues each of ``here``, and whether no other one can.

    The sum of the distances is least. It is certain for a multiplier that, with any other one, moves less
    than the two are apart; complex conjugates, before or after, are no others.
    """
    _, order = linear_sum_assignment(np.abs(here[:, None] - there[None, :]))
    move = np.abs(there[order] - here)
    apart = np.abs(here[:, None] - here)
    alone = (move[:, None] + move < apart) | np.eye(here.size, dtype=bool)
    for values in (here, there[order]):
        alone |= (values[:, None] == values.conj()) & (values.imag != 0.0)
    return order, np.asarray(alone.all(axis=1))
