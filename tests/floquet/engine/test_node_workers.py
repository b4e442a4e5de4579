"""Is a chart by several processes that of one process, to the last bit, with its warnings and errors?"""

import warnings

import numpy as np
import pytest

from floquet import FourierSeries, PeriodicMatrix, PeriodicSystem, PeriodicSystems, from_second_order, scan
from floquet.engine import node_workers, nodes
from lumped.errors import NumericalError, ParameterError, ResolutionWarning

SHAPE = np.array([[1.0, 0.5, -0.3], [0.5, -0.8, 0.6], [-0.3, 0.6, 0.4]])


def three_oscillators(point):
    """Damped, with combination resonances; proven bounds."""
    period = 2.0 * np.pi / point["frequency"]
    wave = FourierSeries(period, 0.0, [point["depth"]])
    stiffness = PeriodicMatrix(np.diag([1.0, 2.9, 9.6]), (wave, SHAPE))
    return from_second_order(np.eye(3), 0.01 * np.eye(3), stiffness, period)


def hills(points):
    """Undamped, many at once; estimates."""

    def A(phases):
        out = np.zeros((points["a"].size, phases.size, 2, 2))
        out[..., 0, 1] = 1.0
        out[..., 1, 0] = -points["a"][:, None] - points["q"][:, None] * np.cos(2.0 * np.pi * phases) ** 3
        return out

    return PeriodicSystems(A, 2.0)


def sizes(point):
    """Another number of states from x = 5 on."""
    return from_second_order(np.eye(1 + (point["x"] >= 5.0)), 0.0 * np.eye(1 + (point["x"] >= 5.0)),
                             np.eye(1 + (point["x"] >= 5.0)), 1.0)  # fmt: skip


def growing(point):
    """Beyond floating point at x = 7."""
    return PeriodicSystem(PeriodicMatrix(900.0 if point["x"] == 7.0 else -1.0), 1.0)


def spiked(point):
    """A callable with a narrow spike, which the samples of a step miss."""
    return PeriodicSystem(lambda t: [[-1.0 - 1e4 * np.exp(-(((t - 0.31) / 1e-3) ** 2))]], 1.0)


FAST = {"frequency": np.linspace(0.8, 5.0, 33), "depth": np.linspace(0.05, 0.6, 17)}
HILL = {"a": np.linspace(0.3, 9.0, 65), "q": np.linspace(0.1, 3.0, 33)}


@pytest.mark.parametrize(
    ("family", "axes", "batched"), [(three_oscillators, FAST, False), (hills, HILL, True)]
)
@pytest.mark.parametrize("refine", [False, True])
def test_two_processes_give_the_bits_of_one(family, axes, batched, refine):
    charts = [scan(family, axes, batched=batched, refine=refine, workers=workers) for workers in (1, 2)]
    assert set(charts[0].variables) == set(charts[1].variables)
    for name in charts[0].variables:
        assert charts[0][name].to_numpy().tobytes() == charts[1][name].to_numpy().tobytes(), name
    assert {-1} < set(charts[0]["verdict"].to_numpy().ravel().tolist())


def test_groups_do_not_depend_on_the_workers():
    places = np.arange(1000)
    one = node_workers.GridNodes(hills, {}, True, 1e-8).groups(places)
    assert [group.size for group in one] == [nodes.TOGETHER_IN_ONE_CALL, 1000 - nodes.TOGETHER_IN_ONE_CALL]
    np.testing.assert_array_equal(np.concatenate(one), places)


def test_errors_and_warnings_of_workers_are_those_of_one_process(monkeypatch):
    for workers in (1, 2):
        with pytest.raises(NumericalError, match="at x = 7: the state grows beyond"):
            scan(growing, {"x": np.arange(9.0)}, workers=workers)
        with pytest.raises(ParameterError, match="4 multipliers at x = 5"):
            scan(sizes, {"x": np.arange(9.0)}, workers=workers)
        with pytest.warns(ResolutionWarning, match="a feature near"):
            scan(spiked, {"x": [1.0, 2.0]}, rtol=1e-6, workers=workers)


def test_a_function_that_no_other_process_imports_is_refused():
    with pytest.raises(ParameterError, match="head of a module") as refused:
        scan(lambda point: three_oscillators(point), FAST, workers=2)
    assert refused.value.problems[0].field == "evaluate"
    for workers in (0, 1.5, 2000):
        with pytest.raises(ParameterError, match="workers"):
            scan(three_oscillators, FAST, workers=workers)


def test_a_chart_without_multipliers_has_the_same_radius():
    full, small = (scan(three_oscillators, FAST, store=store) for store in ("all", "radius"))
    assert "multipliers" not in small
    np.testing.assert_array_equal(small["spectral_radius"], full["spectral_radius"])
    with pytest.raises(ParameterError, match="store"):
        scan(three_oscillators, FAST, store="multipliers")


def test_the_chart_stays_silent_without_warnings():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scan(three_oscillators, {"frequency": [1.0, 2.0], "depth": [0.1, 0.2]}, workers=2)
