"""May runs of like teeth share the tooth pairs of a mesh cycle, and do unlike teeth not share them?"""

import numpy as np
import pytest

from lumped.mesh.motion import CycleSpan
from lumped.model.momentary_load import MomentaryRuns, momentary_tables
from lumped.model.periodic_system import LTVSystem
from lumped.model.solution import static_deflection
from lumped.model.tooth_laws import ToothLaws
from tests.unlike_pairs import unlike_pair

STEP = 1.0 / 64


def runs_of(pair):
    system = LTVSystem.of(pair.healthy, "full", supports="springs")
    return MomentaryRuns(pair, system, momentary_tables(ToothLaws(pair), system, STEP, 16))


def run(runs, share=1.0, first=0, cycles=3):
    """A run from a share of the static deflection, without a brake."""
    torques = runs.pair.operating.pinion_torque * runs.system.torque_pinion
    return runs.run(first, cycles, cycles, share * static_deflection(runs.system), torques)


@pytest.mark.parametrize("name", ["larger_gear_drives_contact_lost", "rack_25_degrees_always_pushing"])
def test_a_run_does_not_depend_on_the_run_before(name):
    pair = unlike_pair(name)
    fresh = run(runs_of(pair))
    used = runs_of(pair)
    run(used, share=0.2, first=5)
    again = run(used)
    np.testing.assert_array_equal(again.states, fresh.states)
    np.testing.assert_array_equal(again.loads, fresh.loads)
    assert again.work == fresh.work


@pytest.mark.parametrize(
    "change",
    [
        {"pinion.deviations": {"tolerance_class": 7}},
        {"operating.torque_ripple": [{"shaft": "pinion", "order": 1, "amplitude": "4 N m"}]},
    ],
)
def test_cycles_differ_with_teeth_that_differ_and_with_a_ripple(change):
    """With the pairs of the first cycle in all cycles the run ends elsewhere."""
    pair = unlike_pair("rack_25_degrees_always_pushing").with_(change)
    runs = runs_of(pair)
    assert not runs.tables.alike
    assert runs_of(pair.healthy).tables.alike
    shared = MomentaryRuns(pair, runs.system, runs.tables._replace(alike=True))
    assert not np.array_equal(run(runs).end, run(shared).end)


@pytest.mark.parametrize("change", [{}, {"pinion.deviations": {"tolerance_class": 7}}])
def test_runs_together_are_the_same_bits_as_runs_one_by_one(unlike, change):
    """Starts and torques differ, and in one run contact is lost at once."""
    pair = unlike.healthy.with_(change)
    runs = runs_of(pair)
    at_rest = static_deflection(runs.system)
    torque = pair.operating.pinion_torque * runs.system.torque_pinion
    states = np.array([at_rest, 0.9 * at_rest, -at_rest])
    torques = np.array([torque, 1.1 * torque, torque])
    span = CycleSpan(2, 3, 2)
    together = runs.together(span, states, torques)
    for number, (state, own_torque) in enumerate(zip(states, torques, strict=True)):
        alone = runs_of(pair).run(*span, state, own_torque)
        np.testing.assert_array_equal(together.states[number], alone.states)
        np.testing.assert_array_equal(together.loads[number], alone.loads)
        np.testing.assert_array_equal(together.end[number], alone.end)
        assert together.work[number] == alone.work[0]
    assert not np.array_equal(together.end[0], together.end[1])
