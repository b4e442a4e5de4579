"""Published formulas against their published values.

Every formula shows in its docstring a number that was worked out apart from this code; ``doctest`` computes
it again, and the multibody model its own formula where it has one. Where the formula is part of a sum, as in
the energy method, the sum is taken here once more.
"""

import doctest
import importlib
import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from lumped import GearPair
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.stiffness.energy import beam_compliance, contact_half_width, local_compliance, pair_compliance
from lumped.stiffness.foundation import foundation_compliance
from multibody.contact import friction as fr
from multibody.contact import kinematics as kn
from multibody.contact.friction import SurfaceMotion, signed_friction
from multibody.contact.records import FRICTION, MACHINE, Record
from tests.evidence.check import Check

#: Module -> formulas that are published, each of which shows one number.
FORMULAS: Mapping[str, frozenset[str]] = {
    f"lumped.{module}": frozenset(names.split())
    for module, names in {
        "friction.benedict_kelley": "benedict_kelley friction_number",
        "friction.composite": "composite",
        "friction.coulomb": "coulomb",
        "friction.iso_14179": "iso_14179_mean_coefficient",
        "friction.smoothed_coulomb": "smoothed_coulomb",
        "friction.xu_kahraman": "xu_kahraman",
        "gear_geometry.tooth_profile": "involute inverse_involute",
        "losses.loss_factor": "ohlendorf",
        "lubrication.film": "film_thickness effective_modulus "
        "hertz_half_width hertz_pressure pressure_viscosity film_parameter regime",
        "lubrication.viscosity": "walther_constants kinematic_viscosity oil_density "
        "viscosity_index viscosity_at_100 grade_viscosity",
        "stiffness.energy": "linear_hertz_compliance contact_half_width local_compliance",
        "stiffness.foundation": "coefficients torsional_stiffness",
        "stiffness.iso6336": "theoretical_single_stiffness basic_rack_factor material_factor "
        "single_stiffness mean_mesh_stiffness",
        "stiffness.parabolic": "iso_end_ratio",
    }.items()
}
#: A tooth of ROSS 2.3.0 (Ma et al. 2014, true fillets): 62 teeth, m 2 mm, b 20 mm, E 211 GPa, G 81.2 GPa.
#: Pressure angle at the contact, then k_b, k_s, k_a [N/m].
ROSS = (
    (0.2777380345253824, 2.9058556613e11, 5.6316833598e09, 2.8124045592e11),
    (0.3490658503988659, 1.1777017855e10, 2.2936547345e09, 6.3527384460e10),
    (0.42672233774374957, 9.9084633695e08, 1.0547146148e09, 1.6995806631e10),
)


def _law(**values: float) -> Record:
    """Parameters of the multibody model's friction laws by the names of their fields."""
    friction = np.zeros(1, FRICTION)[0]
    friction["factor"] = 1.0  # no factor of the user
    for name, value in values.items():
        friction[name] = value
    return friction


def _own_coulomb() -> float:
    machine = np.zeros(1, MACHINE)[0]
    machine["friction"] = _law(law=fr.LAWS["coulomb"], mean=0.05)
    machine["rolling"]["omega_p"] = 1.0
    surface = SurfaceMotion(-2.0, 10.0, 0.01, 0.01)
    return float(signed_friction(machine, np.zeros((0, 0)), kn.SLIDING, 1.0, 0.0, surface, 1.0))


_OIL = {"viscosity": 0.010, "pressure_k": 0.010471, "pressure_s": 0.1348}
_STEEL = 206e9 / (1.0 - 0.3**2)
#: Formula -> the multibody model's own, at the numbers of the docstring but in SI.
OWN: Mapping[str, Callable[[], float]] = {
    "coulomb": _own_coulomb,
    "benedict_kelley": lambda: fr.benedict_kelley(_law(viscosity=0.010, roughness=0.4e-6), 2.0, 10.0, 100e3),
    "xu_kahraman": lambda: fr.xu_kahraman(
        _law(viscosity=0.010, roughness=0.3e-6, modulus=2.0 * math.pi * 0.008 * 1e18 / 100e3),
        1.0,
        20.0,
        0.008,
        100e3,
    ),
    "smoothed_coulomb": lambda: fr.smoothed_coulomb(_law(mean=0.05, sharpness=1.0), 1.0),
    "hertz_pressure": lambda: 1e-9 * fr.hertz_pressure(_law(modulus=_STEEL), 0.008, 100e3),
    "film_parameter": lambda: fr.film_parameter(
        _law(modulus=_STEEL, composite_roughness=0.5e-6, film_length=0.8e-3, **_OIL), 10.0, 0.008, 100e3
    ),
}


