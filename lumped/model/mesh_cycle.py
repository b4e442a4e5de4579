"""One mesh cycle: where each tooth pair is, when the coefficients switch, and what they are in between.

Sources: Abbas Al-Zubaidi 2008, eqs. 5a and 5b; docs/theory/equations.md, "Frame".
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lumped.errors import LikeTeethWarning
from lumped.gear_geometry.geometry import Geometry
from lumped.mesh.linear import forces_of_laws
from lumped.mesh.records import Records
from lumped.path_function import PathFunction
from lumped.quasi_static.contacts import contact_of
from lumped.quasi_static.elements import MeshElements, mean_of_pairs
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray, IntArray

#: One-sided limits are taken this fraction of a base pitch inside a segment.
_INSIDE = 1e-12
#: Switch times closer than this fraction of a cycle are one.
_SAME = 1e-10
#: The same for breaks: their phases are known to this.
_ROUNDING = 1e-13


@dataclass(frozen=True)
class PairState:
    """Coefficients of every tooth pair; each array (pairs, k), zero for a pair out of contact.

    Attributes
    ----------
    position : xi_i, also for a pair out of contact [m]
    contact : whether the pair is where it can touch
    stiffness, damping, friction, error, error_rate : k_i [N/m], c_i [N s/m], mu_i [-], e_i [m], de_i/dt [m/s]
    tilt : sine of the angle between normal and line of action [-]; None where that is 0
    closing : rate of the compression over delta' - e' [-]; None where that is 1
    """

    position: FloatArray
    contact: BoolArray
    stiffness: FloatArray
    damping: FloatArray
    friction: FloatArray
    error: FloatArray
    error_rate: FloatArray
    tilt: FloatArray | None = None
    closing: FloatArray | None = None

    def of_places(self, kept: IntArray) -> PairState:
        """Those of some places (n,) alone."""
        arrays: dict[str, Any] = {one.name: getattr(self, one.name) for one in fields(self)}
        return replace(self, **{name: one[kept] for name, one in arrays.items() if one is not None})

    def taken(self, rate: FloatArray) -> FloatArray:
        """Power (pairs, k) [W] that the dampers take in the linear form, at a rate of the approach [m/s]."""
        share = 1.0 if self.closing is None else self.closing
        return np.asarray(share * self.damping * (rate - self.error_rate) ** 2)

    @property
    def damper_power(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """``taken`` of all pairs over the square of the rate of the approach, over the rate, and the rest."""
        damping = self.damping if self.closing is None else self.closing * self.damping
        by_rate = -2.0 * damping * self.error_rate
        return damping.sum(axis=0), by_rate.sum(axis=0), (damping * self.error_rate**2).sum(axis=0)

    def load(self, approach: FloatArray, rate: FloatArray) -> FloatArray:
        """Normal load (pairs, k) [N] of the linear form, at an approach [m] and its rate [m/s]."""
        closing = rate - self.error_rate
        return np.asarray(self.stiffness * (approach - self.error) + self.damping * closing)

    @property
    def forces(self) -> Records:
        """FORCE (k, 3) of all pairs in the linear form, see ``lumped.mesh.linear``."""
        at_rest = -(self.stiffness * self.error + self.damping * self.error_rate)
        loads = self.stiffness, self.damping, at_rest
        return forces_of_laws(self.position, self.friction, self.tilt, *loads)


@dataclass(frozen=True, eq=False)
class MeshCycle:
    """The mesh cycle of a pair, from its geometry and elements, at nominal rotation; t = 0 is pair n at A."""

    geometry: Geometry
    elements: MeshElements

    @property
    def period(self) -> float:
        """T_m = lambda / (Omega_p r_bp) [s]."""
        return self.geometry.mesh_period

    @classmethod
    def of(cls, pair: GearPair) -> Self:
        """The mesh cycle of a gear pair in its own form of contact, with like teeth."""
        if pair.healthy is not pair:
            text = f"{pair.name}: teeth that differ are taken as alike here, as pair.healthy has them."
            warnings.warn(LikeTeethWarning(text), stacklevel=4)
        return cls(pair.geometry, contact_of(pair).elements(pair))

    @property
    def mean_stiffness(self) -> float:
        """Mean over the mesh cycle of the stiffness of all pairs [N/m]."""
        return mean_of_pairs(self.elements.stiffness, self.geometry.base_pitch)

    @property
    def start(self) -> float:
        """Where a pair can first touch: A, or before it with loaded contact [m]."""
        return self.elements.stiffness.interval[0]

    @property
    def end(self) -> float:
        """Where a pair can last touch: D, or behind it with loaded contact [m]."""
        return self.elements.stiffness.interval[1]

    @cached_property
    def offsets(self) -> FloatArray:
        """xi_i at t = 0, whole pitches from A, of all pairs that can touch in the cycle; ahead first [m]."""
        g = self.geometry
        ahead = math.floor((self.end - g.L_XA) / g.base_pitch)
        behind = math.ceil((g.L_XA - self.start) / g.base_pitch)
        return np.asarray(g.L_XA + np.arange(ahead, -behind - 1, -1) * g.base_pitch, dtype=np.float64)

    @cached_property
    def switch_times(self) -> FloatArray:
        """Times strictly inside (0, T_m) at which a coefficient jumps or has a kink; increasing [s]."""
        entry_pitch_exit = np.array([self.geometry.L_XP, self.start, self.end])
        return self._times([entry_pitch_exit, *(law.switches for law in self._laws)])

    @property
    def _laws(self) -> tuple[PathFunction, ...]:
        e = self.elements
        laws = e.stiffness, e.damping, e.friction, e.error
        return laws if e.tilt is None or e.closing is None else (*laws, e.tilt, e.closing)

    def _times(self, positions: list[FloatArray]) -> FloatArray:
        """Increasing times strictly inside (0, T_m) at which any pair is at any of the positions [s]."""
        g = self.geometry
        phases = np.sort(np.mod((np.concatenate(positions) - g.L_XA) / g.base_pitch, 1.0))
        phases = phases[(phases > _SAME) & (phases < 1.0 - _SAME)]
        keep = np.diff(phases, prepend=-1.0) > _SAME
        return np.asarray(phases[keep] * self.period, dtype=np.float64)

    @cached_property
    def edges(self) -> FloatArray:
        """Ends of the segments without jumps and kinks, 0 and T_m included [s]; see ``breaks``."""
        return np.concatenate([[0.0], self.switch_times, [self.period]])

    @cached_property
    def break_phases(self) -> FloatArray:
        """Phases in [0, 1) at which a pair passes any break of a law, or A, P or D; as computed."""
        g = self.geometry
        positions = np.concatenate([[g.L_XA, g.L_XP, g.L_XD], *(law.breaks for law in self._laws)])
        return np.asarray(np.unique(np.mod((positions - g.L_XA) / g.base_pitch, 1.0)), dtype=np.float64)

    @cached_property
    def bends(self) -> FloatArray:
        """Times strictly inside (0, T_m) at which a law of a pair is not smooth, switches included [s]."""
        return np.union1d(self.switch_times, self._times([law.bends for law in self._laws]))

    @cached_property
    def breaks(self) -> FloatArray:
        """Ends of the pieces in which every law of every pair is one polynomial, 0 and T_m included [s].

        The one list of such times: quadrature, propagation, fits and error bounds all read it. ``edges`` are
        among them; other breaks that are closer together than rounding count as one.
        """
        near = _ROUNDING * self.period
        marks = np.union1d(self.edges, self.break_phases * self.period)
        marks = marks[(marks <= 0.0) | (marks >= near)]
        marks = marks[(marks >= self.period) | (marks <= self.period - near)]
        close = np.flatnonzero(np.diff(marks) < near)
        fixed = is_edge(marks, self.edges)
        return np.asarray(np.delete(marks, [j if fixed[j + 1] else j + 1 for j in close]), dtype=np.float64)

    @cached_property
    def _contact(self) -> BoolArray:
        """Which pairs can touch in which smooth segment (pairs, segments); it cannot change inside."""
        g = self.geometry
        middle = 0.5 * (self.edges[:-1] + self.edges[1:]) * g.omega_pinion * g.base_radius_pinion
        place = self.offsets[:, None] + middle
        return np.asarray((place >= self.start) & (place <= self.end))

    def sample(self, time: ArrayLike, segment: int | NDArray[np.int64] | None = None) -> PairState:
        """Return the coefficients of all pairs at times t [s], any number of cycles.

        Parameters
        ----------
        time : (k,) times [s]
        segment : the smooth segment to which all times belong, or each (k,), so that values at its ends are
            its one-sided limits; by default each time's own segment, right-continuous at switches
        """
        g = self.geometry
        t = np.atleast_1d(np.asarray(time, dtype=float))
        if segment is None:
            # Times round to either side of an edge, by more in later cycles; just before it counts as at it.
            same = _ROUNDING * self.period + 4.0 * np.spacing(np.abs(t))
            tau = np.mod(t, self.period)
            tau = np.where(tau > self.period - same, 0.0, tau)
            index = np.searchsorted(self.edges[1:-1], tau + same, side="right")
        else:
            tau = t
            index = np.broadcast_to(segment, t.shape)
        speed = g.omega_pinion * g.base_radius_pinion
        inside = _INSIDE * g.base_pitch
        low, high = speed * self.edges[index] + inside, speed * self.edges[index + 1] - inside
        shift = np.clip(speed * tau, low, high)
        contact = np.take(self._contact, index, axis=1)
        place = self.offsets[:, None] + shift
        slope, k, c, mu, error, *corners = (
            np.where(contact, law(place), 0.0) for law in (self.elements.error_slope, *self._laws)
        )
        position = self.offsets[:, None] + speed * tau
        return PairState(position, contact, k, c, mu, error, slope * speed, *corners)


def is_edge(times: FloatArray, edges: FloatArray) -> BoolArray:
    """Whether each of some times (k,) is one of the increasing edges; a tenth of the time of `numpy.isin`."""
    return np.asarray(edges[np.minimum(np.searchsorted(edges, times), edges.size - 1)] == times)


def mesh_cycle(pair: AnyPair) -> MeshCycle:
    """Return the mesh cycle of a gear pair."""
    return MeshCycle.of(load_gear_pair(pair))
