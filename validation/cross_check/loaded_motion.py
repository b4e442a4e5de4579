"""Loaded contact's motion with contacts that follow the motion, as the exact contact does.

Loaded contact is linear about the static motion. Here the pairs of teeth are linear about the motion that
was found before: N = k_t (delta - e) with k_t and e of the contact law at the actual compression, where the
contact stands. A motion that repeats itself obeys the contact law itself; each repetition is a step of
Newton's method.

Sources: docs/theory/contact_energy.md, "What the exact contact changes with loaded contact".
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lumped.model.periodic_system import LTVSystem, MeshGain
from lumped.path_function import PathFunction
from lumped.quasi_static.elements import MeshElements
from lumped.quasi_static.kernels import corner_gaps
from lumped.quasi_static.loaded import FULL_DAMPING, StaticMesh
from lumped.quasi_static.tooth_error import relief_starts
from lumped.schema.bodies import bodies
from lumped.typing import BoolArray, FloatArray
from validation.cross_check.effective_elements import Lines
from validation.cross_check.shifted_motion import Motion, ShiftedModel, Shifts

#: Pairs are followed to this share of the way from a tangent point, where radii vanish, to A or D.
_FROM_TANGENT = 0.1
#: Half the distance over which slopes along the path are read [m].
_BESIDE = 1e-7


@dataclass(frozen=True, eq=False)
class PushedSystem(LTVSystem):
    """A system on which the teeth push beside the normal load along the nominal line of action.

    A pair with the energy U(rho_p, rho_g, L) pushes with -dU/d rho_p, -dU/d rho_g and -dU/dL. The motion
    changes these lengths by r_bp (theta_p + psi), -r_bg (theta_g - psi) and x_g - x_p + (r_bp + r_bg) psi,
    with psi = (y_g - y_p)/L_XY.

    Attributes
    ----------
    place : (k,) places of one pair [m]
    push : (3, k) what it pushes there, the nominal load left out [N]
    """

    place: FloatArray = field(default_factory=lambda: np.empty(0))
    push: FloatArray = field(default_factory=lambda: np.empty((3, 0)))

    def gain(self, time: ArrayLike, segment: int | NDArray[np.int64] | None = None) -> MeshGain:
        """The mesh's feedback and the push of all pairs."""
        found = super().gain(time, segment)
        return replace(found, error=found.error + self.forces(time) / self.structure.mass @ self.reduction.T)

    def forces(self, time: ArrayLike) -> FloatArray:
        """Generalised forces of the push at times (k,) [s], (k, 6) [N m, N]."""
        g = self.cycle.geometry
        way = np.mod(np.atleast_1d(np.asarray(time, dtype=float)) / self.period, 1.0) * g.base_pitch
        at = self.cycle.offsets[:, None] + way
        by_p, by_g, by_l = (np.interp(at, self.place, v, left=0.0, right=0.0).sum(0) for v in self.push)
        r_p, r_g = g.base_radius_pinion, g.base_radius_gear
        across = (r_p * by_p + r_g * by_g + (r_p + r_g) * by_l) / g.L_XY
        return np.stack([r_p * by_p, -r_g * by_g, -by_l, by_l, -across, across], axis=1)