def published(pair: GearPair) -> Iterator[Check]:
    """Published values of every formula, and of the sum of compliances on this pair."""
    missed = missed_values()
    number = sum(len(names) for names in FORMULAS.values())
    yield Check(f"{number} published formulas", "the digits stated; how many differ", len(missed), 0.0)
    yield _tooth()
    yield _compliances(pair)


def missed_values() -> list[str]:
    """Formulas with published numbers that the program does not reproduce, and the model."""
    missed = []
    for name, formulas in FORMULAS.items():
        module = importlib.import_module(name)
        shown = {test.name.rpartition(".")[2]: test for test in doctest.DocTestFinder().find(module)}
        for formula in sorted(formulas):
            test = shown.get(formula)
            if test is None or not test.examples:
                missed.append(f"{formula}: no number")
                continue
            if doctest.DocTestRunner(verbose=False).run(test, out=lambda text: None).failed:
                missed.append(f"{formula}: lumped")
            stated = next(one.want.strip() for one in reversed(test.examples) if one.want)
            if formula in OWN and f"{OWN[formula]():.{len(stated.partition('.')[2])}f}" != stated:
                missed.append(f"{formula}: multibody")
    return missed


def _tooth() -> Check:
    sine = math.sin(math.radians(20.0))
    profile = ToothProfile(62, 2e-3, math.radians(20.0), 0.0, 1.25, 0.25 / (1.0 - sine))
    modulus = 211e9
    shear = 81.2e9
    width = 20e-3
    errors = []
    for angle, *wanted in ROSS:
        length = np.array([profile.base_radius * math.tan(angle)])
        beam = beam_compliance(profile, length, modulus, 0.5 * modulus / shear - 1.0)
        for part, value in zip((beam.bending, beam.shear, beam.axial), wanted, strict=True):
            errors.append(abs(width / float(part[0]) / value - 1.0))
    # The values are stated to eleven digits.
    exact = "stiffness by an independent program, ROSS 2.3.0, with true fillets"
    return Check("a tooth in bending, shear and compression", exact, max(errors), 1e-9)


def _compliances(pair: GearPair) -> Check:
    """The stiffness of the energy method from the parts of each tooth, put together again."""
    g = pair.geometry
    xi = np.linspace(g.L_XA, g.L_XD, 9)
    stiffness = pair_compliance(pair, xi).stiffness
    load = pair.operating.pinion_torque / (g.base_radius_pinion * g.face_width)
    moduli = (pair.pinion.youngs_modulus, pair.gear.youngs_modulus)
    ratios = (pair.pinion.poisson_ratio, pair.gear.poisson_ratio)
    half_width = contact_half_width(load, xi * (g.L_XY - xi) / g.L_XY, moduli, ratios)
    total = np.zeros(xi.size)
    for wheel, e, nu, length in zip(pair.wheels, moduli, ratios, (xi, g.L_XY - xi), strict=True):
        profile = wheel.tooth
        _, h, _, angle = profile.involute_points(length)
        beam = beam_compliance(profile, length, e, nu)
        total += (
            beam.bending + beam.shear + beam.axial + local_compliance(half_width, h / np.cos(angle), e, nu)
        )
        root = profile.root_radius
        half = profile.root_half_angle
        total += foundation_compliance(profile.base_radius, root, half, angle, e, nu)
    error = float(np.abs(stiffness * total / g.face_width - 1.0).max())
    return Check("energy method", "its parts, of both teeth and their contact, added up again", error, 1e-9)
