"""Does the model foresee where its contact force jumps, and is a run as accurate there as elsewhere?"""

import numpy as np
import pytest

from lumped import PathFunction
from multibody.contact import kinematics as kn
from multibody.contact.events import (
    FIRST_TOUCH,
    LAST_TOUCH,
    LET_GO,
    SWITCH,
    _change,
    event_table,
    time_to_event,
)
from multibody.contact.kernels import tooth_forces
from multibody.contact.machine import machine
from multibody.contact.records import CONTACTS_SIZE, PHI_G, PHI_P, opened_contacts
from multibody.run.effects import effect_flags
from tests.unlike_pairs import unlike_pair


def jumps(name):
    """A pair with jumps of stiffness and of friction. All pairs have one speed and vibrations of one size."""
    changes = {"mesh.relief": "ignored", "friction.law": "coulomb", "friction.coefficient": 0.05}
    changes |= {"operating.pinion_speed": 6000.0}
    return unlike_pair(name).with_(changes)


def test_a_law_changes_at_a_break_by_the_jumps_of_value_slope_and_curvature():
    """x^2 on [0, 1], then 3 + x^2 + 2 (x - 1) on [1, 3], and on [3, 6] the same: nothing at 3."""
    powers = np.array([[1.0, 1.0, 1.0], [0.0, 4.0, 8.0], [0.0, 4.0, 16.0]])  # of the way since each break
    law = PathFunction(np.array([0.0, 1.0, 3.0, 6.0]), powers, np.array([1.0]))
    step = 0.1
    largest = 16.0
    assert _change(law, 1, step) == pytest.approx((3.0 + 2.0 * step) / largest, rel=1e-12)
    assert _change(law, 2, step) == pytest.approx(0.0, abs=1e-15)


def contacts(numbers, flags, t, q, v):
    """What jumps with the force: the number of pairs and the sign of each friction coefficient."""
    state = np.array([q, v, np.zeros(6)])
    records = np.zeros(CONTACTS_SIZE)
    count = tooth_forces(t, state, numbers.packed, flags, records)
    return count, tuple(np.sign(opened_contacts(records)["friction_coefficient"][:count]))


@pytest.mark.parametrize(("name", "effects"), [
    ("contact_ratio_1_1_large_shifts", None),
    ("contact_ratio_2_3_on_shafts", None),
    ("larger_gear_drives_contact_lost", {"entry_shift": False}),
    ("rack_25_degrees_always_pushing", {"sliding_velocity": False}),
    ("heavily_relieved_under_load", {"rotation_phase": False}),
], ids=str)  # fmt: skip
def test_the_force_jumps_where_it_was_foreseen_and_not_before(name, effects, rng):
    """Along the Taylor continuation of random vibrations, evaluated by the force core itself."""
    numbers = machine(jumps(name))
    flags = effect_flags(effects) & ~kn.BACK_SIDE
    period = numbers.period
    seen = set()
    for t in rng.uniform(0.0, 3.0, size=120) * period:
        q = rng.normal(size=6) * 1e-5
        v = rng.normal(size=6) * 0.02
        a = rng.normal(size=6) * 200.0
        q[[PHI_P, PHI_G]] = -2e-5 / numbers.base_radii  # pressed by some 40 um
        v[[PHI_P, PHI_G]] = v[[PHI_P, PHI_G]] * 10
        a[[2, 5]] = a[[2, 5]] * 10
        wait, _ = time_to_event(t, q, v, a, numbers.packed, flags, numbers.events, 0.05 * period)
        assert 0.0 <= wait < period
        if wait > 0.04 * period:
            continue  # foreseen roughly; the integrator asks again when it is nearer

        def force_at(tau, t=t, q=q, v=v, a=a):
            return contacts(numbers, flags, t + tau, q + tau * (v + 0.5 * tau * a), v + tau * a)

        hair = 1e-11 * period
        before, after = force_at(wait - hair), force_at(wait + hair)
        assert before != after
        seen.add(after[0] - before[0])
        assert all(force_at(tau) == before for tau in np.linspace(0.0, wait - hair, 20))
    assert seen == {-1, 0, 1}  # a pair left, sliding turned, a pair entered


@pytest.mark.parametrize(
    ("name", "pairs"), [("rack_25_degrees_always_pushing", 1), ("contact_ratio_2_3_on_shafts", 2)]
)
def test_corners_touch_and_let_go_where_it_was_foreseen(name, pairs):
    """Also where neighbours share the body; the damper lets go with the corner still pressed.

    There the force only bends. Places are corrected twice by what neighbours move: 5e-6 of a cycle is left.
    """
    loaded = jumps(name)
    flags = effect_flags(None, "loaded")
    numbers = machine(loaded, flags)
    p = numbers.record
    period = numbers.period
    # The gears roll on each other, a little slower than nominal: their approach stays. It is so large that
    # the corner goes fast enough for its damper to let go.
    q = np.zeros(6)
    v = np.array([0.0, 0.0, -1.0, 0.0, 0.0, p.geometry.radius_p / p.geometry.radius_g])
    q[PHI_P] = -3e-5 / p.geometry.radius_p

    def around(kind):
        events = numbers.events[numbers.events["kind"] == kind]
        wait, _ = time_to_event(0.0, q, v, np.zeros(6), numbers.packed, flags, events, np.inf)
        for tau in (wait - 1e-5 * period, wait + 1e-5 * period):
            records = np.zeros(CONTACTS_SIZE)
            state = np.array([q + tau * v, v, np.zeros(6)])
            count = tooth_forces(tau, state, numbers.packed, flags, records)
            touching = opened_contacts(records)[:count]
            yield count, touching["load"].min(), touching["elastic_load"].min()

    assert [count for count, *_ in around(FIRST_TOUCH)] == [pairs, pairs + 1]
    assert [count for count, *_ in around(LAST_TOUCH)] == [pairs + 1, pairs]
    (_, before, _), (_, after, elastic) = around(LET_GO)
    assert before > 0.0 == after
    assert elastic > 1.0


def test_of_many_switches_only_the_largest_are_events():
    breaks = np.linspace(7.5e-3, 22.9e-3, 101)
    heights = 1.0 + np.arange(100.0) ** 2  # jumps grow along the path
    steps = PathFunction(breaks, heights[None], breaks[1:-1])
    rows = event_table(steps, (), (), 9.4e-3)
    switches = rows["place"][rows["kind"] == SWITCH]
    np.testing.assert_allclose(np.sort(switches), breaks[-13:-1], rtol=1e-15)
