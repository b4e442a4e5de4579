"""Do the checks of the code pass with a reason for each limit, and does refining bring every error down?"""

import itertools
import math

import lumped
from validation.verification import (
    Check,
    OrderCheck,
    Refinement,
    code_checks,
    enough_samples,
    order_checks,
    refinements,
)
from validation.verification.checks import Level


def test_all_checks_pass_and_say_why_their_limit_is_what_it_is(pair):
    for check in code_checks(pair):
        assert check.passes, check
        assert check.exact
        assert check.reason


def test_methods_show_their_orders():
    rows = order_checks()
    assert {row.method: row.theory for row in rows}["gauss6"] == 6
    assert all(row.passes for row in rows), rows


def test_refining_brings_every_solution_down_to_its_limit(pair):
    studies = refinements(pair, 256)
    assert all(study.passes for study in studies), studies
    steady = next(s for s in studies if s.key == "steady_state")
    errors = [level.error for level in steady.levels]
    # Each stage adds two orders; at these step angles (0.5 rad) that is worth at least a factor ten.
    assert all(fine < 0.1 * coarse for coarse, fine in itertools.pairwise(errors))


def test_samples_are_raised_until_the_peak_is_read_to_three_digits():
    # Law and stiffness of this pair put the peak at a switch: 512 samples miss it by 1.5e-3.
    pair = lumped.load_gear_pair("fzg_c")
    coarse = next(s for s in refinements(pair, 512) if s.key == "sampling")
    assert coarse.error > coarse.limit == 5e-4
    assert not coarse.passes
    samples = enough_samples(pair, 512)
    assert samples > 512
    fine = next(s for s in refinements(pair, samples) if s.key == "sampling")
    assert fine.passes
    assert enough_samples(lumped.load_gear_pair("nasa_28_28"), 512) == 512


def test_numbers_that_are_not_finite_never_pass():
    assert not Check("k", "s", "e", math.nan, 1.0, "r").passes
    assert not OrderCheck("m", 4, math.nan, 8, 1e-3).passes
    assert not Refinement("k", "s", "m", (Level("a", math.nan, True),), 1.0, "r").passes
