"""Does refining bring every error down?"""

import itertools
import math

import lumped
from tests.evidence.refinement import Level, Refinement, refinements


def test_refining_brings_every_solution_down_to_its_limit(pair):
    studies = {study.key: study for study in refinements(pair, 256)}
    assert all(study.passes for study in studies.values()), studies
    errors = [level.error for level in studies["steady_state"].levels]
    # Each stage adds two orders; at these step angles (0.5 rad) that is worth at least a factor ten.
    assert all(fine < 0.1 * coarse for coarse, fine in itertools.pairwise(errors))
    assert not Refinement("k", "s", "m", 1.0, (Level("a", math.nan, True),)).passes


def test_the_peak_is_read_to_three_digits_whatever_the_sampling():
    # Law and stiffness of this pair put the peak at a switch: the largest of 512 samples misses it by 1.5e-3.
    study = next(s for s in refinements(lumped.load_gear_pair("fzg_c"), 64) if s.key == "sampling")
    assert max(level.error for level in study.levels) < study.limit == 5e-4
