"""Is a source read as its author means it, or refused with a sentence that says what to type?"""

import re

import numpy as np
import pytest

from lumped.errors import ParameterError
from tests.validation.check.natural_imports import ROWS, known
from validation.check.reading.reader import read

#: Nine digits are written, of values whose mean is a hundred times the motion.
TOLERANCE = {"rtol": 2e-9, "atol": 0.0}
ATTRIBUTES = ("places", "abscissa", "remark", "speeds", "speed", "torque", "role", "statics")


@pytest.mark.parametrize("name", ROWS)
def test_a_source_is_read_or_refused(name, tmp_path):
    motion = known(name)
    source, expected = ROWS[name](motion, tmp_path)
    if isinstance(expected, str):
        with pytest.raises(ParameterError) as refused:
            read(source, motion.pair)
        problem = refused.value.problems[0]
        assert expected.replace("\\", "") in re.sub(r"\s+", " ", str(problem))
        assert problem.action
        return
    result = read(source, motion.pair)
    if "speeds" in expected:
        check_values(result, expected)
    else:
        check_curves(result, expected)
    assert expected.get("remark", "") in " ".join(result.remarks)


def check_values(result, expected):
    np.testing.assert_allclose(result.speeds, expected["speeds"], **TOLERANCE)
    columns = {(one.quantity, one.statistic, one.order): one.values for one in result.columns}
    wanted = {key: values for key, values in expected.items() if isinstance(key, tuple)}
    assert set(columns) == set(wanted)
    for key, values in wanted.items():
        np.testing.assert_allclose(columns[key], values, err_msg=str(key), **TOLERANCE)


def check_curves(result, expected):
    wanted = {name: values for name, values in expected.items() if name not in ATTRIBUTES}
    values = {
        one.quantity + (f"_{one.tooth_pair}" if one.tooth_pair else ""): one.values for one in result.channels
    }
    assert set(values) == set(wanted)
    for name, curve in wanted.items():
        size = np.abs(curve).max()
        np.testing.assert_allclose(values[name], curve, rtol=2e-9, atol=1e-9 * size, err_msg=name)
    assert result.abscissa == expected.get("abscissa", "time")
    if "places" in expected:
        places = expected["places"]
        np.testing.assert_allclose(result.places, places, rtol=2e-9, atol=1e-9 * places[-1])
    if "speed" in expected:
        assert result.pinion_speed == pytest.approx(expected["speed"], rel=1e-12)
    if "torque" in expected:
        assert result.pinion_torque == expected["torque"]
    assert result.role == expected.get("role", "model")
    statics = expected.get("statics", {})
    assert set(result.statics) == set(statics)
    for name, value in statics.items():
        np.testing.assert_allclose(result.statics[name], value, rtol=1e-12)


def test_there_are_many():
    assert len(ROWS) > 50
