"""Does the ladder separate two faults, prefer fixed values, and stay the same on other channels and noise?"""

from dataclasses import replace

import numpy as np
import pytest

import lumped
from tests.unlike_pairs import unlike_pair
from tests.validation.check.motions import lumped_motion
from tests.validation.check.sampled_motions import COULOMB, LIMIT, sampled
from tests.validation.check.wrong_readings import changed
from validation.check import reference
from validation.check.curves import Channel
from validation.check.explanations.cause import Variant
from validation.check.explanations.physics import SAMPLES, Physics, motion_of
from validation.check.explanations.registry import EXPLANATIONS
from validation.check.ladder import climb
from validation.check.misfit import residual_of
from validation.check.problem import Problem
from validation.check.search import Path, Search, Step
from validation.check.words import ladder_words

CHANNELS = ("dte", "x_p", "y_g", "mesh_force", "bearing_force_y_g")


@pytest.fixture(scope="module")
def pair():
    """A pair in which nothing is symmetric."""
    return lumped.load_gear_pair("high_contact_ratio_29_47").with_(COULOMB)


@pytest.fixture(scope="module")
def motions():
    """Motions of changed models, shared by the cases."""
    return {}


#: Causes of the cases: those that a fault of these cases resembles.
CAUSES = (
    "sign of a channel",
    "unit of a channel",
    "channels swapped",
    "series stiffness of both teeth",
    "stiffness model",
    "mesh stiffness",
    "mesh damping",
    "torque",
    "density",
    "inertia",
    "friction sign",
    "friction coefficient",
)


def ladder_of(pair, curves, motions, most_motions=400, without=""):
    """The ladder of curves, among some causes, less one."""
    problem = Problem.of(pair, curves, lumped_motion(pair))
    causes = [EXPLANATIONS[name] for name in CAUSES if name != without]
    return climb(
        problem, limit=LIMIT, budget=600.0, motions=motions, most_motions=most_motions, causes=causes
    )


def names(ladder):
    """Names of the steps."""
    return [step.name for step in ladder.steps]


def test_two_faults_are_both_recovered(pair, motions):
    other = motion_of(pair.with_({"mesh.stiffness_factor": 1.2}), Physics(friction=-1.0), None)
    ladder = ladder_of(pair, sampled(other, CHANNELS), motions)
    assert sorted(names(ladder)) == ["friction sign", "mesh stiffness"]
    factor = next(step.factor for step in ladder.steps if step.name == "mesh stiffness")
    assert factor == pytest.approx(1.2, rel=0.01)
    assert ladder.start > ladder.steps[0].misfit > ladder.steps[1].misfit


def test_a_wrong_sign_that_hides_the_stiffness(pair, motions):
    """Neither step alone lowers the misfit by much: both are tried together."""
    other = lumped_motion(pair.with_({"mesh.stiffness_factor": 0.7}))
    curves = changed(sampled(other, CHANNELS), ("y_g",), lambda v: -v)
    assert sorted(names(ladder_of(pair, curves, motions))) == ["mesh stiffness", "sign of a channel"]


def test_a_fixed_value_beats_a_free_factor(pair, motions):
    other = lumped_motion(pair.with_({"mesh.stiffness_factor": 2.0}))
    first = ladder_of(pair, sampled(other, CHANNELS), motions).steps[0]
    assert first.name == "series stiffness of both teeth"
    assert "mesh stiffness" in [one.name for one in first.alternatives]
    assert first.sentence.startswith("Compatible with ")


def test_three_single_explanations_are_named_whatever_they_leave(pair, motions):
    """Two mistakes at once: each of both is beside the path, alone, although it leaves much."""
    two = pair.with_({"mesh.stiffness_factor": 1.3, "operating.pinion_torque": 150.0})
    ladder = ladder_of(pair, sampled(lumped_motion(two), CHANNELS), motions)
    assert len(ladder.alone) == 3
    assert len({one.name for one in ladder.alone}) == 3
    said = {step.sentence for step in ladder.steps}
    said |= {other.sentence for step in ladder.steps for other in step.alternatives}
    assert not said & {one.sentence for one in ladder.others_alone}
    assert said | {one.sentence for one in ladder.others_alone} >= {one.sentence for one in ladder.alone}
    single = ladder_of(
        pair, sampled(lumped_motion(pair.with_({"mesh.stiffness_factor": 2.0})), CHANNELS), motions
    )
    assert single.alone[0].name == single.steps[0].name
    assert len(single.alone) == 3


