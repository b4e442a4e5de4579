"""Does a tooth that is displaced on either gear move the gears as a drawing of the two flanks says?"""

import numpy as np
import pytest

import lumped
from tests.unlike_pairs import unlike_pair

#: A displacement of 1 um along the reference circle of a 25-degree rack: so much along the line of action.
MOVED = 1e-6 * np.cos(np.radians(25.0))
#: The tooth that is displaced, counted from 1.
DISPLACED_TOOTH = 3


@pytest.mark.parametrize(("gear", "lag"), [("pinion", MOVED), ("gear", -MOVED)])
def test_a_displaced_tooth_that_carries_alone_makes_the_gear_lag_or_lead(gear, lag):
    """Teeth are counted as they come into mesh, so the count runs against the rotation, on both gears.

    The pinion pushes with the front of its teeth. One that lies further along the count stands back: the
    pinion turns on by the displacement before it pushes, and the gear lags. The gear is pushed at the back of
    its teeth. One that lies further along the count stands closer to the pinion, and the gear leads. Where
    this tooth carries alone it does so by the whole displacement, for its deflection is that of any tooth.
    """
    pair = unlike_pair("rack_25_degrees_always_pushing")

    def error(displacement):
        index = [0.0] * getattr(pair, gear).teeth
        index[DISPLACED_TOOTH - 1] = displacement
        deviations = {f"{gear}.deviations": {"index": index, "first_order": "steps"}}
        return lumped.static_sharing(pair.with_(deviations), samples_per_cycle=32)

    plain = error(0.0)
    displaced = error(1.0)
    change = (displaced["transmission_error"] - plain["transmission_error"]).to_numpy().ravel()
    # Tooth 3 comes to A after two mesh cycles. It carries alone in the last third of the cycle that follows.
    carrying = (plain["normal_load"].to_numpy() > 0.0).sum(axis=plain["normal_load"].dims.index("pair"))
    cycle = np.arange(change.size) // 32
    alone = (cycle == 2) & (carrying.ravel() == 1)
    assert alone.sum() > 5
    assert change[alone] == pytest.approx(lag, rel=1e-9)
    # Two cycles before it meets, and after it has left, nothing is changed.
    assert change[(cycle == 0) | (cycle > 4)] == pytest.approx(0.0, abs=1e-18)
