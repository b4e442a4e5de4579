"""The coordinates of a gear pair that decide its stability: three on springs, the modes that count on shafts.

Sources: docs/theory/floquet.md, "Structure".
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag, eigh

from floquet.gear.axes import GearVariation
from lumped.model.equations import structure
from lumped.model.periodic_system import LTVSystem, periodic_system
from lumped.typing import FloatArray

MODES = 12
"""Modes of a pair on shafts that are coupled at most; the others move each by itself."""
_EQUAL = 1e-6  # natural frequencies that differ by no more than this part are one


@dataclass(frozen=True, eq=False)
class Feedback:
    """The coordinates that the mesh couples.

    Attributes
    ----------
    system : x' = A(t) x in these coordinates; modes of a pair on shafts have unit modal mass
    gyroscopic : (m, m) part of the constant damping that is proportional to speed, over that of the pinion
    """

    system: LTVSystem
    gyroscopic: FloatArray

    @cached_property
    def squares(self) -> FloatArray:
        """Squares of the natural frequencies (m,) with the mean stiffness of the mesh, without friction."""
        v, m = self.system.deflection, self.system.deflection.size
        k = self.system.cycle.mean_stiffness
        return np.asarray(k * v**2 - np.diag(self.system.constant[m:, :m]))

    def in_terms_of(self, modes: FloatArray) -> Feedback:
        """The same in the coordinates whose unit vectors are the columns of ``modes`` (m, k), orthonormal."""
        s, both = self.system, block_diag(modes, modes)
        return Feedback(
            replace(
                s,
                coordinates=tuple(f"mode_{j + 1}" for j in range(modes.shape[1])),
                constant=both.T @ s.constant @ both,
                torque_pinion=s.torque_pinion @ both,
                torque_gear=s.torque_gear @ both,
                deflection=s.deflection @ modes,
                reduction=modes.T @ s.reduction,
                gears=s.gears @ modes,
                shafts=None,
            ),
            modes.T @ self.gyroscopic @ modes,
        )


def feedback_system(variation: GearVariation) -> Feedback:
    """Return what the mesh couples of a gear pair, on shafts at most `MODES` modes."""
    return _ranked(variation)[0]


def separate_modes(variation: GearVariation) -> tuple[FloatArray, FloatArray]:
    """Decay rates [1/s] and squares of the natural frequencies (k,) of what `feedback_system` leaves out.

    On springs these are the motions off the line of action, on shafts the modes that count least.
    """
    if variation.supports == "springs":
        s = structure(variation.pair)
        return s.damping[4:] / (2.0 * s.mass[4:]), s.stiffness[4:] / s.mass[4:]
    left = _ranked(variation)[1]
    return -0.5 * np.diag(left.system.constant)[left.squares.size :], left.squares


def _ranked(variation: GearVariation) -> tuple[Feedback, Feedback]:
    """The coordinates that are kept coupled, and the others."""
    system = periodic_system(variation.pair, "mesh", cycle=variation.cycle(), supports=variation.supports)
    m = system.deflection.size
    if system.shafts is None:
        whole = Feedback(system, np.zeros((m, m)))
        return whole, whole.in_terms_of(np.empty((m, 0)))
    mesh = system.cycle.mean_stiffness * np.outer(system.deflection, system.deflection)
    modes = eigh(mesh - system.constant[m:, :m])[1]
    # The first coordinate of the shafts is the common rotation, which no tooth feels.
    whole = Feedback(system, system.shafts.gyroscopic[1:, 1:]).in_terms_of(modes)
    whole = whole.in_terms_of(_turn(whole))
    order = np.argsort(-importance(whole), kind="stable")
    kept, left = (np.sort(part) for part in (order[:MODES], order[MODES:]))
    return whole.in_terms_of(np.eye(m)[:, kept]), whole.in_terms_of(np.eye(m)[:, left])


def _turn(feedback: Feedback) -> FloatArray:
    """Combinations (m, m) of modes of equal frequency of which few count.

    The first of each group has all of its deflection, the second all of the gyroscopic moments of the first.
    """
    squares = feedback.squares
    turn = np.eye(squares.size)
    for group in np.split(
        np.arange(squares.size), 1 + np.flatnonzero(np.diff(squares) > _EQUAL * squares[1:])
    ):
        own = np.ix_(group, group)
        first = feedback.system.deflection[group]
        leading = np.column_stack([first, feedback.gyroscopic[own] @ first, np.eye(group.size)])
        leading /= np.maximum(np.linalg.norm(leading, axis=0), np.finfo(float).tiny)
        turn[own] = np.linalg.qr(leading)[0]
    return turn


def importance(feedback: Feedback) -> FloatArray:
    """How much each mode (m,) of a pair on shafts counts in the motion of the mesh, whatever the speed.

    That is the share that the mode has of the static deflection under a mesh force, and what damping and
    gyroscopic moments give it of the others, each at the speed where the mesh frequency is that mode's.
    """
    system, squares = feedback.system, feedback.squares
    v, m = system.deflection, squares.size
    share = v**2 / squares / (v**2 / squares).sum()
    omega, g = np.sqrt(squares), system.pair.geometry
    damping = system.constant[m:, m:] + g.omega_pinion * feedback.gyroscopic
    coupling = omega * (np.abs(damping) + omega / system.pair.pinion.teeth * np.abs(feedback.gyroscopic))
    apart = np.maximum(np.abs(squares[:, None] - squares), coupling + np.finfo(float).tiny)
    ratio = coupling / apart
    np.fill_diagonal(ratio, 0.0)
    return np.asarray(share + np.square(ratio) @ share)
