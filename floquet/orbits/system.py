"""Systems that are linear with periodic coefficients between events: masses that unilateral contacts join.

Sources: docs/theory/orbits.md, "Model".
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from floquet.orbits.kernel import propagate
from floquet.orbits.records import (
    EVENT,
    FINISHED,
    SUMMARY,
    ContactLaws,
    EventArray,
    LinearPart,
    Record,
    Request,
    SystemTables,
)
from lumped.errors import NumericalError
from lumped.typing import BoolArray, FloatArray

#: Order of the Taylor series: the error of the state at 18 is that of rounding (docs/theory/orbits.md).
ORDER = 18
TOLERANCE = 1e-13
_ROUNDING = 1e-15


@dataclass(frozen=True, eq=False)
class Contact:
    """One unilateral contact: N = k d + c d' where d = u.z - e > 0 and k d + c d' > 0, otherwise N = 0.

    A contact never pulls, and carries no load over a gap. Each coefficient is a number or polynomials
    (P, D + 1) of the phase since the start of each of the P pieces, lowest power first.

    Attributes
    ----------
    direction : (m,) u
    acceleration : (n,) or (P, n, D + 1) acceleration of the m coordinates and accumulated rows by a unit load
    stiffness, damping : k >= 0 and c >= 0
    clearance : e
    clearance_rate : de/dtau for the damper; None: the derivative of e
    sign : (alpha, beta), polynomials with N > 0 where alpha d + beta d' > 0; None: (k, c). The polynomials
        are necessary where k and c vanish together, because N is only rounding there
    present : (P,) whether the contact exists in a piece; None: in all pieces
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
    events : (E,) with the fields "phase" in cycles, "contact", and "state", the new state of the contact:
        0 gap, 1 recovering, 2 closed
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
    events: EventArray
    phases: FloatArray
    states: FloatArray
    loads: FloatArray

    @property
    def derivative(self) -> FloatArray:
        """The derivatives of a run with derivatives."""
        assert self.derivatives is not None
        return self.derivatives

    @property
    def rms(self) -> float:
        """Root mean square of the output about the mean."""
        return float(np.sqrt(max(self.mean_square - self.mean**2, 0.0)))


