"""Sound pairs that an earlier limit refused: of none of them the cross-check fails."""

import tomllib

import numpy as np
import pytest

import lumped
import multibody
from tests.evidence.faults.sound import drawn
from validation.cross_check.agreement import agreement, off_switch_samples
from validation.cross_check.comparison import crosscheck
from validation.cross_check.motions import unilateral_orbit
from validation.cross_check.variant import asymmetric_variant
from validation.cross_check.verdict import limit_of
from validation.exchange.new_pair_file import new_pair_text


def bearings(*stiffness):
    """Stiffness of pinion and gear, along and off the line of action, [1e8 N/m]."""
    places = ("pinion.loa", "pinion.oloa", "gear.loa", "gear.oloa")
    return {f"bearings.{p}_stiffness": 1e8 * k for p, k in zip(places, stiffness, strict=True)}


def shifts(pinion, gear):
    return {"pinion.profile_shift": pinion, "gear.profile_shift": gear}


def gears(pinion, gear, *shift):
    named = {"pinion.teeth": pinion, "gear.teeth": gear, "centre_distance": None} | shifts(*shift)
    return named | {
        f"{g}.{key}": None for g in ("pinion", "gear") for key in ("tip_diameter", "addendum", "tip_relief")
    }


def running(speed, torque, law, viscosity=None):
    changes = {"operating.pinion_speed": speed, "operating.pinion_torque": torque, "friction.law": law}
    return changes if viscosity is None else changes | {"lubricant.viscosity": viscosity}


def stiffness(model, **more):
    return {"mesh.stiffness": {"model": model, **more}}


def relief(amount, pinion, gear):
    angles = {"pinion": pinion, "gear": gear}
    shapes = {
        f"{g}.tip_relief": {"shape": "linear", "amount": amount, "start_roll_angle": roll_angle}
        for g, roll_angle in angles.items()
    }
    return shapes | {"mesh.relief": "static"}


ENERGY = stiffness("energy")
RAMP = stiffness("parabolic", ramp_length=0.5)
LOADED = {"mesh.contact": "loaded"}
#: What was wrong -> preset and changes.
PAIRS = {
    "y a ten thousandth of x: its error of integration was judged by the size of x": (
        "nasa_28_28", gears(50, 41, 0.2448, 0.2364), bearings(2.63, 4.36, 0.51, 5.57), stiffness("energy"),
        running(8396, 77.7, "composite", 14.26)),
    "contact ratio 1.996: friction forces cancel but between two samples": (
        "high_contact_ratio_29_47", gears(25, 22, 0.07968, 0.1009), bearings(1.187, 0.589, 0.5595, 3.763),
        stiffness("rectangular"), running(4500, 62.92, "coulomb")),
    "law III: friction power that a constant displacement of the law does not change": (
        "nasa_28_28", bearings(4.12, 0.632, 6.27, 2.236), RAMP, running(6002, 33.87, "xu_kahraman", 33.5)),
    "the bearings carry a contact beyond the end of its nominal path": (
        "kahraman_blankenship_50_50", gears(50, 22, 0.08574, 0.2813), bearings(9.81, 0.912, 2.115, 7.394),
        stiffness("rectangular"), running(1165.6, 171.4, "composite", 20.84)),
    "loaded, without friction: y moves by corners and path work alone; a ramp ends without stiffness": (
        "high_contact_ratio_29_47", RAMP, LOADED, running(3071.6, 43.9, "none")),
    "loaded, a ramp: the damper's load pushes along the path only where there is relief": (
        "nasa_art_25_31", gears(46, 36, 0.26478, 0.18977), bearings(7.576, 0.7392, 2.381, 3.059), RAMP,
        LOADED, running(3439.4, 56.96, "xu_kahraman", 35.25), {"mesh.damping_ratio": 0.098}),
    "every law is compared with the same equations: law IV": (
        "high_contact_ratio_29_47", stiffness("parabolic"), {"friction.law": "smoothed_coulomb"}),
    "friction holds the teeth": (
        "fzg_c", bearings(0.632, 0.627, 5.0, 9.14), stiffness("energy"),
        running(3618.6, 159.6, "benedict_kelley", 24.12)),
}  # fmt: skip


@pytest.mark.parametrize("name", PAIRS)
def test_a_sound_pair_is_not_refused(name):
    preset, *changes = PAIRS[name]
    pair = lumped.load_gear_pair(preset).with_(
        {"mesh.relief": "ignored"} | {key: value for one in changes for key, value in one.items()}
    )
    assert crosscheck(pair, cycles=6, samples_per_cycle=128, variant=False).failures == ()


@pytest.mark.parametrize(
    ("seed", "number", "cycles"),
    [("g.9", 0, 40), ("final.7", 5, 8)],
    ids=["a periodic solution that the motion forgets", "half of the samples miss as much as all"],
)
def test_a_drawn_sound_pair_is_not_refused(seed, number, cycles):
    pair = list(drawn(number + 1, seed))[number]
    assert crosscheck(pair, cycles=cycles, samples_per_cycle=128, variant=False).failures == ()


def test_the_variant_of_a_pair_with_a_change_of_regime_is_not_refused():
    *_, last = drawn(19, "final.8")
    pair = asymmetric_variant(last)
    assert crosscheck(pair, cycles=6, samples_per_cycle=64, variant=False).failures == ()


def own(teeth, module, width, speed, torque, *more):
    """A pair as ``spurcheck init --teeth`` makes it, on equal springs, without friction at C."""
    sizes = {
        "teeth": teeth, "mesh.stiffness.model": "rectangular", "basic_rack.module": module,
        "gears.face_width": width, "operating.pinion_speed": speed, "operating.pinion_torque": torque,
        "bearings.stiffness": 1e8, "friction.law": "xu_kahraman",
    }  # fmt: skip
    pair = lumped.load_gear_pair(tomllib.loads(new_pair_text("own", sizes)))
    return pair.with_({key: value for one in more for key, value in one.items()})


