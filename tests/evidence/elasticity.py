"""Plane elasticity of the teeth, and the standard's formulas, against other ways to the same numbers.

Sources: ISO 6336-1:2019, eqs. (82) to (93); docs/theory/elasticity.md.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from lumped import GearPair
from lumped.elasticity.gear import meshed
from lumped.elasticity.load import FAR, NEAR
from lumped.elasticity.ring import compliances
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.stiffness import iso6336
from lumped.stiffness.energy import contact_half_width
from lumped.stiffness.finite_elements import cross_compliance, elastic_teeth, hertz_half_width
from lumped.stiffness.neighbours import neighbour_compliances
from multibody.gears.circles import circles
from tests.evidence.check import Check, rows

#: Root over bore radius of the ring that the energy method's foundation stands for.
_RING = 4.0
_TEETH = 9
_SHIFT = 0.5
_POISSON = 0.3
#: Length along the base tangent of the load, near the tip, whose land only the larger circle meets; elements
#: at the surface; radii of another cut-off [modules].
_LENGTH = 3.9
_SIZE = 0.2
_OTHER = (0.2, 0.6)


def elasticity(pair: GearPair) -> Iterator[Check]:
    """Load, neighbours and contact of the finite elements, and ISO 6336-1."""
    yield _load()
    yield _standard(pair)
    yield _neighbours(pair)
    yield _contact(pair)


def _load() -> Check:
    """Largest change of the deflection of a tooth and of the next one by the radii of the cut-off.

    The split of the displacement into half plane and rest is a choice, so the sum must not know it: each
    term that is left out, of the surface, of the cut-off or of the body's mean motion, is seen here.
    """
    profile = ToothProfile(_TEETH, 1.0, math.radians(20.0), _SHIFT, 1.25, 0.38)
    tip = 0.5 * _TEETH + 1.0 + _SHIFT
    bore = profile.root_radius / 4.0
    mesh = meshed(profile, tip, bore, _SIZE)
    place = np.array([_LENGTH])
    one, other = (
        compliances(mesh, _POISSON, _TEETH, place, 1, "free", radii) for radii in ((NEAR, FAR), _OTHER)
    )
    # Elements of 0.2 modules, 1e-3 for other radii; a term of the load that is left out is 1 % and more.
    exact = "the same wherever the half plane's solution is cut off; over the deflection"
    error = float(np.abs(one - other).max() / np.abs(one).max())
    return Check("deflection of a tooth and of the next one under a load on the flank", exact, error, 2e-3)


def _standard(pair: GearPair) -> Check:
    """The standard's c' b and c_gamma b, eqs. (82) to (93), once more from the drawing."""
    gears = sorted((pair.pinion, pair.gear), key=lambda gear: (gear.teeth, -gear.profile_shift))
    (z1, x1), (z2, x2) = ((gear.teeth, gear.profile_shift) for gear in gears)
    q = 0.04723 + 0.15551 / z1 + 0.25791 / z2 - 0.00635 * x1 - 0.11654 * x1 / z1 - 0.00193 * x2
    q += -0.24188 * x2 / z2 + 0.00529 * x1**2 + 0.00182 * x2**2
    rack = pair.basic_rack
    factor = 1.0 + 0.5 * (1.2 - rack.dedendum_coefficient)
    factor *= 1.0 - 0.02 * (20.0 - math.degrees(rack.pressure_angle))
    e1 = pair.pinion.youngs_modulus
    e2 = pair.gear.youngs_modulus
    width = min(pair.pinion.face_width, pair.gear.face_width)
    single = 0.8 * factor / q * 2.0 * e1 * e2 / (e1 + e2) / 206e9 * 1e9 * width
    c = circles(pair)
    contact_ratio = (c.end - c.start) / c.pitch
    twice = (
        (iso6336.single_of(pair), single),
        (iso6336.mean_of(pair), single * (0.75 * contact_ratio + 0.25)),
    )
    return rows("c' and c_gamma of ISO 6336-1", "equations (82) to (93), written once more", 1e-9, twice)


def _neighbours(pair: GearPair) -> Check:
    """Motion of the next pair by finite elements, over that of the Fourier ring."""
    g = pair.geometry
    ring = elastic_teeth(pair, support="untwisted", bore=_RING)
    place = np.array([0.5 * (g.L_XA + g.L_XD - g.base_pitch)])
    by_fourier = neighbour_compliances(pair)[0](place)[0]
    ratio = float(cross_compliance(pair, ring, 1, place)[0] / by_fourier)
    # A foot without a tooth: within 0.024 on 160 pairs, 9 to 150 teeth, 14.5° to 28°.
    exact = "the Fourier series of a ring"
    return Check("motion of the next pair by plane finite elements", exact, abs(ratio - 1.0), 0.04)


def _contact(pair: GearPair) -> Check:
    """In plane strain no depth is left: u_c + (2 ln(2/a) - nu')/pi over E', with the other formula for a."""
    g = pair.geometry
    bodies = (pair.pinion, pair.gear)
    teeth = elastic_teeth(pair)
    xi = np.linspace(g.L_XA, g.L_XD, 23)[1:-1]
    load = pair.operating.pinion_torque / (g.base_radius_pinion * g.face_width)
    moduli = bodies[0].youngs_modulus, bodies[1].youngs_modulus
    ratios = bodies[0].poisson_ratio, bodies[1].poisson_ratio
    half = contact_half_width(load, xi * (g.L_XY - xi) / g.L_XY, moduli, ratios)
    both = []
    for tooth, length, modulus, nu in zip(teeth, (xi, g.L_XY - xi), moduli, ratios, strict=True):
        module = tooth.wheel.tooth.module
        deflection = tooth.flank.deflection(length / module)
        deflection = deflection + (2.0 * np.log(2.0 * module / half) - nu / (1.0 - nu)) / math.pi
        compliance = replace(tooth, plane="strain").compliance(length, hertz_half_width(pair, xi))
        both.append(np.stack([compliance * modulus / (1.0 - nu**2), deflection], axis=-1))
    exact = "the plane solution under a Hertzian pressure, half width of the energy method"
    return rows("contact by plane elasticity, plane strain", exact, 1e-12, np.concatenate(both))