@dataclass(frozen=True, eq=False)
class ContactSystem:
    """z'' = F + p H - K z - C z' + sum a_i(tau) N_i, periodic in tau = t/T, contacts unilateral.

    One further row of K, C, F, H and a, after the m coordinates, may accumulate an acceleration, for example
    the acceleration of a rigid rotation. This acceleration has no effect on the coordinates, and the mean
    must vanish: the parameter p is the unknown for this condition.

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
    tables: SystemTables = field(init=False, repr=False)

    def __post_init__(self) -> None:
        phases = np.ascontiguousarray(self.phases, dtype=float)
        # Arrays of one layout: another layout would be another compilation.
        stiffness, damping, force, output = (
            np.ascontiguousarray(x, dtype=float)
            for x in (self.stiffness, self.damping, self.force, self.output)
        )
        parameter_force = np.zeros(force.size) if self.parameter_force is None else self.parameter_force
        for name, value in (("stiffness", stiffness), ("damping", damping), ("force", force)):
            object.__setattr__(self, name, value)
        object.__setattr__(self, "phases", phases)
        linear = LinearPart(stiffness, damping, force, np.ascontiguousarray(parameter_force, dtype=float))
        direction = np.ascontiguousarray([np.asarray(x.direction, dtype=float) for x in self.contacts])
        tables = SystemTables(phases, self._present(), self._laws(), direction, linear, output)
        object.__setattr__(self, "tables", tables)

    def _present(self) -> BoolArray:
        """(P, I) whether a contact exists in a piece."""
        pieces = self.phases.size - 1
        rows = [True if x.present is None else np.asarray(x.present, bool) for x in self.contacts]
        return np.ascontiguousarray(np.stack([np.broadcast_to(row, pieces) for row in rows], axis=1))

    def _laws(self) -> ContactLaws:
        """Laws of all contacts as polynomials of one width, without powers below rounding."""
        lengths = np.diff(self.phases)
        laws = [_laws_of(contact, lengths.size, self.force.size) for contact in self.contacts]
        trimmed = [ContactLaws(*(_trimmed(rows, lengths) for rows in law)) for law in laws]
        width = max(rows.shape[-1] for law in trimmed for rows in law[:-1])
        acceleration_width = max(law.acceleration.shape[-1] for law in trimmed)
        return ContactLaws(
            stiffness=_stacked([law.stiffness for law in trimmed], width),
            damping=_stacked([law.damping for law in trimmed], width),
            clearance=_stacked([law.clearance for law in trimmed], width),
            clearance_rate=_stacked([law.clearance_rate for law in trimmed], width),
            sign_by_penetration=_stacked([law.sign_by_penetration for law in trimmed], width),
            sign_by_rate=_stacked([law.sign_by_rate for law in trimmed], width),
            acceleration=_stacked([law.acceleration for law in trimmed], acceleration_width),
        )

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
        laws = self.tables.laws._replace(acceleration=np.ascontiguousarray(acceleration))
        other = copy.copy(self)
        object.__setattr__(other, "tables", self.tables._replace(laws=laws))
        return other

    @property
    def acceleration(self) -> FloatArray:
        """Accelerations per unit load, (P, I, n, D + 1) of all contacts."""
        return self.tables.laws.acceleration

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
        start = np.ascontiguousarray(start, dtype=float)
        request = Request(period, parameter, cycles, derivatives, order, TOLERANCE, samples)
        record = Record(
            states=np.zeros((cycles * samples.size, 2 * m)),
            loads=np.zeros((cycles * samples.size, len(self.contacts))),
            events=np.zeros(logged, EVENT),
            summary=np.zeros(1, SUMMARY)[0],
            end=np.zeros((m + n, 2 * m + 3 if derivatives else 1)),
        )
        if propagate(start, request, self.tables, record) != FINISHED:
            raise NumericalError(
                "the motion grew beyond all numbers or has more than 1000 contact events in a cycle. "
                "Start nearer to the motion looked for, or change the speed."
            )
        summary = record.summary
        return Run(
            start=start,
            end=record.end[: 2 * m, 0],
            accumulated=record.end[2 * m :, 0],
            derivatives=record.end[:, 1:] if derivatives else None,
            mean=float(summary.output_mean),
            mean_square=float(summary.output_mean_square),
            least=float(summary.least_output),
            most=float(summary.most_output),
            largest_load=float(summary.largest_load),
            least_load=float(summary.least_load),
            events=record.events[: min(int(summary.events), logged)],
            phases=(np.arange(cycles)[:, None] + samples).ravel(),
            states=record.states,
            loads=record.loads,
        )


def _laws_of(contact: Contact, pieces: int, rows: int) -> ContactLaws:
    """Laws of one contact as polynomials (P, D + 1), the acceleration (P, n, D + 1)."""
    stiffness = _polynomials(contact.stiffness, pieces)
    damping = _polynomials(contact.damping, pieces)
    clearance = _polynomials(contact.clearance, pieces)
    if contact.clearance_rate is None:
        clearance_rate = _derivative(clearance)
    else:
        clearance_rate = _polynomials(contact.clearance_rate, pieces)
    if contact.sign is None:
        sign_by_penetration = stiffness
        sign_by_rate = damping
    else:
        sign_by_penetration = _polynomials(contact.sign[0], pieces)
        sign_by_rate = _polynomials(contact.sign[1], pieces)
    acceleration = np.asarray(contact.acceleration, dtype=float)
    if acceleration.ndim == 1:
        acceleration = np.broadcast_to(acceleration[:, None], (pieces, rows, 1))
    return ContactLaws(
        stiffness, damping, clearance, clearance_rate, sign_by_penetration, sign_by_rate, acceleration
    )


def _polynomials(value: ArrayLike, pieces: int) -> FloatArray:
    """A number or polynomials (P, D + 1) -> (P, D + 1)."""
    array = np.asarray(value, dtype=float)
    return np.full((pieces, 1), float(array)) if array.ndim == 0 else array


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
