"""Does Gauss collocation converge as theory says, on smooth systems and across the switches of the pair?"""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from lumped import geometry, periodic_system
from lumped.gauss_legendre import gauss_tableau
from lumped.model.periodic_system import MeshGain
from lumped.model.propagation import fastest_frequency, step_maps


class System(SimpleNamespace):
    """A system is one by itself, as an ``LTVSystem`` is."""

    __hash__ = object.__hash__


def system_of(constant, gain, deflection, edges):
    """What ``step_maps`` needs of a system, for equations that are not a gear pair's."""
    size = constant.shape[0]
    column = np.asarray(deflection)

    def with_feedback(stiffness, damping):
        a = np.repeat(constant[None], len(stiffness), axis=0)
        a[:, size // 2 :] += np.concatenate([g[..., None] * column for g in (stiffness, damping)], axis=2)
        return a

    def no_pairs(t):
        none = np.zeros((0, t.size))
        return SimpleNamespace(stiffness=none, damping=none, error=none, error_rate=none, closing=None)

    ends = np.asarray(edges, dtype=float)
    return System(
        size=size, period=float(edges[-1]), cycle=SimpleNamespace(edges=ends, breaks=ends, bends=ends[:0]),
        constant=constant, deflection=column, torque_pinion=np.zeros(size), pinion_torque=0.0,
        gain=lambda t, segment: MeshGain(*gain(t), no_pairs(t)),
        with_feedback=with_feedback, matrices=lambda t: with_feedback(*gain(t)[:2]),
        mesh_forces=lambda t, segment: (np.stack(gain(t), axis=1), no_pairs(t)), directions=np.eye(size // 2),
    )  # fmt: skip


def mathieu(t):
    """z'' + (0.4 + 0.2 sin(2 t)) z' + (9 + 4 cos(2 t)) z = cos(2 t)^2: smooth, stiffness and damping vary."""
    return tuple(v[:, None] for v in (-4.0 * np.cos(2 * t), -0.2 * np.sin(2 * t), np.cos(2 * t) ** 2))


SMOOTH = system_of(np.array([[0.0, 1.0], [-9.0, -0.4]]), mathieu, [1.0], [0.0, np.pi])
EXTRA = np.array([[0.0], [1.0]])


def reference():
    """Map over the period by an explicit method of another family at its tightest tolerance."""

    def rate(t, x):
        z, v = x.reshape(2, 4)
        acceleration = -(9.0 + 4.0 * np.cos(2 * t)) * z - (0.4 + 0.2 * np.sin(2 * t)) * v
        return np.concatenate([v, acceleration + np.array([0.0, 0.0, np.cos(2 * t) ** 2, 1.0])])

    start = np.zeros((2, 4))
    start[:, :2] = np.eye(2)
    run = solve_ivp(rate, (0.0, np.pi), start.ravel(), method="DOP853", rtol=2.3e-14, atol=1e-15)
    return run.y[:, -1].reshape(2, 4)


@pytest.mark.parametrize(
    ("stages", "angles"), [(1, (0.17, 0.085)), (2, (0.34, 0.17)), (3, (0.68, 0.34)), (4, (0.68, 0.34))]
)
def test_order_is_twice_the_stages(stages, angles):
    exact = reference()
    steps = []
    errors = []
    for angle in angles:
        maps = step_maps(SMOOTH, EXTRA, step_angle=angle, stages=stages)
        steps.append(maps.edges.size - 1)
        errors.append(np.abs(np.hstack(maps.over_all) - exact).max())
    assert errors[1] > 1e-12  # above the reference's own error
    order = np.log(errors[0] / errors[1]) / np.log(steps[1] / steps[0])
    # Next terms of the error are a few per cent at these steps.
    assert order == pytest.approx(2 * stages, rel=0.06)


@pytest.mark.parametrize("stages", [1, 2, 3, 4, 6])
def test_tableau_meets_the_simplifying_assumptions(stages):
    """B(2s), C(s) and D(s) of Butcher, which give order 2 s."""
    a, b, c = gauss_tableau(stages)
    for k in range(1, 2 * stages + 1):
        assert b @ c ** (k - 1) == pytest.approx(1 / k, rel=1e-12)
    for k in range(1, stages + 1):
        np.testing.assert_allclose(a @ c ** (k - 1), c**k / k, rtol=1e-11, atol=1e-15)
        np.testing.assert_allclose((b * c ** (k - 1)) @ a, b * (1 - c**k) / k, rtol=1e-9, atol=1e-13)


def test_a_jump_at_an_edge_costs_no_order():
    """z'' + w(t)^2 z with w = 3 then 5: the map is the product of two rotations."""

    def rotation(w, t):
        return np.array([[np.cos(w * t), np.sin(w * t) / w], [-w * np.sin(w * t), np.cos(w * t)]])

    def jump(t):
        return np.where(t < 0.7, -9.0, -25.0)[:, None], np.zeros((t.size, 1)), np.zeros((t.size, 1))

    system = system_of(np.array([[0.0, 1.0], [0.0, 0.0]]), jump, [1.0], [0.0, 0.7, 2.0])
    phi, _ = step_maps(system, np.zeros((2, 0)), step_angle=0.3).over_all
    np.testing.assert_allclose(phi, rotation(5.0, 1.3) @ rotation(3.0, 0.7), atol=1e-12)


class TestSteps:
    def test_switches_outputs_and_short_pieces_end_steps(self, published):
        system = periodic_system(published, "full")
        outputs = np.linspace(0.0, system.period, 37, endpoint=False)
        edges = step_maps(system, np.zeros((12, 0)), outputs=outputs).edges
        distance = np.abs(edges[:, None] - outputs).min(axis=0)
        assert distance.max() < 1e-12 * system.period
        assert set(system.cycle.edges) <= set(edges)  # bit for bit: a step must not straddle a switch
        assert np.all(np.diff(edges) > 0)
        pieces = np.diff(system.cycle.breaks)
        breaks = system.cycle.breaks[1:-1]
        passed = np.abs(edges[:, None] - breaks).min(axis=0) > 1e-12 * system.period
        step = np.diff(edges)[np.searchsorted(edges, breaks) - 1]
        assert passed.any()
        assert np.all(np.minimum(pieces[:-1], pieces[1:])[passed] >= 0.5 * step[passed])

    @pytest.mark.parametrize("offset", [-1e-14, -1e-15, 1e-15, 1e-14])
    def test_outputs_beside_a_switch_do_not_move_it(self, published, offset):
        system = periodic_system(published, "full")
        outputs = system.cycle.switch_times + offset * system.period
        edges = step_maps(system, np.zeros((12, 0)), outputs=outputs).edges
        assert set(system.cycle.edges) <= set(edges)
        # No step as short as a rounding is left between the two.
        assert np.diff(edges).min() > 1e-13 * system.period

    def test_no_step_exceeds_the_angle(self, published):
        system = periodic_system(published.with_(operating__pinion_speed=300), "full")
        edges = step_maps(system, np.zeros((12, 0)), step_angle=0.3).edges
        assert np.diff(edges).max() * fastest_frequency(system) <= 0.3 * (1 + 1e-9)

    @pytest.mark.parametrize("peak", [0.0, 5e9])
    def test_fastest_frequency_bounds_every_frozen_one(self, unequal, peak):
        phase = np.linspace(0.0, geometry(unequal).contact_ratio, 60)
        stiffness = 1e8 + peak * np.exp(-(((phase - 0.6) / 0.05) ** 2))
        table = {"model": "table", "axis": "phase", "points": list(phase), "stiffness": list(stiffness)}
        for pair in (unequal, unequal.with_(mesh__stiffness=table)):
            system = periodic_system(pair, "full")
            times = np.linspace(0.0, system.period, 1000)
            fastest = np.abs(np.linalg.eigvals(system.matrices(times))).max()
            assert fastest <= fastest_frequency(system) <= 1.3 * fastest
