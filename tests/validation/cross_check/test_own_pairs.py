"""Random pairs as ``spurcheck init --teeth`` makes them that were refused once, each with what was wrong."""

import tomllib

import numpy as np
import pytest

import lumped
import multibody
from validation.cross_check.comparison import crosscheck
from validation.cross_check.motions import unilateral_orbit
from validation.cross_check.variant import asymmetric_variant
from validation.exchange.new_pair_file import new_pair_text


def own(teeth, module, width, speed, torque, **more):
    given = {
        "teeth": teeth, "mesh.stiffness.model": "rectangular", "basic_rack.module": module,
        "gears.face_width": width, "operating.pinion_speed": speed, "operating.pinion_torque": torque,
    }  # fmt: skip
    pair = lumped.load_gear_pair(tomllib.loads(new_pair_text("own", given)))
    return pair.with_({name.replace("__", "."): value for name, value in more.items()})


def bearings(*stiffness):
    """Stiffness of pinion and gear, along and off the line of action, [1e8 N/m]."""
    places = ("pinion__loa", "pinion__oloa", "gear__loa", "gear__oloa")
    return {f"bearings__{p}_stiffness": 1e8 * k for p, k in zip(places, stiffness, strict=True)}


def relief(amount, pinion, gear):
    shape = {"shape": "linear", "amount": amount}
    return {
        "pinion__tip_relief": shape | {"start_roll_angle": pinion},
        "gear__tip_relief": shape | {"start_roll_angle": gear},
        "mesh__relief": "static",
    }


SLOW = own(
    "48/84", 0.8, 11.9, 549.1, 29.4, friction__law="II", mesh__stiffness__model="energy",
    mesh__contact="prescribed", mesh__damping_ratio=0.06, **bearings(0.737, 16.6, 1.31, 8.0),
)  # fmt: skip


def test_a_motion_small_beside_its_deflection_is_integrated_more_tightly():
    """Far above the resonances y moves by 1/6000 of the deflection, by which the integrators' errors go."""
    pair = own(
        "81/84", 2.0, 21.6, 11586.9, 1320.0, pinion__profile_shift=0.305, gear__profile_shift=-0.102,
        mesh__contact="prescribed", lubricant__viscosity=12.0,
    )  # fmt: skip
    found = crosscheck(pair, cycles=6, samples_per_cycle=64, variant=False)
    assert found.failures == ()
    settings = found.multibody["linear"].attrs["settings"]
    assert float(settings.partition("rtol=")[2].partition(",")[0]) < 1e-10


def test_sixty_swings_in_a_cycle_are_seen_at_more_times_than_asked_for():
    pair = own(
        "20/44", 1.0, 4.6, 1591.0, 2.03, pinion__profile_shift=0.225, gear__profile_shift=0.243,
        friction__law="none", mesh__stiffness__model="parabolic", **relief(4.43, 29.922, 26.027),
    )  # fmt: skip
    found = crosscheck(asymmetric_variant(pair), cycles=6, samples_per_cycle=64, variant=False)
    assert found.failures == ()
    assert found.lumped.sizes["time"] == found.multibody["exact"].sizes["time"] == 6 * 64 + 1


def test_the_error_of_the_momentum_is_not_told_by_four_samples_in_a_swing():
    """64 samples of 7.5 swings, and half of them, missed the impulse of the bearings alike: 2e-5."""
    pair = own(
        "12/30", 8.0, 65.7, 3863.4, 251.0, pinion__profile_shift=0.318, gear__profile_shift=0.15,
        friction__law="none", mesh__stiffness__model="parabolic", mesh__damping_ratio=0.061,
    )  # fmt: skip
    found = crosscheck(asymmetric_variant(pair), cycles=6, samples_per_cycle=64, variant=False)
    assert found.failures == ()


def test_no_tooth_enters_unseen_where_friction_holds_the_teeth():
    """Turns of the sliding used up the events: the energy of a tooth that enters was in no account."""
    balance = multibody.power_balance(
        SLOW, 1, initial="periodic", effects={"clearance": False}, friction_velocity=1e-4
    )
    assert balance.mesh_jump > 1e-4 * balance.driving
    assert abs(balance.residual) < 1e-7 * balance.driving


def test_backs_that_strike_are_named_as_the_reason_why_a_pulling_motion_is_compared():
    wide = own(
        "52/90", 2.5, 27.3, 797.6, 69.2, pinion__profile_shift=0.391, gear__profile_shift=0.185,
        friction__law="V", mesh__contact="prescribed",
    )  # fmt: skip
    orbit, pulling = unilateral_orbit(wide)
    assert orbit is not None
    assert pulling == ""
    orbit, pulling = unilateral_orbit(wide.with_({"mesh.backlash": 0.0}))
    assert orbit is None
    assert "the backs of the teeth strike" in pulling


def test_a_small_swing_of_a_centre_is_no_difference_of_the_models():
    """Order 3 stands on the gear's natural frequency: 1.5 N of 520 N are 15 % of a swing of 2.3 um."""
    pair = own("19/41", 2.5, 20.0, 1450.0, 80.0, centre_distance=76.0, mesh__stiffness__model="energy")
    found = crosscheck(pair, cycles=6, samples_per_cycle=128, variant=False)
    gear = next(a for a in found.of("exact") if a.quantity == "x_g")
    swing = float(np.ptp(found.lumped["dte"].to_numpy()))
    assert gear.within
    # Off the line of action the corner that touches beyond A presses along the flank, in one model only.
    assert {a.quantity for a in found.of("exact") if not a.within} <= {"y_p", "y_g"}
    assert gear.scale == pytest.approx(swing, rel=0.02)  # sampled at more times than are kept
    assert gear.difference * gear.scale / gear.peak_to_peak > 0.1
