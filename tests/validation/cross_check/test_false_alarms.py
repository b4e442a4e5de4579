"""Sound pairs that an earlier limit refused: of none of them the cross-check fails."""

from functools import lru_cache

import pytest

import lumped
from tests.evidence.faults.sound import drawn
from validation.cross_check.comparison import crosscheck
from validation.cross_check.variant import asymmetric_variant


def bearings(*stiffness):
    """Stiffness of pinion and gear, along and off the line of action, [1e8 N/m]."""
    places = ("pinion.loa", "pinion.oloa", "gear.loa", "gear.oloa")
    return {f"bearings.{p}_stiffness": 1e8 * k for p, k in zip(places, stiffness, strict=True)}


def gears(pinion, gear, *shifts):
    named = {"pinion.teeth": pinion, "gear.teeth": gear, "centre_distance": None}
    for name in ("pinion", "gear"):
        named |= {f"{name}.{what}": None for what in ("tip_diameter", "addendum", "tip_relief")}
    return named | {f"{g}.profile_shift": s for g, s in zip(("pinion", "gear"), shifts, strict=True)}


def running(speed, torque, law, **more):
    return {"operating.pinion_speed": speed, "operating.pinion_torque": torque, "friction.law": law} | more


RECTANGULAR, ENERGY = {"mesh.stiffness": {"model": "rectangular"}}, {"mesh.stiffness": {"model": "energy"}}
#: What was wrong -> preset and changes.
PAIRS = {
    "y a ten thousandth of x: its error of integration was judged by the size of x": (
        "nasa_28_28",
        gears(50, 41, 0.2448, 0.2364)
        | bearings(2.63, 4.36, 0.51, 5.57)
        | ENERGY
        | running(8396, 77.7, "composite", **{"lubricant.viscosity": 14.26}),
    ),
    "contact ratio 1.996: friction forces cancel but between two samples": (
        "high_contact_ratio_29_47",
        gears(25, 22, 0.07968, 0.1009)
        | bearings(1.187, 0.589, 0.5595, 3.763)
        | RECTANGULAR
        | running(4500, 62.92, "coulomb"),
    ),
    "law III: friction power that a constant displacement of the law does not change": (
        "nasa_28_28",
        bearings(4.12, 0.632, 6.27, 2.236)
        | {"mesh.stiffness": {"model": "parabolic", "ramp_length": 0.5}}
        | running(6002, 33.87, "xu_kahraman", **{"lubricant.viscosity": 33.5}),
    ),
    "the bearings carry a contact beyond the end of its nominal path": (
        "kahraman_blankenship_50_50",
        gears(50, 22, 0.08574, 0.2813)
        | bearings(9.81, 0.912, 2.115, 7.394)
        | RECTANGULAR
        | running(1165.6, 171.4, "composite", **{"lubricant.viscosity": 20.84}),
    ),
    "loaded, without friction: y moves by corners and path work alone; a ramp ends without stiffness": (
        "high_contact_ratio_29_47",
        {"mesh.stiffness": {"model": "parabolic", "ramp_length": 0.5}, "mesh.contact": "loaded"}
        | running(3071.6, 43.9, "none"),
    ),
    "loaded, a ramp: the damper's load pushes along the path only where there is relief": (
        "nasa_art_25_31",
        gears(46, 36, 0.26478, 0.18977)
        | bearings(7.576, 0.7392, 2.381, 3.059)
        | {"mesh.stiffness": {"model": "parabolic", "ramp_length": 0.5}, "mesh.contact": "loaded"}
        | running(
            3439.4, 56.96, "xu_kahraman", **{"lubricant.viscosity": 35.25, "mesh.damping_ratio": 0.098}
        ),
    ),
    "friction holds the teeth": (
        "fzg_c",
        bearings(0.632, 0.627, 5.0, 9.14)
        | ENERGY
        | running(3618.6, 159.6, "benedict_kelley", **{"lubricant.viscosity": 24.12}),
    ),
}


@lru_cache(maxsize=8)
def checked(name):
    preset, changes = PAIRS[name]
    pair = lumped.load_gear_pair(preset).with_({"mesh.relief": "ignored"} | changes)
    return crosscheck(pair, cycles=6, samples_per_cycle=128, variant=False)


@pytest.mark.parametrize("name", PAIRS)
def test_a_sound_pair_is_not_refused(name):
    assert checked(name).failures == ()


@pytest.mark.parametrize(
    ("seed", "number", "cycles"),
    [("g.9", 0, 40), ("final.7", 5, 8)],
    ids=["a periodic solution that the motion forgets", "half of the samples miss as much as all"],
)
def test_a_drawn_sound_pair_is_not_refused(seed, number, cycles):
    pair = list(drawn(number + 1, seed))[number]
    assert crosscheck(pair, cycles=cycles, samples_per_cycle=128, variant=False).failures == ()


def test_the_variant_of_a_pair_with_a_change_of_regime_is_not_refused():
    pair = asymmetric_variant(list(drawn(19, "final.8"))[18])
    assert crosscheck(pair, cycles=6, samples_per_cycle=64, variant=False).failures == ()
