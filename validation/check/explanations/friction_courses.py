"""Alterations of the friction over the path of contact: where it acts, where it reverses, by which load.

Sources: docs/how_to/check_your_model.md, "Explanations"; docs/theory/friction.md for the laws.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lumped.mesh.records import AT_REST, BY_APPROACH, BY_RATE, Records
from lumped.model.mesh_cycle import PairState
from lumped.model.periodic_system import LTVSystem
from lumped.path_function import PathFunction
from lumped.quasi_static.elements import mean_of_pairs
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.explanations.pair_laws import SAME, TOLERANCE, marks_of, separate, total_of_pairs

Friction = Literal[
    "",
    "without reversal",
    "leading pair",
    "total load on the leading pair",
    "newest pair",
    "total load on the newest pair",
    "pitch point of the rack",
    "middle of the path",
    "middle of the line of action",
    "coefficient of the newest pair",
    "coefficient of the leading pair",
    "line of the rack",
    "equal shares of the load",
    "static load",
    "static load in equal shares",
    "natural logarithm",
]
#: Courses in which friction follows a load that does not vibrate.
STATIC_LOAD = ("static load", "static load in equal shares")


class StaticFriction(LTVSystem):
    """The linear system with friction by the static load F = T_p/r_bp, not by the load that vibrates.

    A tooth pair has the friction force mu F k/K, with K the stiffness of all pairs: a force that only the
    time decides.
    """

    equal: bool = False

    def mesh_forces(
        self, time: ArrayLike, segment: int | NDArray[np.int64] | None = None
    ) -> tuple[Records, PairState]:
        """Return FORCE (k, 3) of the linear form at times (k,) [s], and its pairs."""
        pairs = self.cycle.sample(time, segment)
        forces = pairs.forces.copy()
        friction = static_friction(self, pairs, equal=self.equal)
        for row in (BY_APPROACH, BY_RATE):
            forces["friction_force"][..., row] = 0.0
            forces["friction_moment"][..., row] = 0.0
        forces["friction_force"][..., AT_REST] = friction.sum(axis=0)
        forces["friction_moment"][..., AT_REST] = (friction * pairs.position).sum(axis=0)
        return forces, pairs


class EqualStaticFriction(StaticFriction):
    """The same with F in equal shares on the pairs in contact."""

    equal = True


def static_friction(system: LTVSystem, pairs: PairState, *, equal: bool) -> FloatArray:
    """Return the friction force (pairs, k) of each tooth pair by its share of the static load [N].

    ``equal``: each pair in contact has the same share; else shares are as the stiffnesses.
    """
    force = system.pinion_torque / system.pair.geometry.base_radius_pinion
    weights = pairs.contact.astype(float) if equal else pairs.stiffness
    share = weights / np.maximum(weights.sum(axis=0), np.finfo(float).tiny)
    return np.asarray(force * share * pairs.friction)


def shifted_friction(pair: GearPair, friction: PathFunction, shift: float) -> PathFunction:
    """Return the friction coefficient over xi of a path of contact that lies further along by a length [m].

    Beyond its ends the coefficient stays.
    """
    low, high = friction.interval
    edge = SAME * pair.geometry.base_pitch

    def further(xi: FloatArray) -> FloatArray:
        return np.asarray(friction(np.clip(xi + shift, low + edge, high - edge)))

    marks = np.append(friction.breaks, [low, high, pair.geometry.L_XP]) - shift
    marks = separate(marks, pair, low, high)
    size = float(np.abs(further(np.linspace(low, high, 401)[1:-1])).max())
    breaks = np.concatenate([[low], marks, [high]])
    return PathFunction.fit(further, breaks, marks, tolerance=TOLERANCE * max(size, 1e-300))


def friction_over_path(
    pair: GearPair, friction: PathFunction, stiffness: PathFunction, course: Friction
) -> PathFunction:
    """Return the friction coefficient over xi with another course.

    Without reversal: |mu|. Only the leading pair, the last one that is on the path of contact: mu where the
    next pair is no longer there, else 0. Only the newest pair, the one that came into contact last: the same
    before the next pair comes. The friction of one pair by the load of all pairs: mu K/k there, with the
    stiffness K of the whole mesh, because loads are shared as stiffnesses. Reversal at another place: |mu|
    with the sign that mu has on its side of that place.

    Equal shares of the load: mu K/(n k) with n pairs in contact. Line of the rack: the law of a line whose
    pitch point is that of the rack. Natural logarithm: ln(10) mu, at most the bound of the pair. Coefficient
    of the newest or the leading pair: mu at the place of that pair, for all pairs.
    """
    if course in STATIC_LOAD:
        return friction  # the load changes, not the coefficient
    if course == "line of the rack":
        return shifted_friction(pair, friction, pair.geometry.L_XP - pitch_point_of_rack(pair))
    low, high = friction.interval
    pitch = pair.geometry.base_pitch
    only_newest = course.endswith("newest pair")
    change_of_pairs = low + pitch if only_newest else high - pitch
    total = total_of_pairs(pair, stiffness)
    pairs = total_of_pairs(pair, PathFunction.constant(1.0, *stiffness.interval))
    reversal = reversal_of(pair, course, low, high)
    behind = float(np.sign(friction(np.array([high - SAME * pitch]))[0]))

    def changed(xi: FloatArray) -> FloatArray:
        if course == "without reversal":
            return np.abs(friction(xi))
        if course == "coefficient of the newest pair":
            return friction(low + np.mod(xi - low, pitch))
        if course == "coefficient of the leading pair":
            return friction(high - np.mod(high - xi, pitch))
        if course == "natural logarithm":
            most = max(pair.friction.maximum, float(np.abs(friction(xi)).max()))
            return np.asarray(np.clip(math.log(10.0) * friction(xi), -most, most))
        if course == "equal shares of the load":
            of_pair = np.maximum(stiffness(xi), 1e-6 * pair_stiffness_scale)
            return np.asarray(friction(xi) * total(xi) / np.maximum(pairs(xi), 1.0) / of_pair)
        if reversal is not None:
            return np.asarray(behind * np.sign(xi - reversal) * np.abs(friction(xi)))
        alone = xi < change_of_pairs if only_newest else xi > change_of_pairs
        of_one_pair = np.where(alone, friction(xi), 0.0)
        if not course.startswith("total"):
            return np.asarray(of_one_pair)
        of_pair = np.maximum(stiffness(xi), 1e-6 * pair_stiffness_scale)
        return np.asarray(of_one_pair * np.maximum(total(xi), of_pair) / of_pair)

    pair_stiffness_scale = mean_of_pairs(stiffness, pitch)
    by_load = course.startswith(("total", "equal"))
    laws = (friction, stiffness) if by_load else (friction,)
    marks = marks_of(pair, laws, low, high)
    reach = int(np.ceil((high - low) / pitch))
    of_others = pair.geometry.L_XP + np.arange(-reach, reach + 1) * pitch
    marks = np.append(marks, [change_of_pairs, *of_others, *([] if reversal is None else [reversal])])
    marks = separate(marks, pair, low, high)
    size = float(np.abs(changed(np.linspace(low, high, 401)[1:-1])).max())
    breaks = np.concatenate([[low], marks, [high]])
    return PathFunction.fit(changed, breaks, marks, tolerance=TOLERANCE * max(size, 1e-300))


def pitch_point_of_rack(pair: GearPair) -> float:
    """Return the place xi of the pitch point at the standard centre distance [m]."""
    return pair.geometry.base_radius_pinion * math.tan(pair.basic_rack.pressure_angle)


def reversal_of(pair: GearPair, course: Friction, low: float, high: float) -> float | None:
    """Return the place xi [m] at which friction reverses where that is not the pitch point; None: it is.

    The pitch point of the rack lies at r_b tan(alpha) with the pressure angle of the rack, not of operation.
    """
    if course == "pitch point of the rack":
        return pitch_point_of_rack(pair)
    if course == "middle of the line of action":
        return 0.5 * pair.geometry.L_XY
    return 0.5 * (low + high) if course == "middle of the path" else None


def smoothed_friction(
    pair: GearPair, friction: PathFunction, speed: float, shape: Literal["tanh", "ramp"]
) -> PathFunction:
    """Return the friction coefficient |mu| s(v/v_0) over xi, with s = tanh or a ramp from -1 to 1.

    v is the sliding velocity with its sign, v_0 a share ``speed`` of its largest size on the path.
    """
    low, high = friction.interval
    pitch_point = pair.geometry.L_XP
    reach = speed * max(pitch_point - low, high - pitch_point)

    def changed(xi: FloatArray) -> FloatArray:
        sliding = (xi - pitch_point) / reach
        size = np.tanh(sliding) if shape == "tanh" else np.clip(sliding, -1.0, 1.0)
        return np.asarray(np.abs(friction(xi)) * size)

    marks = np.append(friction.breaks, [pitch_point, pitch_point - reach, pitch_point + reach])
    marks = separate(marks, pair, low, high)
    size = float(np.abs(changed(np.linspace(low, high, 401)[1:-1])).max())
    breaks = np.concatenate([[low], marks, [high]])
    return PathFunction.fit(changed, breaks, marks, tolerance=TOLERANCE * max(size, 1e-300))
