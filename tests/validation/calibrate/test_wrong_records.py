"""Records that a calibration must not use are refused, with what to do."""

from dataclasses import replace

import numpy as np
import pytest

import spurcheck
from lumped.errors import ParameterError
from tests.validation.calibrate.rig import rig_pair, rig_record
from validation.calibrate import calibrate


def _channel(record, values):
    return replace(record, channels=(replace(record.channels[0], values=values),))


def _other_speed(record):
    return replace(record, pinion_speed=1.02 * record.pinion_speed)


def _micrometres_as_metres(record):
    return _channel(record, 1e6 * record.channels[0].values)


def _noise_alone(record):
    return _channel(record, np.random.default_rng(2).standard_normal(record.places.size))


def _rest(record):
    return _channel(record, np.zeros(record.places.size))


def _few_samples(record):
    return replace(
        record, places=record.places[:30], channels=(
            replace(record.channels[0], values=record.channels[0].values[:30]),
        ),
    )  # fmt: skip


def _statics_alone(record):
    return replace(record, channels=(), statics={"contact_ratio": np.array(1.6)})


def _another_pair(record):
    """A pair with the same tooth numbers, so with the same mesh frequency, and four times the torque."""
    other = spurcheck.new_pair("19/41", module=2.5, face_width=20, speed=1450, torque=320, stiffness="energy")
    return replace(rig_record(other), pinion_torque=80.0)


def _other_teeth(record):
    """A pair with other tooth numbers: its mesh frequency is another one."""
    other = spurcheck.new_pair("28/28", module=2.5, face_width=20, speed=1450, torque=80, stiffness="energy")
    return rig_record(other)


WRONG = {
    _other_speed: "speed",
    _micrometres_as_metres: "a motion of this pair",
    _noise_alone: "%",
    _rest: "no motion",
    _few_samples: "at least 8 mesh cycles",
    _statics_alone: "at least one",
    _another_pair: "a motion of this pair",
    _other_teeth: "numbers of teeth|speed of the samples",
}


@pytest.mark.parametrize("spoil", WRONG, ids=lambda one: one.__name__)
def test_a_wrong_record_is_refused(truth, spoil):
    with pytest.raises(ParameterError, match=WRONG[spoil]):
        calibrate(rig_pair(), spoil(rig_record(truth)), machines=16, progress=False)


def test_the_same_record_twice_is_refused(truth):
    with pytest.raises(ParameterError, match="records that differ"):
        calibrate(rig_pair(), [rig_record(truth), rig_record(truth)], machines=16, progress=False)


def test_no_record_and_no_input_are_refused(truth):
    with pytest.raises(ParameterError, match="at least one record"):
        calibrate(rig_pair(), [])
    with pytest.raises(ParameterError, match="at least one uncertain input"):
        calibrate(rig_pair(uncertainty={}), rig_record(truth))


def test_a_pair_is_not_calibrated_twice(one_run, truth):
    with pytest.raises(ParameterError, match="Give all records together"):
        calibrate(one_run.pair, rig_record(truth))


def test_the_message_names_the_record(truth):
    with pytest.raises(ParameterError, match="record 2"):
        calibrate(rig_pair(), [rig_record(truth), _rest(rig_record(truth))])
