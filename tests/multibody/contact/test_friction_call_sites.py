"""Does each law of the multibody model get the right oil, load and material? On pairs with unlike gears."""

import numpy as np
import pytest

from lumped.path_of_contact import friction_path_function
from multibody.contact.friction import nominal_friction
from multibody.contact.machine import machine

#: Error of the lumped model's polynomials; tests/lumped/friction pins them on the same pairs by hand.
FIT = 1e-9


@pytest.mark.parametrize(
    "law", ["benedict_kelley", "xu_kahraman", "iso_14179", "composite", "smoothed_coulomb"]
)
def test_nominal_friction_is_the_lumped_models(unlike, law):
    """Law V reads the film thickness, and with it k and s of the oil; I and IV the mean of law II."""
    # Between A and D contact is the same in both forms; a constant stiffness is made at once.
    pair = unlike.with_(law=law, stiffness="rectangular", mesh__contact="prescribed", mesh__relief="ignored")
    numbers = machine(pair)
    p = numbers.record.geometry
    mu = friction_path_function(pair, warn=False)
    xi = np.linspace(p.L_XA, p.L_XD, 23)[1:-1]
    friction = [nominal_friction(numbers.packed, float(one)) for one in xi]
    np.testing.assert_allclose(friction, mu(xi), rtol=0.0, atol=FIT)
