"""The element laws of one tooth pair that every model of the pair shares, and what a form of contact is.

Sources: Abbas Al-Zubaidi 2008, eqs. 3 and 4; damping c_i = 2 zeta sqrt(k_i m_e), as He, Cho and Singh 2008.
"""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.optimize import brentq

from lumped.path_function import PathFunction
from lumped.schema.assumed import Assumed
from lumped.schema.friction import Friction
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray

#: Speed [rad/s] and friction of the pairs by which static results are cached: any.
_SPEED = 100.0
_FRICTION = Friction.model_construct(law="none")
#: Samples over the searched range between which contact begins or ends at most once.
_SAMPLES = 500


@dataclass(frozen=True, eq=False)
class MeshElements:
    """Element laws of one tooth pair over the interval of xi in which it can touch; zero outside.

    That is [L_XA, L_XD] with prescribed contact, and reaches beyond with loaded contact.

    N = k (delta - e) + c (delta' - e'), F = mu N (docs/theory/equations.md, eqs. 3 and 4). The compression
    grows at the rate f (delta' - e'), so the damper takes f c (delta' - e')^2.

    Attributes
    ----------
    stiffness : k [N/m]
    damping : c = 2 zeta sqrt(k m_e) [N s/m], with loaded contact times f and the share that acts
    friction : mu at nominal speed [-], signed by s = sgn(xi - L_XP)
    error : e, unloaded tooth error, positive where the teeth come too late to touch [m]
    gap : that whose slope is the e' of the damper, where it is not that of e [m]
    tilt : sine of the angle by which a tip corner beyond A and D turns the normal out of the line of action,
        so that it pushes the gears apart [-]; None where teeth touch on that line alone
    closing : f, by how much less than 1 the approach closes a tip corner, whose contact it moves outside [-];
        None where it is 1
    """

    stiffness: PathFunction
    damping: PathFunction
    friction: PathFunction
    error: PathFunction
    gap: PathFunction | None = None
    tilt: PathFunction | None = None
    closing: PathFunction | None = None

    @property
    def error_slope(self) -> PathFunction:
        """E' over xi, that the damper sees: of the gap itself where e is the tangent's [-]."""
        return (self.error if self.gap is None else self.gap).slope


class Contact(ABC):
    """A form of contact of the linear model: where a tooth pair touches, and with which laws."""

    name: ClassVar[str]
    #: Whether the elastic energy of the teeth is conserved, so that the brake balances every loss.
    conservative: ClassVar[bool]
    #: What must press in words: below zero load it has lost contact.
    pressed: ClassVar[str]
    #: Whether the damping of a pair is 2 zeta sqrt(k m_e) wherever it touches.
    root_damping: ClassVar[bool]

    @abstractmethod
    def elements(self, pair: GearPair) -> MeshElements:
        """Laws of one tooth pair."""

    @abstractmethod
    def neighbours(self, pair: GearPair) -> Sequence[PathFunction]:
        """How far the load of a pair moves the one m pitches ahead, w_m(xi), m = 1, 2, ... [m/N]."""

    @abstractmethod
    def unilateral_elements(self, pair: GearPair) -> MeshElements:
        """Laws of one tooth pair that touches where its flanks meet, relief being clearance."""

    @abstractmethod
    def pressing(self, load: FloatArray, contact: BoolArray) -> tuple[FloatArray, BoolArray]:
        """Loads that must not pull [N] and where they touch (n, k), of those of the pairs (pairs, k)."""


def at_rest(pair: GearPair) -> GearPair:
    """The pair without speed, friction and dampers, which statics does not feel: the key of its results."""
    pair = pair.healthy
    fields = {name: getattr(pair, name) for name in GearPair.model_fields}
    fields |= {
        "name": "",
        "description": "",
        "sources": (),
        "assumed": Assumed(),
        "friction": _FRICTION,
        "mesh": pair.mesh.model_copy(update={"damping_ratio": 0.0}),
        "operating": pair.operating.model_copy(update={"pinion_speed": _SPEED}),
    }
    return GearPair.model_construct(**fields)


def mean_of_pairs(law: PathFunction, pitch: float) -> float:
    """Mean over the mesh cycle of the sum of a law over all pairs."""
    low, high = law.interval
    return law.mean() * (high - low) / pitch


def positive_intervals(
    function: Callable[[FloatArray], FloatArray], low: float, high: float, kinks: FloatArray, pitch: float
) -> FloatArray:
    """Intervals (n, 2) of [low, high] in which a function (n,) -> (n,) of positions is positive [m].

    ``kinks`` are where it jumps or has a kink, any shape; the base pitch is the scale of what is close.
    """
    inside = 1e-12 * pitch
    marks = np.unique(kinks[(kinks > low + inside) & (kinks < high - inside)])
    ends: list[float] = []
    for left, right in itertools.pairwise([low, *marks, high]):
        if right - left <= 4 * inside:
            continue
        count = max(3, int(_SAMPLES * (right - left) / (high - low)))
        xi = np.linspace(left + inside, right - inside, count)
        positive = function(xi) > 0.0
        roots = [
            float(brentq(lambda x: float(function(np.array([x]))[0]), xi[j], xi[j + 1], xtol=1e-16))
            for j in np.flatnonzero(np.diff(positive))
        ]
        ends += [*([left] if positive[0] else []), *roots, *([right] if positive[-1] else [])]
    meet = 2 * np.flatnonzero(np.diff(ends)[1::2] <= 4 * inside)  # intervals that meet at a mark are one
    return np.delete(ends, [*(meet + 1), *(meet + 2)]).reshape(-1, 2)


def restricted(function: PathFunction, intervals: FloatArray) -> PathFunction:
    """The function on the intervals (n, 2), zero between them; jumps are switches."""
    low, high = function.interval
    function = function.split(intervals)
    ends = intervals.ravel()
    middle = 0.5 * (function.breaks[:-1] + function.breaks[1:])
    kept = ((middle[:, None] > intervals[:, 0]) & (middle[:, None] < intervals[:, 1])).any(axis=1)
    jumps = ends[(ends > low) & (ends < high)]
    return PathFunction(
        function.breaks, np.where(kept, function.coefficients, 0.0), np.union1d(function.switches, jumps)
    )
