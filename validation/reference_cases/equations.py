"""Gear pairs with one degree of freedom, whose periodic motion has a closed form.

The coordinate is the dynamic transmission error delta of a gear pair on rigid bearings:

    m delta'' + c delta' + k(t) delta = F,    k(t + T) = k(t),

with the effective mass m, 1/m = r_bp^2/J_p + r_bg^2/J_g. The constant force F stands for both torques.

Sources: E. Meissner, Schweizerische Bauzeitung 72 (1918) 95-98; DLMF 9.2 (Airy functions) and 28.29 (Hill's
equation); M. Vaishya and R. Singh, J. Sound Vib. 243 (2001) 525-545.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np
from scipy.linalg import solve_banded

from floquet.one_degree.linear_segments import LinearSegments, Motion
from lumped.errors import refuse
from lumped.typing import FloatArray

#: Harmonics of the motion of a cosine mesh. The amplitudes fall faster than geometrically: 64 reach rounding.
_HARMONICS = 64


class SingleDegree(Protocol):
    """Equation m delta'' + c delta' + k(t) delta = F with a periodic motion in closed form.

    Attributes
    ----------
    mass : effective mass m [kg]
    damping : damping constant c [N s/m]
    force : constant force F [N]
    period : mesh cycle T [s]
    edges : (n + 1,) ends of the smooth segments of the mesh cycle, from 0 to T [s]
    """

    @property
    def mass(self) -> float:
        """Effective mass m [kg]."""
        ...

    @property
    def damping(self) -> float:
        """Damping constant c [N s/m]."""
        ...

    @property
    def force(self) -> float:
        """Constant force F [N]."""
        ...

    @property
    def period(self) -> float:
        """Mesh cycle T [s]."""
        ...

    @property
    def edges(self) -> FloatArray:
        """(n + 1,) ends of the smooth segments, from 0 to T [s]."""
        ...

    def stiffness(self, time: FloatArray) -> FloatArray:
        """Stiffness k(t) (k,) [N/m] at times (k,) of the mesh cycle [s]."""
        ...

    def mesh_stiffness(self, time: FloatArray) -> FloatArray:
        """Stiffness of the tooth pairs (k,) [N/m]; without friction it is k(t)."""
        ...

    def friction_coefficient(self, time: FloatArray) -> FloatArray:
        """SUM mu_i k_i over the mesh stiffness (k,), from which the friction force follows."""
        ...

    def motion(self, time: FloatArray) -> Motion:
        """Periodic motion in closed form, at increasing times (k,) in [0, T) [s]."""
        ...


@dataclass(frozen=True, eq=False)
class PiecewiseLinearMesh:
    """Mesh whose stiffness is linear in time on each segment and may jump between segments.

    The closed form is that of ``floquet.one_degree.linear_segments``, by Airy functions.

    Attributes
    ----------
    mass : effective mass m [kg]
    damping : damping constant c [N s/m]
    force : constant force F [N]
    edges : (n + 1,) ends of the segments, from 0 to the mesh cycle T [s]
    stiffness_start : (n,) k at the start of each segment [N/m]
    stiffness_end : (n,) k at the end of each segment [N/m]
    pair_stiffness : (n,) stiffness of all tooth pairs without friction [N/m]
    friction : (n,) SUM mu_i k_i over ``pair_stiffness``, signed; zero without friction
    """

    mass: float
    damping: float
    force: float
    edges: FloatArray
    stiffness_start: FloatArray
    stiffness_end: FloatArray
    pair_stiffness: FloatArray
    friction: FloatArray

    @property
    def period(self) -> float:
        """Mesh cycle T [s]."""
        return float(self.edges[-1])

    @cached_property
    def segments(self) -> LinearSegments:
        """The equation with its closed form."""
        each = np.ones(self.stiffness_start.size)
        return LinearSegments(
            mass=self.mass,
            edges=self.edges,
            stiffness_start=self.stiffness_start,
            stiffness_end=self.stiffness_end,
            damping=self.damping * each,
            force_start=self.force * each,
            force_end=self.force * each,
        )

    def stiffness(self, time: FloatArray) -> FloatArray:
        """Stiffness k(t) (k,) [N/m]."""
        return self.segments.stiffness(time)

    def mesh_stiffness(self, time: FloatArray) -> FloatArray:
        """Stiffness of the tooth pairs (k,) [N/m]."""
        return np.asarray(self.pair_stiffness[self.segments.segment_of(time)])

    def friction_coefficient(self, time: FloatArray) -> FloatArray:
        """SUM mu_i k_i over the mesh stiffness (k,)."""
        return np.asarray(self.friction[self.segments.segment_of(time)])

    def motion(self, time: FloatArray) -> Motion:
        """Periodic motion in closed form, at increasing times (k,) in [0, T) [s]."""
        return self.segments.motion(time)


@dataclass(frozen=True, eq=False)
class CosineMesh:
    """Mesh whose stiffness is k(t) = k_m (1 + depth cos(2 pi t/T)): the damped equation of Mathieu.

    The periodic motion SUM D_n exp(2 pi i n t/T) solves three equations in a row each, a tridiagonal system,
    which ends after so many harmonics that the rest is below rounding.

    Attributes
    ----------
    mass : effective mass m [kg]
    damping : damping constant c [N s/m]
    force : constant force F [N]
    period : mesh cycle T [s]
    mean_stiffness : k_m [N/m]
    depth : amplitude of the stiffness over its mean, a share below 1
    """

    mass: float
    damping: float
    force: float
    period: float
    mean_stiffness: float
    depth: float

    @property
    def edges(self) -> FloatArray:
        """(2,) the mesh cycle is one smooth segment [s]."""
        return np.array([0.0, self.period])

    def stiffness(self, time: FloatArray) -> FloatArray:
        """Stiffness k(t) (k,) [N/m]."""
        wave = np.cos(2.0 * np.pi * time / self.period)
        return np.asarray(self.mean_stiffness * (1.0 + self.depth * wave))

    def mesh_stiffness(self, time: FloatArray) -> FloatArray:
        """Stiffness of the tooth pairs (k,) [N/m]."""
        return self.stiffness(time)

    def friction_coefficient(self, time: FloatArray) -> FloatArray:
        """Zero (k,): the mesh is without friction."""
        return np.zeros_like(time)

    def motion(self, time: FloatArray) -> Motion:
        """Periodic motion in closed form, at times (k,) in [0, T) [s]."""
        number = np.arange(-_HARMONICS, _HARMONICS + 1)
        frequency = 2.0 * np.pi * number / self.period
        bands = np.zeros((3, number.size), dtype=complex)
        bands[1] = self.mean_stiffness - self.mass * frequency**2 + 1j * self.damping * frequency
        bands[0, 1:] = bands[2, :-1] = 0.5 * self.mean_stiffness * self.depth
        right = np.where(number == 0, self.force, 0.0).astype(complex)
        amplitudes = solve_banded((1, 1), bands, right)
        waves = np.exp(1j * np.multiply.outer(time, frequency))
        return Motion((waves @ amplitudes).real, (waves @ (1j * frequency * amplitudes)).real)


class InvolutePair(NamedTuple):
    """Numbers of an involute gear pair with one degree of freedom and constant friction coefficient.

    Attributes
    ----------
    base_radius_pinion : r_bp [m]
    base_radius_gear : r_bg [m]
    inertia_pinion : J_p [kg m^2]
    inertia_gear : J_g [kg m^2]
    path_start : distance of the start of contact A from the pinion's tangent point [m]
    path_end : the same of the end of contact [m]
    pitch_point : the same of the pitch point [m]
    tangent_points : distance between both tangent points [m]
    base_pitch : p_b [m]
    """

    base_radius_pinion: float
    base_radius_gear: float
    inertia_pinion: float
    inertia_gear: float
    path_start: float
    path_end: float
    pitch_point: float
    tangent_points: float
    base_pitch: float

    @property
    def effective_mass(self) -> float:
        """Effective mass m [kg], 1/m = r_bp^2/J_p + r_bg^2/J_g."""
        pinion = self.base_radius_pinion**2 / self.inertia_pinion
        gear = self.base_radius_gear**2 / self.inertia_gear
        return 1.0 / (pinion + gear)

    def friction_arm(self, position: FloatArray) -> FloatArray:
        """Share of a friction force that acts along delta, m (r_bp X/J_p + r_bg (L - X)/J_g), at X (k,) [m].

        The friction force mu N turns the pinion by the arm X and the gear by the arm L - X about their
        tangent points (docs/theory/equations.md, eqs. 1 and 2).
        """
        pinion = self.base_radius_pinion * position / self.inertia_pinion
        gear = self.base_radius_gear * (self.tangent_points - position) / self.inertia_gear
        return np.asarray(self.effective_mass * (pinion + gear))


def sliding_mesh(
    pair: InvolutePair,
    *,
    pair_stiffness: float,
    friction_coefficient: float,
    damping: float,
    force: float,
    period: float,
) -> PiecewiseLinearMesh:
    """Mesh of tooth pairs with constant stiffness and friction coefficient, for a contact ratio of 1 to 2.

    A pair in contact at X has the load N = k_i delta and the friction force s mu N, with s = -1 before the
    pitch point and s = 1 beyond it. So k(t) = SUM k_i (1 + s_i mu a(X_i)), which is linear in time between
    the events of the mesh cycle. The damper acts between the gears: its force causes no friction.

    Parameters
    ----------
    pair : numbers of the gear pair
    pair_stiffness : stiffness k_i of a tooth pair [N/m]
    friction_coefficient : mu
    damping : damping constant c [N s/m]
    force : constant force F [N]
    period : mesh cycle T [s]
    """
    contact_ratio = (pair.path_end - pair.path_start) / pair.base_pitch
    if not 1.0 < contact_ratio < 2.0:
        action = "Change the addendum or the number of teeth."
        raise refuse("contact ratio", f"{contact_ratio:.4g}", "between 1 and 2", action)
    pitch = (pair.pitch_point - pair.path_start) / pair.base_pitch
    events = np.unique([0.0, contact_ratio - 1.0, pitch % 1.0, 1.0])
    start = np.zeros(events.size - 1)
    end = np.zeros_like(start)
    stiffness = np.zeros_like(start)
    friction = np.zeros_like(start)
    for number in (0, 1):  # the pair that enters at t = 0, and the pair ahead of it
        middle = 0.5 * (events[:-1] + events[1:]) + number
        in_contact = middle < contact_ratio
        sign = np.where(middle < pitch, -1.0, 1.0)
        arm = pair.friction_arm(pair.path_start + pair.base_pitch * (events + number))
        start += pair_stiffness * in_contact * (1.0 + sign * friction_coefficient * arm[:-1])
        end += pair_stiffness * in_contact * (1.0 + sign * friction_coefficient * arm[1:])
        stiffness += pair_stiffness * in_contact
        friction += pair_stiffness * in_contact * sign * friction_coefficient
    return PiecewiseLinearMesh(
        pair.effective_mass, damping, force, events * period, start, end, stiffness, friction / stiffness
    )


def equation_of(table: Mapping[str, Any]) -> SingleDegree:
    """Return the equation of the table ``equation`` of a case file."""
    common = {name: float(table[name]) for name in ("damping", "force", "period")}
    if table["form"] == "cosine":
        return CosineMesh(
            mass=float(table["mass"]),
            mean_stiffness=float(table["mean_stiffness"]),
            depth=float(table["depth"]),
            **common,
        )
    if table["form"] == "rectangular":
        pair_stiffness = float(table["pair_stiffness"])
        edges = common["period"] * np.array([0.0, float(table["contact_ratio"]) - 1.0, 1.0])
        stiffness = pair_stiffness * np.array([2.0, 1.0])
        mass = float(table["mass"])
        return PiecewiseLinearMesh(
            mass, common["damping"], common["force"], edges, stiffness, stiffness, stiffness, np.zeros(2)
        )
    pair = InvolutePair(**{name: float(table[name]) for name in InvolutePair._fields})
    return sliding_mesh(
        pair,
        pair_stiffness=float(table["pair_stiffness"]),
        friction_coefficient=float(table["friction_coefficient"]),
        **common,
    )