def test_what_takes_something_else_away_counts_as_worse(motions):
    """A reversed stiffness needs prescribed contact: under loaded contact one thing more than it says."""
    pair = lumped.load_gear_pair("high_contact_ratio_29_47")
    motion = lumped_motion(pair)
    problem = Problem.of(pair, sampled(motion, CHANNELS), motion)
    search = Search(problem, 600.0)
    scores = {}
    for form in ("loaded", "prescribed"):
        own = pair.with_({"mesh.contact": form})
        one = Search(replace(problem, pair=own), 600.0)
        cause = EXPLANATIONS["stiffness over the mesh cycle"]
        choice = next(c for c in cause.choices(one.problem, Variant(own)) if c.label == "reversed")
        scores[form] = one.trial((Step(cause, choice),))
    assert (scores["loaded"].side_effects, scores["prescribed"].side_effects) == (1, 0)
    start = search.start()
    worse = replace(start, trial=start.trial._replace(side_effects=1))
    assert worse.score(1e-4) > 1.2 * start.score(1e-4)


def test_a_mistake_comes_before_a_course_that_it_resembles(pair, motions):
    """Of equal misfits the shape of a stiffness, which describes, stands behind a factor, which names."""
    motion = lumped_motion(pair)
    search = Search(Problem.of(pair, sampled(motion, CHANNELS), motion), 600.0)
    steps = [Step(EXPLANATIONS[name], None, 0.01) for name in ("mesh stiffness", "slope of the stiffness")]
    named, described = (Path((step,), search.start().trial) for step in steps)
    assert described.score(1e-4) > 1.1 * named.score(1e-4)


def test_a_stiffness_comes_before_a_modulus_of_the_same_effect(pair, motions):
    """Of equal misfits a factor on the stiffness stands before one on the modulus, and a round one first."""
    motion = lumped_motion(pair)
    start = Search(Problem.of(pair, sampled(motion, CHANNELS), motion), 600.0).start()

    def score(name, factor):
        return Path((Step(EXPLANATIONS[name], None, np.log(factor)),), start.trial).score(1e-4)

    assert score("Young's modulus", 1.4) > score("mesh stiffness", 1.4)
    assert score("mesh stiffness", 2.0) < 0.95 * score("mesh stiffness", 1.9)


def test_a_slight_later_step_is_told_with_the_step_before(pair):
    """A thousandth of a base pitch is no mistake, whatever the misfit says of it."""
    cause = EXPLANATIONS["contact ratio"]
    assert Step(cause, None, 1e-3).slight
    assert not Step(cause, None, 0.05).slight


def test_explanations_of_one_motion_are_named_together(pair, motions):
    """Masses and inertias times a factor are a density."""
    cause = EXPLANATIONS["density"]
    variant = cause.change(Variant(pair), 1.5)
    other = motion_of(variant.pair, variant.physics, None)
    first = ladder_of(pair, sampled(other, ("dte", "theta_p")), motions).steps[0]
    assert "density" in [first.name, *(one.name for one in first.alternatives)]


@pytest.mark.parametrize("channels", [CHANNELS[::-1], CHANNELS[:2], ("bearing_force_y_g", "dte")])
def test_order_and_subset_of_channels_do_not_matter(pair, motions, channels):
    other = lumped_motion(pair.with_({"mesh.stiffness_factor": 1.2}))
    ladder = ladder_of(pair, sampled(other, channels), motions)
    assert names(ladder) == ["mesh stiffness"]
    assert ladder.steps[0].factor == pytest.approx(1.2, rel=0.01)


def test_noise_changes_nothing(pair, motions):
    random = np.random.default_rng(5)
    other = motion_of(pair, Physics(friction=-1.0), None)
    curves = changed(
        sampled(other, CHANNELS), CHANNELS, lambda v: v + 0.01 * np.std(v) * random.standard_normal(v.size)
    )
    assert names(ladder_of(pair, curves, motions)) == ["friction sign"]


