"""What the compiled propagation reads and writes: records with named fields.

Sources: docs/theory/orbits.md, "Model" and "Propagation". Symbols of that page stand behind the fields.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from lumped.compiler import compiled
from lumped.typing import BoolArray, FloatArray, IntArray

#: States of a contact. The contact does not exist in this piece of the cycle:
ABSENT = -1
#: The flanks do not touch.
GAP = 0
#: The flanks overlap, but spring and damper together would pull.
RECOVERING = 1
#: The contact carries load.
CLOSED = 2

#: How a propagation ended.
FINISHED = 0
#: The motion grows beyond all numbers: a step or a state is not finite.
GREW = 1
#: More than `MOST_EVENTS` a cycle.
TOO_MANY_EVENTS = 2
MOST_EVENTS = 1000

#: One change of the state of a contact.
EVENT = np.dtype((np.record, [("phase", np.float64), ("contact", np.int64), ("state", np.int64)]))
EventArray = np.ndarray[Any, np.dtype[np.void]]
#: One number each for the whole run. The output is y = output . z. While the run goes on, the means hold
#: integrals over the phase, and the loads hold T^2 N.
SUMMARY = np.dtype(
    (
        np.record,
        [
            ("output_mean", np.float64),
            ("output_mean_square", np.float64),
            ("least_output", np.float64),
            ("most_output", np.float64),
            ("largest_load", np.float64),  # of one contact
            ("least_load", np.float64),  # of all contacts together
            ("events", np.int64),  # how many changes of contact states happened
            ("samples_in_cycle", np.int64),  # how many samples of the present cycle are recorded
        ],
    )
)
#: Steps, as phases, after which a contact changes its state; twice the step where it does not change.
CROSSING = np.dtype(
    (
        np.record,
        [
            ("penetration", np.float64),  # d passes zero
            ("load", np.float64),  # N passes zero, while d > 0
        ],
    )
)


class ContactLaws(NamedTuple):
    """Coefficients of the contacts: polynomials of the phase, lowest power first along the last axis.

    `SystemTables` has the laws of all pieces (P, I, ...), as functions of the phase since the start of the
    piece. `Workspace` has the laws of one piece (I, ...), as functions of the phase since the start of the
    step. The signs alpha d + beta d' > 0 and N > 0 are equivalent. N itself would be rounding where k and c
    vanish together.

    Attributes
    ----------
    stiffness : k
    damping : c
    clearance : e
    clearance_rate : de/dtau in the damper
    sign_by_penetration : alpha
    sign_by_rate : beta
    acceleration : a, with one more axis (n,) before the last
    """

    stiffness: FloatArray
    damping: FloatArray
    clearance: FloatArray
    clearance_rate: FloatArray
    sign_by_penetration: FloatArray
    sign_by_rate: FloatArray
    acceleration: FloatArray


class LinearPart(NamedTuple):
    """The part F + p H - K z - C z' of the acceleration, which needs no contact.

    Attributes
    ----------
    stiffness : (n, m) K
    damping : (n, m) C
    force : (n,) F
    parameter_force : (n,) H
    """

    stiffness: FloatArray
    damping: FloatArray
    force: FloatArray
    parameter_force: FloatArray


class SystemTables(NamedTuple):
    """A `floquet.orbits.system.ContactSystem` as arrays.

    Attributes
    ----------
    phases : (P + 1,) ends of the pieces of the cycle, 0 to 1
    present : (P, I) whether a contact exists in a piece
    laws : of all contacts in all pieces
    direction : (I, m) u
    linear : the part without contacts
    output : (m,) the output is output . z
    """

    phases: FloatArray
    present: BoolArray
    laws: ContactLaws
    direction: FloatArray
    linear: LinearPart
    output: FloatArray


class Request(NamedTuple):
    """What to propagate.

    Attributes
    ----------
    period : T [s]
    parameter : p
    cycles : whole cycles from phase 0
    derivatives : whether derivatives by the start, T and p are propagated with the state
    order : of the Taylor series
    tolerance : bound of the last two terms of a series, relative to the state
    samples : increasing phases in [0, 1) at which each cycle is recorded
    """

    period: float
    parameter: float
    cycles: int
    derivatives: bool
    order: int
    tolerance: float
    samples: FloatArray


class Record(NamedTuple):
    """What a propagation writes, with room for S samples a cycle.

    Attributes
    ----------
    states : (cycles S, 2m) displacements and phase rates at the samples
    loads : (cycles S, I) N at the samples
    events : (E,) of EVENT: the first E changes of contact states, phase in cycles
    summary : one SUMMARY
    end : (m + n, q) z and v after the last cycle: the state in column 0, then its derivatives by the 2m
        initial states, by T and by p
    """

    states: FloatArray
    loads: FloatArray
    events: EventArray
    summary: Any
    end: FloatArray


class Series(NamedTuple):
    """Taylor coefficients of one step; phase rates throughout: v = dz/dtau.

    The last axis (q,) has the state in column 0. Where derivatives are propagated, columns 1 to 2m are those
    by the initial state, column BY_PERIOD is that by T, and column BY_PARAMETER that by p.

    Attributes
    ----------
    z : (R + 1, m, q) displacements
    v : (R + 1, n, q) phase rates, those of the accumulated row behind those of z
    penetration : (I, R + 1, q) d
    penetration_rate : (I, R + 1, q) d' as the damper has it
    load : (I, R + 1, q) T^2 N of the closed contacts
    """

    z: FloatArray
    v: FloatArray
    penetration: FloatArray
    penetration_rate: FloatArray
    load: FloatArray


#: Columns of `Series`, counted from the last one.
BY_PERIOD = -2
BY_PARAMETER = -1


class Contacts(NamedTuple):
    """What the contacts do on the present step.

    Attributes
    ----------
    states : (I,) ABSENT, GAP, RECOVERING or CLOSED
    crossings : (I,) of CROSSING: when the contacts change their states
    penetration : (I, R + 1) series of d without its derivatives, contiguous
    load_sign : (I, R + 1 + D) series of alpha d + beta d', which has the sign of N
    """

    states: IntArray
    crossings: np.ndarray[Any, np.dtype[np.void]]
    penetration: FloatArray
    load_sign: FloatArray


@compiled(no_cpython_wrapper=True)
def new_series(system: SystemTables, order: int, columns: int) -> Series:
    """Memory for series of an order with some columns."""
    contacts, m = system.direction.shape
    by_contact = (contacts, order + 1, columns)
    return Series(
        np.zeros((order + 1, m, columns)),
        np.zeros((order + 1, system.linear.stiffness.shape[0], columns)),
        np.zeros(by_contact),
        np.zeros(by_contact),
        np.zeros(by_contact),
    )


@compiled(no_cpython_wrapper=True)
def new_laws(table: ContactLaws) -> ContactLaws:
    """Memory for the laws of all contacts in one piece."""
    _, contacts, width = table.stiffness.shape
    _, _, n, acceleration_width = table.acceleration.shape
    return ContactLaws(
        np.zeros((contacts, width)),
        np.zeros((contacts, width)),
        np.zeros((contacts, width)),
        np.zeros((contacts, width)),
        np.zeros((contacts, width)),
        np.zeros((contacts, width)),
        np.zeros((contacts, n, acceleration_width)),
    )


@compiled(no_cpython_wrapper=True)
def new_contacts(table: ContactLaws, order: int) -> Contacts:
    """Memory for what the contacts do."""
    _, contacts, width = table.stiffness.shape
    return Contacts(
        np.empty(contacts, np.int64),
        np.empty(contacts, CROSSING),
        np.zeros((contacts, order + 1)),
        np.zeros((contacts, order + width)),
    )
