"""Does the cross-check see a fault in errors of teeth, eccentricity, faults or ripples that one model has?

Each fault of ``faults_of_own_teeth.toml`` is put into the program alone: into the road of the lumped model,
or into the road of the multibody model. Before the multibody model read the schema by its own formulas,
faults of the lumped road changed both models alike, and the cross-check agreed.
"""

import tomllib
import warnings
from functools import cache
from pathlib import Path

import pytest

from tests.evidence.faults.fault import Fault
from tests.evidence.faults.rewriting import applied
from tests.unlike_pairs import unlike_pair
from validation.cross_check import comparison
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


def checked(name):
    """Cross-check of a pair of ``PAIRS``; its twin with like teeth, which no fault reaches, once."""
    pair = unlike_pair("unlike_teeth_finite_elements").with_(FRICTIONLESS | PAIRS[name])
    with pytest.MonkeyPatch.context() as patch, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        patch.setattr(comparison, "_compared", twin(name))
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
def sound(name):
    """Cross-check of a pair without a fault, computed once; its twin is then known too."""
    return checked(name)


@pytest.mark.parametrize("name", PAIRS)
def test_sound_models_agree(name):
    check = sound(name)
    assert check.verdict is Verdict.AGREES, [(a.quantity, a.difference) for a in check.of("exact")]


@pytest.mark.parametrize("key", FAULTS)
def test_a_fault_in_one_model_makes_them_differ(key):
    sound(PAIR_OF[key])
    with applied(FAULTS[key]):
        assert checked(PAIR_OF[key]).verdict is Verdict.DIFFERS
