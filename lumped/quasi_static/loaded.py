"""Contact of the tooth pairs in the statically loaded mesh: its beginning, its end and its stiffness.

A pair touches where its gap closes under the mean load. This happens also before A and behind D, where a tip
corner meets the mate's flank. About the static state the load is linear, N_i = k_t,i (delta - e_i): k_t is
the tangent stiffness when all pairs approach together, e the approach at which the tangent has no load. If
the stiffness model knows it, the load of a pair moves the neighbours of the pair.

Sources: docs/theory/contact_energy.md, "Loaded contact of the linear model".
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import NamedTuple

import numpy as np

from lumped.errors import BeyondFlanksError, NumericalError, refuse
from lumped.mesh.damper import FULL_DAMPING, damping_law
from lumped.mesh.records import CONTACT, EXACT, FLANKS, ContactLaw, Records
from lumped.mesh.statics import (
    Phases,
    Workspace,
    middle_contacts,
    static_approaches,
    tips_minus_edges,
    workspace,
)
from lumped.mesh.unloaded import RELIEF, PairLaws, unloaded_phases
from lumped.path_function import FIT_POINTS, PathFunction
from lumped.path_of_contact import friction_path_function, pair_stiffness
from lumped.path_of_contact.stiffness import contact_softening, cross_compliances
from lumped.quasi_static.elements import Contact, MeshElements, at_rest, positive_intervals, restricted
from lumped.quasi_static.load_sharing import neighbour_laws
from lumped.quasi_static.tooth_error import relief_starts, reliefs_of
from lumped.root_in_bracket import roots_in_brackets
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray

#: Pairs are computed up to this fraction of a base pitch beyond A and D.
_REACH = 0.4
#: Breaks closer than this fraction of a base pitch are one.
_SAME = 1e-9
#: Fit error over the largest value; rounding error of a length, which is a difference of positions [m].
_TOLERANCE = 1e-11
_LENGTH = 2e-17
#: Fit error of a slope of the gap over the largest one.
_SLOPE = 1e-8
#: Fit error of the approach over the fit error of the laws that follow from the approach.
_APPROACH = 1e-2
#: Share of the mean load below which Hertz's contact is linear, see ``ContactLaw.linear_below``.
LEAST_LOAD = 1e-3
#: A ramp ends without stiffness. This share of the largest stiffness remains; it is below all fit errors.
_LEAST_STIFFNESS = 1e-11
#: Fit error of c over its largest value.
_DAMPING_TOLERANCE = 1e-11
#: Pairs whose contact is cached: an uncertainty computes all its samples again at each speed.
_KEPT = 256
#: Largest load of a pair, over the mean load, for which ``ContactLaw.apart_below`` holds.
_MOST_LOAD = 10.0


def _least(law: PathFunction) -> float:
    """Least value of a law at its breaks and halfway between."""
    breaks = law.breaks
    return float(law(np.concatenate([breaks[:-1], 0.5 * (breaks[1:] + breaks[:-1])])).min())


class Loaded(Contact):
    """Loaded contact: a pair touches where its gap closes under the mean load.

    The brake balances every loss.
    """

    name = "loaded"
    conservative = True
    pressed = "all pairs together"
    root_damping = False

    def elements(self, pair: GearPair) -> MeshElements:
        """Return the laws about the static state. The damper acts more, the more load the pair has."""
        rest = at_rest(pair)
        contact = loaded_contact(rest)
        return MeshElements(
            stiffness=contact.stiffness,
            damping=_damping(rest, pair.mesh.damping_ratio, bodies_of(pair).effective_mass),
            friction=friction_path_function(pair, interval=contact.stiffness.interval),
            error=contact.error,
            gap=contact.damper_gap,
            tilt=contact.tilt,
            closing=contact.closing,
        )

    def neighbours(self, pair: GearPair) -> Sequence[PathFunction]:
        """Return the functions of the stiffness model."""
        return cross_compliances(pair)

    def unilateral_elements(self, pair: GearPair) -> MeshElements:
        """Return the same laws. Their error is a gap, which the mean load closes."""
        return self.elements(pair)

    def pressing(self, load: FloatArray, contact: BoolArray) -> tuple[FloatArray, BoolArray]:
        """Return the sum over all pairs, because each pair begins and ends its contact gradually."""
        return np.atleast_2d(load.sum(axis=0)), np.atleast_2d(contact.any(axis=0))


@dataclass(frozen=True, eq=False)
class PairStiffness:
    """k(xi) of a tooth pair at the mean load, from A to D [N/m]."""

    law: PathFunction

    @cached_property
    def largest(self) -> float:
        """Largest k at the breaks and halfway between the breaks [N/m]."""
        breaks = self.law.breaks[:-1]
        return float(self.law(np.concatenate([breaks, breaks + 0.5 * np.diff(self.law.breaks)])).max())


class TeethAtLoad(NamedTuple):
    """Stiffness of the teeth at the mean load, by the stiffness model.

    Attributes
    ----------
    stiffness : k(xi) of a tooth pair
    neighbours : w_m(xi), m = 1, 2, ...: how far the load of a pair moves the pair m pitches ahead [m/N]
    softening : D in 1/k(T) = 1/k(T_0) - D ln(T/T_0) [m/N]
    """

    stiffness: PairStiffness
    neighbours: tuple[PathFunction, ...]
    softening: float


@lru_cache(maxsize=_KEPT)
def teeth_at_load(pair: GearPair) -> TeethAtLoad:
    """Return the stiffness of the teeth of a pair ``at_rest``. All forms of the motion use it."""
    return TeethAtLoad(PairStiffness(pair_stiffness(pair)), cross_compliances(pair), contact_softening(pair))


class StaticPair(NamedTuple):
    """One pair in static equilibrium at n positions: the approach (n,) [m], and CONTACT records (n,).

    The compression in ``contact`` is the approach less the gap and less the motion by neighbours. It is
    negative where the pair is apart.
    """

    approach: FloatArray
    contact: Records

    @property
    def load(self) -> FloatArray:
        """N [N]."""
        return np.asarray(self.contact["load"], dtype=np.float64)

    @property
    def tangent(self) -> FloatArray:
        """Slope dN/dp for a compression that all pairs share [N/m]."""
        return np.asarray(self.contact["tangent"], dtype=np.float64)

    @property
    def gap(self) -> FloatArray:
        """Gap between flanks and tip corners [m]."""
        return np.asarray(self.contact["gap"], dtype=np.float64)

    @property
    def tilt(self) -> FloatArray:
        """Sine of the angle between the normal and the line of action [-]."""
        return np.asarray(self.contact["tilt"], dtype=np.float64)

    @property
    def compression(self) -> FloatArray:
        """Compression by the load of the pair alone [m]."""
        return np.asarray(self.contact["compression"], dtype=np.float64)

    @property
    def error(self) -> FloatArray:
        """Approach at which the tangent has no load, (n,) [m]."""
        return self.approach - self.load / np.where(self.tangent > 0.0, self.tangent, np.inf)


@dataclass(frozen=True, eq=False)
class LoadedContact:
    """Laws of a tooth pair in the statically loaded mesh, over the interval of xi in which the pair can
    touch.

    Attributes
    ----------
    stiffness : tangent stiffness k_t(xi), zero where the loaded pair is apart [N/m]
    error : e(xi) with N = k_t (delta - e) [m]
    gap : between flanks and tip corners without deflection [m]
    damper_gap : gap whose slope over xi, at a constant approach, is the slope of ``gap`` over ``closing`` [m]
    closing : share of the approach that compresses the pair, at a constant xi [-]
    tilt : sine of the angle between the normal at a tip corner and the line of action, 0 on the line [-]
    engagement : share of the damper that acts, from 0 at the first touch to 1 [-]
    secant : k(xi) of the stiffness model, from which the damping coefficient follows [N/m]
    contact : (n, 2) intervals of xi in which the pair carries load [m]
    """

    stiffness: PathFunction
    error: PathFunction
    gap: PathFunction
    damper_gap: PathFunction
    closing: PathFunction
    tilt: PathFunction
    engagement: PathFunction
    secant: PathFunction
    contact: FloatArray


class StaticMesh:
    """Static equilibrium of the mesh under the mean load at any position of a tooth pair."""

    def __init__(self, pair: GearPair) -> None:
        g = pair.geometry
        bearings = pair.bearings
        self.pair = pair
        self.geometry = g
        self.force = pair.operating.pinion_torque / g.base_radius_pinion
        self.stiffness, self.neighbours, softening = teeth_at_load(at_rest(pair))
        self.law = ContactLaw(
            force=self.force,
            softening=softening,
            linear_below=LEAST_LOAD * self.force,
            converged=EXACT,
            full_damper=FULL_DAMPING * self.force,
            coupled=len(self.neighbours) > 0,
            apart_below=_MOST_LOAD * self.force * min([0.0, *(_least(law) for law in self.neighbours)]),
            prescribed=False,
            radius_pinion=g.base_radius_pinion,
            radius_gear=g.base_radius_gear,
            rolling_speed=g.omega_pinion * g.base_radius_pinion,
        )
        compliance = 1.0 / bearings.pinion.loa_stiffness + 1.0 / bearings.gear.loa_stiffness
        self.lengthening = self.force * compliance  # of the line of action, by the bearings
        # Pairs further away than this carry no load.
        reach = int(g.contact_ratio + 2.0 * _REACH)
        self.shifts = np.asarray(np.arange(-reach, reach + 1) * g.base_pitch, dtype=np.float64)
        tips = (g.L_XY - g.tip_length_gear, g.tip_length_pinion)
        edges = (g.undercut_pinion, g.undercut_gear)
        self.flanks = np.array([(*tips, g.L_XY, *edges, 0.0, 0.0)], FLANKS)
        self.low = g.L_XA - _REACH * g.base_pitch
        self.high = g.L_XD + _REACH * g.base_pitch
        self.unloaded = PairLaws(
            start=g.L_XA,
            end=g.L_XD,
            low=self.low,
            high=self.high,
            breaks=self.stiffness.law.breaks,
            coefficients=self.stiffness.law.coefficients,
            least_stiffness=_LEAST_STIFFNESS * self.stiffness.largest,
            reliefs=reliefs_of(pair) if pair.mesh.relief == "static" else np.empty(0, RELIEF),
            neighbours=neighbour_laws(self.neighbours),
            lengthening=self.lengthening,
        )
        self._fitted: PathFunction | None = None

    def phases(self, xi: FloatArray) -> Phases:
        """Return all pairs without load. The middle pair is at xi (n,) [m]."""
        phases: Phases = unloaded_phases(xi, self.shifts, self.unloaded)
        return phases

    def single_pairs(self, xi: FloatArray) -> Phases:
        """Return a pair at xi (n,) [m] without load, without the pairs around it."""
        pairs: Phases = unloaded_phases(xi, np.zeros(1), self.unloaded)
        return pairs

    def stiffness_at(self, xi: FloatArray) -> FloatArray:
        """Return k (n,) at positions (n,), also beyond A and D; never quite zero [N/m]."""
        return self.single_pairs(xi).stiffness[:, 0]

    def approach(self, xi: FloatArray) -> FloatArray:
        """Static approach delta (n,) [m] with a tooth pair at the positions xi (n,) [m]."""
        if self._fitted is not None:
            start = self._fitted.breaks[0]
            return self._fitted(start + np.mod(xi - start, self.geometry.base_pitch))
        phases = self.phases(xi)
        return self._approach(phases, workspace(phases))

    def _approach(self, phases: Phases, space: Workspace) -> FloatArray:
        """Static approach delta (n,) [m] by iteration."""
        force = np.full(len(phases.position), self.force)
        no_loads = np.empty((0, self.shifts.size))
        approach = static_approaches(phases, force, self.flanks, self.law, no_loads, space)
        if not np.isfinite(approach).all():
            self.refuse_soft_bearings()
            raise NumericalError("At a position no tooth pair carries the load: check stiffness and relief.")
        return np.asarray(approach, dtype=np.float64)

    def refuse_soft_bearings(self) -> None:
        """Refuse bearings that let the teeth part; called where no contact was found.

        The path of contact is as much shorter as the bearings give way along the line of action. Beyond the
        length that the pair has above one base pitch, one tooth pair leaves before the next one touches.
        """
        g = self.geometry
        reserve = (g.contact_ratio - 1.0) * g.base_pitch
        if self.lengthening <= reserve:
            return
        bearings = self.pair.bearings
        name = "pinion" if bearings.pinion.loa_stiffness <= bearings.gear.loa_stiffness else "gear"
        raise refuse(
            f"bearings.{name}.loa_stiffness",
            f"{getattr(bearings, name).loa_stiffness:.3g} N/m",
            f">= {2.0 * self.force / reserve:.2g} N/m at both gears, with which the teeth stay in mesh",
            f"Under the mesh force of {self.force:.3g} N the bearings give way by "
            f"{1e3 * self.lengthening:.3g} mm, and the teeth part. A bare number is in N/m: check the unit, "
            "as in '200 N/um'.",
        )

    def fit_approach(self, marks: FloatArray, tolerance: float) -> None:
        """Fit the static approach once, because all laws of a pair follow from it. It repeats with every
        pitch.

        Parameters
        ----------
        marks : positions of kinks of the approach, plus or minus any number of pitches [m]
        tolerance : largest error [m]
        """
        start = self.geometry.L_XA
        pitch = self.geometry.base_pitch
        inside = np.unique(start + np.mod(marks - start, pitch))
        near = _SAME * pitch
        inside = inside[(inside > start + near) & (inside < start + pitch - near)]
        inside = inside[np.diff(inside, prepend=-np.inf) > near]
        breaks = np.concatenate([[start], inside, [start + pitch]])
        self._fitted = PathFunction.fit(self.approach, breaks, inside, tolerance=tolerance)

    def static(self, xi: FloatArray) -> StaticPair:
        """Return the pair at xi (n,) [m] in static equilibrium."""
        contact = np.zeros(np.size(xi), CONTACT)
        phases = self.phases(xi)
        space = workspace(phases)
        approach = self._approach(phases, space) if self._fitted is None else self.approach(xi)
        middle_contacts(approach, phases, self.flanks, self.law, contact, space)
        return StaticPair(approach, contact)

    def pairs_in_contact(self, xi: FloatArray) -> StaticPair:
        """Return pairs at xi (pairs, n) [m], whole pitches apart in each column, in static equilibrium.

        The result has pairs n entries, those of the first pair first. The middle pair of a column must have
        all pairs that carry load within reach.
        """
        contact = np.zeros(xi.size, CONTACT)
        phases = self.phases(xi.ravel())
        approach = np.tile(self.approach(xi[len(xi) // 2]), len(xi))
        middle_contacts(approach, phases, self.flanks, self.law, contact, workspace(phases))
        return StaticPair(approach, contact)

    def approach_slope(self, xi: FloatArray) -> FloatArray:
        """Slope of the fitted approach over xi, (n,) [-]."""
        assert self._fitted is not None
        start = self._fitted.breaks[0]
        return self._fitted.slope(start + np.mod(xi - start, self.geometry.base_pitch))

    def half_way_out(self, xi: FloatArray) -> FloatArray:
        """Distance by which deflected teeth touch further out, (n,) [m]; see ``tip_corners.half_way_out``."""
        return np.asarray(0.5 * (self.approach(xi) + self.lengthening), dtype=np.float64)

    def tip_minus_edge(self, at_start: bool, xi: FloatArray) -> FloatArray:
        """Quantity (n,) that is 0 where tip corner and edge exchange, at start or end of the flanks."""
        g = self.geometry
        half = self.half_way_out(xi)
        beyond_edge = self.beyond_edge(at_start, xi)
        radii = (g.base_radius_pinion, g.base_radius_gear)
        length = g.L_XY + self.lengthening
        if at_start:
            beyond = g.L_XY - xi + half - g.tip_length_gear
            tip = g.tip_length_gear
            edge = g.undercut_pinion
        else:
            beyond = xi + half - g.tip_length_pinion
            tip = g.tip_length_pinion
            edge = g.undercut_gear
            radii = radii[::-1]
        return np.asarray(tips_minus_edges(beyond, tip, beyond_edge, edge, length, *radii), dtype=np.float64)

    def beyond_edge(self, at_start: bool, xi: FloatArray) -> FloatArray:
        """Distance of the contact beyond the edge at start or end of undercut flanks, (n,) [m]."""
        g = self.geometry
        half = self.half_way_out(xi)
        return g.undercut_pinion - xi - half if at_start else g.undercut_gear - (g.L_XY - xi) - half


class _StaticPieces:
    """Static pairs at the positions of fits: each piece is computed once, whatever laws are fitted on it."""

    def __init__(self, mesh: StaticMesh) -> None:
        points = FIT_POINTS.size
        self._mesh = mesh
        self._row_of_piece: dict[bytes, int] = {}
        self._approach = np.empty((0, points))
        self._contact = np.empty((0, points), CONTACT)

    def __call__(self, xi: FloatArray) -> StaticPair:
        """Return the pair at xi (n,) [m]: ``FIT_POINTS`` of some pieces, or other positions."""
        if xi.size % FIT_POINTS.size:
            return self._mesh.static(xi)
        pieces = xi.reshape(-1, FIT_POINTS.size)
        keys = [piece.tobytes() for piece in pieces]
        new = [piece for piece, key in zip(pieces, keys, strict=True) if key not in self._row_of_piece]
        if new:
            self._add(np.array(new))
        rows = [self._row_of_piece[key] for key in keys]
        return StaticPair(self._approach[rows].ravel(), self._contact[rows].ravel())

    def _add(self, pieces: FloatArray) -> None:
        """Compute the pair at the positions of pieces (n, points)."""
        known = len(self._row_of_piece)
        shape = (known + len(pieces), FIT_POINTS.size)
        self._approach.resize(shape, refcheck=False)
        self._contact.resize(shape, refcheck=False)
        computed = self._mesh.static(pieces.ravel())
        self._approach[known:] = computed.approach.reshape(pieces.shape)
        self._contact[known:] = computed.contact.reshape(pieces.shape)
        self._row_of_piece |= {piece.tobytes(): known + number for number, piece in enumerate(pieces)}


@lru_cache(maxsize=_KEPT)
def _damping(pair: GearPair, ratio: float, mass: float) -> PathFunction:
    """Damping coefficient that acts in the linear form: s f c, of a pair ``at_rest``.

    ``ratio`` is zeta, ``mass`` the effective mass of both gears [kg].

    c is ``lumped.mesh.damper.damping_law``, s the share of the damper at the static load, f the share of the
    approach that compresses the pair.
    """
    contact = loaded_contact(pair)
    low, high = contact.stiffness.interval
    whole_damper = damping_law(ratio, contact.secant, mass)

    def damping(xi: FloatArray) -> FloatArray:
        return whole_damper(xi) * contact.engagement(xi) * contact.closing(xi)

    engaged = contact.engagement
    breaks = np.union1d(np.union1d(engaged.breaks, contact.secant.breaks), contact.closing.breaks)
    largest = float(np.abs(damping(np.linspace(low, high, 401))).max())
    if largest == 0.0:
        return PathFunction.constant(0.0, low, high)
    tolerance = _DAMPING_TOLERANCE * largest
    return PathFunction.fit(damping, breaks, engaged.switches, tolerance=tolerance, by_length=True)


@lru_cache(maxsize=_KEPT)
def static_mesh(pair: GearPair) -> StaticMesh:
    """Return the mesh under the mean torque, of a pair ``at_rest``, without a fit of the approach."""
    return StaticMesh(pair)


class Touching(NamedTuple):
    """Where a tooth pair carries load in the statically loaded mesh.

    Attributes
    ----------
    contact : (n, 2) intervals of xi in which the pair carries load [m]
    kinks : positions of a pair at which stiffness or gap of this pair is not smooth (k,) [m]
    """

    contact: FloatArray
    kinks: FloatArray

    @property
    def interval(self) -> tuple[float, float]:
        """First and last position at which the pair carries load [m]."""
        return float(self.contact[0, 0]), float(self.contact[-1, 1])


@lru_cache(maxsize=_KEPT)
def touching(pair: GearPair) -> Touching:
    """Return where a tooth pair carries load under the mean torque, of a pair ``at_rest``.

    Raises
    ------
    NumericalError : the pair touches too far beyond its flanks
    ParameterError : the bearings let the teeth part
    """
    mesh = static_mesh(pair)
    g = pair.geometry
    starts = relief_starts(pair) if pair.mesh.relief == "static" else np.empty(0)
    kinks = np.concatenate([mesh.stiffness.law.switches, starts, [g.L_XA, g.L_XD]])
    jumps = np.add.outer(kinks, mesh.shifts)
    contact = positive_intervals(
        lambda xi: mesh.static(xi).compression, mesh.low, mesh.high, jumps, g.base_pitch
    )
    if contact.size == 0 or contact[0, 0] <= mesh.low or contact[-1, 1] >= mesh.high:
        mesh.refuse_soft_bearings()
        undercut = [name for name in ("pinion", "gear") if getattr(g, f"undercut_{name}") > 0.0]
        action = "lower the torque, check the stiffness"
        if undercut:
            fields = " and ".join(f"{name}.profile_shift" for name in undercut)
            action = f"the flanks are undercut, so raise {fields}, or lower the torque"
        raise BeyondFlanksError(
            f"Under {pair.operating.pinion_torque:g} N m a tooth pair touches more than {_REACH:g} base "
            f"pitches beyond its flanks: {action}."
        )
    return Touching(contact, kinks)


@lru_cache(maxsize=_KEPT)
def loaded_contact(pair: GearPair) -> LoadedContact:
    """Return the laws of a tooth pair under the mean torque, of a pair ``at_rest``."""
    mesh = copy.copy(static_mesh(pair))
    law = mesh.law
    stiffness_of = mesh.stiffness
    near = _SAME * pair.geometry.base_pitch
    contact, kinks = touching(pair)
    low, high = touching(pair).interval
    corners = _corners(mesh, low, high)
    marks = np.add.outer(np.concatenate([kinks, contact.ravel(), corners]), mesh.shifts)
    inside = np.unique(marks[(marks > low + near) & (marks < high - near)])
    inside = inside[np.diff(inside, prepend=-np.inf) > near]
    smooth = stiffness_of.law.breaks[(stiffness_of.law.breaks > low) & (stiffness_of.law.breaks < high)]
    breaks = np.concatenate([[low], inside, [high]])
    pieces = np.union1d(breaks, smooth)
    largest = float(mesh.stiffness_at(np.linspace(low, high, 101)).max())
    deflection = mesh.force / largest
    relative = max(_TOLERANCE, _LENGTH / (FULL_DAMPING * deflection))
    # The approach is found by iteration: its error is several times the rounding of positions.
    exact = max(_APPROACH * relative * deflection, 5.0 * _LENGTH)
    mesh.fit_approach(np.concatenate([marks.ravel(), stiffness_of.law.breaks]), exact)

    static = _StaticPieces(mesh)
    # Without softening and neighbours the laws have the pieces of the stiffness.
    ends = pieces if law.softening == 0.0 and not mesh.neighbours else breaks

    def fitted(value: Callable[[FloatArray], FloatArray], scale: float) -> PathFunction:
        return PathFunction.fit(value, ends, inside, tolerance=relative * scale, by_length=True)

    stiffness = fitted(lambda xi: static(xi).tangent, largest)
    # Only the share of the damper has a kink where the whole damper begins to act. Its breaks are those of
    # the stiffness too: laws with the same breaks leave few pieces in a mesh cycle.
    full = FULL_DAMPING * mesh.force
    bends = np.union1d(inside, _roots(lambda x: static(x).load - full, breaks))
    cuts = np.union1d(stiffness.breaks, bends)

    def engagement(xi: FloatArray) -> FloatArray:
        return np.asarray(static(xi).contact["damper_share"], dtype=np.float64)

    engaged = PathFunction.fit(engagement, cuts, bends, tolerance=relative, by_length=True)
    error = fitted(lambda xi: static(xi).error, deflection)
    gap = fitted(lambda xi: static(xi).gap, deflection)

    def closing(xi: FloatArray) -> FloatArray:
        return np.asarray(1.0 - static(xi).contact["gap_by_approach"], dtype=np.float64)

    def rolling(xi: FloatArray) -> FloatArray:
        """Slope of the gap at a constant approach: without the part by the change of the approach."""
        share = closing(xi)
        return np.asarray((gap.slope(xi) - (1.0 - share) * mesh.approach_slope(xi)) / share)

    slope_of_deflection = deflection / pair.geometry.base_pitch
    steepest = max(float(np.abs(gap.slope(np.linspace(low, high, 101))).max()), slope_of_deflection)
    damper_gap = PathFunction.fit(rolling, gap.breaks, inside, tolerance=_SLOPE * steepest, by_length=True)
    return LoadedContact(
        stiffness=restricted(stiffness, contact),
        error=error,
        gap=gap,
        damper_gap=damper_gap.antiderivative,
        closing=PathFunction.fit(closing, error.breaks, inside, tolerance=relative, by_length=True),
        tilt=PathFunction.fit(
            lambda xi: static(xi).tilt, error.breaks, inside, tolerance=relative, by_length=True
        ),
        engagement=restricted(engaged, contact),
        secant=PathFunction.fit(mesh.stiffness_at, pieces, inside, tolerance=_TOLERANCE * largest),
        contact=contact,
    )


def _corners(mesh: StaticMesh, low: float, high: float) -> FloatArray:
    """Positions where a tip corner or an edge begins to touch, or where both exchange (n,) [m]."""
    return np.concatenate([_start_corners(mesh, low), _end_corners(mesh, high)])


def _start_corners(mesh: StaticMesh, low: float) -> FloatArray:
    """The same at the start of the flanks, from ``low`` to the pitch point.

    Without an edge a tip leaves the flank where the pair is half the approach inside the path of contact.
    """
    g = mesh.geometry
    if g.undercut_pinion == 0.0:
        return _roots(lambda x: x - g.L_XA - mesh.half_way_out(x), [g.L_XA, g.L_XP])
    exchanges = _roots(partial(mesh.tip_minus_edge, True), [low, g.L_XP])
    return np.concatenate([exchanges, _roots(partial(mesh.beyond_edge, True), [low, g.L_XP])])


def _end_corners(mesh: StaticMesh, high: float) -> FloatArray:
    """The same at the end of the flanks, from the pitch point to ``high``."""
    g = mesh.geometry
    if g.undercut_gear == 0.0:
        return _roots(lambda x: g.L_XD - x - mesh.half_way_out(x), [g.L_XP, g.L_XD])
    exchanges = _roots(partial(mesh.tip_minus_edge, False), [g.L_XP, high])
    return np.concatenate([exchanges, _roots(partial(mesh.beyond_edge, False), [g.L_XP, high])])


def _roots(function: Callable[[FloatArray], FloatArray], breaks: Sequence[float] | FloatArray) -> FloatArray:
    """Sign changes of a function (n,) -> (n,) between breaks, at most one in each 64th part of a piece."""
    low = np.asarray(breaks[:-1])
    high = np.asarray(breaks[1:])
    x = np.linspace(low, high, 65, axis=1)
    x[:, 0] = np.nextafter(low, high)
    x[:, -1] = np.nextafter(high, low)
    negative = np.signbit(function(x.ravel()).reshape(x.shape))
    changes = negative[:, :-1] != negative[:, 1:]
    return roots_in_brackets(function, x[:, :-1][changes], x[:, 1:][changes], xtol=1e-15)
