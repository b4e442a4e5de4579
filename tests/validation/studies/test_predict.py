"""Is a study of the prediction the prediction of each case, and does a case without it say so?"""

import math

import numpy as np
import pytest

from lumped.errors import NumericalError
from tests.unlike_pairs import unlike_pair
from validation.prediction import motion
from validation.prediction.motion import QUANTITIES, predict
from validation.studies import Status, read_results, run_sweep
from validation.studies.analyses import ANALYSES

OUTPUTS = tuple(ANALYSES["predict"].outputs)


def of_pair(make_study, pair, torques, **changes):
    axes = [{"field": "operating.pinion_torque", "values": torques}]
    data = {"gear_pair": pair, "analysis": "predict", "outputs": OUTPUTS, "axes": axes}
    return make_study(**(data | changes))


@pytest.mark.parametrize(("name", "contact_is_lost"), [
    ("larger_gear_drives_contact_lost", True),
    ("contact_ratio_2_3_on_shafts", False),
])  # fmt: skip
def test_the_outputs_are_those_of_the_prediction(make_study, tmp_path, name, contact_is_lost):
    """The same numbers to the last bit, with units. The first pair loses contact, the second has shafts.

    Two outputs follow from others: the lost power is the share 1 - efficiency of the driving power T Omega,
    and contact is lost exactly where the smallest mesh force is 0.
    """
    pair = unlike_pair(name)
    torque = pair.operating.pinion_torque
    torques = [torque, 1.25 * torque]
    summary = run_sweep(of_pair(make_study, pair, torques), tmp_path)
    assert dict(summary.statuses).keys() <= {Status.OK, Status.OUTSIDE_LAW_RANGE}
    result = read_results(tmp_path)
    assert result.attrs["teeth"] == ("alike" if pair.healthy is pair else "as given")
    for number, value in enumerate(torques):
        prediction = predict(pair.with_(operating__pinion_torque=value))
        case = result.isel(operating_pinion_torque=number)
        assert {q: float(case[q]) for q in QUANTITIES} == prediction.numbers
        power = value * pair.operating.pinion_speed
        # 1 - efficiency loses the digits of the efficiency.
        assert float(case.power_loss) == pytest.approx((1.0 - float(case.efficiency)) * power, rel=1e-9)
        assert (float(case.contact_lost) == 1.0) == (float(case.least_force) == 0.0)
        assert (float(case.unstable), float(case.linear)) == (float(not prediction.stable), 0.0)
    assert (float(result.contact_lost[0]) == 1.0) == contact_is_lost
    for quantity, (unit, text) in QUANTITIES.items():
        assert (result[quantity].attrs["units"], result[quantity].attrs["long_name"]) == (unit, text)


def test_springs_of_the_settings_hold_a_pair_with_shafts(make_study, tmp_path):
    pair = unlike_pair("contact_ratio_2_3_on_shafts")
    torque = pair.operating.pinion_torque
    study = of_pair(make_study, pair, [torque], settings={"supports": "springs"})
    run_sweep(study, tmp_path)
    (factor,) = read_results(tmp_path).dynamic_factor.to_numpy()
    assert factor == predict(pair, supports="springs").dynamic_factor
    assert factor != predict(pair).dynamic_factor


def test_a_case_in_which_the_linear_motion_stands_in_says_so(make_study, tmp_path, monkeypatch):
    """At the larger torque no motion with unilateral contact is found."""
    motion_of = motion.periodic_motion

    def without_one(pair, contact="linear", **options):
        if contact == "unilateral" and pair.operating.pinion_torque > 50.0:
            raise NumericalError("the motion grows")
        return motion_of(pair, contact, **options)

    monkeypatch.setattr(motion, "periodic_motion", without_one)
    pair = unlike_pair("rack_25_degrees_always_pushing")
    summary = run_sweep(of_pair(make_study, pair, [40.0, 60.0]), tmp_path)
    assert summary.failed == 0
    result = read_results(tmp_path)
    assert int(result.status[1]) == Status.LINEAR_MOTION
    assert int(result.status[0]) != Status.LINEAR_MOTION
    np.testing.assert_array_equal(result.linear, [0.0, 1.0])
    assert math.isfinite(float(result.dynamic_factor[1]))


def test_a_case_with_the_linear_motion_has_outputs_and_is_not_failed():
    failed = {"REFUSED", "NUMERICAL", "UNEXPECTED", "WORKER_DIED", "TIME_LIMIT"}
    assert {status.name for status in Status if status.failed} == failed
    codes = np.array([status.value for status in Status], dtype=np.int8)
    assert {Status(code).name for code in codes[Status.failed_among(codes)]} == failed
