"""The mesh cycle of like teeth: positions of the tooth pairs, coefficients, and the times of their switches.

Sources: Abbas Al-Zubaidi 2008, eqs. 5a and 5b; docs/theory/equations.md, "Frame".
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lumped.display.result import DisplayedResult
from lumped.errors import LikeTeethWarning
from lumped.gear_geometry.geometry import Geometry
from lumped.mesh.linear import forces_of_laws
from lumped.mesh.records import Records
from lumped.path_function import PathFunction, one_of_each
from lumped.quasi_static.contacts import contact_of
from lumped.quasi_static.elements import MeshElements, mean_of_pairs
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray, IntArray

#: Distance from the end of a segment at which a one-sided limit is taken, over the base pitch.
_INSIDE = 1e-12
#: Switch times closer than this fraction of a cycle are one.
_SAME = 1e-10
#: The same for breaks, whose phases have this rounding error.
_ROUNDING = 1e-13


class DamperPower(NamedTuple):
    """Power of the dampers of all pairs, by_square delta'^2 + by_rate delta' + at_rest; each (k,).

    Attributes
    ----------
    by_square : [N s/m]
    by_rate : [N]
    at_rest : [W]
    """

    by_square: FloatArray
    by_rate: FloatArray
    at_rest: FloatArray


class PairPlaces(NamedTuple):
    """Where all pairs are at k times; each array (pairs, k).

    Attributes
    ----------
    position : xi_i [m]
    place : the same, but inside the smooth segment: at the ends of the segment by a rounding error [m]
    contact : whether the pair is where it can touch
    """

    position: FloatArray
    place: FloatArray
    contact: BoolArray


@dataclass(frozen=True)
class PairState:
    """Coefficients of every tooth pair; each array (pairs, k), zero for a pair out of contact.

    Attributes
    ----------
    position : xi_i, also for a pair out of contact [m]
    contact : whether the pair is where it can touch
    stiffness : k_i [N/m]
    damping : c_i [N s/m]
    friction : friction coefficient mu_i, with the sign of the sliding [-]
    error : e_i [m]
    error_rate : de_i/dt [m/s]
    tilt : sine of the angle between normal and line of action [-]; None where the sine is 0
    closing : f_i, rate of the compression over delta' - e_i' [-]; None where f_i is 1
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

    def of_places(self, places: IntArray) -> PairState:
        """Return the coefficients of the pairs at some places (n,) only."""
        arrays: dict[str, Any] = {one.name: getattr(self, one.name) for one in fields(self)}
        return replace(self, **{name: one[places] for name, one in arrays.items() if one is not None})

    def damper_powers(self, rate: FloatArray) -> FloatArray:
        """Power f_i c_i (delta' - e_i')^2 of each damper in the linear form (pairs, k) [W].

        ``rate`` is the rate delta' of the approach (k,) [m/s].
        """
        share = 1.0 if self.closing is None else self.closing
        return np.asarray(share * self.damping * (rate - self.error_rate) ** 2)

    @property
    def damper_power(self) -> DamperPower:
        """The sum of ``damper_powers`` over all pairs, as a polynomial of the rate of the approach."""
        damping = self.damping if self.closing is None else self.closing * self.damping
        by_rate = -2.0 * damping * self.error_rate
        return DamperPower(
            by_square=damping.sum(axis=0),
            by_rate=by_rate.sum(axis=0),
            at_rest=(damping * self.error_rate**2).sum(axis=0),
        )

    def load(self, approach: FloatArray, rate: FloatArray) -> FloatArray:
        """Normal load k (delta - e) + c (delta' - e') of each pair in the linear form (pairs, k) [N].

        ``approach`` is delta (k,) [m], ``rate`` is delta' (k,) [m/s].
        """
        compression_rate = rate - self.error_rate
        return np.asarray(self.stiffness * (approach - self.error) + self.damping * compression_rate)

    @property
    def forces(self) -> Records:
        """FORCE (k, 3) of all pairs in the linear form, see ``lumped.mesh.linear``."""
        return forces_of_laws(
            position=self.position,
            mu=self.friction,
            tilt=self.tilt,
            by_approach=self.stiffness,
            by_rate=self.damping,
            at_rest=-(self.stiffness * self.error + self.damping * self.error_rate),
        )


