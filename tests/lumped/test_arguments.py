"""What is read as a number, a list or a name, and where ranges end."""

import math

import numpy as np
import pytest

import lumped
from lumped.arguments import one_of, real_array, real_number, real_numbers, some_of, whole_number
from lumped.errors import ParameterError
from lumped.path_of_contact import friction_profile
from tests.unlike_pairs import unlike_pair


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


def test_just_inside_and_just_outside_of_each_end():
    """The next floats beside 1 and 2, which both belong to the range; with ``above`` 1 does not."""
    below, over, short, beyond = (math.nextafter(end, to) for end in (1.0, 2.0) for to in (0.0, 3.0))
    for reads in (real_number, real_numbers):
        for taken in (1.0, over, short, 2.0):
            assert reads("a", taken, 1.0, 2.0) == taken
        for refused in (below, beyond):
            with pytest.raises(ParameterError, match="1 to 2"):
                reads("a", refused, 1.0, 2.0)
        for taken in (over, 2.0):
            assert reads("a", taken, 1.0, 2.0, above=True) == taken
        for refused in (1.0, beyond):
            with pytest.raises(ParameterError, match="> 1 and <= 2"):
                reads("a", refused, 1.0, 2.0, above=True)
    assert [whole_number("a", n, 1, 3) for n in (1, 3)] == [1, 3]
    for refused in (0, 4):
        with pytest.raises(ParameterError, match="1 to 3"):
            whole_number("a", refused, 1, 3)
    assert real_numbers("a", [1.0, over], increasing=True).tolist() == [1.0, over]


#: Argument of a public function -> a call with it, values just outside its ends, values just inside. Ends at
#: which an answer takes long are tried from outside alone.
CALLS = {
    "samples": (lambda pair, n: lumped.mesh_stiffness(pair, n), (0, 1_000_001), (1,)),
    "points": (lambda pair, n: lumped.stiffness_components(pair, n), (1, 100_001), (2,)),
    "points of friction": (lambda pair, n: friction_profile(pair, n), (1, 1_000_001), (2,)),
    "phases": (lambda pair, n: lumped.static_transmission_error(pair, phases=n), (1, 65537), (2,)),
    "phases of finite elements": (lambda pair, n: lumped.plane_compliance(pair, phases=n), (0, 100_001), ()),
    "torques": (lambda pair, x: lumped.static_transmission_error(pair, x, phases=2), (-1e-300,), (1e-9,)),
    "torque": (lambda pair, x: lumped.optimal_relief(pair, torque=x), (0.0, -1e-300), ()),
    "samples_per_cycle": (lambda pair, n: lumped.steady_state(pair, samples_per_cycle=n), (7, 65537), (8,)),
    "speeds_rpm": (
        lambda pair, x: lumped.speed_sweep(pair, [x], samples_per_cycle=8), (0.0, -1e-300), (1e3,)
    ),
    "speeds_rpm of a run-up": (lambda pair, x: lumped.run_up(pair, (1e3, x), 1.0), (0.0, 200000.00001), ()),
    "seconds": (lambda pair, x: lumped.run_up(pair, (1e3, 2e3), x), (0.0, -1e-300), ()),
}  # fmt: skip


@pytest.mark.parametrize("name", CALLS)
def test_ends_of_arguments_of_public_functions(name):
    call, refused, taken = CALLS[name]
    pair = unlike_pair("rack_25_degrees_always_pushing")
    for value in refused:
        with pytest.raises(ParameterError) as caught:
            call(pair, value)
        assert [problem.field for problem in caught.value.problems] == [name.partition(" ")[0]], value
    for value in taken:
        call(pair, value)
