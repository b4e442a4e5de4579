"""Is a unit of all lengths, or of all forces, one explanation and not one for each channel?"""

import pytest

from tests.validation.check.motions import lumped_motion
from tests.validation.check.sampled_motions import sampled
from tests.validation.check.test_explanations import climbed
from tests.validation.check.wrong_readings import changed
from validation.check.explanations.reading import families
from validation.check.problem import Problem


def test_a_family_has_its_narrowest_name(pairs):
    """Where the only forces are bearing forces, and the only lengths displacements, these are named."""
    curves = sampled(
        lumped_motion(pairs["unlike"]), ("theta_p", "x_p", "y_g", "bearing_force_x_p", "bearing_force_y_g")
    )
    found = families(curves.channels)
    assert found["all bearing forces"] == ("bearing_force_x_p", "bearing_force_y_g")
    assert found["all displacements of the gears"] == ("x_p", "y_g")
    assert not {"all forces", "all lengths"} & set(found)


@pytest.mark.parametrize(
    ("words", "names", "factor"),
    [
        ("all lengths", ("dte", "x_p", "y_g"), 1e3),
        ("all forces", ("mesh_force", "bearing_force_x_p"), 1e-3),
        ("a length on the tip circle of the pinion", ("dte",), None),
    ],
)
def test_a_unit_of_all_channels_that_have_it(words, names, factor, pairs, shared):
    """Millimetres and kilonewtons are of all lengths and forces; r_a/r_b of the pinion, by hand."""
    pair = pairs["unlike"]
    g = pair.geometry
    if factor is None:
        factor = g.tip_radius_pinion / g.base_radius_pinion
    motion = lumped_motion(pair)
    curves = sampled(motion, ("dte", "theta_p", "x_p", "y_g", "mesh_force", "bearing_force_x_p"))
    problem = Problem.of(pair, changed(curves, names, lambda v: factor * v), motion)
    ladder = climbed(
        problem, shared, "unlike", "radius of a channel" if len(names) == 1 else "unit of a channel"
    )
    assert len(ladder.steps) == 1
    assert words in ladder.steps[0].sentence
