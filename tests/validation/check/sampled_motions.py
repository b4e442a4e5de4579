"""Pairs of the cases of explanations, and curves of their motions at samples of their own."""

import numpy as np

import lumped
from tests.unlike_pairs import unlike_pair
from validation.check.curves import Channel, Curves

LIMIT = 0.05
CHANNELS = ("dte", "theta_g", "x_p", "y_g", "bearing_force_x_p")
COULOMB = {
    "mesh.contact": "prescribed",
    "friction.law": "coulomb",
    "friction.coefficient": 0.06,
}


def sampled(motion, channels=CHANNELS, cycles=2, per_cycle=421, phase=0.3):
    """Curves of a motion, at phases of their own."""
    place = phase + np.arange(cycles * per_cycle) / per_cycle
    time = (place - phase) * motion.pair.geometry.mesh_period
    return Curves(
        "other", "time", time, tuple(Channel(name, name, motion.at(name, place)) for name in channels)
    )


def pairs_of_cases():
    """Name -> pair of the cases."""
    unlike = lumped.load_gear_pair("high_contact_ratio_29_47").with_(COULOMB)
    symmetric = lumped.load_gear_pair("nasa_28_28")
    return {
        "unlike": unlike,
        "stiff bearings": unlike.with_({"bearings.stiffness": 4e9, "bearings.damping_ratio": 0.5}),
        "energy": unlike.with_({"mesh.stiffness": {"model": "energy"}}),
        "relieved": symmetric.with_(
            {**COULOMB, "pinion.tip_relief": {"amount": "4 um", "start_roll_angle": "24 deg"}}
        ),
        "eccentric": symmetric.with_(
            {**COULOMB, "mesh.relief": "ignored", "pinion.mounting": {"eccentricity": "10 um"}}
        ),
        "soft bearings": unlike.with_({"bearings.stiffness": 6e7}),
        "polymer": unlike.with_({"gear.youngs_modulus": "3 GPa", "gear.poisson_ratio": 0.38}),
        "rough": unlike.with_(
            {
                "friction.law": "xu_kahraman",
                "friction.coefficient": None,
                "pinion.roughness": "0.3 um",
                "gear.roughness": "0.5 um",
            }
        ),
        "both relieved": symmetric.with_(
            {
                **COULOMB,
                "pinion.tip_relief": {"amount": "4 um", "start_roll_angle": "24 deg"},
                "gear.tip_relief": {"amount": "6 um", "start_roll_angle": "23 deg"},
            }
        ),
        "damped relief": symmetric.with_(
            {
                **COULOMB,
                "operating.pinion_speed": "6000 rpm",
                "mesh.damping_ratio": 0.3,
                "pinion.tip_relief": {"amount": "14 um", "start_roll_angle": "25 deg"},
                "gear.tip_relief": {"amount": "9 um", "start_roll_angle": "24 deg"},
            }
        ),
        "parting": unlike.with_({"operating.pinion_speed": "8000 rpm", "mesh.damping_ratio": 0.02}),
        "unlike addenda": unlike.with_({"pinion.addendum": None, "gear.tip_alteration": "-0.4 mm"}),
        "contact lost": lumped.load_gear_pair("nasa_art_25_31").healthy,
        "shifted": unlike_pair("contact_ratio_1_1_large_shifts").with_(COULOMB),
        "on shafts": unlike_pair("contact_ratio_2_3_on_shafts").with_(COULOMB),
    }
