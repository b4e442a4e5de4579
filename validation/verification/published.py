"""Published formulas against their published values, on this installation.

Every formula shows in its docstring a number that was worked out apart from this code; ``doctest`` computes
it again. Where the formula is part of a sum, as in the energy method, the sum is taken here once more.
"""

from __future__ import annotations

import doctest
import importlib
import math
from collections.abc import Iterator, Mapping

import numpy as np

from lumped import GearPair
from lumped.friction import benedict_kelley, xu_kahraman
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.lubrication.film import effective_modulus, film_parameter, film_thickness, hertz_half_width
from lumped.stiffness.contact import contact_half_width, local_compliance
from lumped.stiffness.foundation import foundation_compliance
from lumped.stiffness.pair_compliance import pair_compliance
from lumped.stiffness.tooth_beam import beam_compliance
from validation.verification.checks import Check

#: Module -> formulas that are published, each of which shows one number.
FORMULAS: Mapping[str, frozenset[str]] = {
    f"lumped.{module}": frozenset(names.split())
    for module, names in {
        "friction.benedict_kelley": "benedict_kelley friction_number",
        "friction.composite": "composite",
        "friction.coulomb": "coulomb",
        "friction.smoothed_coulomb": "smoothed_coulomb",
        "friction.xu_kahraman": "xu_kahraman",
        "gear_geometry.involute": "involute inverse_involute",
        "losses.anderson_loewenthal": "anderson_loewenthal_coefficient",
        "losses.loss_factor": "ohlendorf",
        "losses.mean_friction": "iso_14179_mean_coefficient",
        "lubrication.film": "film_thickness effective_modulus hertz_half_width hertz_pressure "
        "pressure_viscosity film_parameter regime",
        "lubrication.roughness": "composite_roughness mean_roughness",
        "lubrication.viscosity": "walther_constants kinematic_viscosity oil_density",
        "lubrication.viscosity_grade": "viscosity_index viscosity_at_100 grade_viscosity",
        "stiffness.contact": "linear_hertz_compliance contact_half_width local_compliance",
        "stiffness.foundation": "coefficients ring_twist",
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


def published_checks(pair: GearPair) -> tuple[Check, ...]:
    """Published values of every formula, and of the sum of compliances on this pair."""
    return (*_by_hand(), _shown(), _tooth(), _compliances(pair))


def _by_hand() -> Iterator[Check]:
    """Published formulas against values worked out by hand, to the digits stated."""
    modulus = effective_modulus(206e3, 0.3, 206e3, 0.3)
    thickness, width = film_thickness(100, 8, 10, 10, modulus), hertz_half_width(100, 8, modulus)
    film = (thickness, width, film_parameter(thickness, width, 0.5, 0.8))
    for key, subject, found, wanted in (
        ("law_ii", "law II, Benedict and Kelley", [benedict_kelley(100, 10, 2, 10, 0.4)], [0.06235267]),
        ("law_iii", "law III, Xu and Kahraman", [xu_kahraman(1.0, 0.1, 10, 10, 0.3, 0.008)], [0.01039515]),
        ("film", "film thickness, Hertzian width, film parameter", film, [0.312115, 0.0948642, 1.281808]),
    ):
        yield Check(
            key=key,
            subject=subject,
            exact="values worked out twice from the published formula, apart from this code",
            value=float(np.abs(np.divide(found, wanted) - 1.0).max()),
            limit=2e-6,
            reason="the values are stated to six or seven digits",
        )


def _shown() -> Check:
    """The numbers that the docstrings of the formulas show."""
    runner, count = doctest.DocTestRunner(verbose=False), 0
    for name in FORMULAS:
        module = importlib.import_module(name)
        for test in doctest.DocTestFinder().find(module):
            count += runner.run(test, out=lambda text: None).failed
    return Check(
        key="published_values",
        subject="every published formula that the lumped model uses: laws, film, oil, ISO 6336, contact",
        exact="the number in its docstring, worked out apart from the code; how many differ",
        value=float(count),
        limit=0.0,
        reason="numbers are compared to the digits shown",
    )


def _tooth() -> Check:
    sine = math.sin(math.radians(20.0))
    profile = ToothProfile(62, 2e-3, math.radians(20.0), 0.0, 1.25, 0.25 / (1.0 - sine))
    modulus, shear, width = 211e9, 81.2e9, 20e-3
    errors = []
    for angle, *wanted in ROSS:
        length = np.array([profile.base_radius * math.tan(angle)])
        beam = beam_compliance(profile, length, modulus, 0.5 * modulus / shear - 1.0)
        for part, value in zip((beam.bending, beam.shear, beam.axial), wanted, strict=True):
            errors.append(abs(width / float(part[0]) / value - 1.0))
    return Check(
        key="tooth",
        subject="a tooth in bending, shear and compression",
        exact="stiffnesses by an independent program, ROSS 2.3.0, with true fillets",
        value=max(errors),
        limit=1e-9,
        reason="the values are stated to eleven digits",
    )


def _compliances(pair: GearPair) -> Check:
    """The stiffness of the energy method from the parts of each tooth, put together again."""
    g = pair.geometry
    xi = np.linspace(g.L_XA, g.L_XD, 9)
    found = pair_compliance(pair, xi).stiffness
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
        root, half = profile.root_radius, profile.root_half_angle
        total += foundation_compliance(profile.base_radius, root, 0.5 * wheel.bore, half, angle, e, nu)
    return Check(
        key="compliances",
        subject="stiffness of this pair's teeth by the energy method",
        exact="its parts, of both teeth and their contact, added up again",
        value=float(np.abs(found * total / g.face_width - 1.0).max()),
        limit=1e-9,
        reason="rounding",
    )
