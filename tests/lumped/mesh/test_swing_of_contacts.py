"""Laws of a pair whose contact swings, because a gear is eccentric, into a step of the tables that is short.

Law II grows like the logarithm of the distance from the pitch point. Its tables have steps of a millionth of
a mesh cycle there, with slopes of 1/x. A step that swung with its middle into one of them took that slope
over its whole length: friction coefficients of 220, and peaks of the transmission error of 950 um in place of
53, in one mesh cycle of hundreds.
"""

import numpy as np
import pytest

from lumped.model.cycle_maps import CycleSteps, linear_motion, linear_steps
from lumped.model.periodic_system import LTVSystem
from lumped.model.results import peak_to_peak
from lumped.model.revolution_motion import plain_motion
from tests.unlike_pairs import unlike_pair
from validation.exchange.new_pair_file import new_pair

#: Outputs in a mesh cycle: steps are as long as their distance where a step needs no shorter ones.
OUTPUTS = (64, 128)
#: Law II is cut off at ``friction.maximum``, 0.2 of these pairs; the tables go to a swung contact with the
#: slope of the nearest place, which may be a little beyond.
LARGEST = 0.25


def class_six(pair, seeds):
    """The pair with pitch errors and run-out of tolerance class 6 on both gears."""
    changes = {}
    for gear, seed in zip(("pinion", "gear"), seeds, strict=True):
        changes |= {f"{gear}.deviations.tolerance_class": 6, f"{gear}.deviations.seed": seed}
    return pair.with_(changes)


PAIRS = {
    "19/41": class_six(
        new_pair(
            (19, 41), 3, 25, 1450, 80,
            {"friction.law": "benedict_kelley", "mesh.stiffness.model": "energy"},
        ),
        (3, 5),
    ),
    "larger gear drives": class_six(
        unlike_pair("larger_gear_drives_contact_lost").with_({"friction.law": "benedict_kelley"}), (1, 2)
    ),
}  # fmt: skip


@pytest.mark.parametrize("outputs", OUTPUTS)
@pytest.mark.parametrize("name", PAIRS)
def test_the_friction_coefficient_of_all_steps_is_one_of_the_law(name, outputs):
    """Over the whole period: friction over the normal load, per approach, is a mean of mu over the pairs."""
    pair = PAIRS[name]
    system = LTVSystem.of(pair.healthy, "full", supports="springs")
    forces = CycleSteps(pair, system, outputs, linear_steps(system)).form.forces[..., 0]
    loaded = forces["normal"] > 0.1 * forces["normal"].max()
    ratio = np.abs(forces["friction_force"][loaded]) / forces["normal"][loaded]
    assert loaded.mean() > 0.9
    assert ratio.max() < LARGEST


def test_the_linear_motion_does_not_depend_on_the_outputs():
    """Outputs are where one looks; law II gave 53, 951 and 93 um at 64, 128 and 256 of them."""
    pair = PAIRS["19/41"]
    swings = []
    for outputs in OUTPUTS:
        motion = plain_motion(linear_motion(pair, outputs), dict)
        swings.append(peak_to_peak(motion.time, motion.values["dte"], motion.values["dte_dot"]))
    assert swings[1] == pytest.approx(swings[0], rel=2e-3)
