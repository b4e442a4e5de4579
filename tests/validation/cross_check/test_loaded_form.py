"""Does the cross-check judge loaded contact?"""

import numpy as np
import pytest

import lumped
import multibody
from validation.cross_check.comparison import crosscheck
from validation.exchange.new_pair_file import new_pair

EQUAL = lumped.load_gear_pair("nasa_28_28").with_(
    mesh__stiffness={"model": "energy"}, mesh__contact="loaded", mesh__relief="ignored"
)
#: The corner of the gear's tip stands a seventh of a radian from the line of action; soft bearings.
UNEQUAL = lumped.load_gear_pair("fzg_c").with_(
    mesh__stiffness={"model": "energy"}, mesh__contact="loaded", operating__pinion_speed=1000
)
OWN = new_pair("19/41", module=2.5, face_width=20, speed=1450, torque=80)
RELIEF = EQUAL.with_(mesh__relief="static")
QUICK = {"cycles": 6, "samples_per_cycle": 64}


def apart(pair, share):
    """Largest difference of both models' DTE over its peak to peak, every length of the flanks times a share.

    Torque, relief and backlash are such lengths: without finite motions nothing else would change.
    """
    sizes = {
        "operating.pinion_torque": pair.operating.pinion_torque,
        "mesh.backlash": 1e3 * pair.mesh.backlash,
    }
    for name in ("pinion", "gear"):
        if (relief := getattr(pair, name).tip_relief) is not None:
            sizes[f"{name}.tip_relief.amount"] = 1e6 * relief.amount
    small = pair.with_({field: share * size for field, size in sizes.items()})
    exact, own = (
        model.steady_state(small, samples_per_cycle=128)["dte"].to_numpy() for model in (multibody, lumped)
    )
    return float(np.abs(exact - own).max() / np.ptp(own))


@pytest.mark.parametrize("pair", [UNEQUAL, OWN], ids=["16/24", "19/41"])
def test_the_loaded_form_and_the_exact_contact_differ_by_finite_motions_alone(pair):
    """Their share falls with every length: 1.07 to 0.38 % and 2.5 to 0.78 % of the peak to peak measured.

    A stiffness that is 2 % off in one model stays: 7.0 to 4.9 % and 6.6 to 5.2 %.
    """
    whole = apart(pair, 1.0)
    assert whole < 0.03
    assert apart(pair, 0.25) < 0.45 * whole


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
