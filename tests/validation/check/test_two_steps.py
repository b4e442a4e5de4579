"""Are the two steps at once those that leave least, and are two mistakes found together?"""

import itertools

import numpy as np
import pytest

import lumped
from tests.validation.check.motions import lumped_motion
from tests.validation.check.sampled_motions import COULOMB, sampled
from validation.check.explanations.cause import Cause, Choice, Kind
from validation.check.explanations.physics import Physics, motion_of
from validation.check.explanations.registry import EXPLANATIONS
from validation.check.problem import Problem
from validation.check.search import Search
from validation.check.steps import FREE_IS_WORSE, Step
from validation.check.two_steps import Effect, promising_pairs

SIZE = 9


def effects_of(random, fixed=4, free=3):
    """Effects of fixed values and of free parameters from 0.5 to 1.5, of random residuals."""
    effects = []
    for number in range(fixed):
        choice = Choice(f"value {number}", "", lambda variant: variant)
        step = Step(Cause(f"fixed {number}", Kind.INPUT, "", ""), choice)
        effects.append(Effect(step, random.standard_normal(SIZE), np.zeros(SIZE)))
    for number in range(free):
        step = Step(Cause(f"free {number}", Kind.PHYSICS, "", "", grid=(2.0,), neutral=0.0), None, 0.5)
        effects.append(Effect(step, random.standard_normal(SIZE), random.standard_normal(SIZE), 1.0))
    return effects


def least_of(residual, one, other):
    """What two effects leave at the best of many places, with their prices."""
    shares = np.linspace(0.0, 1.0, 101)
    left = [
        np.linalg.norm(residual + one.start + a * one.along + other.start + b * other.along)
        for a in (shares if one.along.any() else [0.0])
        for b in (shares if other.along.any() else [0.0])
    ]
    return min(left) * one.step.price * other.step.price


@pytest.mark.parametrize("seed", range(5))
def test_pairs_come_in_the_order_of_what_they_leave(seed):
    random = np.random.default_rng(seed)
    residual = random.standard_normal(SIZE)
    effects = effects_of(random)
    by_key = {one.step.key: one for one in effects}
    chosen = promising_pairs(residual, effects, 100)
    left = [least_of(residual, *(by_key[step.key] for step in pair)) for pair in chosen]
    assert np.all(np.diff(left) > -1e-3 * left[-1])
    every = [least_of(residual, *pair) for pair in itertools.combinations(effects, 2)]
    assert left[0] == pytest.approx(min(every), rel=1e-3)


def test_free_parameters_get_the_places_of_the_minimum():
    random = np.random.default_rng(7)
    effects = effects_of(random)
    one, other = effects[-2:]
    residual = -(one.start + 0.3 * one.along + other.start + 0.8 * other.along)
    (first, *_) = promising_pairs(residual, effects, 3)
    assert [step.key for step in first] == [one.step.key, other.step.key]
    assert [step.coordinate for step in first] == pytest.approx([0.8, 1.3], abs=0.02)


def test_no_change_takes_all_pairs():
    random = np.random.default_rng(3)
    effects = effects_of(random, fixed=12, free=0)
    effects[0] = effects[0]._replace(start=np.ones(SIZE))
    chosen = promising_pairs(-np.ones(SIZE), effects, 10)
    assert len(chosen) == 10
    assert sum(effects[0].step.key in {step.key for step in pair} for pair in chosen) == 4
    assert FREE_IS_WORSE > 1.0  # a free parameter pays, a fixed value does not


#: Causes among which two mistakes are looked for.
CAUSES = (
    "bearings in the mesh stiffness",
    "table of the stiffness",
    "mesh stiffness",
    "bearing stiffness",
    "bearing stiffness of the pinion",
    "bearing stiffness of the gear",
    "inertia",
    "mesh damping",
    "torque",
)


def test_two_mistakes_at_once_are_found_by_their_effects_alone():
    pair = lumped.load_gear_pair("high_contact_ratio_29_47").with_(COULOMB)
    softer = pair.with_({"bearings.pinion.loa_stiffness": 0.5 * pair.bearings.pinion.loa_stiffness})
    other = motion_of(softer, Physics(table=5), None)
    curves = sampled(other, ("dte", "x_p", "y_g", "mesh_force"))
    causes = tuple(EXPLANATIONS[name] for name in CAUSES)
    search = Search(Problem.of(pair, curves, lumped_motion(pair)), 600.0, causes=causes)
    start = search.start()
    best, *_ = search.with_two_steps(start)
    assert {step.cause.name for step in best.steps} >= {"table of the stiffness"}
    assert best.trial.value < 0.05 * start.trial.value
    factor = next(step.label for step in best.steps if step.cause.name.startswith("bearing stiffness"))
    assert factor == pytest.approx(0.5, rel=0.02)
    singles = search.expand(start)
    assert singles[0].trial.value > 5.0 * best.trial.value
