"""Multipliers of a gear pair over speed, damping and friction, which cost the compiled kernel no new fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from floquet.engine.multipliers import radii_with_bounds
from floquet.gear.axes import GearVariation, operating_rpm, vary
from floquet.gear.block import gear_block
from floquet.gear.friction_over_speed import friction_families
from floquet.gear.multipliers import OffLineOfAction
from floquet.rank_one.batch import FastMultipliers, fast_multipliers
from lumped.model.periodic_system import Supports
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

_REFERENCE_DAMPING = 1.0
_CHUNK = 32_768  # points in memory with their matrices


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


def plane_multipliers(plane: Plane, store: Store, rtol: float) -> None:
    """Put the multipliers of all points into the store, those of the bearings off the line of action too.

    ``rtol``: wanted error relative to the scale of the monodromy matrices.
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
        block = gear_block(
            variation,
            rtol=max(0.01 * rtol, 1e-12),
            friction_apart=variation.pair.friction.law != "none",
            friction_level=family.level,
        )
        periods = block.period * variation.pair.operating.pinion_speed * 30.0 / np.pi / speeds
        # At the other speeds of a family the law is that of one speed times factors found by sampling.
        exact = family.members.size == 1 or family.law is None
        bearings = OffLineOfAction.of(variation)
        for chunk in np.split(part, range(_CHUNK, part.size, _CHUNK)):
            T = periods[chunk]
            factors = friction[chunk, None] * family.factors[row[which[chunk]]]
            factors = factors if block.parts[1:] else np.ones((chunk.size, 0))
            found = fast_multipliers(block, T, damping[chunk], factors, tolerance=2e-4 * rtol)
            store.put(plane.index[chunk], found, bearings, T, exact)
