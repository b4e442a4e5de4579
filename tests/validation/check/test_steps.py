"""Which of two causes with the same misfit is named: a usual factor before an odd one?"""

import math

import pytest

from validation.check.explanations.registry import EXPLANATIONS
from validation.check.steps import Step


def step(name, factor):
    """A free factor; causes search over its logarithm."""
    made = Step(EXPLANATIONS[name], None, math.log(factor))
    assert made.label == pytest.approx(factor)
    return made


@pytest.mark.parametrize("factor", [2.0, 0.5, 4.0, 0.1, 1000.0])
def test_a_usual_factor_is_likelier_than_an_odd_one(factor):
    """A diameter for a radius, a decimal point, a unit: these factors are mistakes, 1.9 is not."""
    assert step("inertia", factor).is_round
    assert not step("inertia", 0.95 * factor).is_round
    assert 1.0 < step("inertia", factor).price < step("inertia", 0.95 * factor).price


def test_a_cause_with_a_simpler_twin_is_less_likely():
    """The modulus of both gears moves the stiffness alone, which has a name of its own."""
    assert step("Young's modulus", 1.7).price > step("mesh stiffness", 1.7).price
