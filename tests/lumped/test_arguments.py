"""What is read as a number, a list or a name, and where ranges end."""

import math

import numpy as np
import pytest

from lumped.arguments import one_of, real_array, real_number, real_numbers, some_of, whole_number
from lumped.errors import ParameterError


def test_numbers_of_every_kind_are_read():
    for number in (2, 2.0, np.float32(2.0), np.int8(2), np.array(2.0)):
        assert real_number("a", number, 1, 3) == 2.0
        assert real_numbers("a", number).tolist() == [2.0]
    for numbers in ([1, 2], (1.0, 2.0), range(1, 3), iter([1, 2]), {1: 0, 2: 0}.keys(), np.array([1, 2])):
        assert real_numbers("a", numbers, 1, 2, increasing=True).tolist() == [1.0, 2.0]
    assert real_array("a", [[1, 2], [3, 4]]).shape == (2, 2)
    assert whole_number("a", np.int64(3), 0, 3) == 3
    assert one_of("a", "b", ("b", "c")) == "b"
    assert some_of("a", {"b": 0}, ("b", "c")) == ("b",)
    assert some_of("a", np.array([1, 2]), (1, 2, 7)) == (1, 2)


def test_ends_of_ranges():
    assert real_number("a", 1.0, 1.0, 2.0) == 1.0
    for refused in (0.5, 2.5, True, np.bool_(True), "1.5", [1.5], math.nan):
        with pytest.raises(ParameterError, match="1 to 2"):
            real_number("a", refused, 1.0, 2.0)
    with pytest.raises(ParameterError, match="> 0 m"):
        real_number("a", 0.0, 0.0, above=True, unit="m")
    for refused in ([], [2.0, 1.0], [1.0, 1.0], [[1.0, 2.0]], ["1"], range(10**15)):
        with pytest.raises(ParameterError, match="increasing numbers"):
            real_numbers("a", refused, increasing=True)
