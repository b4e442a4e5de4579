"""Faults put into the lumped model at run time: the cross-check fails."""

import dataclasses

import numpy as np
import pytest

import lumped
from lumped.model import periodic_system
from lumped.path_function import PathFunction
from lumped.quasi_static import prescribed
from validation.cross_check.comparison import crosscheck
from validation.cross_check.conservation import fed_back
from validation.cross_check.variant import asymmetric_variant
from validation.cross_check.verdict import Verdict

QUICK = {"cycles": 6, "samples_per_cycle": 64}


def scaled(law: PathFunction, factor: float) -> PathFunction:
    return PathFunction(law.breaks, factor * law.coefficients, law.switches)


def friction(factor):
    true = prescribed.friction_path_function
    return lambda m: m.setattr(prescribed, "friction_path_function", lambda pair: scaled(true(pair), factor))


def structure(change):
    """A change of the constants of the equations of motion: (structure) -> structure."""
    true = periodic_system.structure
    return lambda m: m.setattr(periodic_system, "structure", lambda *a, **k: change(true(*a, **k)))


def _swapped(s):
    order = [0, 1, 3, 2, 5, 4]
    return dataclasses.replace(s, stiffness=s.stiffness[order], damping=s.damping[order])


def _wrong_arm(s):
    arm = s.friction_arm.copy()
    arm[1, 0] *= 0.97
    return dataclasses.replace(s, friction_arm=arm)


def _light(s):
    return dataclasses.replace(s, mass=s.mass / np.pi)


def damping_doubled(m):
    true = prescribed.Prescribed.elements

    def doubled(form, pair):
        elements = true(form, pair)
        return dataclasses.replace(elements, damping=scaled(elements.damping, 2.0))

    m.setattr(prescribed.Prescribed, "elements", doubled)


FAULTS = {
    "friction reversed": friction(-1.0), "friction doubled": friction(2.0),
    "bearings swapped": structure(_swapped), "wrong moment arm": structure(_wrong_arm),
    "masses over pi": structure(_light), "damping doubled": damping_doubled,
}  # fmt: skip
#: The conservation law that must see each fault without any help of the comparison of histories.
BY_LAW = {
    "friction reversed": "conservation: friction takes power, lumped",
    "bearings swapped": "conservation: mean bearing load x_p, lumped",
    "wrong moment arm": "conservation: first law, lumped",
    "masses over pi": "conservation: action and reaction y, lumped",
    "damping doubled": "conservation: power mesh_damping, linear",
    "friction doubled": "conservation: power friction, linear",
}


@pytest.fixture(scope="module")
def unlike(pair):
    return asymmetric_variant(pair)


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_fails_and_a_conservation_law_names_it(unlike, monkeypatch, fault):
    FAULTS[fault](monkeypatch)
    found = crosscheck(unlike, **QUICK, variant=False)
    assert found.verdict is Verdict.FAILS
    failed = {failure.check for failure in found.failures}
    assert BY_LAW[fault] in failed, failed
    assert any(check.startswith("same equations: ") for check in failed)


def test_a_pitch_point_from_the_wrong_pressure_angle_fails(unlike):
    g = lumped.geometry(unlike)
    wrong = unlike.with_({})
    wrong.__dict__["geometry"] = dataclasses.replace(g, L_XP=g.L_XP * np.tan(0.9) / np.tan(0.85))
    found = crosscheck(wrong, **QUICK, variant=False)
    failed = {failure.check for failure in found.failures}
    assert "conservation: friction takes power, lumped" in failed
    assert "same equations: y_p" in failed


def test_what_symmetry_hides_is_seen_by_the_asymmetric_variant(pair, monkeypatch):
    """The default pair has equal bearings: swapped ones change nothing but in the variant."""
    FAULTS["bearings swapped"](monkeypatch)
    found = crosscheck(pair, **QUICK)
    assert found.verdict is Verdict.FAILS
    assert all(failure.check.startswith("variant: ") for failure in found.failures)


def test_a_sound_pair_and_its_variant_obey_the_conservation_laws(check):
    assert check.failures == ()
    assert check.variant is not None
    for found in (check, check.variant):
        checks = [j.check for j in found.conservation]
        assert len(set(checks)) == len(checks) > 25
    pinion, gear = check.variant.pair.bearings.pinion, check.variant.pair.bearings.gear
    values = [getattr(b, f"{axis}_stiffness") for b in (pinion, gear) for axis in ("loa", "oloa")]
    assert len(set(values)) == 4
    assert check.variant.pair.pinion.teeth != check.variant.pair.gear.teeth


def test_vibration_that_reverses_sliding_is_no_wrong_sign(check):
    """The lumped friction feeds power in where vibration turns the sliding: a limit of validity, stated."""
    assert 0.0 < fed_back(check.lumped) < 1e-2
    [taken] = [j for j in check.conservation if j.check == "conservation: friction takes power, lumped"]
    assert taken.within


def test_the_first_law_holds_with_the_source_of_the_contact_counted(check):
    """The change of stiffness along the path feeds energy in; without it the balance would not close."""
    own = check.powers["lumped"]
    assert own["mesh_stiffness"] < 0.0
    [law] = [j for j in check.conservation if j.check == "conservation: first law, lumped"]
    assert law.value < 1e-10
    assert abs(own["mesh_stiffness"]) > 1e3 * law.limit * own["driving"]


def test_a_variant_that_loses_contact_is_not_taken(pair):
    slow = pair.with_({"operating.pinion_torque": 5.0, "operating.pinion_speed": 8500.0})
    found = asymmetric_variant(slow)
    assert (
        found is None or float(lumped.steady_state(found, samples_per_cycle=64)["normal_load"].min()) >= 0.0
    )
