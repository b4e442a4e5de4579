"""Does the cross-check see a fault in errors of teeth, eccentricity, faults or ripples that one model has?

Each fault of ``faults_of_own_teeth.toml`` is put into the program alone: into the road of the lumped model,
or into the road of the multibody model. Before the multibody model read the schema by its own formulas,
faults of the lumped road changed both models alike, and the cross-check agreed.

Under a fault in one model the motion of the other one is that without the fault: the lumped model does not
import ``multibody`` (tests/meta/test_architecture.py), and under a fault in the lumped model the numbers of
the multibody model are compared with those without the fault.
"""

import dataclasses
import tomllib
import warnings
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr

import lumped
from lumped.typing import FloatArray
from multibody.contact.machine import machine
from tests.evidence.faults.fault import Fault
from tests.evidence.faults.rewriting import applied
from tests.unlike_pairs import unlike_pair
from validation.cross_check import comparison, own_teeth
from validation.cross_check.comparison import CrossCheck
from validation.cross_check.verdict import Verdict

_ROWS = tomllib.loads(Path(__file__).with_name("faults_of_own_teeth.toml").read_text(encoding="utf-8"))
PAIR_OF = {key: row.pop("pair") for key, row in _ROWS.items()}
FAULTS = {key: Fault(key, **row) for key, row in _ROWS.items()}

#: Index deviations of 20 teeth with a first harmonic of some 12 um and steps of some 6 um [um].
INDEX = [
    10.2,
    15.8,
    4.4,
    12.8,
    1.6,
    6.6,
    -8.0,
    -2.4,
    -15.0,
    -6.2,
    -17.6,
    -8.4,
    -12.0,
    0.8,
    -7.8,
    5.4,
    8.8,
    0.2,
    13.2,
    3.4,
]
#: Profile slope deviations of 30 teeth [um].
SLOPES = [9.0, -6.0, 4.0, -8.0, 7.0] * 6

#: Friction at each pair turns a little earlier or later in the two models: the whole jump is a difference.
FRICTIONLESS = {"friction.law": "coulomb", "friction.coefficient": 0.0}
#: What is unlike in the teeth, beside tooth numbers, reliefs, widths and bearings.
PAIRS = {
    "deviations": {
        "mesh.first_teeth": [4, 9],
        "pinion.inertia": 0.05,
        "gear.inertia": 0.09,
        "pinion.deviations": {"index": INDEX, "counted": "against"},
        "gear.deviations": {"tolerance_class": 7, "seed": 5},
    },
    "mounting": {
        "mesh.first_teeth": [4, 9],
        "pinion.inertia": 0.05,
        "gear.inertia": 0.09,
        "pinion.deviations": {"tolerance_class": 5, "seed": 2, "first_order": "steps"},
        "gear.deviations": {"profile_slope": SLOPES, "first_order": "steps"},
        "pinion.mounting": {"eccentricity": 14, "phase": 70},
        "gear.mounting": {"eccentricity": 11, "phase": 200},
        "pinion.faults": [{"kind": "crack", "tooth": 7, "depth": 2.5}],
        "gear.faults": [
            {"kind": "spall", "tooth": 15, "start_roll_angle": 22, "end_roll_angle": 25, "width": 14}
        ],
        "operating.torque_ripple": [{"shaft": "gear", "order": 5, "amplitude": 150, "phase": 50}],
    },
}


#: Middle of the compared mesh cycles of each pair: those of "mounting" have its crack and its spall.
MIDDLE = {"deviations": 3, "mounting": 4}


class Sound(NamedTuple):
    """What the sound program computes for a pair of ``PAIRS``."""

    check: CrossCheck
    lumped: xr.Dataset
    multibody: xr.Dataset
    numbers: tuple[FloatArray, ...]  # all that the multibody model knows of the pair


def numbers_of(pair) -> tuple[FloatArray, ...]:
    """Everything that the multibody model reads of a pair, as arrays."""
    made = machine(pair)
    values = [getattr(made, one.name) for one in dataclasses.fields(made)]
    arrays = [np.asarray(value) for value in values if value is not None]
    return tuple(np.frombuffer(one.tobytes(), np.uint8) for one in arrays)


def checked(name, lumped_motion, multibody_motion):
    """Cross-check of a pair of ``PAIRS`` over 6 mesh cycles, by these functions for the two motions.

    The twin with like teeth, which no fault reaches, is computed once.
    """
    pair = unlike_pair("unlike_teeth_finite_elements").with_(FRICTIONLESS | PAIRS[name])
    with pytest.MonkeyPatch.context() as patch, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        patch.setattr(comparison, "_compared", twin(name))
        patch.setattr(own_teeth, "_WHOLE", 8)
        patch.setattr(own_teeth, "worst_cycle", lambda pair: MIDDLE[name])
        patch.setattr(own_teeth, "lumped", SimpleNamespace(steady_state=lumped_motion))
        patch.setattr(own_teeth, "at_mean_speed", multibody_motion)
        return comparison.crosscheck(
            pair, cycles=6, samples_per_cycle=32, fidelities=["exact"], variant=False, supports="springs"
        )


@cache
def twin(name):
    """Function in the place of ``comparison._compared``: it computes once, before a fault is in."""
    compare = comparison._compared
    results = []

    def compared(*arguments):
        if not results:
            results.append(compare(*arguments))
        return results[0]

    return compared


@cache
def sound(name) -> Sound:
    """The cross-check of a pair without a fault, both motions, and the numbers of the multibody model."""
    motion, run = lumped.steady_state, own_teeth.at_mean_speed
    found = {}

    def lumped_motion(pair, **options):
        return found.setdefault("lumped", motion(pair, **options))

    def multibody_motion(pair, *arguments):
        found["numbers"] = numbers_of(pair)
        return found.setdefault("multibody", run(pair, *arguments))

    return Sound(check=checked(name, lumped_motion, multibody_motion), **found)


def verdict_with(fault, name):
    """The verdict with a fault in one of the models, whose motion alone is computed again."""
    known = sound(name)
    motion, run = lumped.steady_state, own_teeth.at_mean_speed
    in_lumped = fault.target.startswith("lumped.")

    def multibody_motion(pair, *arguments):
        if not in_lumped:
            return run(pair, *arguments)
        for one, other in zip(numbers_of(pair), known.numbers, strict=True):
            np.testing.assert_array_equal(one, other, "the fault changes both models")
        return known.multibody

    with applied(fault):
        sound_motion = lambda pair, **options: known.lumped  # noqa: E731
        return checked(name, motion if in_lumped else sound_motion, multibody_motion).verdict


@pytest.mark.parametrize("name", PAIRS)
def test_sound_models_agree(name):
    check = sound(name).check
    assert check.verdict is Verdict.AGREES, [(a.quantity, a.difference) for a in check.of("exact")]


@pytest.mark.parametrize("key", FAULTS)
def test_a_fault_in_one_model_makes_them_differ(key):
    assert verdict_with(FAULTS[key], PAIR_OF[key]) is Verdict.DIFFERS
