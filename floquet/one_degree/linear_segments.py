"""One degree of freedom with a stiffness that is linear in time between its switches, in closed form.

    m delta'' + c(t) delta' + k(t) delta = F(t)    with the period T

On every segment k and F are linear in time and c is constant; all three may jump between segments. On a
segment with constant k the motion is a damped harmonic. Elsewhere delta = exp(-d t) y with d = c/(2 m), and y
obeys the equation of Airy, whose solutions are Bessel functions of the order 1/3.

Sources: docs/theory/floquet.md, "One degree of freedom"; DLMF 9.2 and 9.6 (Airy functions); M. Vaishya and
R. Singh, J. Sound Vib. 243 (2001) 525-545.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import airy

from floquet.engine.coefficients import PeriodicMatrix, PiecewisePolynomial
from floquet.engine.system import PeriodicSystem
from lumped.arguments import real_number, real_numbers
from lumped.errors import refuse, shown
from lumped.typing import ComplexArray, FloatArray, IntArray

#: Least panels of a segment, and Gauss-Legendre nodes of a panel, for the integral of the force.
_PANELS = 64
_NODES = 10
#: A stiffness that changes by less than this share over a segment counts as constant.
_CONSTANT = 1e-13
#: A force that changes by less than this share over a segment counts as constant.
_CONSTANT_FORCE = 1e-13


class Motion(NamedTuple):
    """Motion of one degree of freedom: ``dte`` (k,) [m] and its rate ``dte_dot`` (k,) [m/s]."""

    dte: FloatArray
    dte_dot: FloatArray


class _Flow(NamedTuple):
    """Map from the start of a segment to times (k,): ``transition`` (k, 2, 2) and ``forced`` (k, 2)."""

    transition: FloatArray
    forced: FloatArray


class _Segment(NamedTuple):
    """One segment, over the mass: k = square + slope t and F = push + ramp t, t since its start.

    Attributes
    ----------
    square : [1/s^2]
    slope : [1/s^3]
    decay : d = c/(2 m) [1/s]
    push : [m/s^2]
    ramp : [m/s^3]
    """

    square: float
    slope: float
    decay: float
    push: float
    ramp: float


@dataclass(frozen=True, eq=False)
class LinearSegments:
    """Equation with one degree of freedom whose stiffness is linear in time on each of n segments.

    Attributes
    ----------
    mass : m [kg]
    edges : (n + 1,) ends of the segments, from 0 to the period T [s]
    stiffness_start, stiffness_end : (n,) k at both ends of each segment [N/m]
    damping : (n,) c of each segment [N s/m]
    force_start, force_end : (n,) F at both ends of each segment [N]

    Raises
    ------
    ParameterError : edges that do not increase from 0, arrays of another length, a mass or stiffness that is
        not positive, a segment whose damping is not below the critical damping of its stiffness
    """

    mass: float
    edges: FloatArray
    stiffness_start: FloatArray
    stiffness_end: FloatArray
    damping: FloatArray
    force_start: FloatArray
    force_end: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "mass", real_number("mass", self.mass, 0.0, above=True, unit="kg"))
        edges = real_numbers("edges", self.edges, increasing=True, unit="s")
        if edges.size < 2 or edges[0] != 0.0:
            raise refuse(
                "edges", shown(self.edges), "0 and later times", "Begin with 0, end with the period."
            )
        object.__setattr__(self, "edges", edges)
        for name, low, above in (
            ("stiffness_start", 0.0, True),
            ("stiffness_end", 0.0, True),
            ("damping", 0.0, False),
            ("force_start", -np.inf, False),
            ("force_end", -np.inf, False),
        ):
            values = real_numbers(name, getattr(self, name), low, above=above)
            if values.size != edges.size - 1:
                allowed = f"{edges.size - 1} numbers, one a segment"
                raise refuse(name, f"{values.size} numbers", allowed, "Give one number for each segment.")
            object.__setattr__(self, name, values)
        self._check_damping()

    def _check_damping(self) -> None:
        """Refuse a segment that does not swing."""
        critical = 2.0 * np.sqrt(np.minimum(self.stiffness_start, self.stiffness_end) * self.mass)
        over = np.flatnonzero(self.damping >= critical)
        if over.size:
            allowed = f"below {critical[over[0]]:.4g} N s/m, the critical damping of the segment"
            action = "Lower mesh.damping_ratio, or use floquet.monodromy."
            raise refuse("damping", f"{self.damping[over[0]]:.4g} N s/m", allowed, action)

    @property
    def period(self) -> float:
        """T [s]."""
        return float(self.edges[-1])

    def segment_of(self, time: FloatArray) -> IntArray:
        """Number of the segment in which each time (k,) of the period lies [s]."""
        last = self.stiffness_start.size - 1
        return np.asarray(np.clip(np.searchsorted(self.edges, time, side="right") - 1, 0, last))

    def stiffness(self, time: FloatArray) -> FloatArray:
        """Stiffness k(t) (k,) [N/m] at times (k,) of the period [s]."""
        return self._between(self.stiffness_start, self.stiffness_end, time)

    def force(self, time: FloatArray) -> FloatArray:
        """Force F(t) (k,) [N] at times (k,) of the period [s]."""
        return self._between(self.force_start, self.force_end, time)

    def _between(self, start: FloatArray, end: FloatArray, time: FloatArray) -> FloatArray:
        segment = self.segment_of(time)
        share = (time - self.edges[segment]) / np.diff(self.edges)[segment]
        return np.asarray(start[segment] + share * (end[segment] - start[segment]))

    @property
    def system(self) -> PeriodicSystem:
        """The equation without force for `floquet.monodromy`, in formulas; the states are (delta, delta')."""
        lengths = np.diff(self.edges)
        rate = (self.stiffness_end - self.stiffness_start) / lengths
        k = PiecewisePolynomial(self.edges, np.column_stack([self.stiffness_start, rate]) / self.mass)
        terms = [(k, np.array([[0.0, 0.0], [-1.0, 0.0]]))]
        if self.damping.any():
            c = PiecewisePolynomial(self.edges, self.damping[:, None] / self.mass)
            terms.append((c, np.array([[0.0, 0.0], [0.0, -1.0]])))
        return PeriodicSystem(PeriodicMatrix(np.array([[0.0, 1.0], [0.0, 0.0]]), *terms), self.period)

    @property
    def monodromy_matrix(self) -> FloatArray:
        """State (delta, delta') at the end of the period per state at the start, (2, 2)."""
        transition = np.eye(2)
        for number, length in enumerate(np.diff(self.edges)):
            transition = self._flow(number, np.array([length])).transition[-1] @ transition
        return transition

    @property
    def multipliers(self) -> ComplexArray:
        """Floquet multipliers (2,), the larger modulus first."""
        values = np.linalg.eigvals(self.monodromy_matrix).astype(complex)
        return np.asarray(values[np.argsort(-np.abs(values), kind="stable")])

    def motion(self, time: FloatArray) -> Motion:
        """Periodic motion in closed form, at increasing times (k,) in [0, T) [s]."""
        segment = self.segment_of(time)
        flows = []
        transition = np.eye(2)
        forced = np.zeros(2)
        for number, length in enumerate(np.diff(self.edges)):
            inner = time[segment == number] - self.edges[number]
            flow = self._flow(number, np.append(inner, length))
            flows.append(flow)
            transition = flow.transition[-1] @ transition
            forced = flow.transition[-1] @ forced + flow.forced[-1]
        state = np.linalg.solve(np.eye(2) - transition, forced)
        parts = []
        for flow in flows:
            states = flow.transition @ state + flow.forced
            parts.append(states[:-1])
            state = states[-1]
        states = np.concatenate(parts)
        return Motion(states[:, 0], states[:, 1])

    def _flow(self, number: int, time: FloatArray) -> _Flow:
        """Map from the start of a segment to times (k,) after its start; the last time is its end."""
        length = float(time[-1])
        square = float(self.stiffness_start[number]) / self.mass
        push = float(self.force_start[number]) / self.mass
        segment = _Segment(
            square=square,
            slope=(float(self.stiffness_end[number]) / self.mass - square) / length,
            decay=0.5 * float(self.damping[number]) / self.mass,
            push=push,
            ramp=(float(self.force_end[number]) / self.mass - push) / length,
        )
        if abs(segment.slope * length) <= _CONSTANT * square:
            return _harmonic_flow(segment, time)
        return _airy_flow(segment, time)


def _harmonic_flow(segment: _Segment, time: FloatArray) -> _Flow:
    """Solve delta'' + 2 decay delta' + square delta = push + ramp t for a damping below the critical one."""
    square, decay = segment.square, segment.decay
    frequency = np.sqrt(square - decay**2)
    fall = np.exp(-decay * time)
    cosine = fall * np.cos(frequency * time)
    sine = fall * np.sin(frequency * time) / frequency
    rows = [[cosine + decay * sine, sine], [-square * sine, cosine - decay * sine]]
    transition = np.moveaxis(np.array(rows), 2, 0)
    # A straight line solves the equation with the force.
    rate = (
        0.0 if abs(segment.ramp * time[-1]) <= _CONSTANT_FORCE * abs(segment.push) else segment.ramp / square
    )
    rest = np.array([(segment.push - 2.0 * decay * rate) / square, rate])
    line = rest + np.outer(time, [rate, 0.0])
    return _Flow(transition, line - transition @ rest)


def _airy_flow(segment: _Segment, time: FloatArray) -> _Flow:
    """Solve delta'' + 2 decay delta' + (square + slope t) delta = push + ramp t from t = 0.

    With c^3 = slope and s = -(square - decay^2 + slope t)/c^2 the functions exp(-decay t) Ai(s) and
    exp(-decay t) Bi(s) solve the equation without force. Their Wronskian is -(c/pi) exp(-2 decay t).
    Variation of constants adds the force.
    """
    decay = segment.decay
    scale = float(np.cbrt(segment.slope))
    panels = np.union1d(np.append(0.0, time), np.linspace(0.0, time[-1], _PANELS + 1))
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    half = 0.5 * np.diff(panels)
    inside = panels[:-1, None] + half[:, None] * (1.0 + nodes)

    def basis(times: FloatArray) -> FloatArray:
        """Values and rates (k, 2, 2) of both solutions; the solution is the last axis."""
        place = -(segment.square - decay**2 + segment.slope * times) / scale**2
        ai, ai_rate, bi, bi_rate = airy(place)
        fall = np.exp(-decay * times)
        values = fall * np.array([ai, bi])
        rates = -scale * fall * np.array([ai_rate, bi_rate]) - decay * values
        return np.moveaxis(np.array([values, rates]), 2, 0)

    solutions = basis(inside.ravel())[:, 0].reshape(*inside.shape, 2)
    wronskian = -(scale / np.pi) * np.exp(-2.0 * decay * inside)
    acceleration = (segment.push + segment.ramp * inside)[..., None]
    integrands = acceleration * np.stack([-solutions[..., 1], solutions[..., 0]], axis=-1)
    of_panels = half[:, None] * np.einsum("pnj,n->pj", integrands / wronskian[..., None], weights)
    integrals = np.vstack([np.zeros(2), np.cumsum(of_panels, axis=0)])
    solutions_then = basis(time)
    transition = solutions_then @ np.linalg.inv(basis(np.zeros(1))[0])
    forced = np.einsum("kij,kj->ki", solutions_then, integrals[np.searchsorted(panels, time)])
    return _Flow(transition, forced)
