"""Is a chart on an executor the chart of this process, to the last bit?"""

import pickle
from concurrent.futures import Executor, Future

import numpy as np
import pytest
import xarray as xr

from floquet import stability_chart
from floquet.gear import chart as module
from lumped.errors import ParameterError
from tests.unlike_pairs import unlike_pair

SPEEDS = np.linspace(3000.0, 15000.0, 41)
DAMPING = np.linspace(0.0, 0.03, 21)
LIGHT = {"mesh.damping_ratio": 0.004}


class Copies(Executor):
    """An executor whose calls get copies of their arguments and return copies, as on another machine."""

    def __init__(self):
        self.calls = []

    def submit(self, function, /, *arguments):
        self.calls.append(function.__name__)
        future = Future()
        try:
            function, arguments = pickle.loads(pickle.dumps((function, arguments)))
            future.set_result(pickle.loads(pickle.dumps(function(*arguments))))
        except Exception as error:  # noqa: BLE001  (an executor passes every error on)
            future.set_exception(error)
        return future


#: What becomes a call: a plane at each torque, a slice at each node of a plane, pieces of the full grid.
CASES = {
    "a plane at each torque": (
        {"speed_rpm": SPEEDS, "torque": np.array([40.0, 70.0, 95.0]), "damping_ratio": DAMPING},
        {}, "solved", 3,
    ),
    "planes at each friction together": (
        {"speed_rpm": SPEEDS, "damping_ratio": DAMPING, "friction_coefficient": np.array([0.02, 0.09])},
        {}, "solve_slice", None,
    ),
    "a slow axis in the plane": (
        {"speed_rpm": SPEEDS, "bearing_stiffness": np.geomspace(5e7, 5e8, 7)}, {}, "solve_slice", None,
    ),
    "every node with its multipliers": (
        {"torque": np.array([40.0, 95.0]), "speed_rpm": SPEEDS[::4], "damping_ratio": DAMPING[::2]},
        {"refine": False, "store": "all"}, "solve_slice", 4,
    ),
    "cells that are proven": (
        {"speed_rpm": SPEEDS[::5], "damping_ratio": DAMPING[::5]}, {"prove": True}, "solve_slice", 1,
    ),
}  # fmt: skip


#: What is sent does not depend on the pair: one case has a second pair.
PAIR_OF = dict.fromkeys(CASES, "contact_ratio_1_1_large_shifts")
PAIR_OF["every node with its multipliers"] = "rack_25_degrees_always_pushing"


@pytest.mark.parametrize("case", CASES)
def test_a_chart_on_an_executor_is_that_of_this_process(case, monkeypatch):
    monkeypatch.setattr(module, "SMALL", 250)
    monkeypatch.setattr(module, "_CHUNK", 100)
    pair = unlike_pair(PAIR_OF[case]).with_(LIGHT)
    axes, options, function, count = CASES[case]
    alone = stability_chart(pair, axes, **options)
    executor = Copies()
    fractions = []
    chart = stability_chart(
        pair, axes, **options, executor=executor, progress=lambda fraction, *_: fractions.append(fraction)
    )
    xr.testing.assert_identical(chart, alone)
    assert set(executor.calls) == {function}
    assert len(executor.calls) == count if count else len(executor.calls) > 1
    assert fractions[-1] == 1.0
    if case == "a plane at each torque":
        assert not alone.known.all()  # refined: otherwise each node would be evaluated


def test_what_is_no_executor_is_refused():
    with pytest.raises(ParameterError, match=r"an executor of concurrent\.futures"):
        stability_chart("nasa_28_28", {"torque": [20.0, 30.0]}, executor="tcp://head:8786")
