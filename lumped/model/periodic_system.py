"""The gear pair as a linear system with periodic coefficients, x' = A(t) x + b(t).

Sources: Abbas Al-Zubaidi 2008, eqs. 1 to 9, repaired and derived in docs/theory/equations.md.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Self, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lumped.arguments import one_of
from lumped.display.result import DisplayedResult
from lumped.errors import refuse
from lumped.mesh.records import AT_REST, BY_APPROACH, BY_RATE, Records
from lumped.model.equations import Structure, structure
from lumped.model.mesh_cycle import MeshCycle, PairState
from lumped.model.supports import SUPPORTS, Form
from lumped.model.supports import Supports as _Supports
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.shafts.pair import supported_shafts
from lumped.typing import FloatArray

#: Supports of the gears: four springs, or the elastic shafts of the parameter file in their bearings.
Supports = Literal["springs", "shafts"]
#: The same, and the rigid bearings of ``floquet.single_degree``, which no argument asks for.
AnySupports = Literal["springs", "shafts", "rigid"]


def supports_of(pair: GearPair, supports: Supports | None) -> Supports:
    """Return the supports of the argument; by default shafts where the pair has shafts, else springs."""
    if supports is None:
        return "springs" if pair.shafts is None else "shafts"
    one_of("supports", supports, get_args(Supports))
    return supports


def without_shafts(pair: GearPair) -> GearPair:
    """Return the pair on the springs of ``bearings``: without shafts and the ranges of their values."""
    if pair.shafts is None:
        return pair
    tables = {
        name: {path: one for path, one in getattr(pair, name) if path.split(".")[0] != "shafts"}
        for name in ("uncertainty", "posterior")
    }
    return pair.with_({"shafts": None} | tables)


def with_supports(pair: GearPair, supports: Supports | None) -> GearPair:
    """Return the pair with the supports of the argument: without shafts for "springs"."""
    if supports_of(pair, supports) == "springs":
        return without_shafts(pair)
    supported_shafts(pair)  # refused for a pair that has none
    return pair


def on_springs(pair: GearPair, supports: Supports | None, what: str) -> GearPair:
    """Return the pair without shafts, because ``what`` can be computed on springs only.

    Refused unless ``supports`` is "springs" or the pair has no shafts.
    """
    if supports_of(pair, supports) == "shafts":
        allowed = f'"springs" for {what}, which cannot be computed on shafts'
        argument = "left out for a pair with shafts" if supports is None else supports
        raise refuse("supports", argument, allowed, 'Give supports="springs".')
    return without_shafts(pair)


@dataclass(frozen=True, eq=False)
class MeshGain:
    """Feedback of the mesh, z'' = stiffness (u.z) + damping (u.z') + error + ....

    Attributes
    ----------
    stiffness, damping, error : (k, m)
    pairs : coefficients of the tooth pairs from which the feedback follows
    """

    stiffness: FloatArray
    damping: FloatArray
    error: FloatArray
    pairs: PairState


@dataclass(frozen=True, eq=False, repr=False)
class LTVSystem(DisplayedResult):
    """x' = A(t) x + b(t) with x = (z, z'), z the coordinates of ``form``; SI.

    Attributes
    ----------
    pair : the gear pair
    form : "full" (theta_p, theta_g, x_p, x_g, y_p, y_g: 12 states, with the rigid rotation),
        "elastic" (q = r_bp theta_p - r_bg theta_g instead of the rotations: 10 states) or
        "mesh" (q, x_p, x_g: the 6 states that decide stability). On shafts z are modal coordinates of
        the shafts with the teeth apart: in "full" the common rotation is first and the relative rotation
        second; "elastic" and "mesh" are the same and lack the common rotation, because gyroscopic moments
        couple y. On rigid bearings "full" has theta_p and theta_g, "elastic" and "mesh" have q
    coordinates : names of z, (m,)
    cycle : mesh cycle with positions, switch times and coefficients of the tooth pairs
    constant : (2m, 2m) part of A that does not depend on time. On springs the blocks are diagonal, because
        each bearing acts on one coordinate; on shafts they have the squares of the frequencies, the
        dissipation and the gyroscopic moments
    torque_pinion, torque_gear : (2m,) b per unit T_p and per unit T_g
    deflection : (m,) u with dynamic transmission error u . z
    reduction : (m, 6) from accelerations of both gears by forces on the gears to accelerations of z; on
        springs also from the six coordinates to z
    structure : constant data of the equations of motion without shafts
    gears : (6, m) from z to the six coordinates, up to the common rotation
    gyroscopic : (m, m) gyroscopic moments over the speed of the pinion, part of ``constant``
    supports : the supports of the gears, in the coordinates of "full"
    """

    pair: GearPair
    form: Form
    coordinates: tuple[str, ...]
    cycle: MeshCycle
    constant: FloatArray
    torque_pinion: FloatArray
    torque_gear: FloatArray
    deflection: FloatArray
    reduction: FloatArray
    structure: Structure
    gears: FloatArray
    gyroscopic: FloatArray
    supports: _Supports

    def gear_motion(self, states: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The six coordinates and their rates, (k, 6) each, of states (k, 2m); see ``gears``."""
        m = len(self.coordinates)
        return states[:, :m] @ self.gears.T, states[:, m:] @ self.gears.T

    @classmethod
    def of(
        cls,
        pair: GearPair,
        form: Form = "elastic",
        *,
        as_printed: Collection[int] = (),
        cycle: MeshCycle | None = None,
        supports: AnySupports,
        equations: Structure | None = None,
    ) -> Self:
        """Return the system of a gear pair; arguments as of ``periodic_system``.

        ``equations`` replaces the constant data of the equations of motion, on springs.
        """
        one_of("form", form, get_args(Form))
        one_of("supports", supports, get_args(AnySupports))
        s = structure(pair, as_printed) if equations is None else equations
        support = SUPPORTS[supports](pair, s)
        z = support.coordinates(form)
        m = len(z.names)
        constant = np.zeros((2 * m, 2 * m))
        torques = np.zeros((2, 2 * m))
        constant[:m, m:] = np.eye(m)
        constant[m:, :m] = -z.stiffness
        constant[m:, m:] = -z.damping
        torques[:, m:] = z.torques
        return cls(
            pair=pair,
            form=form,
            coordinates=z.names,
            cycle=cycle or MeshCycle.of(pair),
            constant=constant,
            torque_pinion=torques[0],
            torque_gear=torques[1],
            deflection=z.deflection,
            reduction=z.reduction,
            structure=s,
            gears=z.gears,
            gyroscopic=z.gyroscopic,
            supports=support,
        )

    def at_speed(self, pair: GearPair, cycle: MeshCycle) -> LTVSystem:
        """Return the system of a pair that differs in speed alone, with its mesh cycle.

        On springs and rigid bearings only the mesh cycle changes; shafts have gyroscopic moments.
        """
        if self.supports.name != "shafts":
            return replace(self, pair=pair, cycle=cycle)
        return LTVSystem.of(pair, self.form, cycle=cycle, supports="shafts")

    @property
    def pinion_torque(self) -> float:
        """T_p [N m]."""
        return self.pair.operating.pinion_torque

    @property
    def size(self) -> int:
        """Number of states 2m."""
        return 2 * len(self.coordinates)

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the states: coordinates, then rates with the suffix ``_dot``."""
        return self.coordinates + tuple(f"{name}_dot" for name in self.coordinates)

    @property
    def period(self) -> float:
        """One mesh cycle [s]."""
        return self.cycle.period

    @property
    def breakpoints(self) -> FloatArray:
        """Breaks of the coefficients strictly inside the period [s]."""
        return self.cycle.breaks[1:-1]

    @cached_property
    def per_load(self) -> FloatArray:
        """Accelerations (3, m) of z per unit N, F and F xi of a tooth pair."""
        s = self.structure
        return np.vstack([s.normal, s.friction_arm.T]) / s.mass @ self.reduction.T

    @cached_property
    def per_apart(self) -> FloatArray:
        """Acceleration (m,) of z per unit of the force by which a tip corner pushes the gears apart."""
        return np.asarray(self.structure.apart / self.structure.mass @ self.reduction.T, dtype=np.float64)

    @cached_property
    def directions(self) -> FloatArray:
        """Accelerations (4, m) of z per unit of each field of ``lumped.mesh.records.FORCE``."""
        return np.vstack([self.per_load, self.per_apart])

    def mesh_forces(
        self, time: ArrayLike, segment: int | NDArray[np.int64] | None = None
    ) -> tuple[Records, PairState]:
        """FORCE (k, 3) of the linear form at times (k,) [s], and its pairs; ``segment`` as in ``gain``."""
        pairs = self.cycle.sample(time, segment)
        return pairs.forces, pairs

    def gain(self, time: ArrayLike, segment: int | NDArray[np.int64] | None = None) -> MeshGain:
        """Rank-one feedback of the mesh at times (k,) [s]; ``segment`` as in ``MeshCycle.sample``."""
        forces, pairs = self.mesh_forces(time, segment)
        by_part = forces.view(np.float64).reshape(*forces.shape, -1) @ self.directions
        return MeshGain(by_part[:, BY_APPROACH], by_part[:, BY_RATE], by_part[:, AT_REST], pairs)

    def matrices(self, time: ArrayLike) -> FloatArray:
        """A at times (k,) [s] -> (k, 2m, 2m)."""
        gain = self.gain(time)
        return self.with_feedback(gain.stiffness, gain.damping)

    def with_feedback(self, stiffness: FloatArray, damping: FloatArray) -> FloatArray:
        """A with the mesh feedback of ``MeshGain`` (k, m) -> (k, 2m, 2m)."""
        m = len(self.coordinates)
        a = np.repeat(self.constant[None], len(stiffness), axis=0)
        a[:, m:, :m] += stiffness[:, :, None] * self.deflection
        a[:, m:, m:] += damping[:, :, None] * self.deflection
        return a

    def forcing(self, time: ArrayLike) -> FloatArray:
        """The part of b without the brake torque, at times (k,) [s] -> (k, 2m)."""
        gain = self.gain(time)
        b = np.zeros((gain.error.shape[0], self.size))
        b[:, len(self.coordinates) :] = gain.error
        return np.asarray(b + self.torque_pinion * self.pinion_torque, dtype=np.float64)

    def A(self, time: float) -> FloatArray:
        """System matrix at one time [s] -> (2m, 2m)."""
        return np.asarray(self.matrices([time])[0], dtype=np.float64)

    def b(self, time: float, brake_torque: float) -> FloatArray:
        """Forcing at one time [s] with a brake torque T_g [N m] -> (2m,)."""
        return np.asarray(self.forcing([time])[0] + self.torque_gear * brake_torque, dtype=np.float64)


def periodic_system(
    pair: AnyPair,
    form: Form = "elastic",
    *,
    as_printed: Collection[int] = (),
    cycle: MeshCycle | None = None,
    supports: Supports | None = None,
) -> LTVSystem:
    """Return the gear pair as a linear time-varying periodic system (docs/theory/equations.md, eqs. 1 to 9).

    Parameters
    ----------
    pair : a validated gear pair
    form : coordinates, see ``LTVSystem``; the rigid rotation is only in "full"
    as_printed : equations out of 1, 2, 7, 9 whose printed sign is used; every form stays exact, because all
        forces depend on the rotations through the dynamic transmission error only
    cycle : the mesh cycle of the pair, if it has been computed already
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``; by default
        the shafts of a pair that has them

    Raises
    ------
    ParameterError : unknown form, supports or equation, or shafts that the pair does not have
    """
    pair = load_gear_pair(pair)
    supports = supports_of(pair, supports)
    return LTVSystem.of(pair, form, as_printed=as_printed, cycle=cycle, supports=supports)
