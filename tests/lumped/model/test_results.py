"""Are variables of a motion that nobody reads not computed, and are those that are read all the same?"""

import numpy as np
import pytest

from lumped.model.results import VARIABLES, MotionValues
from lumped.model.steady_state import periodic_motion
from tests.unlike_pairs import unlike_pair


def test_other_variables_are_computed_once_and_when_one_is_read():
    calls = []

    def others():
        calls.append(1)
        return {"mu": np.array([2.0]), "dte": np.array([9.0])}

    values = MotionValues({"dte": np.array([1.0])}, others)
    assert values["dte"] == 1.0
    assert not calls
    assert values["mu"] == 2.0
    assert sorted(values) == ["dte", "mu"]
    assert len(values) == 2
    assert dict(values)["dte"] == 1.0  # what is known replaces what is computed
    assert len(calls) == 1
    with pytest.raises(KeyError):
        values["force"]


def test_a_motion_has_every_variable_and_its_dataset_has_the_same():
    motion = periodic_motion(
        unlike_pair("rack_25_degrees_always_pushing"), "unilateral", samples_per_cycle=64
    )
    assert set(motion.values) == set(VARIABLES)
    for name in VARIABLES:
        np.testing.assert_array_equal(motion.values[name], motion.dataset[name].to_numpy())