def test_a_motion_small_beside_its_deflection_is_integrated_more_tightly():
    """Far above the resonances y moves by 1/6000 of the deflection, by which the integrators' errors go."""
    changes = shifts(0.305, -0.102) | {"mesh.contact": "prescribed", "lubricant.viscosity": 12.0}
    result = crosscheck(
        own("81/84", 2.0, 21.6, 11586.9, 1320.0, changes), cycles=6, samples_per_cycle=64, variant=False
    )
    assert result.failures == ()
    settings = result.multibody["linear"].attrs["settings"]
    _, _, after_rtol = settings.partition("rtol=")
    assert float(after_rtol.partition(",")[0]) < 1e-10


FREE = {"friction.law": "none", "mesh.stiffness.model": "parabolic"}


@pytest.mark.parametrize("pair", [
    # Sixty swings in a cycle are seen at more times than asked for.
    own("20/44", 1.0, 4.6, 1591.0, 2.03, shifts(0.225, 0.243), FREE, relief(4.43, 29.922, 26.027)),
    # 64 samples of 7.5 swings, and half of them, missed the impulse of the bearings alike: 2e-5.
    own("12/30", 8.0, 65.7, 3863.4, 251.0, shifts(0.318, 0.15), FREE, {"mesh.damping_ratio": 0.061}),
    # Teeth change in the last of 63 steps, which the quadrature by half of the samples did not reach.
    own("26/90", 6.0, 66.0, 3020.0, 155.0, ENERGY),
], ids=["sixty swings in a cycle", "momentum by few samples", "a change in the last step"])  # fmt: skip
def test_a_variant_with_fast_swings_is_not_refused(pair):
    result = crosscheck(asymmetric_variant(pair), cycles=6, samples_per_cycle=64, variant=False)
    assert result.failures == ()
    assert result.lumped.sizes["time"] == result.multibody["exact"].sizes["time"] == 6 * 64 + 1


def test_no_tooth_enters_unseen_where_friction_holds_the_teeth():
    """Turns of the sliding used up the events: the energy of a tooth that enters was in no account."""
    more = {"friction.law": "II", "mesh.contact": "prescribed", "mesh.damping_ratio": 0.06}
    balance = multibody.power_balance(
        own("48/84", 0.8, 11.9, 549.1, 29.4, more, stiffness("energy"), bearings(0.737, 16.6, 1.31, 8.0)),
        1,
        initial="periodic",
        effects={"clearance": False},
        friction_velocity=1e-4,
    )
    assert balance.mesh_jump > 1e-4 * balance.driving
    assert abs(balance.residual) < 1e-7 * balance.driving


def test_backs_that_strike_are_named_as_the_reason_why_a_pulling_motion_is_compared():
    more = shifts(0.391, 0.185) | {"friction.law": "V", "mesh.contact": "prescribed"}
    more |= {"pinion.tip_alteration": 0.0, "gear.tip_alteration": 0.0}  # at its full contact ratio it pulls
    with_backlash = own("52/90", 2.5, 27.3, 797.6, 69.2, more)
    orbit, pulling = unilateral_orbit(with_backlash)
    assert orbit is not None
    assert pulling == ""
    orbit, pulling = unilateral_orbit(with_backlash.with_({"mesh.backlash": 0.0}))
    assert orbit is None
    assert "the backs of the teeth strike" in pulling


@pytest.mark.parametrize(("pair", "quantity", "share"), [
    # Order 3 stands near the gear's natural frequency: .27 um of 36 um are 9 % of a swing of 2.9 um.
    (
        own("19/41", 2.5, 20.0, 1450.0, 80.0, ENERGY, shifts(0.0, 0.0) | {"centre_distance": 75.65}),
        "x_g",
        0.09,
    ),
    # Above resonance: 0.1 N, 1 % of the mean force, are 28 % of the swing of the bearing's force.
    (own("31/57", 3.0, 25.0, 12000.0, 150.0, ENERGY), "y_g", 0.25),
    (own("31/57", 3.0, 25.0, 12000.0, 150.0, ENERGY, {"friction.law": "none"}), "y_g", 0.15),
    # Slow: the load swings by 2 % of itself.
    (own("39/108", 1.5, 9.7, 497.0, 23.86, ENERGY), "normal_load", 0.1),
], ids=["x", "y", "y of corners", "load"])  # fmt: skip
def test_a_small_swing_is_no_difference_of_the_models(pair, quantity, share):
    """The difference is large over the swing of the quantity, and small over the scale of the cross-check."""
    result = crosscheck(pair, cycles=6, samples_per_cycle=128, variant=False)
    motions = [m.isel(time=slice(-129, None)) for m in (result.multibody["exact"], result.lumped)]
    keep = off_switch_samples(pair, motions[1]["time"].to_numpy(), 0.02)
    a, b = (np.atleast_2d(m[quantity].to_numpy()).sum(axis=0)[keep] for m in motions)
    assert np.abs(a - b).max() > share * np.ptp(b)
    assert result.verdict.word == "agrees"
    assert next(one for one in result.of("exact") if one.quantity == quantity).difference < 0.05
    # The same motion with another vibration off the line of action, however small it is, is told.
    if quantity == "y_g":
        mirrored = motions[0].assign(y_g=2.0 * motions[1]["y_g"].mean() - motions[1]["y_g"])
        assert not agreement(pair, "y_g", "exact", mirrored, motions[1], limit_of("y_g", "exact")).within
