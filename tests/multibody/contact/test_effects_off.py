"""Is the exact model without its effects the lumped equations, to rounding?"""

import itertools

import numpy as np
import pytest

import lumped
from lumped.friction.registry import law_named
from lumped.model.steady import periodic_solution
from lumped.path_of_contact.friction import contact_path
from multibody.contact import kernels as kn
from multibody.run.model import accelerations, from_lumped_state
from multibody.run.setup import prepare


def lumped_forces(setup, motion, pair):
    """Forces of the lumped equations at the states of a motion, on the coordinates of ``from_lumped_state``.

    The friction coefficient is the law's own; the lumped model solves with a polynomial within 1e-10 of it.
    """
    s, mesh, states = setup.system.structure, setup.system.cycle.sample(motion.time), motion.states
    q, v, touch = states[:, :6], states[:, 6:], mesh.contact
    load = mesh.stiffness * (q @ s.deflection - mesh.error)
    load += mesh.damping * (v @ s.deflection - mesh.error_rate)
    friction, law = np.zeros(load.shape), law_named(pair.friction.law)
    friction[touch] = load[touch] * law.signed(mesh.position[touch], contact_path(pair), pair.friction)
    force = np.outer(load.sum(0), s.normal) + (friction[..., None] * s.friction(mesh.position)).sum(0)
    force -= s.stiffness * q + s.damping * v
    force[:, :2] += setup.machine.torque_pinion, -setup.machine.torque_gear
    return from_lumped_state(np.hstack([force, force]))[0]


@pytest.mark.parametrize("contact", ["prescribed", "loaded"])
@pytest.mark.parametrize("stiffness", ["energy", "rectangular"])
def test_with_all_effects_off_it_is_the_lumped_equations(stiffness, contact):
    """To rounding: of the static load 4e-14 at 500 to 4875 rpm, 2e-13 at 18000 rpm."""
    for preset, rpm in zip(lumped.preset_names(), itertools.cycle((500, 18000, 4875)), strict=False):
        pair = lumped.load_gear_pair(preset).with_(
            mesh__stiffness={"model": stiffness}, mesh__contact=contact, operating__pinion_speed=rpm
        )
        setup = prepare(pair, effects=())
        times = np.array([0.3, 0.55, 0.8]) * setup.system.period
        motion = periodic_solution(setup.system, times, estimate_error=False)
        q, v = from_lumped_state(motion.states)
        forces = accelerations(setup.model, motion.time, q, v) * setup.machine.bodies[0]
        radii = setup.machine.parameters[[kn.RADIUS_P, kn.RADIUS_G]]
        units = np.array([1.0, 1.0, 1.0 / radii[0], 1.0, 1.0, 1.0 / radii[1]])
        off = (forces - lumped_forces(setup, motion, pair)) * units
        static = setup.machine.torque_pinion / setup.machine.parameters[kn.RADIUS_P]
        assert np.abs(off).max() < 1e-12 * static, preset
