"""Is the closed form by Airy functions the motion of its equation?

DOP853, Bessel functions of the order 1/3 and the engine with A(t) as formulas know nothing of it.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import jv

from floquet import LinearSegments, monodromy
from lumped.errors import ParameterError


def equation(seed):
    """Four segments of all kinds: k falls, rises, is constant; c and F differ, F is linear."""
    rng = np.random.default_rng(seed)
    start = 1e8 * rng.uniform(1.0, 3.0, 4)
    end = start * np.array([rng.uniform(0.6, 0.9), rng.uniform(1.1, 1.5), 1.0, rng.uniform(0.95, 0.99)])
    return LinearSegments(
        mass=rng.uniform(0.2, 0.7),
        edges=6e-4 * np.array([0.0, *np.sort(rng.uniform(0.1, 0.9, 3)), 1.0]),
        stiffness_start=start,
        stiffness_end=end,
        damping=rng.uniform(300.0, 1500.0, 4),
        force_start=rng.uniform(500.0, 1500.0, 4),
        force_end=rng.uniform(500.0, 1500.0, 4),
    )


def over_segments(one, state, time, forced):
    """States of an integrator at times (k,) and at the end of the period, anew in every segment."""
    inside, states = [], np.array(state, dtype=float)
    for j, (low, high) in enumerate(pairwise(one.edges)):

        def rate(t, x, j=j, low=low, high=high):
            s = (t - low) / (high - low)
            k = one.stiffness_start[j] * (1.0 - s) + one.stiffness_end[j] * s
            force = one.force_start[j] * (1.0 - s) + one.force_end[j] * s
            return [x[1], (forced * force - one.damping[j] * x[1] - k * x[0]) / one.mass]

        times = time[(time >= low) & (time < high)]
        atol = 1e-13 * np.array([1e-6, 1e-2])
        run = solve_ivp(rate, (low, high), states, "DOP853", np.append(times, high), rtol=3e-14, atol=atol)
        inside.append(run.y[:, :-1])
        states = run.y[:, -1]
    return np.hstack(inside), states


@pytest.mark.parametrize("seed", range(3))
def test_the_motion_is_what_an_integrator_says(seed):
    one = equation(seed)
    time = one.period * np.arange(200) / 200
    motion = one.motion(time)
    start = np.array([motion.dte[0], motion.dte_dot[0]])
    states, end = over_segments(one, start, time, 1.0)
    size = np.array([np.ptp(motion.dte), np.ptp(motion.dte_dot)])
    # DOP853 is asked for 3e-14 a step and takes some hundred steps.
    assert np.abs(states[0] - motion.dte).max() < 1e-10 * size[0]
    assert np.abs(states[1] - motion.dte_dot).max() < 1e-10 * size[1]
    assert (np.abs(end - start) < 1e-10 * size).all(), "the motion is periodic"


@pytest.mark.parametrize("seed", range(3))
def test_the_matrix_over_the_period_is_that_of_the_engine(seed):
    one = equation(seed)
    columns = [over_segments(one, unit, np.zeros(0), 0.0)[1] for unit in ([1.0, 0.0], [0.0, 1.0])]
    integrated = np.column_stack(columns)
    proven = monodromy(one.system, 1e-11)
    assert proven.certificate == "proven"
    scale = np.array([[1.0, 1e-4], [1e4, 1.0]])  # a rate is some 1e4 1/s times a length
    for matrix in (one.monodromy_matrix, proven.matrix):
        assert (np.abs(matrix - integrated) < 1e-10 * scale).all()
    decay = np.diff(one.edges) @ one.damping / one.mass  # Liouville
    assert np.linalg.det(one.monodromy_matrix) == pytest.approx(np.exp(-decay), rel=1e-11)
    for value in proven.multipliers:
        assert np.abs(one.multipliers - value).min() < 1e-10


@pytest.mark.parametrize("falls", [False, True])
def test_airy_functions_are_bessel_functions_of_the_order_one_third(falls):
    """With w = a + b t, sqrt(w) J_(+-1/3)(2 w^(3/2)/(3 b)) solve y'' + w y = 0 (Vaishya and Singh)."""
    length, a, b = 5e-4, 4e8, 3e11
    a, b = (a + b * length, -b) if falls else (a, b)
    one = LinearSegments(
        mass=1.0, edges=np.array([0.0, length]), stiffness_start=np.array([a]),
        stiffness_end=np.array([a + b * length]), damping=np.zeros(1), force_start=np.ones(1),
        force_end=np.ones(1),
    )  # fmt: skip

    def solutions(t):
        w = a + b * t
        place = 2.0 * w**1.5 / (3.0 * abs(b))
        values = [np.sqrt(w) * jv(order, place) for order in (1 / 3, -1 / 3)]
        # (z^(1/3) J_(1/3))' = z^(1/3) J_(-2/3) and (z^(1/3) J_(-1/3))' = -z^(1/3) J_(2/3), z ~ w^(3/2)
        rates = [np.sign(b) * w * jv(-2 / 3, place), -np.sign(b) * w * jv(2 / 3, place)]
        return np.array([values, rates])

    expected = solutions(length) @ np.linalg.inv(solutions(0.0))
    scale = np.array([[1.0, 1e-4], [1e4, 1.0]])
    # The argument is some 20: both sides round to some hundred units.
    assert (np.abs(one.monodromy_matrix - expected) < 1e-10 * scale).all()


GOOD = {
    "mass": 1.0, "edges": [0.0, 4e-4, 1e-3], "stiffness_start": [1e8, 2e8], "stiffness_end": [1.2e8, 2e8],
    "damping": [100.0, 0.0], "force_start": [1.0, 1.0], "force_end": [1.0, -1.0],
}  # fmt: skip


@pytest.mark.parametrize(("changes", "words"), [
    ({"damping": [2.5e4, 0.0]}, r"damping = 2\.5e\+04 N s/m: .*2e\+04.*critical damping.*damping_ratio"),
    ({"damping": [-1.0, 0.0]}, "damping"),
    ({"mass": 0.0}, "mass"),
    ({"edges": [0.0, 1e-3, 4e-4]}, "edges"),
    ({"edges": [1e-4, 4e-4, 1e-3]}, "edges = .*0 and later times"),
    ({"stiffness_end": [1.2e8, 0.0]}, "stiffness_end"),
    ({"stiffness_start": [1e8]}, "stiffness_start = 1 numbers: .*2 numbers, one a segment"),
    ({"force_end": [np.nan, 1.0]}, "force_end"),
    ({"force_start": "much"}, "force_start"),
])  # fmt: skip
def test_what_has_no_such_motion_is_refused(changes, words):
    assert LinearSegments(**GOOD).motion(np.array([0.0])).dte.size == 1
    with pytest.raises(ParameterError, match=words):
        LinearSegments(**(GOOD | changes))