def test_sound_curves_have_no_step(pair, motions):
    ladder = ladder_of(pair, sampled(lumped_motion(pair), CHANNELS), motions)
    assert ladder.steps == ()
    assert ladder.runs == 0


def test_an_entry_that_is_missing_is_not_named(pair, motions):
    other = motion_of(pair, Physics(friction=-1.0), None)
    ladder = ladder_of(pair, sampled(other, CHANNELS), motions, without="friction sign")
    assert "friction sign" not in names(ladder)
    assert not ladder.steps or ladder.steps[-1].misfit > 0.2 * LIMIT
    words = ladder_words(ladder, LIMIT)
    assert words.startswith("No named explanation") or "stays above the limit" in words


def test_a_vague_unit_is_no_explanation_above_the_limit(pair, motions):
    """Many causes change the size of a channel by 2: the factor alone is named only where it is enough."""
    other = lumped_motion(pair.with_({"mesh.stiffness": {"model": "energy"}, "mesh.damping_ratio": 0.3}))
    curves = changed(sampled(other, CHANNELS), ("dte",), lambda v: 2.0 * v + 0.8 * np.roll(v, 90))
    ladder = ladder_of(pair, curves, motions)
    assert ladder.steps == () or ladder.steps[-1].misfit > LIMIT
    assert "unit of a channel" not in names(ladder)
    enough = changed(sampled(lumped_motion(pair), CHANNELS), ("dte",), lambda v: 2.0 * v)
    assert names(ladder_of(pair, enough, motions)) == ["unit of a channel"]


def test_the_number_of_motions_cuts_the_search(pair):
    other = lumped_motion(pair.with_({"mesh.stiffness_factor": 1.2}))
    ladder = ladder_of(pair, sampled(other, CHANNELS), {}, most_motions=5)
    assert not ladder.complete
    assert ladder.runs == 5


def test_the_budget_cuts_the_search(pair):
    problem = Problem.of(
        pair,
        sampled(lumped_motion(unlike_pair("contact_ratio_1_1_large_shifts")), CHANNELS),
        lumped_motion(pair),
    )
    ladder = climb(problem, limit=LIMIT, budget=0.0)
    assert not ladder.complete
    assert ladder.runs == 0


def test_residual_is_the_misfit(pair):
    other = lumped_motion(pair.with_({"mesh.stiffness_factor": 2.0, "operating.pinion_torque": 80.0}))
    problem = Problem.of(pair, sampled(other, CHANNELS, cycles=4), lumped_motion(pair))
    # Only the misfit leaves out the expected square of the noise, of which orders above 12 leave a little.
    assert np.linalg.norm(residual_of(problem.misfit)) == pytest.approx(problem.misfit.value, rel=1e-3)


def test_tooth_pairs_count_as_one_channel(pair):
    """Four channels of the loads of tooth pairs weigh as much as the one channel of the whole mesh."""
    other = lumped_motion(pair.with_({"mesh.stiffness_factor": 2.0}))
    curves = sampled(other, ("x_p",), cycles=2 * pair.pinion.teeth, per_cycle=101)
    place = 0.3 + np.arange(curves.places.size) / 101
    loads = (
        Channel(f"load {one}", "normal_load", other.at("normal_load", place, one), one) for one in "ABCD"
    )
    curves = replace(curves, channels=(*curves.channels, *loads))
    problem = Problem.of(pair, curves, lumped_motion(pair))
    assert np.linalg.norm(residual_of(problem.misfit)) == pytest.approx(problem.misfit.value, rel=0.02)


def test_tooth_pairs_that_are_not_compared_do_not_stop_the_search(pair, motions):
    """Of the loads of four tooth pairs one channel is compared; a family of channels has all four."""
    other = lumped_motion(pair.with_({"mesh.stiffness_factor": 1.3}))
    curves = sampled(other, ("dte",))
    places = np.arange(curves.places.size) * (curves.places[1] - curves.places[0])
    loads = (
        Channel(f"normal_load_{one}", "normal_load", other.at("normal_load", places, one), one)
        for one in "ABCD"
    )
    curves = replace(curves, channels=(*curves.channels, *loads))
    assert names(ladder_of(pair, curves, motions))[0] == "mesh stiffness"


