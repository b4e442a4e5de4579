"""Does a check that runs hold both models to a stiffness of the whole mesh, and catch what adds to it?

It is load over transmission error by definition: docs/theory/mesh_physics.md, "Stiffness of the whole mesh".
"""

from dataclasses import replace

import numpy as np
import pytest

import validation.cross_check.conservation as laws
from lumped.quasi_static import transmission_error
from multibody.contact.machine import machine
from tests.unlike_pairs import UNLIKE, unlike_pair
from validation.cross_check.comparison import crosscheck
from validation.cross_check.verdict import Verdict

LAW = "conservation: load over stiffness of the whole mesh, "


def wave(phase):
    """Stiffness over a mesh cycle [N/m], without symmetry."""
    return 3e8 * (1.0 + 0.2 * np.cos(2 * np.pi * phase) + 0.1 * np.sin(4 * np.pi * phase))


def whole(name, stiffness=wave):
    return unlike_pair(name).healthy.with_({"mesh.contact": None, "mesh.relief": None}, stiffness=stiffness)


def judged(pair, numbers=None):
    """Model -> the judgement of its load over stiffness."""
    judgements = laws._load_over_stiffness(pair, machine(pair) if numbers is None else numbers)
    return {one.check.removeprefix(LAW): one for one in judgements}


@pytest.mark.parametrize("name", UNLIKE)
@pytest.mark.parametrize("stiffness", [2.3e8, wave], ids=["constant", "curve"])
def test_both_models_give_the_stiffness_back(name, stiffness):
    judgements = judged(whole(name, stiffness))
    assert set(judgements) == {"lumped", "exact"}
    assert all(one.within for one in judgements.values())


def test_the_stiffness_factor_is_part_of_it():
    assert all(one.within for one in judged(whole(UNLIKE[0]).with_(mesh__stiffness_factor=1.3)).values())


def test_a_curve_of_one_tooth_pair_has_no_such_law():
    assert judged(unlike_pair("rack_25_degrees_always_pushing").healthy) == {}


def test_contact_beyond_the_curve_is_caught(monkeypatch):
    pair = whole("rack_25_degrees_always_pushing")
    monkeypatch.setattr(transmission_error, "_extended", lambda pair, extended: True)
    judgements = judged(pair)
    assert not judgements["lumped"].within
    assert judgements["exact"].within


def test_relief_that_counts_twice_is_caught(monkeypatch):
    pair = whole("heavily_relieved_under_load")
    error = transmission_error.corner_gap
    monkeypatch.setattr(
        transmission_error,
        "corner_gap",
        lambda g, xi: error(g, xi) + transmission_error.relief_error(pair, xi),
    )
    assert not judged(pair)["lumped"].within


@pytest.mark.parametrize("fault", ["soft", "late", "one pair"])
def test_another_stiffness_of_the_second_model_is_caught(fault):
    pair = whole("contact_ratio_2_3_on_shafts")
    right = machine(pair)
    wrong = replace(right, packed=right.packed.copy(), pairs=1 if fault == "one pair" else right.pairs)
    table = wrong.stiffness_table  # a view of the packed numbers
    if fault == "soft":
        table[:, 2:] *= 1.0 - 1e-6
    elif fault == "late":
        table[:, :2] += 1e-7
    judgements = judged(pair, wrong)
    assert judgements["lumped"].within
    assert not judgements["exact"].within


@pytest.mark.parametrize("stiffness", [2.3e8, wave], ids=["constant", "curve"])
def test_both_models_agree_on_the_motion(stiffness):
    """Without friction nothing but the stiffness acts: a constant one leaves no vibration and no loss."""
    pair = whole("rack_25_degrees_always_pushing", stiffness).with_(friction__law="none")
    result = crosscheck(pair, cycles=6, samples_per_cycle=64, variant=False, supports="springs")
    assert result.verdict is Verdict.AGREES, [*result.failures, result.worst("exact")]
    assert sum(one.check.startswith(LAW) for one in result.judgements) == 2
