"""Does the cross-check see wrong geometry, and what only unlike bearings show? Sound pairs keep the laws."""

import dataclasses

import lumped
from lumped.model import periodic_system
from validation.cross_check.comparison import crosscheck
from validation.cross_check.variant import asymmetric_variant
from validation.cross_check.verdict import Verdict

QUICK = {"cycles": 6, "samples_per_cycle": 64}


def _swapped(s):
    order = [0, 1, 3, 2, 5, 4]
    return dataclasses.replace(s, stiffness=s.stiffness[order], damping=s.damping[order])


def test_what_symmetry_hides_is_seen_by_the_asymmetric_variant(pair, monkeypatch):
    """The default pair has equal bearings: swapped ones change nothing but in the variant."""
    true = periodic_system.structure
    monkeypatch.setattr(periodic_system, "structure", lambda *a, **k: _swapped(true(*a, **k)))
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
    assert float(check.lumped["friction_power"].max()) > 0.0
    [taken] = [j for j in check.conservation if j.check == "conservation: friction takes power, lumped"]
    assert taken.within


def test_a_variant_that_loses_contact_is_not_taken(pair):
    slow = pair.with_({"operating.pinion_torque": 5.0, "operating.pinion_speed": 8500.0})
    found = asymmetric_variant(slow)
    assert (
        found is None or float(lumped.steady_state(found, samples_per_cycle=64)["normal_load"].min()) >= 0.0
    )
