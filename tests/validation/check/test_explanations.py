"""Does every entry of the registry explain the curves that it alone, or a named alternative, can explain?

Each case makes curves by its cause, with samples at other times than those of the search, and climbs. The
motions of changed models are shared by all cases of a pair. A case tries its cause beside its rivals, which
are the causes near to it in the registry and some that many curves resemble. A few cases try the whole
registry.
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import lumped
from lumped.schema.bodies import bodies_of
from tests.validation.check.further_values import FURTHER, OF_OTHER_PAIRS
from tests.validation.check.motions import lumped_motion
from tests.validation.check.sampled_motions import CHANNELS, LIMIT, sampled
from tests.validation.check.wrong_readings import (
    AXES,
    averaged,
    butterworth,
    butterworth_both_ways,
    butterworth_of_fourth_order,
    changed,
    high_passed,
    low_passed,
    renamed,
    swapped,
    three_orders,
    turned,
)
from validation.check.curves import Channel, Curves
from validation.check.explanations.cause import Variant
from validation.check.explanations.misreadings import causes_of_channels
from validation.check.explanations.physics import Physics, motion_of
from validation.check.explanations.registry import EXPLANATIONS
from validation.check.ladder import climb
from validation.check.problem import Problem

PAGE = Path(__file__).parents[3] / "docs/how_to/check_your_model.md"


#: Cause -> pair and label of the fixed value; None: the first one. Pair and value of a free parameter.
FIXED = {
    "torque of the other gear": ("unlike", None),
    "contact form": ("unlike", None),
    "friction left out": ("unlike", None),
    "friction law": ("unlike", "benedict_kelley"),
    "stiffness model": ("unlike", "rectangular"),
    "series stiffness of both teeth": ("unlike", None),
    "compliance counted twice": ("unlike", None),
    "mesh damping left out": ("unlike", None),
    "bearing damping left out": ("unlike", None),
    "inertia by m r^2": ("unlike", "the gear: 2"),
    "radius of the discs": ("unlike", None),
    "unit of the masses": ("unlike", "1000"),
    "relief ignored": ("relieved", None),
    "deviations": ("eccentric", None),
    "exchanged": ("unlike", "bearings"),
    "pressure angle": ("unlike", 22.5),
    "profile shifts": ("unlike", None),
    "material of the gears": ("polymer", "of the pinion"),
    "one face width": ("unlike", None),
    "friction sign": ("unlike", None),
    "part of friction": ("unlike", None),
    "mesh force sign": ("stiff bearings", None),
    "damper law": ("energy", "constant"),
    "teeth pull": ("contact lost", None),
    "stiffness over the mesh cycle": ("unlike", "constant"),
    "pitch radius": ("unlike", None),
    "supports": ("unlike", None),
    "shafts left out": ("on shafts", None),
    "driving gear": ("unlike", "the gear at its speed, called pinion"),
    "constant speed of a gear": ("unlike", "the gear"),
    "static curve": ("unlike", None),
    "friction over the path": ("unlike", "without reversal"),
    "number of teeth": ("unlike", "gear: +1"),
    "approach of the teeth": ("soft bearings", "without the pinion"),
    "lever arms of friction": ("unlike", "of the other gear"),
    "static error as an excitation": ("unlike", None),
    "unit of the torque": ("unlike", "1.356"),
    "part of the relief ignored": ("both relieved", "of the gear"),
    "shape of the relief": ("relieved", None),
    "tips exchanged": ("unlike addenda", "addenda"),
    "values of one for both": ("unlike", "masses of the pinion"),
    "formula of the mesh damper": ("unlike", "masses of translation"),
    "zones of contact": ("unlike", "zones exchanged"),
    "line of action": ("shifted", "of the rack"),
    "parts of the compliance": ("energy", "no foundation"),
    "table of the stiffness": ("unlike", "8, lines"),
    "peak at the pitch point": ("unlike", None),
    "addendum of the rack": ("unlike", 1.0),
    "formula of the stiffness": ("unlike", "0.8 forgotten"),
    "measure of the roughness": ("rough", "Ra for Rz 5"),
    "end of the relief": ("both relieved", "of the pinion"),
    "start of the relief": ("both relieved", "height as a length"),
    "sign of the relief": ("both relieved", "of the gear"),
    "one error for all pairs": ("both relieved", "newest pair"),
    "rate of the errors": ("damped relief", None),
    "number of pairs that carry": ("unlike", "newest 2"),
    "bearings in the mesh stiffness": ("unlike", None),
    "input of the friction law": ("rough", "half of the slide-to-roll ratio"),
    "exponent of the contact force": ("unlike", "exponent 1.5"),
    "long steps": ("unlike", "implicit Euler, 421 a cycle"),
}
#: Inputs of one gear.
OF_ONE_GEAR = {"bore": 1.8, "face width": 0.6, "Young's modulus": 1.7, "profile shift": 0.2}
OF_ONE_GEAR |= {"amount of the tip relief": 1.8, "length of the tip relief": 0.6}
FREE = {
    "mesh stiffness": 1.17,
    "mesh damping": 1.8,
    "torque": 1.3,
    "inertia": 1.4,
    "mass": 1.4,
    "density": 0.7,
    "inertia of the pinion": 1.5,
    "mass of the pinion": 1.5,
    "inertia of the gear": 0.7,
    "mass of the gear": 0.6,
    "bearing stiffness": 0.6,
    "bearing damping": 3.0,
    "bearing stiffness of the pinion": 3.0,
    "bearing damping of the pinion": 3.0,
    "bearing stiffness of the gear": 3.0,
    "bearing damping of the gear": 3.0,
    "bearing stiffness along the line of action": 0.5,
    "bearing damping along the line of action": 3.0,
    "bearing stiffness across the line of action": 0.5,
    "bearing damping across the line of action": 3.0,
    "face width": 0.8,
    "addendum": 0.93,
    "addendum of the pinion": 0.9,
    "addendum of the gear": 0.93,
    "numerical damping": 2.0,
    "centre distance": 1.003,
    "module": 1.07,
    "friction coefficient": 1.5,
    "variation of the mesh stiffness": 0.5,
    "smoothed mesh stiffness": 0.3,
    "profile error: cosine": 0.6,
    "profile error: sine": -0.6,
    "relief added": 0.5,
    "amount of relief": 1.6,
    "density of the pinion": 1.4,
    "density of the gear": 0.7,
    "bearing stiffness of the pinion, along": 3.0,
    "bearing damping of the pinion, along": 3.0,
    "bearing stiffness of the pinion, across": 3.0,
    "bearing damping of the pinion, across": 3.0,
    "bearing stiffness of the gear, along": 3.0,
    "bearing damping of the gear, along": 3.0,
    "bearing stiffness of the gear, across": 3.0,
    "bearing damping of the gear, across": 3.0,
    "ends of the parabola": 0.6,
    "viscosity": 4.0,
    "roughness": 3.0,
    "length of the relief": 1.4,
    "balance of the profile shifts": 0.1,
    "slope of the stiffness": 0.3,
    "curvature of the stiffness": -0.4,
    "ramps of the stiffness": 0.15,
    "lag of the stiffness": 0.08,
    "place of the path of contact": 0.2,
    "damping of the masses": 0.05,
    "peak of the parabola": 0.3,
    "contact ratio": 0.15,
    "end of the path of contact": -0.2,
    "start of the path of contact": 0.15,
    "compliance in series": 0.35,
    "constant friction coefficient": 0.05,
    "friction smoothed by a tanh": 0.4,
    "friction smoothed by a ramp": 0.6,
    "forces one step late": 0.002,
    "bores": 1.8,
    "Young's modulus": 0.6,
    **{f"{what} of the {gear}": value for gear in ("pinion", "gear") for what, value in OF_ONE_GEAR.items()},
}
#: Pairs of free parameters that the pair "unlike" does not have.
PAIR_OF = {
    "amount of relief": "relieved",
    "length of the relief": "relieved",
    "viscosity": "rough",
    "roughness": "rough",
    "constant friction coefficient": "rough",
    "density of the pinion": "soft bearings",
    "density of the gear": "soft bearings",
    **{name: "both relieved" for name in FREE if "of the tip relief of the" in name},
    **{name: "soft bearings" for name in FREE if name.startswith("bore")},
}
#: Causes that are tried in every case, because many curves resemble theirs.
ALWAYS = ("sign of a channel", "mesh stiffness", "torque", "friction sign", "mesh damping")
#: Rivals of a cause: so many entries of the registry before it and behind it.
NEAR = 3
#: Cases that try the whole registry, with one value each.
WHOLE = ("friction over the path", "mass of the gear", "delay of a channel")
READINGS = {
    "sign of a channel": lambda curves: changed(curves, ("y_g",), lambda v: -v),
    "unit of a channel": lambda curves: changed(curves, ("x_p",), lambda v: 1e3 * v),
    "radius of a channel": lambda curves: changed(curves, ("theta_g",), lambda v: v * 29 / 47),
    "channels swapped": lambda curves: swapped(curves, "x_p", "y_g"),
    "another quantity": lambda curves: renamed(curves, "x_p", "bearing_force_x_p"),
    "time reversed": lambda curves: changed(curves, CHANNELS, lambda v: v[::-1]),
    "delay of a channel": lambda curves: changed(curves, ("dte",), lambda v: np.roll(v, 29)),
    "low-pass filter of fourth order": lambda curves: changed(curves, CHANNELS, butterworth_of_fourth_order),
    "few mesh orders": lambda curves: changed(curves, CHANNELS, three_orders),
    "moving average": lambda curves: changed(curves, CHANNELS, averaged),
    "axes of the bearing forces": lambda curves: turned(
        curves, 70.0, ("bearing_force_x_p", "bearing_force_y_p")
    ),
    "axes of all channels": lambda curves: turned(curves, -20.0, *AXES),
    "low-pass filter": lambda curves: changed(curves, CHANNELS, low_passed),
    "low-pass filter of second order": lambda curves: changed(curves, CHANNELS, butterworth),
    "filter of a channel": lambda curves: changed(curves, ("bearing_force_x_p",), butterworth),
    "low-pass filter both ways": lambda curves: changed(curves, CHANNELS, butterworth_both_ways),
    "high-pass filter": lambda curves: changed(curves, CHANNELS, high_passed),
    "zero of a channel": lambda curves: changed(curves, ("x_p",), lambda v: v + 3.0 * np.ptp(v)),
}
#: Cases with a test of their own.
SINGLE = (
    "time axis",
    "speed of the curves",
    "speed",
    "wrong phase",
    "not settled",
    "step too long",
    "dampers stay",
    "amount of the deviations",
    "sign of the deviations",
    "reading of the deviations",
    "places of tooth pairs",
    *("few digits", "brake torque", "errors of the integration", "form of the export"),  # test_agreeing.py
)


def rivals(name, problem, whole=False):
    """The cause and the causes that it is tried beside; None: the whole registry."""
    if whole:
        return None
    listed = list(EXPLANATIONS)
    place = listed.index(name)
    chosen = {*listed[max(place - NEAR, 0) : place + NEAR + 1], *ALWAYS}
    causes = [EXPLANATIONS[one] for one in listed if one in chosen]
    of_channels = {"delay of a channel", "filter of a channel"} & chosen
    return [*causes, *causes_of_channels(problem)] if of_channels else causes


def climbed(problem, shared, pair_name, name, most_motions=1200, whole=False):
    """The ladder of a problem beside the rivals of a cause, with the motions of its pair."""
    return climb(
        problem,
        limit=LIMIT,
        budget=600.0,
        motions=shared.setdefault(pair_name, {}),
        most_motions=most_motions,
        causes=rivals(name, problem, whole),
    )


def variant_of(cause, label, problem):
    """The variant of a pair with a fixed value of a cause."""
    variant = Variant(problem.pair)
    choices = cause.choices(problem, variant)
    choice = choices[0] if label is None else next(one for one in choices if one.label == label)
    return choice.variant(variant)


def says(ladder, name):
    """Whether one step is enough, and it or an explanation that does as well bears the name."""
    first = ladder.steps[0]
    names = [first.name, *(other.name for other in first.alternatives)]
    return len(ladder.steps) == 1 and name in names and first.misfit < 0.3 * LIMIT


def test_every_entry_has_a_case():
    assert {*FIXED, *FREE, *READINGS, *SINGLE} == set(EXPLANATIONS)


def test_further_fixed_values(pairs, shared):
    pair = pairs["unlike"]
    motion = lumped_motion(pair)
    own = Problem.of(pair, sampled(motion), motion)
    for name, label in FURTHER:
        variant = variant_of(EXPLANATIONS[name], label, own)
        other = motion_of(variant.pair, variant.physics, None)
        ladder = climbed(Problem.of(pair, sampled(other), motion), shared, "unlike", name)
        assert [(step.name, step.factor) for step in ladder.steps] == [(name, label)]


@pytest.mark.parametrize(("pair_name", "name", "label"), OF_OTHER_PAIRS)
def test_fixed_values_of_other_pairs(pair_name, name, label, pairs, shared):
    pair = pairs[pair_name]
    motion = lumped_motion(pair)
    own = Problem.of(pair, sampled(motion), motion)
    variant = variant_of(EXPLANATIONS[name], label, own)
    other = motion_of(variant.pair, variant.physics, None)
    ladder = climbed(Problem.of(pair, sampled(other), motion), shared, pair_name, name, most_motions=300)
    first = ladder.steps[0]
    assert (name, label) in [(one.name, one.factor) for one in (first, *first.alternatives)]
    assert first.misfit < 0.3 * LIMIT


def test_dampers_that_stay_are_told_with_the_inertia(pairs, shared):
    """A damper [N s/m] of the inertia of before: one explanation, not a second wrong damping."""
    pair = pairs["unlike"]
    lighter = EXPLANATIONS["inertia of the gear"].change(Variant(pair), 0.3)
    masses = [bodies_of(one).effective_mass for one in (pair, lighter.pair)]
    ratio = pair.mesh.damping_ratio * np.sqrt(masses[0] / masses[1])
    other = lumped_motion(lighter.pair.with_({"mesh.damping_ratio": ratio}))
    problem = Problem.of(pair, sampled(other), lumped_motion(pair))
    names = ("inertia of the gear", "dampers stay", "mesh damping", "mesh stiffness", "torque")
    ladder = climb(
        problem,
        limit=LIMIT,
        budget=600.0,
        motions=shared.setdefault("unlike", {}),
        most_motions=300,
        causes=[EXPLANATIONS[name] for name in names],
    )
    assert [step.name for step in ladder.steps] == ["inertia of the gear"]
    assert ladder.steps[0].factor == pytest.approx(0.3, rel=0.02)
    assert "dampers" in ladder.steps[0].sentence
    assert ladder.steps[0].misfit < 0.2 * LIMIT


@pytest.mark.parametrize("name", FIXED)
def test_fixed_value(name, pairs, shared):
    pair_name, label = FIXED[name]
    pair = pairs[pair_name]
    motion = lumped_motion(pair)
    channels = ("dte", "mesh_force") if name == "shafts left out" else CHANNELS
    own = Problem.of(pair, sampled(motion, channels), motion)
    variant = variant_of(EXPLANATIONS[name], label, own)
    other = motion_of(variant.pair, variant.physics, None)
    if motion.mesh_cycles > 1:  # the last half, two turns, tells the shaft orders
        curves = sampled(other, channels, cycles=4 * motion.mesh_cycles + 1, per_cycle=64)
    else:
        curves = sampled(other, channels)
    if name == "static curve":  # a curve over the times of the pair
        curves = replace(curves, places=sampled(motion, channels).places)
    problem = Problem.of(pair, curves, motion)
    most = 60 if pair_name in ("eccentric", "on shafts", "contact lost") else 300
    assert says(climbed(problem, shared, pair_name, name, most, name in WHOLE), name)


@pytest.mark.parametrize("name", FREE)
def test_free_factor_is_recovered(name, pairs, shared):
    pair_name = PAIR_OF.get(name, "unlike")
    pair = pairs[pair_name]
    cause = EXPLANATIONS[name]
    variant = cause.change(Variant(pair), FREE[name])
    other = motion_of(variant.pair, variant.physics, None)
    # A bearing in one direction is told by the displacement of its gear in this direction.
    channels = (*CHANNELS, "x_g", "y_p") if name.endswith(("along", "across")) else CHANNELS
    curves = sampled(other, channels)
    problem = Problem.of(pair, curves, lumped_motion(pair))
    ladder = climbed(problem, shared, pair_name, name, whole=name in WHOLE)
    assert says(ladder, name)
    if ladder.steps[0].name == name:
        assert ladder.steps[0].factor == pytest.approx(cause.shown(FREE[name]), rel=0.02)


def test_deviations_with_another_size_or_sign(pairs, shared):
    """Index deviations of the pinion with steps, times 1.7 or with the wrong sign, over four turns."""
    index = 4.0 * np.random.default_rng(3).normal(size=28)
    pair = pairs["eccentric"].with_({"pinion.mounting": None, "pinion.deviations": {"index": tuple(index)}})
    motion = lumped_motion(pair)
    backwards = np.append(index[0], index[:0:-1])
    for name, factor, numbers in (
        ("amount of the deviations", 1.7, 1.7 * index),
        ("sign of the deviations", -1.0, -index),
        ("reading of the deviations", 0.0, backwards),
    ):
        other = lumped_motion(pair.with_({"pinion.deviations": {"index": tuple(numbers)}}))
        curves = sampled(other, cycles=4 * motion.mesh_cycles + 1, per_cycle=64)
        rivals_of_it = (
            "deviations",
            "amount of the deviations",
            "sign of the deviations",
            "reading of the deviations",
            "mesh damping",
        )
        ladder = climb(
            Problem.of(pair, curves, motion),
            limit=LIMIT,
            budget=600.0,
            motions=shared.setdefault("deviating", {}),
            most_motions=120,
            causes=[EXPLANATIONS[one] for one in rivals_of_it],
        )
        assert [step.name for step in ladder.steps] == [name]
        assert ladder.steps[0].misfit < 0.5 * LIMIT
        if factor > 0.0:  # pairs that lose contact make the motion jump with the factor
            assert ladder.steps[0].factor == pytest.approx(factor, rel=0.03)


@pytest.mark.parametrize("name", READINGS)
def test_reading(name, pairs, shared):
    pair = pairs["unlike"]
    motion = lumped_motion(pair)
    both = ("dte", *(one for axes in AXES for one in axes)) if name.startswith("axes") else CHANNELS
    curves = READINGS[name](sampled(motion, both))
    problem = Problem.of(pair, curves, motion)
    assert says(climbed(problem, shared, "unlike", name, whole=name in WHOLE), name)


@pytest.mark.parametrize(
    ("words", "share_pinion", "share_gear"),
    [
        ("without the displacements", 0.0, 0.0),
        ("with the wrong sign", -1.0, 1.0),
        ("no displacement of the gear", 1.0, 0.0),
        ("no displacement of the pinion", 0.0, -1.0),
        ("the sum of both displacements", 1.0, 1.0),
    ],
)
def test_transmission_error_of_other_displacements(words, share_pinion, share_gear, pairs, shared):
    """dte = r_p theta_p - r_g theta_g + x_p - x_g (docs/theory/equations.md): the last two are wrong."""
    pair = pairs["unlike"]
    motion = lumped_motion(pair)
    curves = sampled(motion, ("dte", "x_p", "x_g", "y_g"))
    values = {channel.name: channel.values for channel in curves.channels}
    rotations = values["dte"] - values["x_p"] + values["x_g"]
    error = rotations + share_pinion * values["x_p"] + share_gear * values["x_g"]
    wrong = changed(curves, ("dte",), lambda v: error)
    ladder = climbed(Problem.of(pair, wrong, motion), shared, "unlike", "another quantity")
    assert [step.name for step in ladder.steps] == ["another quantity"]
    assert words in ladder.steps[0].sentence


@pytest.mark.parametrize(
    ("name", "words", "share"),
    [
        ("mesh_force", "without the dampers", None),
        ("dte", "less the static one", None),
        ("dte", "rotations on the pitch circles", None),
        ("bearing_force_y_p", "the resultant of both directions", None),
        ("y_g", "the magnitude, without sign", None),
        ("friction", "the sum of the sizes", None),
        ("mesh_force", "the load of the leading tooth pair alone", None),
        ("mesh_force", "per millimetre of face width", 1e-3),
        ("dte", "the rotations alone, as an angle of the gear in arc seconds", None),
        ("dte", "an angle of the pinion in degrees", 1.0),
    ],
)
def test_channel_that_holds_another_quantity(name, words, share, pairs, shared):
    """Values by hand: K delta, delta - F/K, rotations times 1/cos(alpha), a hypotenuse, |y|, SUM |F|, F/b."""
    pair = pairs["unlike"]
    g = pair.geometry
    motion = lumped_motion(pair)
    names = ("dte", "x_p", "x_g", "y_g", "mesh_force", "friction", "bearing_force_x_p", "bearing_force_y_p")
    curves = sampled(motion, (*names, "mesh_stiffness"))
    values = {channel.name: channel.values for channel in curves.channels}
    curves = replace(curves, channels=curves.channels[:-1])
    force = pair.operating.pinion_torque / g.base_radius_pinion
    phase = 0.3 + np.arange(curves.places.size) / 421
    displaced = values["x_p"] - values["x_g"]
    rotations = values["dte"] - displaced
    grid = np.arange(512) / 512
    of_pairs = {
        name: [np.interp(phase % 1.0, grid, row, period=1.0) for row in motion.motion[name].to_numpy()]
        for name in ("normal_load", "friction_force")
    }
    wrong = {
        "the sum of the sizes": np.abs(of_pairs["friction_force"]).sum(axis=0),
        "the load of the leading tooth pair alone": of_pairs["normal_load"][0],
        "without the dampers": values["mesh_stiffness"] * values["dte"],
        "less the static one": values["dte"] - force / values["mesh_stiffness"],
        "rotations on the pitch circles": rotations / np.cos(g.operating_pressure_angle) + displaced,
        "the resultant of both directions": np.hypot(
            values["bearing_force_x_p"], values["bearing_force_y_p"]
        ),
        "the magnitude, without sign": np.abs(values["y_g"]),
        "per millimetre of face width": values["mesh_force"] * 1e-3 / g.face_width,
        "the rotations alone, as an angle of the gear in arc seconds": np.degrees(
            3600.0 * rotations / g.base_radius_gear
        ),
        "an angle of the pinion in degrees": np.degrees(values["dte"] / g.base_radius_pinion),
    }[words]
    changed_curves = changed(curves, (name,), lambda v: wrong)
    problem = Problem.of(pair, changed_curves, motion)
    cause = "radius of a channel" if share else "another quantity"
    ladder = climbed(problem, shared, "unlike", cause)
    assert [step.name for step in ladder.steps] == [cause]
    assert words in ladder.steps[0].sentence


@pytest.mark.parametrize("label", ["newest pair first", "leading pair first"])
def test_places_of_the_mesh_in_channels_of_tooth_pairs(label, pairs, shared):
    """Row i holds the load of the i-th pair on the path, so that it jumps with every mesh cycle."""
    pair = pairs["unlike"]
    motion = lumped_motion(pair)
    curves = sampled(motion, ("dte", "x_p"), cycles=36, per_cycle=101)
    phase = 0.3 + np.arange(curves.places.size) / 101
    loads = motion.motion["normal_load"].to_numpy()  # the pair ahead is first
    rows = loads if label.startswith("leading") else loads[::-1]
    grid = np.arange(loads.shape[1]) / loads.shape[1]
    channels = tuple(
        Channel(f"load {name}", "normal_load", np.interp(phase % 1.0, grid, row, period=1.0), tooth_pair=name)
        for name, row in zip("AB", rows, strict=False)
    )
    problem = Problem.of(pair, replace(curves, channels=(*curves.channels, *channels)), motion)
    ladder = climbed(problem, shared, "unlike", "places of tooth pairs")
    assert [(step.name, step.factor) for step in ladder.steps] == [("places of tooth pairs", label)]


def test_transmission_error_with_a_dead_zone_about_zero(pairs, shared):
    """delta is larger by half of the backlash, and nothing else changes."""
    pair = pairs["unlike"].with_({"mesh.backlash": "30 um"})
    motion = lumped_motion(pair)
    curves = changed(sampled(motion), ("dte",), lambda v: v + 15e-6)
    ladder = climbed(Problem.of(pair, curves, motion), shared, "backlash", "zero of a channel")
    assert [step.factor for step in ladder.steps] == ["dte: half of the backlash"]


@pytest.mark.parametrize("words", ["times are a thousandth", "times are angles of the pinion in radians"])
def test_time_axis(words, pairs, shared):
    pair = pairs["unlike"]
    factor = pair.operating.pinion_speed if "angles" in words else 1e3
    motion = lumped_motion(pair)
    curves = sampled(motion)
    per_second = factor if "angles" in words else 1.0 / factor
    problem = Problem.of(pair, replace(curves, places=per_second * curves.places), motion)
    ladder = climbed(problem, shared, "unlike", "time axis")
    assert [step.name for step in ladder.steps] == ["time axis"]
    assert ladder.steps[0].factor == pytest.approx(per_second, rel=1e-3)
    assert words in ladder.steps[0].sentence


def test_all_bearing_forces_without_their_dampers(pairs, shared):
    """One mistake in several channels is one step."""
    pair = pairs["unlike"].with_({"bearings.damping_ratio": 0.3})
    motion = lumped_motion(pair)
    bearings = {"p": pair.bearings.pinion, "g": pair.bearings.gear}
    curves = sampled(motion, ("dte", "x_p", "x_g", "bearing_force_x_p", "bearing_force_x_g"))
    values = {channel.name: channel.values for channel in curves.channels}
    for gear, bearing in bearings.items():
        springs = -bearing.loa_stiffness * values[f"x_{gear}"]
        curves = changed(curves, (f"bearing_force_x_{gear}",), lambda v, springs=springs: springs)
    ladder = climbed(Problem.of(pair, curves, motion), shared, "unlike", "another quantity")
    assert [step.name for step in ladder.steps] == ["another quantity"]
    assert "damper in the channels bearing_force_x_p, bearing_force_x_g" in ladder.steps[0].sentence


def test_speed_of_the_other_gear(pairs, shared):
    pair = pairs["unlike"]
    speed = pair.operating.pinion_speed * 30.0 / np.pi * 29 / 47
    other = lumped_motion(pair.with_({"operating.pinion_speed": speed}))
    problem = Problem.of(pair, sampled(other, cycles=6), lumped_motion(pair))
    ladder = climbed(problem, shared, "unlike", "speed of the curves")
    assert [step.name for step in ladder.steps] == ["speed of the curves"]
    assert ladder.steps[0].factor == pytest.approx(29 / 47, rel=1e-3)


def test_circular_pitch_in_the_mesh_period(pairs, shared):
    """Mesh cycles of p_t = pi m last longer by 1/cos(alpha); a pair touches as long as before."""
    pair = pairs["unlike"]
    g = pair.geometry
    cosine = np.cos(g.operating_pressure_angle)
    speed = pair.operating.pinion_speed * 30.0 / np.pi * cosine
    less = g.contact_ratio * (1.0 - cosine)
    before = (g.L_XP - g.L_XA) / (g.L_XD - g.L_XA)
    ends = 0.25 + 0.75 / (g.contact_ratio - less)  # ISO 6336-1, by the mistaken contact ratio
    slower = pair.with_({"operating.pinion_speed": speed, "mesh.stiffness.end_ratio": ends})
    other = motion_of(slower, Physics(path_start=before * less, path_end=-(1.0 - before) * less), None)
    problem = Problem.of(pair, sampled(other, cycles=5, per_cycle=101), lumped_motion(pair))
    assert problem.frequency.factor == pytest.approx(cosine, rel=1e-6)
    ladder = climbed(problem, shared, "unlike", "speed of the curves")
    assert [step.factor for step in ladder.steps] == ["circular pitch, about the pitch point"]
    assert ladder.steps[0].misfit < 0.05 * LIMIT


def test_all_forces_over_the_pitch_radius(pairs, shared):
    """F_t = T/r is F cos(alpha), with the force F along the line of action."""
    pair = pairs["unlike"]
    motion = lumped_motion(pair)
    names = ("mesh_force", "bearing_force_x_p", "bearing_force_y_p")
    cosine = np.cos(pair.geometry.operating_pressure_angle)
    curves = changed(sampled(motion, ("dte", *names)), names, lambda v: cosine * v)
    ladder = climbed(Problem.of(pair, curves, motion), shared, "unlike", "radius of a channel")
    assert [step.factor for step in ladder.steps] == ["all forces: a force over the pitch radius"]


def test_speed_of_curves_over_mesh_cycles(pairs, shared):
    pair = pairs["unlike"]
    speed = pair.operating.pinion_speed * 30.0 / np.pi
    other = lumped_motion(pair.with_({"operating.pinion_speed": 1.2 * speed}))
    curves = sampled(other)
    curves = replace(curves, abscissa="mesh_cycles", places=curves.places / other.pair.geometry.mesh_period)
    ladder = climbed(Problem.of(pair, curves, lumped_motion(pair)), shared, "unlike", "speed")
    # All masses times 1.44 make the same displacements: the dynamics are similar.
    assert says(ladder, "speed")


def test_wrong_phase(pairs, shared):
    motion = lumped_motion(pairs["unlike"])
    problem = Problem.of(pairs["unlike"], sampled(motion), motion, 0.1)
    assert says(climbed(problem, shared, "unlike", "wrong phase"), "wrong phase")


def test_half_the_step(pairs, shared):
    pair = pairs["unlike"]
    motion = lumped_motion(pair)
    coarse = changed(sampled(motion), ("dte", "y_g"), lambda v: v + 0.2 * np.roll(v, 40))
    problem = Problem.of(pair, coarse, motion, None, sampled(motion))
    assert says(climbed(problem, shared, "unlike", "step too long"), "step too long")


def test_not_settled(pairs, shared):
    pair = pairs["unlike"]
    run = lumped.simulate(pair, cycles=8, samples_per_cycle=421, initial="static")
    values = {name: run[name].to_numpy() for name in ("dte", "x_p", "y_p", "bearing_force_x_p")}
    channels = tuple(Channel(name, name, row) for name, row in values.items())
    curves = Curves("other", "time", run["time"].to_numpy(), channels)
    problem = Problem.of(pair, curves, lumped_motion(pair))
    assert problem.misfit.value > 0.01
    ladder = climb(
        problem,
        limit=problem.misfit.value / 2.0,
        budget=600.0,
        motions=shared.setdefault("unlike", {}),
        most_motions=100,
        causes=rivals("not settled", problem),
    )
    assert ladder.steps[0].name == "not settled"
    assert ladder.steps[0].misfit < 0.3 * problem.misfit.value


def test_the_page_has_the_registry():
    rows = re.findall(r"^\| (.+?) \| (.+?) \| (.+?) \|$", PAGE.read_text(encoding="utf-8"), re.M)
    table = {name: (meaning, span) for name, meaning, span in rows}
    for cause in EXPLANATIONS.values():
        assert table.get(cause.name) == (cause.meaning, cause.span), cause.name


def test_sentences_say_compatible(pairs):
    pair = pairs["unlike"]
    motion = lumped_motion(pair)
    problem = Problem.of(pair, sampled(motion), motion)
    for cause in EXPLANATIONS.values():
        for choice in cause.choices(problem, Variant(pair)):
            assert " is " not in choice.words
