"""Does refining bring every error down?"""

import itertools
import math

import lumped
from tests.evidence.pair_check import Check
from tests.evidence.refinement import Level, Refinement, refinements


def test_refining_brings_every_solution_down_to_its_limit(pair):
    studies = refinements(pair, 256)
    assert all(study.passes for study in studies), studies
    steady = next(s for s in studies if s.key == "steady_state")
    errors = [level.error for level in steady.levels]
    # Each stage adds two orders; at these step angles (0.5 rad) that is worth at least a factor ten.
    assert all(fine < 0.1 * coarse for coarse, fine in itertools.pairwise(errors))


def test_the_peak_is_read_to_three_digits_whatever_the_sampling():
    # Law and stiffness of this pair put the peak at a switch: the largest of 512 samples misses it by 1.5e-3.
    study = next(s for s in refinements(lumped.load_gear_pair("fzg_c"), 64) if s.key == "sampling")
    assert max(level.error for level in study.levels) < study.limit == 5e-4


def test_numbers_that_are_not_finite_never_pass():
    assert not Check("k", "s", "e", math.nan, 1.0, "r").passes
    assert not Refinement("k", "s", "m", (Level("a", math.nan, True),), 1.0, "r").passes
