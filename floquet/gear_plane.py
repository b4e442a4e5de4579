"""Multipliers of a gear pair over speed, damping and friction, which cost the compiled kernel no new fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from floquet.coarsening import coarsened
from floquet.fast import FastMonodromy, FastMultipliers, fast_monodromies, fast_multipliers
from floquet.gear_axes import GearVariation, vary
from floquet.gear_block import gear_block
from floquet.gear_friction import FrictionFamily, factors_at, friction_families
from floquet.gear_multipliers import oloa_exponents
from floquet.interpolation import interpolated_multipliers
from floquet.rank_one import RankOneSystem
from floquet.system import ComplexArray, FloatArray
from lumped.parameters import GearPair
from lumped.periodic_system import periodic_system

_REFERENCE_DAMPING = 1.0
# Periods that share one coarsened block differ by at most this factor: short ones need fewer pieces still.
_BAND = 1.5
_FEW_PIECES = 6  # not worth joining
_FEW_POINTS = 300  # for which joining costs more than it saves
_FEW_SPEEDS = 64  # for which interpolation would cost more


@dataclass(frozen=True, eq=False)
class Plane:
    """Points that differ in speed, mesh damping and mean friction only.

    Attributes
    ----------
    pair : the gear pair
    point : name -> value of the axes that are the same for all points
    flat : name -> values (count,) of those that are not
    count : number of points
    """

    pair: GearPair
    point: Mapping[str, float]
    flat: Mapping[str, FloatArray]
    count: int

    def variation(self, speed_rpm: float | None = None) -> GearVariation:
        """The pair with the reference values of damping and friction, to which the factors relate."""
        values = dict(self.point)
        if "damping_ratio" in self.flat:
            values["damping_ratio"] = _REFERENCE_DAMPING
        if "friction_coefficient" in self.flat:
            values["friction_coefficient"] = float(self.flat["friction_coefficient"].max())
        if speed_rpm is not None and "speed_rpm" in self.flat:
            values["speed_rpm"] = speed_rpm
        return vary(self.pair, values)

    def damping(self) -> FloatArray:
        """Factors (count,) on the damping of the reference."""
        given = self.flat.get("damping_ratio")
        return np.ones(self.count) if given is None else given / _REFERENCE_DAMPING

    def friction(self) -> FloatArray:
        """Factors (count,) on the mean friction of the reference."""
        given = self.flat.get("friction_coefficient")
        return np.ones(self.count) if given is None else given / given.max()


def plane_multipliers(
    plane: Plane, rtol: float, threads: int | None, report: Callable[[int], None], interpolate: bool
) -> tuple[ComplexArray, FloatArray]:
    """Multipliers (count, 10) and their bounds: the feedback block and the bearings off the line of action.

    Parameters
    ----------
    plane : the points
    rtol : wanted error relative to the scale of the monodromy matrices
    threads : default one per core
    report : called with the number of points done since the last call
    interpolate : over speed and over damping or friction, where speeds are many and share one friction law
    """
    first = plane.variation()
    own = first.pair.operating.pinion_speed * 30.0 / np.pi
    speeds = plane.flat.get("speed_rpm", np.full(plane.count, own))
    unique, which = np.unique(speeds, return_inverse=True)
    values, errors = np.empty((plane.count, 10), dtype=complex), np.empty((plane.count, 10))
    damping, friction = plane.damping(), plane.friction()
    for family in friction_families(first, unique):
        row = np.full(unique.size, -1)
        row[family.members] = np.arange(family.members.size)
        part = np.flatnonzero(row[which] >= 0)
        variation = plane.variation(family.speed_rpm)
        block = gear_block(
            variation,
            rtol=max(0.01 * rtol, 1e-12),
            friction_apart=variation.pair.friction.law != "none",
            friction_level=family.level,
        )
        periods = block.period * variation.pair.operating.pinion_speed * 30.0 / np.pi / speeds[part]
        found = None
        if interpolate and family.members.size > _FEW_SPEEDS:
            found = _interpolated(
                block, variation, family, periods, damping[part], friction[part], rtol, threads
            )
        if found is None:
            factors = friction[part, None] * family.factors[row[which[part]]]
            found = _direct(block, periods, damping[part], factors, rtol, threads)
        exponents = oloa_exponents(periodic_system(variation.pair, "relative"))
        angle = exponents[None, :] * periods[:, None]
        oloa = np.exp(angle)
        values[part, :6], errors[part, :6] = found.multipliers, found.errors
        values[part, 6:] = oloa
        errors[part, 6:] = 4e-16 * (1.0 + np.abs(angle)) * np.abs(oloa)  # rounding of the exponent
        report(part.size)
    return values, errors


def _direct(
    block: RankOneSystem,
    periods: FloatArray,
    damping: FloatArray,
    factors: FloatArray,
    rtol: float,
    threads: int | None,
) -> FastMultipliers:
    """The kernel at every point, in bands of periods with a coarser block for each."""
    tolerance = 2e-3 * rtol
    if not block.parts[1:]:
        factors = np.ones((periods.size, 0))
    if periods.size < _FEW_POINTS or block.phases.size - 1 <= _FEW_PIECES:
        return fast_multipliers(block, periods, damping, factors, tolerance=tolerance, threads=threads)
    values, errors = np.empty((periods.size, 6), dtype=complex), np.empty((periods.size, 6))
    deltas = np.empty(periods.size)
    rest = np.arange(periods.size)
    while rest.size:
        longest = float(periods[rest].max())
        inside = periods[rest] > longest / _BAND
        part, rest = rest[inside], rest[~inside]
        system = block
        if part.size >= _FEW_POINTS:
            most = np.abs(factors[part]).max(axis=0)
            system = coarsened(block, longest, float(damping[part].max()), most, 0.05 * rtol)
        found = fast_multipliers(
            system, periods[part], damping[part], factors[part], tolerance=tolerance, threads=threads
        )
        values[part], errors[part], deltas[part] = found.multipliers, found.errors, found.matrix_errors
    return FastMultipliers(values, errors, deltas)


class _AnotherFamily(Exception):
    """A node of the interpolation has another friction law than the speeds around it."""


def _interpolated(
    block: RankOneSystem,
    variation: GearVariation,
    family: FrictionFamily,
    periods: FloatArray,
    damping: FloatArray,
    friction: FloatArray,
    rtol: float,
    threads: int | None,
) -> FastMultipliers | None:
    """`_direct` by interpolation over periods and over damping or friction, whichever varies.

    None where friction between the given speeds is not of the family.
    """
    by_friction = bool(np.ptp(friction) > 0.0)
    unique, row = np.unique(periods, return_inverse=True)
    other, column = np.unique(friction if by_friction else damping, return_inverse=True)
    fixed = float(damping[0] if by_friction else friction[0])
    scale = block.period * family.speed_rpm

    def flow(T: FloatArray, parameters: FloatArray) -> FastMonodromy:
        nodes, index = np.unique(T, return_inverse=True)
        factors = factors_at(variation, family, scale / nodes)
        if factors is None:
            raise _AnotherFamily
        strength = parameters if by_friction else np.full(T.size, fixed)
        zeta = np.full(T.size, fixed) if by_friction else parameters
        gains = strength[:, None] * factors[index] if block.parts[1:] else np.ones((T.size, 0))
        tolerance = max(1e-5 * rtol, 1e-14)
        return fast_monodromies(block, T, zeta, gains, tolerance=tolerance, threads=threads)

    turning = float(block.modal().omega.max())
    try:
        found, _ = interpolated_multipliers(flow, unique, other, turning, 1e-3 * rtol, threads)
    except _AnotherFamily:
        return None
    at = row * other.size + column
    return FastMultipliers(found.multipliers[at], found.errors[at], found.matrix_errors[at])
