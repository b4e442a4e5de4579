"""Multipliers of a gear pair over speed, damping and friction, which cost the compiled kernel no new fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from floquet.engine.multipliers import radii_with_bounds
from floquet.gear.axes import GearVariation, operating_rpm, vary
from floquet.gear.block import gear_block
from floquet.gear.friction_over_speed import FrictionFamily, friction_families
from floquet.gear.multipliers import OffLineOfAction
from floquet.rank_one.batch import FastMonodromy, FastMultipliers, fast_monodromies, fast_multipliers
from floquet.rank_one.coarsening import coarsened
from floquet.rank_one.interpolation import interpolated_multipliers
from floquet.rank_one.system import RankOneSystem
from lumped.model.periodic_system import Supports
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

Put = Callable[[npt.NDArray[np.intp], FastMultipliers], None]
"""(indices (k,) of points, their multipliers)."""

_REFERENCE_DAMPING = 1.0
# Periods that share one coarsened block differ by at most this factor: short ones need fewer pieces still.
_BAND = 1.5
_CHUNK = 32_768  # points in memory with their matrices
_FEW_PIECES = 6  # not worth joining
_FEW_POINTS = 300  # for which joining costs more than it saves
_FEW_SPEEDS = 64  # for which interpolation would cost more


@dataclass(frozen=True, eq=False)
class Plane:
    """Points that differ in speed, mesh damping and mean friction only.

    Attributes
    ----------
    pair, supports : the gear pair, and what holds it
    point : name -> value of the axes that are the same for all points
    flat : name -> values (count,) of those that are not
    index : (count,) where their multipliers belong in a `Store`
    """

    pair: GearPair
    supports: Supports
    point: Mapping[str, float]
    flat: Mapping[str, FloatArray]
    index: npt.NDArray[np.intp]

    def variation(self, speed_rpm: float | None = None) -> GearVariation:
        """The pair with the reference values of damping and friction, to which the factors relate."""
        values = dict(self.point)
        if "damping_ratio" in self.flat:
            values["damping_ratio"] = _REFERENCE_DAMPING
        if "friction_coefficient" in self.flat:
            values["friction_coefficient"] = float(self.flat["friction_coefficient"].max())
        if speed_rpm is not None and "speed_rpm" in self.flat:
            values["speed_rpm"] = speed_rpm
        return vary(self.pair, values, self.supports)

    def damping(self) -> FloatArray:
        """Factors (count,) on the damping of the reference."""
        given = self.flat.get("damping_ratio")
        return np.ones(self.index.size) if given is None else given / _REFERENCE_DAMPING

    def friction(self) -> FloatArray:
        """Factors (count,) on the mean friction of the reference."""
        given = self.flat.get("friction_coefficient")
        return np.ones(self.index.size) if given is None else given / given.max()


class Store:
    """Multipliers of many points, or no more than their spectral radius.

    Parameters
    ----------
    count : number of points
    size : number of multipliers of each
    multipliers : whether to keep the multipliers and their errors

    Attributes
    ----------
    radius, radius_error : (count,)
    proven : (count,) whether the errors are proven bounds
    multipliers, errors : (count, size) the largest modulus first, or None
    """

    def __init__(self, count: int, size: int, multipliers: bool) -> None:
        self.radius, self.radius_error = np.empty(count), np.empty(count)
        self.proven = np.zeros(count, dtype=bool)
        self.multipliers = np.empty((count, size), dtype=complex) if multipliers else None
        self.errors = np.empty((count, size)) if multipliers else None

    def put(
        self,
        points: npt.NDArray[np.intp],
        found: FastMultipliers,
        bearings: OffLineOfAction,
        periods: FloatArray,
        exact: bool,
    ) -> None:
        """Take the multipliers of the feedback block at some points (k,), and add those of the bearings.

        ``exact``: whether these gains are those of the points, and not like them to a tolerance.
        """
        oloa, oloa_errors = bearings.multipliers(periods)
        values = np.concatenate([found.multipliers, oloa], axis=1)
        errors = np.concatenate([found.errors, oloa_errors], axis=1)
        self.radius[points], self.radius_error[points] = radii_with_bounds(values, errors)
        self.proven[points] = exact and found.certificate == "proven"
        if self.multipliers is not None and self.errors is not None:
            ranking = np.argsort(-np.abs(values), axis=1, kind="stable")
            self.multipliers[points] = np.take_along_axis(values, ranking, 1)
            self.errors[points] = np.take_along_axis(errors, ranking, 1)


def plane_multipliers(
    plane: Plane,
    store: Store,
    rtol: float,
    interpolate: bool,
) -> None:
    """Multipliers of all points: the feedback block and the bearings off the line of action.

    Parameters
    ----------
    plane : the points
    store : takes the multipliers
    rtol : wanted error relative to the scale of the monodromy matrices
    interpolate : over speed and over damping or friction, where speeds are many and share one friction law
    """
    first = plane.variation()
    speeds = plane.flat.get("speed_rpm", np.full(plane.index.size, operating_rpm(first.pair)))
    unique, which = np.unique(speeds, return_inverse=True)
    damping, friction = plane.damping(), plane.friction()
    for family in friction_families(first, unique):
        row = np.full(unique.size, -1)
        row[family.members] = np.arange(family.members.size)
        part = np.flatnonzero(row[which] >= 0)
        variation = plane.variation(family.speed_rpm)
        several = interpolate and family.members.size > _FEW_SPEEDS
        # Interpolation multiplies the bounds at its nodes, most of which is the fit of the law, by 9 to 13.
        block = gear_block(
            variation,
            rtol=max((0.002 if several else 0.01) * rtol, 1e-12),
            friction_apart=variation.pair.friction.law != "none",
            friction_level=family.level,
        )
        periods = block.period * variation.pair.operating.pinion_speed * 30.0 / np.pi / speeds[part]
        # At the other speeds of a family the law is that of one speed times factors found by sampling.
        exact = family.members.size == 1 or family.law is None
        bearings = OffLineOfAction.of(variation)

        def put(
            index: npt.NDArray[np.intp],
            found: FastMultipliers,
            owner: npt.NDArray[np.intp] = plane.index[part],
            periods: FloatArray = periods,
            bearings: OffLineOfAction = bearings,
            exact: bool = exact,
        ) -> None:
            store.put(owner[index], found, bearings, periods[index], exact)

        done = False
        if several:
            done = _interpolated(block, family, periods, damping[part], friction[part], rtol, put)
        if not done:
            factors = friction[part, None] * family.factors[row[which[part]]]
            _direct(block, periods, damping[part], factors, rtol, put)


def _direct(
    block: RankOneSystem,
    periods: FloatArray,
    damping: FloatArray,
    factors: FloatArray,
    rtol: float,
    put: Put,
) -> None:
    """The kernel at every point, in bands of periods with a coarser block for each."""
    if not block.parts[1:]:
        factors = np.ones((periods.size, 0))
    worth = periods.size >= _FEW_POINTS and block.phases.size - 1 > _FEW_PIECES
    rest = np.arange(periods.size)
    while rest.size:
        longest = float(periods[rest].max())
        inside = periods[rest] > (longest / _BAND if worth else 0.0)
        band, rest = rest[inside], rest[~inside]
        system = block
        if worth and band.size >= _FEW_POINTS:
            most = np.abs(factors[band]).max(axis=0)
            system = coarsened(block, longest, float(damping[band].max()), most, 0.05 * rtol)
        for first in range(0, band.size, _CHUNK):
            part = band[first : first + _CHUNK]
            found = fast_multipliers(
                system, periods[part], damping[part], factors[part], tolerance=2e-4 * rtol
            )
            put(part, found)


class _AnotherFamily(Exception):
    """A node of the interpolation has another friction law than the speeds around it."""


def _interpolated(
    block: RankOneSystem,
    family: FrictionFamily,
    periods: FloatArray,
    damping: FloatArray,
    friction: FloatArray,
    rtol: float,
    put: Put,
) -> bool:
    """`_direct` by interpolation over periods and over damping or friction, whichever varies.

    Returns False where friction between the given speeds is not of the family; what was put then is void.
    """
    by_friction = bool(np.ptp(friction) > 0.0)
    unique, row = np.unique(periods, return_inverse=True)
    other, column = np.unique(friction if by_friction else damping, return_inverse=True)
    fixed = float(damping[0] if by_friction else friction[0])
    scale = block.period * family.speed_rpm

    def flow(T: FloatArray, parameters: FloatArray) -> FastMonodromy:
        nodes, index = np.unique(T, return_inverse=True)
        factors = family.factors_at(scale / nodes)
        if factors is None:
            raise _AnotherFamily
        strength = parameters if by_friction else np.full(T.size, fixed)
        zeta = np.full(T.size, fixed) if by_friction else parameters
        gains = strength[:, None] * factors[index] if block.parts[1:] else np.ones((T.size, 0))
        tolerance = max(1e-5 * rtol, 1e-14)
        return fast_monodromies(block, T, zeta, gains, tolerance=tolerance)

    # The points are all combinations of both.
    points = np.empty((unique.size, other.size), dtype=np.intp)
    points[row, column] = np.arange(periods.size)

    def receive(rows: npt.NDArray[np.intp], found: FastMultipliers) -> None:
        put(points[rows].ravel(), found)

    try:
        interpolated_multipliers(flow, unique, other, float(block.modal().omega.max()), 1e-3 * rtol, receive)
    except _AnotherFamily:
        return False
    return True
