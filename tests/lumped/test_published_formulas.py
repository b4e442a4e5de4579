"""Do the published formulas give the numbers that their docstrings show?"""

import doctest
import importlib

import pytest

#: Module -> formulas that are published, each of which shows one number.
FORMULAS = {
    "lumped.friction.benedict_kelley": {"benedict_kelley", "friction_number"},
    "lumped.friction.composite": {"composite"},
    "lumped.friction.coulomb": {"coulomb"},
    "lumped.friction.smoothed_coulomb": {"smoothed_coulomb"},
    "lumped.gear_geometry.involute": {"involute", "inverse_involute"},
    "lumped.losses.anderson_loewenthal": {"anderson_loewenthal_coefficient"},
    "lumped.losses.loss_factor": {"ohlendorf"},
    "lumped.lubrication.film": {
        "film_thickness",
        "effective_modulus",
        "hertz_half_width",
        "hertz_pressure",
        "pressure_viscosity",
        "film_parameter",
        "regime",
    },
    "lumped.lubrication.roughness": {
        "composite_roughness",
        "mean_roughness",
    },
    "lumped.lubrication.viscosity": {"walther_constants", "kinematic_viscosity", "oil_density"},
    "lumped.lubrication.viscosity_grade": {"viscosity_index", "viscosity_at_100", "grade_viscosity"},
    "lumped.stiffness.contact": {"linear_hertz_compliance", "contact_half_width", "local_compliance"},
    "lumped.stiffness.foundation": {"coefficients", "ring_twist"},
    "lumped.stiffness.iso6336": {
        "theoretical_single_stiffness",
        "basic_rack_factor",
        "material_factor",
        "single_stiffness",
        "mean_mesh_stiffness",
    },
    "lumped.stiffness.parabolic": {"iso_end_ratio"},
    "lumped.friction.xu_kahraman": {"xu_kahraman"},
    "lumped.losses.mean_friction": {"iso_14179_mean_coefficient"},
}


@pytest.mark.parametrize("module", FORMULAS)
def test_every_formula_shows_a_number_and_it_is_right(module):
    loaded = importlib.import_module(module)
    shown = {test.name.rpartition(".")[2] for test in doctest.DocTestFinder().find(loaded) if test.examples}
    assert shown >= FORMULAS[module]
    assert doctest.testmod(loaded).failed == 0
