"""The element laws of one tooth pair, which both models share, and the base class of the forms of contact.

Sources: Abbas Al-Zubaidi 2008, eqs. 3 and 4; damping c_i = 2 zeta sqrt(k_i m_e), as He, Cho and Singh 2008.
"""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lumped.display.result import DisplayedResult
from lumped.path_function import PathFunction
from lumped.root_in_bracket import roots_in_brackets
from lumped.schema.assumed import Assumed
from lumped.schema.contact import Lubricant
from lumped.schema.friction import Friction
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray

#: Values of ``at_rest`` in fields that statics does not read. Any values do.
_SPEED = 100.0
_FRICTION = Friction.model_construct(law="none")
_LUBRICANT = Lubricant.model_construct(viscosity=1.0)
_OF_GEAR = {"inertia": None, "roughness": 0.0}
_OF_BEARING = {"loa_damping_ratio": 0.0, "oloa_damping_ratio": 0.0}
#: Samples over the searched range. Between two samples contact begins or ends at most once.
_SAMPLES = 500


@dataclass(frozen=True, eq=False, repr=False)
class MeshElements(DisplayedResult):
    """Element laws of one tooth pair over the interval of xi in which it can touch; zero outside.

    The interval is [L_XA, L_XD] with prescribed contact, and longer with loaded contact.

    N = k (delta - e) + c (delta' - e'), F = mu N (docs/theory/equations.md, eqs. 3 and 4). The compression
    grows at the rate f (delta' - e'), so the power of the damper is f c (delta' - e')^2.

    Attributes
    ----------
    stiffness : k [N/m]
    damping : c = 2 zeta sqrt(k m_e) [N s/m], with loaded contact times f and the share that acts
    friction : mu at nominal speed [-], signed by s = sgn(xi - L_XP)
    error : e, unloaded tooth error, positive where the teeth come too late to touch [m]
    gap : gap whose slope is the e' of the damper; None where the slope of e is [m]
    tilt : sine of the angle by which a tip corner beyond A and D turns the normal out of the line of action
        [-]. A tilted force pushes the gears apart. None: teeth touch on the line of action only
    closing : f, share of the approach that compresses the pair [-]. At a tip corner f is less than 1, because
        the approach also moves the contact further outside. None: f is 1
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
        """Slope e' over xi for the damper [-]: the slope of ``gap``, or of ``error`` without a gap."""
        return (self.error if self.gap is None else self.gap).slope


class Contact(ABC):
    """A form of contact of the linear model: where a tooth pair touches, and with which laws."""

    name: ClassVar[str]
    #: Whether the elastic energy of the teeth is conserved, so that the brake balances every loss.
    conservative: ClassVar[bool]
    #: In words, whose load must not be negative: a negative load is contact loss.
    pressed: ClassVar[str]
    #: Whether the damping of a pair is 2 zeta sqrt(k m_e) wherever it touches.
    root_damping: ClassVar[bool]

    @abstractmethod
    def elements(self, pair: GearPair) -> MeshElements:
        """Return the laws of one tooth pair."""

    @abstractmethod
    def neighbours(self, pair: GearPair) -> Sequence[PathFunction]:
        """Return w_m(xi) [m/N], m = 1, 2, ...: how far the load of a pair moves the pair m pitches ahead."""

    @abstractmethod
    def unilateral_elements(self, pair: GearPair) -> MeshElements:
        """Return the laws of a tooth pair that touches where its flanks meet. Relief is clearance."""

    @abstractmethod
    def pressing(self, load: FloatArray, contact: BoolArray) -> tuple[FloatArray, BoolArray]:
        """Return the loads that must not be negative (n, k) [N], and whether each is in contact (n, k).

        Parameters
        ----------
        load, contact : (pairs, k) load of each pair [N], and whether the pair can touch
        """


def at_rest(pair: GearPair) -> GearPair:
    """Return the pair without speed, friction, oil, dampers and inertia, on which statics does not depend.

    Static results are cached by this pair.
    """
    pair = pair.healthy
    bearings = {
        gear: getattr(pair.bearings, gear).model_copy(update=_OF_BEARING) for gear in ("pinion", "gear")
    }
    fields = {name: getattr(pair, name) for name in GearPair.model_fields}
    fields |= {
        "name": "",
        "description": "",
        "sources": (),
        "assumed": Assumed(),
        "friction": _FRICTION,
        "lubricant": _LUBRICANT,
        "pinion": pair.pinion.model_copy(update=_OF_GEAR),
        "gear": pair.gear.model_copy(update=_OF_GEAR),
        "bearings": pair.bearings.model_copy(update=bearings),
        "mesh": pair.mesh.model_copy(update={"damping_ratio": 0.0}),
        "operating": pair.operating.at_speed(_SPEED),
    }
    return GearPair.model_construct(**fields)


def mean_of_pairs(law: PathFunction, pitch: float) -> float:
    """Mean over the mesh cycle of the sum of a law over all pairs."""
    low, high = law.interval
    return law.mean() * (high - low) / pitch


def positive_intervals(
    function: Callable[[FloatArray], FloatArray], low: float, high: float, kinks: FloatArray, pitch: float
) -> FloatArray:
    """Intervals (n, 2) of [low, high] in which a function of positions is positive [m].

    Parameters
    ----------
    function : positions (n,) -> values (n,)
    low, high : ends of the searched range [m]
    kinks : positions at which the function jumps or has a kink, any shape [m]
    pitch : base pitch, the scale for positions that are close to each other [m]
    """
    inside = 1e-12 * pitch
    marks = np.unique(kinks[(kinks > low + inside) & (kinks < high - inside)])
    smooth = [(a, b) for a, b in itertools.pairwise([low, *marks, high]) if b - a > 4 * inside]
    starts, stops = np.array(smooth).T
    counts = np.maximum(3, (_SAMPLES * (stops - starts) / (high - low)).astype(np.int64))
    first = np.concatenate([[0], np.cumsum(counts)])
    number = np.arange(first[-1]) - np.repeat(first[:-1], counts)
    steps = ((stops - inside) - (starts + inside)) / (counts - 1)
    xi = number * np.repeat(steps, counts) + np.repeat(starts + inside, counts)
    xi[first[1:] - 1] = stops - inside
    positive = function(xi) > 0.0
    changes = np.setdiff1d(np.flatnonzero(np.diff(positive)), first[1:] - 1)
    roots = roots_in_brackets(function, xi[changes], xi[changes + 1], xtol=1e-16)
    ends = np.sort(np.concatenate([starts[positive[first[:-1]]], roots, stops[positive[first[1:] - 1]]]))
    meet = 2 * np.flatnonzero(np.diff(ends)[1::2] <= 4 * inside)  # intervals that meet at a mark are one
    return np.delete(ends, [*(meet + 1), *(meet + 2)]).reshape(-1, 2)


def restricted(function: PathFunction, intervals: FloatArray) -> PathFunction:
    """Return the function on the intervals (n, 2), and zero between them. Its jumps are switches."""
    low, high = function.interval
    function = function.split(intervals)
    ends = intervals.ravel()
    middle = 0.5 * (function.breaks[:-1] + function.breaks[1:])
    inside = ((middle[:, None] > intervals[:, 0]) & (middle[:, None] < intervals[:, 1])).any(axis=1)
    jumps = ends[(ends > low) & (ends < high)]
    return PathFunction(
        function.breaks, np.where(inside, function.coefficients, 0.0), np.union1d(function.switches, jumps)
    )
