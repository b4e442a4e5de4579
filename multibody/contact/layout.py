"""Where the numbers of the multibody model stand: effect switches, parameters, contact records."""

from __future__ import annotations

from lumped.path_function import FIT_DEGREE

#: Most tooth pairs in contact at once: contact ratio below 4.
MAX_PAIRS = 4
#: Parameters of the friction laws, named in ``multibody.contact.friction``.
N_FRICTION = 18

# Bits of the effect switches, and of the linear mesh, which has none of the effects.
ROTATION_PHASE, MOVING_LINE, SLIDING, ENTRY_SHIFT, CONTACT_LOSS, BACK_SIDE, LINEAR = 1, 2, 4, 8, 16, 32, 64
FRICTION_LOAD, PATH_WORK, TIP_CONTACT, CONTACT_LAW, NEIGHBOURS, CLEARANCE = 128, 256, 512, 1024, 2048, 4096

# Places in the parameter vector. Lengths in m, angles in rad, speeds in rad/s.
(
    RADIUS_P, RADIUS_G, PITCH, TIP_P, TIP_G,  # base radii, base pitch, tangent lengths of the tip circles
    CHI_P, APART, CHI_P_BACK, APART_BACK,  # chi_p and overlap of mesh_phase: drive and coast side
    CENTRE_PX, CENTRE_PY, CENTRE_GX, CENTRE_GY,  # nominal centres
    L_XA, L_XP, L_XD, L_XY,  # nominal path of contact
    OMEGA_P, OMEGA_G,  # nominal speeds
    V_REG,  # velocity over which friction changes sign; 0 = at once
    T_LOW, T_HIGH,  # the nominal phase is clamped to this open time interval (a smooth segment)
    DAMPING,  # c/sqrt(k) of a tooth pair, 2 zeta sqrt(m_e) [sqrt(kg)]
    SOFTENING, NOMINAL_FORCE,  # D of Hertz's contact [m/N], and the load at which the table's k holds [N]
    K_ROWS, C_ROWS, E_ROWS, GAP_ROWS,  # of k, c, e, gap in the table of the linear, loaded mesh, or 0
    OWN,  # where the block of ``machine.own_block`` starts, or 0
    RELIEFS,  # number of reliefs that act
    FIRST_RELIEF,  # of each: gear, roll angles of start and end [rad], amount [m], power of growth
) = range(32)  # fmt: skip
#: Columns of one relief, and the most reliefs: tip and root of both flanks.
RELIEF_COLUMNS, MOST_RELIEFS = 5, 4
#: Where the parameters of the friction laws start, see ``multibody.contact.friction``.
FRICTION = FIRST_RELIEF + RELIEF_COLUMNS * MOST_RELIEFS
#: How far pairs 1, 2, ... base pitches apart move each other: the number of such functions, then each as
#: a row of ``elements.stiffness_and_slope`` over the position of the pair behind [m/N].
COUPLED = FRICTION + N_FRICTION
FIRST_COUPLED, COUPLED_COLUMNS = COUPLED + 1, FIT_DEGREE + 3
#: The rows of ``friction_size``'s table, if there is one, stand behind all others.
N_PARAMETERS = FIRST_COUPLED + COUPLED_COLUMNS * (MAX_PAIRS - 1)

# Places in the block of teeth that differ: of pinion and gear eccentricity [m], its angle at t = 0 [rad],
# number of teeth, tooth at A at t = 0; then the number of faults, the errors of the pinion's teeth and of
# the gear's [m], their rise along the own base tangents from the pitch point [-], and a row for each fault.
ECCENTRICITY, ANGLE, TEETH, FIRST, OWN_COLUMNS = range(5)
OWN_FAULTS = 2 * OWN_COLUMNS
OWN_ERRORS = OWN_FAULTS + 1
# Columns of a fault: gear (1) or pinion (0), tooth from 0; of a crack the compliance over the square of the
# arm of the load [1/(N m)], place of the root section on the centre line of the tooth [m], half its angle on
# the base circle [rad]; of a spall both ends [m], compliance between them [m/N], depth [m]; where the flank
# ends [m]. Lengths are on the own base tangent.
(
    FAULT_GEAR, FAULT_TOOTH, CRACK, ROOT, HALF_TOOTH, SPALL_START, SPALL_END, SPALL, PIT, FLANK_END,
    FAULT_COLUMNS,
) = range(11)  # fmt: skip

# Columns of a contact record.
# OVERLAP and its rate are those pressed elastically (tooth error taken off); CLOSING is the overlap's own
# rate.
# ELASTIC is the load without the damper, ENERGY what the two teeth store, PATH their force along the path of
# contact (``path_force``), and PATH_RATE the velocity of the contact along it.
(
    XI, LOAD, FRICTION_FORCE, MU, K, SLIDE, OVERLAP, OVERLAP_RATE, C, FLANK, CLOSING,
    ELASTIC, ENERGY, PATH, PATH_RATE,
) = range(15)  # fmt: skip
N_RECORD = 15

# Rows of what is known of the pairs before their loads are.
(
    POSITION, PRESSED, PRESSING, RELIEF_SLOPE, BY_P, BY_G, BY_L, STIFFNESS, SLOPE, NORMAL, BEYOND, ARMS,
) = range(12)  # fmt: skip
# The flank distances take two rows; behind them stand how pairs move each other, and its slopes.
COUPLINGS = ARMS + 2
SLOPES = COUPLINGS + MAX_PAIRS
N_STATE = SLOPES + MAX_PAIRS
