"""The numbers of one machine as records with named fields, for compiled code.

A call of a compiled function costs Python time for each argument. So all numbers of a machine cross that
border in one flat array, ``packed``: a MACHINE record comes first, and behind it the blocks whose length
depends on the pair. Compiled code opens the array once: ``machine_of(packed)`` is an array of one MACHINE,
and the functions below it read the blocks. Contact records go back in the same way, as a flat array that is
viewed as CONTACT records.

Lengths in m, angles in rad, speeds in rad/s, counts as whole numbers. Angles are positive counter-clockwise.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from lumped.compiler import compiled
from lumped.path_function import FIT_DEGREE
from lumped.typing import FloatArray
from multibody.contact.views import as_records

#: One record of a dtype below, or an array of records. Type checkers know no fields of records.
Record = Any
Records = np.ndarray[Any, np.dtype[Any]]

#: Coordinates of the gears: deviations of centres and rotation angles of pinion and gear from the nominal
#: motion. Forces and moments stand in the same places.
X_P, Y_P, PHI_P, X_G, Y_G, PHI_G = range(6)
#: Rows of a state of the gears, (3, 6): coordinates, their rates, and the wrench of the tooth contacts.
COORDINATES, RATES, WRENCH = range(3)

#: Most tooth pairs in contact at once: contact ratio below 4.
MAX_PAIRS = 4
#: Most reliefs: tip and root of both flanks.
MOST_RELIEFS = 4
#: Columns of a piece of a piecewise polynomial: left end, right end, coefficients, highest power first.
PIECE_COLUMNS = FIT_DEGREE + 3

#: Of functions that allocate nothing: counting references to arrays would take a third of a call. None of
#: them may return an array to Python. ``called`` and ``inlined`` are the same without a wrapper for Python.
uncounted = compiled(_nrt=False)
#: For functions that return views of an array: their lines stand in the place of each call.
expanded = compiled(inline="always")

_F = np.float64
_I = np.int64


def record(**fields: object) -> np.dtype[Any]:
    """A dtype whose records have their fields as attributes; a field without a kind is a float."""
    return np.dtype((np.record, list(fields.items())))


#: Circles and path of contact of the drawing.
GEOMETRY = record(
    radius_p=_F,  # base radius of the pinion
    radius_g=_F,  # base radius of the gear
    pitch=_F,  # base pitch
    tip_p=_F,  # length of the pinion's tip circle on its base tangent
    tip_g=_F,  # the same of the gear
    edge_p=_F,  # length on the base tangent at which an undercut ends the pinion's flank; 0 without undercut
    edge_g=_F,  # the same of the gear
    L_XA=_F,  # nominal path of contact, from the pinion's tangent point X: start of contact A
    L_XP=_F,  # ... pitch point P
    L_XD=_F,  # ... end of contact D
    L_XY=_F,  # ... the gear's tangent point Y
    centre_p_x=_F,  # nominal centres
    centre_p_y=_F,
    centre_g_x=_F,
    centre_g_y=_F,
)
#: Nominal rotation, and where the teeth stand at t = 0.
ROLLING = record(
    omega_p=_F,  # nominal speeds, both positive
    omega_g=_F,
    earliest=_F,  # the nominal phase is that of a time inside this open interval, in which it is smooth [s]
    latest=_F,
    chi_drive=_F,  # angle of a pinion flank at t = 0, of the driving side
    apart_drive=_F,  # overlap that it has there with the nearest gear flank
    chi_coast=_F,  # the same of the coast side
    apart_coast=_F,
)
#: What a tooth pair resists with, beside its stiffness.
PAIR_LAW = record(
    damping=_F,  # c/sqrt(k) of a tooth pair, 2 zeta sqrt(m_e) [sqrt(kg)]
    softening=_F,  # D of Hertz's contact [m/N]
    nominal_force=_F,  # load at which the stiffness k holds [N]
)
#: Parameters of the friction laws, see ``multibody.contact.friction``.
FRICTION = record(
    law=_I,  # code of the law
    factor=_F,  # factor on the coefficient of every law [-]
    mean=_F,  # mu_avg of laws I and IV, or the mean coefficient of ISO/TR 14179-2, without the factor [-]
    sharpness=_F,  # Phi of law IV [1/m]
    maximum=_F,  # upper bound of law II [-]
    boundary=_F,  # film parameter below which law V takes law IV [-]
    mixed=_F,  # film parameter below which law V takes law II [-]
    nominal_load=_F,  # w_n, full static load per face width [N/m]
    face_width=_F,
    modulus=_F,  # E' [Pa]
    viscosity=_F,  # eta [Pa s]
    pressure_k=_F,  # alpha = k eta^s [mm^2/N], eta in mPa s
    pressure_s=_F,
    roughness=_F,  # S, mean of both Ra
    composite_roughness=_F,  # R_comp
    film_length=_F,  # L_x
    slowest=_F,  # sliding velocity below which law II is constant [m/s]
    slowest_rolling=_F,  # sum of the rolling velocities below which the laws are constant [m/s]
    reversal_velocity=_F,  # sliding velocity over which friction changes its sign; 0: at once [m/s]
)
#: A relief of one flank.
RELIEF = record(
    gear=_I,  # 0 pinion, 1 gear
    start=_F,  # roll angle at which it starts
    end=_F,  # roll angle at which it has its amount
    amount=_F,
    power=_F,  # of its growth
)
#: How an eccentric gear turns, and how its teeth are counted.
MOUNTING = record(
    eccentricity=_F,
    angle=_F,  # of the error along the line of action at t = 0
    first_tooth=_I,  # tooth at A at t = 0, from 0
)
#: Where a block stands in ``packed``.
BLOCK = record(start=_I, rows=_I, columns=_I)
#: Blocks of variable length.
BLOCKS = record(
    stiffness=BLOCK,  # k of a tooth pair, a piecewise polynomial of xi
    friction=BLOCK,  # the lumped model's mu, where this package has no formula of the law
    linear_damping=BLOCK,  # laws of the loaded linear mesh, all empty without one: c,
    linear_error=BLOCK,  # error that stands for the gap,
    linear_gap=BLOCK,  # gap itself,
    linear_tilt=BLOCK,  # sine of the angle of the normal at tip corners,
    linear_closing=BLOCK,  # share of the approach that closes the gap
    teeth_p=BLOCK,  # TOOTH of each tooth of the pinion; empty for like teeth
    teeth_g=BLOCK,  # the same of the gear
    faults=BLOCK,  # FAULT
    ripples=BLOCK,  # RIPPLE
)
#: A tooth that differs.
TOOTH = record(
    error=_F,  # material missing along the line of action
    rise=_F,  # its slope along the own base tangent, zero at the pitch point [-]
    relief=_F,  # tip relief beyond that of the design
)
#: A fault of one tooth; lengths are on the own base tangent.
FAULT = record(
    gear=_I,  # 0 pinion, 1 gear
    tooth=_I,  # from 0
    crack=_F,  # compliance of the crack over the square of the arm of the load [1/(N m)]
    root=_F,  # place of the root section on the centre line of the tooth
    half_tooth=_F,  # half the angle of the tooth on the base circle
    spall_start=_F,
    spall_end=_F,
    spall=_F,  # compliance between both ends [m/N]
    pit=_F,  # depth between both ends
    flank_end=_F,
)
#: A harmonic of the torque of one shaft.
RIPPLE = record(
    gear=_I,  # 0 pinion, 1 gear
    order=_F,  # periods a turn
    amplitude=_F,  # [N m]
    phase=_F,  # at t = 0
)
#: All numbers of a machine whose count does not depend on the pair.
MACHINE = record(
    geometry=GEOMETRY,
    rolling=ROLLING,
    pair_law=PAIR_LAW,
    friction=FRICTION,
    reliefs=(RELIEF, (MOST_RELIEFS,)),
    relief_count=_I,
    couplings=(_F, (MAX_PAIRS - 1, PIECE_COLUMNS)),  # how far pairs 1, 2, ... pitches apart move each other
    coupling_count=_I,  # ... over the position of the pair behind [m/N]; and how many of them act
    mountings=(MOUNTING, (2,)),  # of pinion and gear
    ripples_on_gears=_I,  # 1: ripples of the torques act on the gears; 0: on motor and load
    own_teeth=_I,  # whether teeth differ, gears are eccentric or torques have ripples
    blocks=BLOCKS,
)
#: One tooth pair at one instant, while its load is computed.
PAIR = record(
    position=_F,  # xi
    arm_p=_F,  # flank distances from X and Y
    arm_g=_F,
    compression=_F,  # approach less all gaps, neighbours not yet taken off
    compression_rate=_F,  # [m/s]
    error_slope=_F,  # of the gap over xi [-]
    corner_by_p=_F,  # slope of the gap of a tip corner by the pinion's flank distance [-]
    corner_by_g=_F,  # ... by the gear's flank distance
    corner_by_length=_F,  # ... by the length of the line of action
    stiffness=_F,  # k with the faults of its teeth [N/m]
    stiffness_slope=_F,  # over xi [N/m^2]
    elastic_load=_F,  # [N]
    couplings=(_F, (MAX_PAIRS,)),  # how far a unit load on each pair moves this one [m/N]
    coupling_slopes=(_F, (MAX_PAIRS,)),  # over xi [1/N]
    equation=(_F, (MAX_PAIRS,)),  # in the search for the loads: derivatives of its compression by the loads
    residual=_F,  # what is left of its equation, then the step of its load
    beyond=_I,  # 1: beyond a tip or an edge, where only pressed teeth touch
    may_pull=_I,  # 1: the pair cannot lose contact, and its load may be negative
    touches=_I,  # 1: the pair touches, in the search for the loads
)
#: One tooth pair in contact at one instant.
CONTACT = record(
    position=_F,  # xi
    load=_F,  # N, damper included [N]
    friction_force=_F,  # [N]
    friction_coefficient=_F,  # with the sign of the sliding velocity
    stiffness=_F,  # k [N/m]
    sliding_velocity=_F,  # [m/s]
    compression=_F,  # approach less all gaps, neighbours not yet taken off
    compression_rate=_F,  # [m/s]
    damping=_F,  # c [N s/m]
    flank=_F,  # +1 drive side, -1 coast side
    approach_rate=_F,  # rate of the overlap itself [m/s]
    elastic_load=_F,  # load without the damper [N]
    energy=_F,  # that the two teeth store [J]
    path_force=_F,  # force of the pair along the path of contact [N]
    path_rate=_F,  # velocity of the contact along the path [m/s]
)

#: What moves one coordinate of a gear, beside the teeth.
BODY = record(
    inertia=_F,  # mass [kg] or polar inertia [kg m^2]
    stiffness=_F,  # of the bearing; 0 for a rotation [N/m]
    damping=_F,  # of the bearing [N s/m]
    load=_F,  # driving or braking torque, counter-clockwise positive [N m]
)
#: What makes the contact force jump or bend, see ``multibody.contact.events``.
EVENT = record(
    kind=_I,
    place=_F,  # position xi of a switch or of turned sliding; stiffness where a corner lets go [N/m]
)

#: Lengths of records in a flat array of floats.
MACHINE_SIZE = MACHINE.itemsize // 8
CONTACT_SIZE = CONTACT.itemsize // 8
#: Length of a flat array for the contacts of one instant: both sides of the teeth.
CONTACTS_SIZE = 2 * MAX_PAIRS * CONTACT_SIZE


@expanded
def machine_of(packed: FloatArray) -> Records:
    """MACHINE (1,), a view."""
    return as_records(packed[:MACHINE_SIZE], MACHINE)


@expanded
def contacts_of(packed: FloatArray) -> Records:
    """CONTACT (n,), a view of a flat array."""
    return as_records(packed, CONTACT)


@expanded
def block_of(packed: FloatArray, block: Record) -> FloatArray:
    """The flat numbers of a block, a view."""
    return packed[block.start : block.start + block.rows * block.columns]


@expanded
def table_of(packed: FloatArray, block: Record) -> FloatArray:
    """A block as a table of rows and columns, a view."""
    return block_of(packed, block).reshape((block.rows, block.columns))


@expanded
def teeth_of(packed: FloatArray, block: Record) -> Records:
    """A block as TOOTH (z,), a view."""
    return as_records(block_of(packed, block), TOOTH)


@expanded
def faults_of(packed: FloatArray, block: Record) -> Records:
    """A block as FAULT (n,), a view."""
    return as_records(block_of(packed, block), FAULT)


@expanded
def ripples_of(packed: FloatArray, block: Record) -> Records:
    """A block as RIPPLE (n,), a view."""
    return as_records(block_of(packed, block), RIPPLE)


def opened(packed: FloatArray) -> Record:
    """The MACHINE record at the start of ``packed``; what is written into it is written there."""
    return packed[:MACHINE_SIZE].view(MACHINE)[0]


def opened_table(packed: FloatArray, block: Record) -> FloatArray:
    """A block as a table of rows and columns, a view."""
    return packed[block.start : block.start + block.rows * block.columns].reshape(block.rows, block.columns)


def opened_records(packed: FloatArray, name: str) -> Records:
    """The block ``teeth_p``, ``teeth_g``, ``faults`` or ``ripples`` as records (n,), a view."""
    kinds = {"teeth_p": TOOTH, "teeth_g": TOOTH, "faults": FAULT, "ripples": RIPPLE}
    return opened_table(packed, opened(packed).blocks[name]).ravel().view(kinds[name])


def opened_contacts(packed: FloatArray) -> Records:
    """Flat contacts (..., n CONTACT_SIZE) as CONTACT (..., n), a view."""
    return packed.view(CONTACT)


#: Blocks of the laws of the loaded linear mesh beside the stiffness.
LINEAR_BLOCKS = ("linear_damping", "linear_error", "linear_gap", "linear_tilt", "linear_closing")


def with_blocks(packed: FloatArray, blocks: dict[str, FloatArray | Records]) -> FloatArray:
    """The MACHINE part of ``packed``, with blocks behind it: tables (rows, columns), or records (n,)."""
    parts = [packed[:MACHINE_SIZE].copy()]
    places = opened(parts[0])["blocks"]
    start = MACHINE_SIZE
    for name in BLOCKS.names or ():
        values = np.ascontiguousarray(blocks.get(name, np.zeros((0, 0))))
        rows, columns = values.shape if values.ndim == 2 else (values.size, values.dtype.itemsize // 8)
        places[name] = (start, rows, columns)
        parts.append(values.view(np.float64).ravel())
        start += rows * columns
    return np.concatenate(parts)


def with_block(packed: FloatArray, name: str, table: FloatArray) -> FloatArray:
    """A packed machine with another table (rows, columns) in the place of the block of a name."""
    places = opened(packed).blocks
    blocks: dict[str, FloatArray | Records] = {
        block: opened_table(packed, places[block]) for block in BLOCKS.names or ()
    }
    return with_blocks(packed, blocks | {name: table})