@dataclass(frozen=True, eq=False, repr=False)
class MeshCycle(DisplayedResult):
    """The mesh cycle of a pair, from its geometry and elements, at nominal rotation; t = 0 is pair n at A."""

    shown: ClassVar = ("period", "mean_stiffness", "start", "end")

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
        """Position at which a pair can first touch: A, with loaded contact before A [m]."""
        return self.elements.stiffness.interval[0]

    @property
    def end(self) -> float:
        """Position at which a pair can last touch: D, with loaded contact behind D [m]."""
        return self.elements.stiffness.interval[1]

    @cached_property
    def offsets(self) -> FloatArray:
        """Positions xi_i at t = 0 of all pairs that can touch in the cycle; the pair ahead is first [m]."""
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
        """Phases in [0, 1) at which a pair passes a break of a law, or A, P or D, with their rounding."""
        g = self.geometry
        positions = np.concatenate([[g.L_XA, g.L_XP, g.L_XD], *(law.breaks for law in self._laws)])
        return np.asarray(np.unique(np.mod((positions - g.L_XA) / g.base_pitch, 1.0)), dtype=np.float64)

    @cached_property
    def bends(self) -> FloatArray:
        """Times strictly inside (0, T_m) at which a law of a pair is not smooth, switches included [s]."""
        return np.union1d(self.switch_times, self._times([law.bends for law in self._laws]))

    @cached_property
    def breaks(self) -> FloatArray:
        """Ends of the pieces in which every law of every pair is one polynomial, with 0 and T_m [s].

        Quadrature, propagation, fits and error bounds all use these times. All ``edges`` are among them.
        Other breaks that differ by rounding count as one.
        """
        near = _ROUNDING * self.period
        marks = np.union1d(self.edges, self.break_phases * self.period)
        marks = marks[(marks <= 0.0) | (marks >= near)]
        marks = marks[(marks >= self.period) | (marks <= self.period - near)]
        return one_of_each(marks, near, is_edge(marks, self.edges))

    @cached_property
    def _contact(self) -> BoolArray:
        """Whether each pair can touch in each smooth segment (pairs, segments); constant inside a segment."""
        g = self.geometry
        middle = 0.5 * (self.edges[:-1] + self.edges[1:]) * g.omega_pinion * g.base_radius_pinion
        place = self.offsets[:, None] + middle
        return np.asarray((place >= self.start) & (place <= self.end))

    @property
    def stiffness_scale(self) -> float:
        """Order of magnitude of the stiffness of the mesh, for scaling only [N/m]."""
        k = self.elements.stiffness
        return max(float(k(k.breaks[:-1]).max()), k.mean())

    def places(self, time: ArrayLike, segment: int | NDArray[np.int64] | None = None) -> PairPlaces:
        """Return where all pairs are at times t [s]; arguments as of ``sample``."""
        g = self.geometry
        t = np.atleast_1d(np.asarray(time, dtype=float))
        if segment is None:
            # Rounding puts times on either side of an edge: a time just before an edge counts as the edge.
            same = _ROUNDING * self.period + 4.0 * np.spacing(np.abs(t))
            tau = np.mod(t, self.period)
            tau = np.where(tau > self.period - same, 0.0, tau)
            index = np.searchsorted(self.edges[1:-1], tau + same, side="right")
        else:
            tau = t
            index = np.broadcast_to(segment, t.shape)
        speed = g.omega_pinion * g.base_radius_pinion
        inside = _INSIDE * g.base_pitch
        low = speed * self.edges[index] + inside
        high = speed * self.edges[index + 1] - inside
        shift = np.clip(speed * tau, low, high)
        offsets = self.offsets[:, None]
        return PairPlaces(offsets + speed * tau, offsets + shift, np.take(self._contact, index, axis=1))

    def sample(self, time: ArrayLike, segment: int | NDArray[np.int64] | None = None) -> PairState:
        """Return the coefficients of all pairs at times t [s], any number of cycles.

        Parameters
        ----------
        time : (k,) times [s]
        segment : smooth segment of all times, or of each time (k,). At the ends of the segment the values are
            limits from inside the segment. By default the segment in which each time lies; a switch belongs
            to the segment behind it
        """
        position, place, contact = self.places(time, segment)
        speed = self.geometry.omega_pinion * self.geometry.base_radius_pinion
        e = self.elements
        return PairState(
            position=position,
            contact=contact,
            stiffness=_in_contact(e.stiffness, place, contact),
            damping=_in_contact(e.damping, place, contact),
            friction=friction_coefficients(e, place, contact),
            error=_in_contact(e.error, place, contact),
            error_rate=_in_contact(e.error_slope, place, contact) * speed,
            tilt=None if e.tilt is None else _in_contact(e.tilt, place, contact),
            closing=None if e.closing is None else _in_contact(e.closing, place, contact),
        )


def _in_contact(law: PathFunction, place: FloatArray, contact: BoolArray) -> FloatArray:
    """Values of a law at the places (pairs, k) [m] of the pairs, 0 where a pair is out of contact."""
    return np.asarray(np.where(contact, law(place), 0.0), dtype=np.float64)


def friction_coefficients(elements: MeshElements, place: FloatArray, contact: BoolArray) -> FloatArray:
    """Friction coefficient mu of every pair, with the sign of the sliding; 0 out of contact (pairs, k).

    The law mu(xi) is ``MeshElements.friction``, made by ``lumped.path_of_contact.friction_path_function``. At
    a time t, ``MeshCycle.sample(t).friction`` is mu of every pair.

    Parameters
    ----------
    place : xi of the pairs (pairs, k) [m]
    contact : whether each pair can touch (pairs, k)
    """
    return _in_contact(elements.friction, place, contact)


def is_edge(times: FloatArray, edges: FloatArray) -> BoolArray:
    """Whether each time (k,) is one of the increasing edges; ten times faster than `numpy.isin`."""
    return np.asarray(edges[np.minimum(np.searchsorted(edges, times), edges.size - 1)] == times)


def mesh_cycle(pair: AnyPair) -> MeshCycle:
    """Return the mesh cycle of a gear pair."""
    return MeshCycle.of(load_gear_pair(pair))
