"""Do the Gauss steps without the mesh solve the equations of collocation as these are written?"""

import warnings

import numpy as np
import pytest

from lumped.gauss_legendre import gauss_tableau
from lumped.model.periodic_system import LTVSystem, supports_of
from lumped.model.propagation import fastest_frequency, padded, without_mesh

#: Rounding of the dense equations of one step, 4 stages of up to 40 states, over the largest value.
TOLERANCE = 1e-12


def collocation_step(system, gauss, h, state, force, impulses):
    """Rates at the stages (s, 2m) and state at the end of one step of x' = A x + b + n, as the method states.

    ``force`` (m,) is constant, ``impulses`` (s, m) are those of the mesh at each stage. The unit of time is
    h, because places and speeds then have one size and the equations lose no digits.
    """
    a, b, _ = gauss
    stages = b.size
    m = system.size // 2
    unit = np.repeat([1.0, h], m)
    matrix = h * unit[:, None] * system.constant / unit
    right = np.zeros((stages, 2 * m))
    right[:, m:] = h**2 * (force + impulses)
    right += matrix @ (unit * state)
    equations = np.eye(stages * 2 * m) - np.kron(a, matrix)
    rates = np.linalg.solve(equations, right.ravel()).reshape(stages, 2 * m)
    return rates / unit / h, (unit * state + b @ rates) / unit


@pytest.mark.parametrize("stages", [3, 4])
@pytest.mark.parametrize("form", ["full", "mesh"])
def test_a_step_is_that_of_collocation_in_all_coordinates(unlike, form, stages):
    """A random state, random forcings and a random force of the mesh at every stage, all of the same size."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pair = unlike.healthy
        system = LTVSystem.of(pair, form, supports=supports_of(pair, None))
    m = system.size // 2
    gauss = gauss_tableau(stages)
    rng = np.random.default_rng(1)
    directions = system.directions * np.array([1.0, 2.0, -3.0, 0.5])[:, None]
    torques = padded(system, np.stack([system.torque_pinion, system.torque_gear], axis=1))
    lengths = np.array([1e-3, 0.2, 0.5]) / fastest_frequency(system)
    free = without_mesh(system, lengths, torques, gauss, directions, with_rates=True)
    forcings = np.column_stack([system.torque_pinion * system.pinion_torque, torques])[m:]
    for number, h in enumerate(lengths):
        unit = 1.0 / np.abs(forcings).max() / h**2
        state = np.concatenate([rng.normal(size=m), rng.normal(size=m) / h])
        weights = rng.normal(size=forcings.shape[1]) * unit
        forces = rng.normal(size=(stages, len(directions))) / np.abs(directions).max() / h**2
        rates, end = collocation_step(system, gauss, h, state, forcings @ weights, forces @ directions)
        rows = np.append(state, weights) @ free.along[number]
        rows += np.einsum("sf,sfr->r", forces, free.by_force[number])
        p, places, speeds, between = np.split(rows, np.cumsum([stages, m, m]))
        size = max(np.abs(end[:m]).max(), h * np.abs(end[m:]).max(), h**2 * np.abs(rates[:, m:]).max())
        assert np.abs(places - end[:m]).max() < TOLERANCE * size
        assert h * np.abs(speeds - end[m:]).max() < TOLERANCE * size
        of_p = np.abs(system.deflection).sum() * size
        assert h**2 * np.abs(p - rates[:, m:] @ system.deflection).max() < TOLERANCE * of_p
        at_stages = state[m:] + h * gauss.a @ rates[:, m:]
        assert h * np.abs(between.reshape(stages, m) - at_stages).max() < TOLERANCE * size
        np.testing.assert_array_equal(free.reach[number], h * gauss.c)
        np.testing.assert_array_equal(
            free.by_p[number], np.vstack([h * h * (gauss.a @ gauss.a), h * gauss.a])
        )


@pytest.mark.parametrize("stages", [3, 4])
def test_nothing_but_forces_acts_on_the_rotations_not_even_rounding(unlike, stages):
    """Gears on springs are free to turn: W is the force at the stage itself, to the last digit.

    The map over the cycle has a double multiplier +1 for this reason, which rounding of W would split.
    """
    system = LTVSystem.of(unlike.healthy, "full", supports="springs")
    m = system.size // 2
    lengths = np.array([0.3, 0.7]) / fastest_frequency(system)
    gauss = gauss_tableau(stages)
    no_torques = padded(system, np.zeros((2 * m, 0)))
    free = without_mesh(system, lengths, no_torques, gauss, system.directions)
    to_place = gauss.b @ gauss.a
    for number, h in enumerate(lengths):
        for rotation in (0, 1):
            force = system.directions[:, rotation]
            for stage in range(stages):
                of_force = free.by_force[number, stage]
                places = of_force[:, stages + rotation]
                speeds = of_force[:, stages + m + rotation]
                np.testing.assert_array_equal(places, h * h * to_place[stage] * force)
                np.testing.assert_array_equal(speeds, h * gauss.b[stage] * force)
