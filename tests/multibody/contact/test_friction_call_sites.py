"""Does each law of the multibody model get the right oil, load and material? On pairs with unlike gears."""

import numpy as np
import pytest

from lumped.path_of_contact import friction_path_function
from lumped.schema.friction import FACTORS
from multibody.contact.friction import nominal_friction
from multibody.contact.machine import machine
from tests.friction_factors import ACTING, example_factor, with_factor

#: Error of the lumped model's polynomials; tests/lumped/friction pins them on the same pairs by hand.
FIT = 1e-9


@pytest.mark.parametrize(
    "law", ["benedict_kelley", "xu_kahraman", "iso_14179", "composite", "smoothed_coulomb"]
)
def test_nominal_friction_is_the_lumped_models(unlike, law):
    """Law V reads the film thickness, and with it k and s of the oil; I and IV the mean of law II."""
    compare(unlike.with_(law=law))


@pytest.mark.parametrize("law", ["benedict_kelley", "xu_kahraman", "iso_14179", "composite", "coulomb"])
def test_a_factor_on_mu_acts_once_in_both_models(unlike, law):
    """Both mean coefficients are without the factor: law V takes law IV where the film is thin."""
    with example_factor():
        compare(with_factor(unlike, 0.63, **{"friction.law": law, "friction.coefficient": None}))


def test_a_law_without_a_formula_has_the_factor_once(unlike):
    """The multibody model reads such a law from the lumped model, with the factor."""
    table = {"points": [-500.0, 0.0, 10.0, 500.0], "coefficient": [0.05, 0.07, 0.06, 0.04]}
    with example_factor():
        compare(with_factor(unlike, 0.63, **{"friction.law": "table", "friction.table": table}))


def test_a_factor_of_one_model_alone_is_seen(unlike):
    with example_factor(in_multibody=False), pytest.raises(AssertionError):
        compare(with_factor(unlike, 0.63, **{"friction.law": "coulomb"}))


@pytest.mark.parametrize("field", [factor.reads[0] for factor in FACTORS])
def test_every_factor_on_mu_is_in_both_models(unlike, field):
    compare(unlike.with_(dict(ACTING[field].changes)))


def compare(pair):
    # Between A and D contact is the same in both forms; a constant stiffness is made at once.
    pair = pair.with_(stiffness="rectangular", mesh__contact="prescribed", mesh__relief="ignored")
    numbers = machine(pair)
    p = numbers.record.geometry
    mu = friction_path_function(pair, warn=False)
    xi = np.linspace(p.L_XA, p.L_XD, 23)[1:-1]
    friction = [nominal_friction(numbers.packed, float(one)) for one in xi]
    np.testing.assert_allclose(friction, mu(xi), rtol=0.0, atol=FIT)
