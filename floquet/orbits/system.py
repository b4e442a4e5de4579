"""Systems that are linear with periodic coefficients between events: masses that unilateral contacts join.

Sources: docs/theory/orbits.md, "Model".
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from floquet.orbits.kernel import propagate
from lumped.errors import NumericalError
from lumped.typing import FloatArray

#: Order of the Taylor series: the error of the state at 18 is that of rounding (docs/theory/orbits.md).
ORDER = 18
TOLERANCE = 1e-13
_ROUNDING = 1e-15
_ACCELERATION = 8  # place in the arguments of the kernel


@dataclass(frozen=True, eq=False)
class Contact:
    """One unilateral contact: N = k d + c d' where d = u.z - e > 0 and that is positive, else 0.

    It never pulls, and a gap carries nothing. Each coefficient is a number or polynomials (P, D + 1) of the
    phase since the start of each of the P pieces, lowest power first.

    Attributes
    ----------
    direction : (m,) u
    acceleration : (n,) or (P, n, D + 1), what a unit load does to the m coordinates and the accumulated rows
    stiffness, damping : k >= 0 and c >= 0
    clearance : e
    clearance_rate : de/dtau as the damper sees it; None: the derivative of e
    sign : (alpha, beta), polynomials with N > 0 where alpha d + beta d' > 0; None: (k, c). They serve where k
        and c vanish together, because N itself is nothing but rounding there
    present : (P,) in which pieces the contact exists; None: in all
    """

    direction: ArrayLike
    acceleration: ArrayLike
    stiffness: ArrayLike
    damping: ArrayLike = 0.0
    clearance: ArrayLike = 0.0
    clearance_rate: ArrayLike | None = None
    sign: tuple[ArrayLike, ArrayLike] | None = None
    present: ArrayLike | None = None


@dataclass(frozen=True, eq=False)
class Run:
    """A motion over whole cycles from phase 0. Rates are by the phase: v = dz/dtau = T dz/dt.

    Attributes
    ----------
    start, end : (2m,) z and v
    accumulated : (n - m,) what the accumulated rows have gathered
    derivatives : (m + n, 2m + 2) of (end, accumulated) by start, T and the parameter; None where not asked
        for
    mean, mean_square, least, most : of the output over the phase
    largest_load : of one contact
    least_load : of all contacts together
    events : (E, 3) phase in cycles, contact and its new state (0 gap, 1 recovering, 2 closed)
    phases : (S,) of the samples in cycles
    states : (S, 2m)
    loads : (S, I)
    """

    start: FloatArray
    end: FloatArray
    accumulated: FloatArray
    derivatives: FloatArray | None
    mean: float
    mean_square: float
    least: float
    most: float
    largest_load: float
    least_load: float
    events: FloatArray
    phases: FloatArray
    states: FloatArray
    loads: FloatArray

    @property
    def derivative(self) -> FloatArray:
        """The derivatives, of a run that has them."""
        assert self.derivatives is not None
        return self.derivatives

    @property
    def rms(self) -> float:
        """Of the output less its mean."""
        return float(np.sqrt(max(self.mean_square - self.mean**2, 0.0)))


@dataclass(frozen=True, eq=False)
class ContactSystem:
    """z'' = F + p H - K z - C z' + sum a_i(tau) N_i, periodic in tau = t/T, contacts unilateral.

    One further row of K, C, F, H and a, behind the m coordinates, may gather an acceleration that does not
    act back and must vanish in the mean, as that of a rigid rotation: the parameter p is the unknown for it.

    Attributes
    ----------
    stiffness, damping : (n, m) K and C per unit mass [1/s^2], [1/s]
    force : (n,) F [m/s^2]
    contacts : the contacts
    phases : (P + 1,) ends of the pieces, 0 to 1
    output : (m,) the motion that is reported, output . z
    parameter_force : (n,) H
    """

    stiffness: FloatArray
    damping: FloatArray
    force: FloatArray
    contacts: tuple[Contact, ...]
    phases: FloatArray
    output: FloatArray
    parameter_force: FloatArray | None = None
    _packed: tuple[Any, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        phases = np.ascontiguousarray(self.phases, dtype=float)
        K, C, F = (np.ascontiguousarray(x, dtype=float) for x in (self.stiffness, self.damping, self.force))
        n = K.shape[0]
        H = np.zeros(n) if self.parameter_force is None else self.parameter_force
        H = np.ascontiguousarray(H, dtype=float)  # another layout would be another compilation
        for name, value in (("stiffness", K), ("damping", C), ("force", F), ("phases", phases)):
            object.__setattr__(self, name, value)
        P = phases.size - 1
        parts: dict[str, list[FloatArray]] = {name: [] for name in ("k", "c", "e", "b", "alpha", "beta", "a")}
        for contact in self.contacts:
            k, c = _pieces(contact.stiffness, P), _pieces(contact.damping, P)
            e = _pieces(contact.clearance, P)
            b = _derivative(e) if contact.clearance_rate is None else _pieces(contact.clearance_rate, P)
            sign = contact.sign
            alpha, beta = (k, c) if sign is None else (_pieces(sign[0], P), _pieces(sign[1], P))
            a = np.asarray(contact.acceleration, dtype=float)
            a = np.broadcast_to(a[:, None], (P, n, 1)) if a.ndim == 1 else a
            for name, value in zip(parts, (k, c, e, b, alpha, beta, a), strict=True):
                parts[name].append(value)
        lengths = np.diff(phases)
        parts = {name: [_trimmed(x, lengths) for x in rows] for name, rows in parts.items()}
        width = max(x.shape[-1] for name in parts if name != "a" for x in parts[name])
        packed = [_stacked(parts[name], width) for name in ("k", "c", "e", "b", "alpha", "beta")]
        packed.append(_stacked(parts["a"], max(x.shape[-1] for x in parts["a"])))
        there = [True if x.present is None else np.asarray(x.present, bool) for x in self.contacts]
        present = np.ascontiguousarray(np.stack([np.broadcast_to(x, P) for x in there], axis=1))
        u = np.ascontiguousarray([np.asarray(x.direction, dtype=float) for x in self.contacts])
        output = np.ascontiguousarray(self.output, dtype=float)
        object.__setattr__(self, "_packed", (phases, present, *packed, u, K, C, F, H, output))

    @property
    def size(self) -> int:
        """Number of states 2m."""
        return 2 * int(self.stiffness.shape[1])

    @property
    def balanced(self) -> bool:
        """Whether the parameter is an unknown that keeps the accumulated row at zero."""
        return bool(self.stiffness.shape[0] > self.stiffness.shape[1])

    def with_acceleration(self, acceleration: FloatArray) -> ContactSystem:
        """The same system with other accelerations per unit load, (P, I, n, D + 1) of all contacts."""
        other = copy.copy(self)
        packed = list(self._packed)
        packed[_ACCELERATION] = np.ascontiguousarray(acceleration)
        object.__setattr__(other, "_packed", tuple(packed))
        return other

    @property
    def acceleration(self) -> FloatArray:
        """Accelerations per unit load, (P, I, n, D + 1) of all contacts."""
        return np.asarray(self._packed[_ACCELERATION], dtype=np.float64)

    def run(
        self, start: FloatArray, period: float, cycles: int = 1, parameter: float = 0.0, *,
        derivatives: bool = False, samples: FloatArray | None = None, order: int = ORDER,
        logged: int = 0,
    ) -> Run:  # fmt: skip
        """Motion over whole cycles from phase 0, from ``start`` (2m,), z [m] and v = T dz/dt [m].

        Each cycle is recorded at ``samples``, increasing phases in [0, 1), at most ``logged`` events as well.
        NumericalError: the motion is not finite, or a contact opens and closes without end.
        """
        n, m = self.stiffness.shape
        samples = np.empty(0) if samples is None else np.ascontiguousarray(samples, dtype=float)
        contacts = len(self.contacts)
        states = np.zeros((cycles * samples.size, 2 * m))
        loads = np.zeros((cycles * samples.size, contacts))
        log = np.zeros((logged, 3))
        totals = np.zeros(6)
        final = np.zeros((m + n, 2 * m + 3 if derivatives else 1))
        start = np.ascontiguousarray(start, dtype=float)
        arguments: tuple[Any, ...] = (
            *(start, period, parameter, cycles, derivatives, order, TOLERANCE),
            *self._packed,
            *(samples, states, loads, log, totals, final),
        )
        count = propagate(*arguments)
        if count < 0:
            raise NumericalError(
                "the motion grew beyond all numbers or has more than 1000 contact events in a cycle. "
                "Start nearer to the motion looked for, or change the speed."
            )
        return Run(
            start=start,
            end=final[: 2 * m, 0],
            accumulated=final[2 * m :, 0],
            derivatives=final[:, 1:] if derivatives else None,
            mean=totals[0] / cycles,
            mean_square=totals[1] / cycles,
            least=float(totals[2]),
            most=float(totals[3]),
            largest_load=float(totals[4]),
            least_load=float(totals[5]),
            events=log[: min(count, logged)],
            phases=(np.arange(cycles)[:, None] + samples).ravel(),
            states=states,
            loads=loads,
        )


def _pieces(value: ArrayLike, count: int) -> FloatArray:
    """A number or polynomials (P, D + 1) -> (P, D + 1)."""
    array = np.asarray(value, dtype=float)
    return np.full((count, 1), float(array)) if array.ndim == 0 else array


def _derivative(rows: FloatArray) -> FloatArray:
    return rows[:, 1:] * np.arange(1, rows.shape[1]) if rows.shape[1] > 1 else np.zeros_like(rows)


def _trimmed(rows: FloatArray, lengths: FloatArray) -> FloatArray:
    """Polynomials (P, ..., D + 1) without the highest powers that are below the rounding of all pieces."""
    powers = lengths.reshape(-1, *[1] * (rows.ndim - 1)) ** np.arange(rows.shape[-1])
    sizes = np.abs(rows * powers).reshape(-1, rows.shape[-1]).max(axis=0)
    needed = np.flatnonzero(sizes > _ROUNDING * sizes.max())
    return rows[..., : needed[-1] + 1] if needed.size else rows[..., :1]


def _stacked(rows: Sequence[FloatArray], width: int) -> FloatArray:
    """(P, ..., D + 1) of each contact -> (P, I, ..., width)."""
    padded = [np.pad(x, [(0, 0)] * (x.ndim - 1) + [(0, width - x.shape[-1])]) for x in rows]
    return np.ascontiguousarray(np.stack(padded, axis=1))
