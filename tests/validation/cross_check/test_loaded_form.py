"""Does the cross-check judge loaded contact?"""

import numpy as np
import pytest

import multibody
from tests.unlike_pairs import UNLIKE, unlike_pair
from tests.validation.cross_check.checked import checked
from validation.cross_check.comparison import crosscheck
from validation.prediction.motion import predicted

#: Pairs on springs, of like teeth, in a motion with unilateral contact that repeats.
NAMES = [n for n in UNLIKE if unlike_pair(n).healthy is unlike_pair(n) and unlike_pair(n).shafts is None]
QUICK = {"cycles": 6, "samples_per_cycle": 64}


def apart(pair, share):
    """Largest difference of the exact DTE from the predicted DTE, over the peak to peak of the prediction.

    The lengths at the flanks are multiplied by ``share``: torque (by the deflection), relief and backlash.
    Without finite motions the difference would not change.
    """
    sizes = {
        "operating.pinion_torque": pair.operating.pinion_torque,
        "mesh.backlash": 1e3 * pair.mesh.backlash,
    }
    for name in ("pinion", "gear"):
        if (relief := getattr(pair, name).tip_relief) is not None:
            sizes[f"{name}.tip_relief.amount"] = 1e6 * relief.amount
    small = pair.with_({field: share * size for field, size in sizes.items()})
    dte = predicted(small).cycle["dte"].to_numpy()
    exact = multibody.steady_state(small, samples_per_cycle=dte.size)["dte"].to_numpy()[: dte.size]
    return float(np.abs(exact - dte).max() / np.ptp(dte))


@pytest.mark.parametrize("name", NAMES)
def test_the_loaded_form_and_the_exact_contact_differ_by_finite_motions_alone(name):
    """The difference by finite motions falls with the lengths at the flanks, also with unilateral contact.

    The difference by a wrong stiffness would stay. There is no friction: vibration reverses friction, and
    these reversals do not fall with the lengths.
    """
    pair = unlike_pair(name).with_(friction__law="none")
    difference = apart(pair, 0.25)
    assert difference < 0.03
    assert apart(pair, 0.0625) < 0.45 * difference


@pytest.fixture(scope="module")
def with_variant():
    """The cross-check of a loaded pair, with that of its twin."""
    return crosscheck(unlike_pair("contact_ratio_2_3_on_shafts"), **QUICK, supports="springs")


@pytest.mark.parametrize("name", NAMES)
def test_a_sound_pair_does_not_fail_and_its_transmission_error_is_near_the_exact_one(name):
    """Up to 12 % where vibration turns the sliding or contact is lost, below 1 % with relief alone."""
    check = checked(name)
    assert check.failures == ()
    dte = next(a for a in check.of("exact") if a.quantity == "dte")
    assert dte.difference < (0.01 if "relieved" in name else 0.13)


def test_the_asymmetric_variant_of_a_loaded_pair_is_checked_too(with_variant):
    assert with_variant.failures == ()
    assert with_variant.variant is not None
    assert with_variant.variant.pair.mesh.contact == "loaded"
    assert with_variant.variant.failures == ()