@dataclass(frozen=True, eq=False)
class LoadedModel(ShiftedModel):
    """Loaded contact of one pair, linear about a motion instead of the static one.

    Attributes
    ----------
    approaches : places (k,) as bytes -> static approach there (k,) [m]; many motions ask for the same
    """

    approaches: dict[bytes, FloatArray] = field(default_factory=dict, kw_only=True, repr=False)

    settling: ClassVar[tuple[str, ...]] = ("slides_as", "overlap")

    @cached_property
    def mesh(self) -> StaticMesh:
        """The mesh under the mean load."""
        return StaticMesh(self.pair)

    @property
    def reach(self) -> tuple[float, float]:
        """Places between which a pair is followed [m]."""
        g = self.cycle.geometry
        low, high = _FROM_TANGENT * g.L_XA, g.L_XY - _FROM_TANGENT * (g.L_XY - g.L_XD)
        return max(self.mesh.low, low), min(self.mesh.high, high)

    def unmoved(self) -> Motion:
        """The motion about the static one, rebuilt like all others.

        Changes are counted from it and not from the nominal motion: a wrong law there would be taken off.
        """
        bare = replace(self, effects=frozenset())
        return bare.motion(bare.shifts_after(bare.motion(None)), line=0.0)

    def static_overlap(self, place: FloatArray) -> FloatArray:
        """Approach of the static motion at places of one pair (k,) [m]."""
        key = place.tobytes()
        if key not in self.approaches:
            self.approaches[key] = self.mesh.approach(place)
        return self.approaches[key]

    def _ends(self, way: FloatArray, reach: FloatArray, further: FloatArray) -> tuple[float, float]:
        """Where contact begins and ends is decided by its gap."""
        return 0.0, 0.0

    def _system(self, shifts: Shifts) -> LTVSystem:
        """Equations of motion linear about the motion of these shifts."""
        system = super()._system(shifts)
        push = np.zeros((3, shifts.place.size))
        if "tip_contact" in self.effects:  # U falls by N for every length that the gap grows by
            push += shifts.load * self._corner_slopes(shifts)
        if "path_work" in self.effects:
            push[:2] += 0.5 * np.outer([1.0, -1.0], self._along_path(shifts))
        given = {f.name: getattr(system, f.name) for f in fields(system)}
        return PushedSystem(**given, place=shifts.place, push=push)

    def _corner_slopes(self, shifts: Shifts) -> FloatArray:
        """Derivatives of the gap at tip corners by both flank distances and by L, (3, k)."""
        g, half = self.cycle.geometry, 0.5 * (shifts.overlap + shifts.longer)
        slopes = np.zeros((3, half.size))
        tips = (
            (shifts.stands_at + half, g.L_XD, g.base_radius_gear, g.base_radius_pinion),
            (g.L_XY - shifts.stands_at + half, g.L_XY - g.L_XA, g.base_radius_pinion, g.base_radius_gear),
        )
        for row, (arm, tip, *radii) in enumerate(tips):
            at = np.flatnonzero(arm > tip)
            beyond, length = arm[at] - tip, g.L_XY + shifts.longer[at]
            for column, further, longer in ((row, _BESIDE, 0.0), (2, 0.0, _BESIDE)):
                high, low = (
                    corner_gaps(beyond + s * further, length + s * longer - tip, length + s * longer, *radii)
                    for s in (1.0, -1.0)
                )
                slopes[column, at] = (high - low) / (2.0 * _BESIDE)
        return slopes

    def _along_path(self, shifts: Shifts) -> FloatArray:
        """Force H of one pair along the path at the places of the shifts, (k,) [N]."""
        mesh, law, at = self.mesh, self.mesh.law, shifts.stands_at
        low, high = (self.mesh.relief(at + s) for s in (-_BESIDE, _BESIDE))
        relief, k = (high - low) / (2.0 * _BESIDE), law.held(at)
        near, far = (law.held(at + s) for s in (-_BESIDE, _BESIDE))
        slope = (far - near) / (2.0 * _BESIDE)
        # Half of what a pair and its neighbours move each other counts at either.
        places, followed = self._neighbours(shifts.place, shifts.place)
        others = np.where(followed, np.interp(places, shifts.place, shifts.elastic), 0.0)
        actual = np.interp(places, shifts.place, at)
        behind, ahead = (
            mesh.coupling(actual + s, followed)[:, followed.shape[1] // 2] for s in (-_BESIDE, _BESIDE)
        )
        moved = ((ahead - behind) / (2.0 * _BESIDE) * others).sum(axis=1)
        # The damper presses on the relief, but stores nothing.
        stored = 0.5 * slope * (shifts.elastic / k) ** 2 - 0.5 * moved * shifts.elastic
        return np.asarray(shifts.load * relief - stored)

    def _neighbours(self, at: FloatArray, place: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Places of a pair at (n,) and of its neighbours, (n, pairs) [m], and whether they are followed."""
        most = len(self.mesh.neighbours)
        places = at[:, None] + np.arange(-most, most + 1) * self.cycle.geometry.base_pitch
        return places, (places >= place[0]) & (places <= place[-1])

    def _contact(self, shifts: Shifts) -> MeshElements:
        """Stiffness, damping, error and gap about the motion of these shifts."""
        g, mesh, law = self.cycle.geometry, self.mesh, self.mesh.law
        place, stands_at = shifts.place, shifts.stands_at
        if "tip_contact" in self.effects:
            overlap, longer = shifts.overlap, shifts.longer
        else:
            overlap, longer = self.static_overlap(place), np.full(place.size, mesh.lengthening)

        scale = 2.0 * self.pair.mesh.damping_ratio * np.sqrt(bodies(self.pair).effective_mass)
        full = FULL_DAMPING * mesh.force

        def own_gap(at: FloatArray) -> FloatArray:
            actual, delta, more = (np.interp(at, place, v) for v in (stands_at, overlap, longer))
            return mesh.gap(actual, 0.5 * (delta + more), more)

        def state(at: FloatArray) -> dict[str, FloatArray]:
            places, near = self._neighbours(at, place)
            actual, delta, more = (np.interp(places, place, v) for v in (stands_at, overlap, longer))
            middle = near.shape[1] // 2
            gap = mesh.gap(actual.ravel(), 0.5 * (delta + more).ravel(), more.ravel()).reshape(near.shape)
            load, tangent, pressed = mesh.together(actual, delta - gap, near)
            actual, delta, gap = actual[:, middle], delta[:, middle], gap[:, middle]
            engaged, secant = np.clip(load / full, 0.0, 1.0), law.held(actual)
            return {
                "gap": gap,
                "compression": delta - gap,
                "pressing": secant * pressed,
                "load": load,
                "stiffness": tangent,
                "error": delta - load / np.where(tangent > 0.0, tangent, np.inf),
                "damping": scale * np.sqrt(secant) * engaged**2 * (3.0 - 2.0 * engaged),
            }

        found, speed = state(place), g.base_pitch / self.cycle.period
        touching = found["pressing"]  # as a force, as below: its zero is found by interpolation
        # A pair lets go where its flanks part, and where its damper would pull more than they press.
        if "tip_contact" in self.effects:
            pressing = found["damping"] * np.gradient(found["compression"], place) * speed
            touching = np.where(touching > 0.0, found["load"] + pressing, touching)
        turn = np.flatnonzero(np.signbit(touching[1:]) != np.signbit(touching[:-1]))
        share = touching[turn] / (touching[turn] - touching[turn + 1])
        ends = place[turn] + share * np.diff(place)[turn]
        nodes = np.union1d(place, ends)
        marks = np.unique(np.concatenate([law.stiffness.breaks, relief_starts(self.pair)]))

        lines = Lines.between(self.reach, marks, nodes, np.interp(nodes, place, stands_at))
        at = lines.inner.ravel()
        values, acts = state(at), np.interp(at, place, touching) > 0.0
        for name in ("stiffness", "damping"):
            values[name] = np.where(acts, values[name], 0.0)

        def fitted(name: str) -> PathFunction:
            return lines.through(values[name].reshape(2, -1))

        return MeshElements(
            stiffness=fitted("stiffness"),
            damping=fitted("damping"),
            friction=self.cycle.elements.friction,
            error=fitted("error"),
            gap=lines.bent_through(values["gap"].reshape(2, -1), own_gap(lines.inner.mean(axis=0))),
        )