def test_altered_models_agree_with_the_prediction(pair):
    """Prescribed contact in which all teeth push: the linear motion is the motion with unilateral contact."""
    alteration = motion_of(pair, Physics(), None).samples("dte")
    prediction = lumped_motion(pair).samples("dte")
    assert np.abs(alteration - prediction).max() < 1e-5 * np.ptp(prediction)


def test_reversed_friction_is_that_of_the_printed_signs(pair):
    """Eq. 9 as printed is the friction force on the gear reversed."""
    altered = motion_of(pair, Physics(force_gear=-1.0), None).samples("y_g")
    printed = lumped.steady_state(pair, contact="linear", as_printed=(9,))["y_g"].to_numpy()
    assert np.abs(altered - printed).max() < 1e-6 * np.ptp(printed)


def test_the_noise_of_curves_is_measured(pair):
    random = np.random.default_rng(2)
    motion = lumped_motion(pair)
    curves = sampled(motion, CHANNELS, cycles=4)
    clean = Search(Problem.of(pair, curves, motion), 1.0).floor(LIMIT)
    noisy = changed(curves, CHANNELS, lambda v: v + 0.3 * np.std(v) * random.standard_normal(v.size))
    assert clean < 1.2 * LIMIT / 50.0
    assert Search(Problem.of(pair, replace(noisy), motion), 1.0).floor(LIMIT) > 5.0 * clean


def test_readings_are_tried_with_the_samples_of_other_trials(pair):
    """Finer samples would be an advantage of readings. Their ladder has the finest motion in the end."""
    fine = reference.lumped_motion(pair, samples=4 * SAMPLES)
    curves = changed(sampled(fine, CHANNELS), ("x_p",), lambda v: 1e3 * v)
    problem = Problem.of(pair, curves, fine)
    assert Search(problem, 600.0).start().trial.motion.plain.time.size == SAMPLES
    causes = [EXPLANATIONS[name] for name in ("unit of a channel", "mesh stiffness")]
    ladder = climb(problem, limit=LIMIT, budget=600.0, causes=causes)
    assert names(ladder) == ["unit of a channel"]
    assert ladder.motion.plain.time.size == 4 * SAMPLES
    assert ladder.motion.motion["dte"].to_numpy() == pytest.approx(fine.samples("dte"), rel=1e-12)


def test_a_step_that_needs_another_one_has_no_trial_without_it(pair):
    """The end of the parabola is an input of the parabola alone: behind another model it is no step."""
    parabola = pair.with_({"mesh.stiffness": {"model": "parabolic"}})
    motion = lumped_motion(parabola)
    search = Search(Problem.of(parabola, sampled(motion, CHANNELS), motion), 600.0)
    model = EXPLANATIONS["stiffness model"]
    start = Variant(parabola)
    choice = next(c for c in model.choices(search.problem, start) if c.label == "rectangular")
    end = EXPLANATIONS["ends of the parabola"]
    assert search.trial((Step(end, None, end.coordinate(end.grid[0])),)) is not None
    assert search.trial((Step(model, choice), Step(end, None, end.coordinate(end.grid[0])))) is None


def test_trials_have_more_samples_where_the_force_jumps(pair):
    """The force of a damper jumps where teeth meet: at low speed its orders need more samples."""
    slow = pair.with_({"mesh.damping_ratio": 0.3, "operating.pinion_speed": "400 rpm"})
    sizes = {}
    for name, turning in (("slow", slow), ("fast", pair)):
        fine = reference.lumped_motion(turning, samples=4 * SAMPLES)
        search = Search(Problem.of(turning, sampled(fine, ("mesh_force",)), fine), 600.0)
        other = search.trial((Step(EXPLANATIONS["torque"], None, 0.1),))
        sizes[name] = [search.start().trial.motion.plain.time.size, other.motion.plain.time.size]
        error = search.start().trial.residual - residual_of(search.problem.misfit)
        assert search.floor(LIMIT) > np.linalg.norm(error)
    assert sizes == {"slow": [4 * SAMPLES] * 2, "fast": [SAMPLES] * 2}
