"""Does the cross-check judge loaded contact?"""

import numpy as np
import pytest

import lumped
import multibody
from validation.cross_check.comparison import crosscheck

EQUAL = lumped.load_gear_pair("nasa_28_28").with_(
    mesh__stiffness={"model": "energy"}, mesh__contact="loaded", mesh__relief="ignored"
)
#: The corner of the gear's tip stands a seventh of a radian from the line of action; soft bearings.
UNEQUAL = lumped.load_gear_pair("fzg_c").with_(
    mesh__stiffness={"model": "energy"}, mesh__contact="loaded", operating__pinion_speed=1000
)
RELIEF = EQUAL.with_(mesh__relief="static")
QUICK = {"cycles": 6, "samples_per_cycle": 64}


@pytest.mark.parametrize(("relief", "most"), [("ignored", 0.02), ("static", 0.03)])
def test_the_loaded_form_meets_the_exact_contact(relief, most):
    """Over peak to peak at 2000 rpm: 0.011 and 0.015 measured; prescribed contact is off by 0.8 and 0.04."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        {"mesh.stiffness": {"model": "energy"}, "mesh.contact": "loaded", "mesh.relief": relief}
    )
    pair = pair.with_(operating__pinion_speed=2000.0)
    exact, own = (
        model.steady_state(pair, samples_per_cycle=256)["dte"].to_numpy() for model in (multibody, lumped)
    )
    difference = (exact - exact.mean()) - (own - own.mean())
    assert np.abs(difference).max() < most * np.ptp(exact)


@pytest.fixture(scope="module")
def equal():
    """The cross-check of the equal pair, with that of its twin."""
    return crosscheck(EQUAL, **QUICK)


@pytest.mark.parametrize("pair", [EQUAL, UNEQUAL, RELIEF], ids=["equal", "unequal", "relief"])
def test_a_sound_pair_does_not_fail_and_its_transmission_error_is_near_the_exact_one(pair, equal):
    """Measured: 1.2, 0.6 and 9.9 %; with relief a pair begins to carry late."""
    check = equal if pair is EQUAL else crosscheck(pair, **QUICK, variant=False)
    assert check.failures == ()
    dte = next(a for a in check.of("exact") if a.quantity == "dte")
    assert dte.difference < 0.12


def test_the_asymmetric_variant_of_a_loaded_pair_is_checked_too(equal):
    assert equal.variant is not None
    assert equal.variant.pair.mesh.contact == "loaded"
    assert equal.variant.failures == ()
