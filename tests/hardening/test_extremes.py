"""Do extreme but legal values give finite numbers with an honest error, or a clear refusal, in time?"""

import copy
import math
import os
import warnings

import numpy as np
import pytest

import multibody
from floquet.gear.multipliers import gear_pair_multipliers
from lumped import geometry, load_gear_pair, simulate, steady_state
from lumped.errors import LawRangeWarning, SpurcheckError
from multibody.contact.kinematics import Side, Turn, mesh_phase

#: Longest time that any analysis of any pair may take here [s]; ordinary ones take well under one.
SECONDS = 60.0
LONG = int(os.environ.get("SPURCHECK_FUZZ", "1")) > 1
GEARS = ("pinion", "gear")


def both(field, value):
    return {f"{gear}.{field}": value for gear in GEARS}


def bearings(what, value):
    return {f"bearings.{gear}.{way}_{what}": value for gear in GEARS for way in ("loa", "oloa")}


VARIATIONS = {
    "100 rpm": {"operating.pinion_speed": 100}, "1e-6 rpm": {"operating.pinion_speed": 1e-6},
    "1e5 rpm": {"operating.pinion_speed": 1e5}, "2e5 rpm": {"operating.pinion_speed": 2e5},
    "mesh damping 0": {"mesh.damping_ratio": 0},
    "all damping 0": {"mesh.damping_ratio": 0, **bearings("damping_ratio", 0)},
    "mesh damping 1": {"mesh.damping_ratio": 1}, "bearing damping 2": bearings("damping_ratio", 2),
    "mu 0": {"friction.law": "coulomb", "friction.coefficient": 0},
    "mu 1": {"friction.law": "coulomb", "friction.coefficient": 1},
    "no friction law": {"friction.law": "none"},
    "sharpness 1e-6": {"friction.law": "smoothed_coulomb", "friction.sharpness": 1e-6},
    "sharpness 1e9": {"friction.law": "smoothed_coulomb", "friction.sharpness": 1e9},
    "no film": {"friction.law": "composite", "friction.film_length": 1e-9},
    "full film": {"friction.law": "composite", "friction.film_length": 1e9},
    "viscosity 1e-9": {"lubricant.viscosity": 1e-9}, "viscosity 1e5": {"lubricant.viscosity": 1e5},
    "roughness 0": both("roughness", 0), "roughness 50": both("roughness", 50),
    "pair stiffness 1e-6": {"mesh.stiffness.pair_stiffness": 1e-6},
    "pair stiffness 1": {"mesh.stiffness.pair_stiffness": 1},
    "pair stiffness 1e11": {"mesh.stiffness.pair_stiffness": 1e11},
    "pair stiffness to nothing": {"mesh.stiffness": {"model": "parabolic", "end_ratio": 1e-9}},
    "bearings 1e-6": bearings("stiffness", 1e-6), "bearings 1": bearings("stiffness", 1),
    "bearings 1e12": bearings("stiffness", 1e12), "bearings 1e30": bearings("stiffness", 1e30),
    "inertia 1e-15": both("inertia", 1e-15), "inertia 1e9": both("inertia", 1e9),
    "mass 1e-15": both("mass", 1e-15), "mass 1e7": both("mass", 1e7),
    "torque 1e-9": {"operating.pinion_torque": 1e-9}, "torque 1e6": {"operating.pinion_torque": 1e6},
    "torque 1e9": {"operating.pinion_torque": 1e9}, "brake 1e-9": {"operating.brake_torque": 1e-9},
    "brake 1e9": {"operating.brake_torque": 1e9}, "width 1e-9": both("face_width", 1e-9),
    "width 2000": both("face_width", 2000), "modulus 1e-6": both("youngs_modulus", 1e-6),
    "modulus 2000": both("youngs_modulus", 2000),
    "relief 1 mm": {"pinion.tip_relief": {"amount": 1000, "start_roll_angle": 24}},
    "backlash 10 mm": {"mesh.backlash": 10},
}  # fmt: skip
if LONG:  # a refusal of the transient at 1 rpm comes after its 200000 steps
    VARIATIONS |= {"10 rpm": {"operating.pinion_speed": 10}, "1 rpm": {"operating.pinion_speed": 1}}


def form(pressure_angle, addendum, dedendum, fillet, pinion, gear):
    """A pair of another tooth form; pinion and gear are (teeth, profile shift)."""
    data = copy.deepcopy(load_gear_pair("nasa_28_28").to_mapping())
    for key in ("sources", "centre_distance"):
        data.pop(key)
    data["basic_rack"] |= {
        "pressure_angle": pressure_angle, "addendum_coefficient": addendum, "dedendum_coefficient": dedendum,
        "fillet_radius_coefficient": fillet,
    }  # fmt: skip
    for name, (teeth, shift) in (("pinion", pinion), ("gear", gear)):
        data[name].pop("tip_relief")
        data[name] |= {"teeth": teeth, "profile_shift": shift}
    return load_gear_pair(data)


#: Tooth forms at the ends of what can mesh; found by search, contact ratio and tooth ratio asserted below.
FORMS = {
    "contact ratio 2.999": lambda: form(14.5, 1.3011549545, 1.5511549545, 0.1, (120, 0.0), (120, 0.0)),
    "ratio 200:1": lambda: form(27.8515209, 0.8208178, 0.93860493, 0.05, (5, 0.31354275), (1000, 0.47291404)),
    "ratio 1:200": lambda: form(27.8515209, 0.8208178, 0.93860493, 0.05, (1000, 0.47291404), (5, 0.31354275)),
}


def test_the_forms_are_what_their_names_say():
    assert geometry(FORMS["contact ratio 2.999"]()).contact_ratio == pytest.approx(2.999, abs=1e-6)
    for name, ratio in (("ratio 200:1", 200.0), ("ratio 1:200", 1 / 200)):
        g = geometry(FORMS[name]())
        assert g.omega_pinion / g.omega_gear == pytest.approx(ratio, rel=1e-12)


def lumped_steady(pair):
    run = steady_state(pair, samples_per_cycle=64)
    assert 0.0 <= run.attrs["error_estimate"] < math.inf
    return run


def lumped_transient(pair):
    return simulate(pair, 2, samples_per_cycle=64)


def multibody_transient(pair):
    return multibody.simulate(pair, 2, samples_per_cycle=64)


def floquet_multipliers(pair):
    found = gear_pair_multipliers(pair)
    assert np.isfinite(found.multipliers).all()
    assert 0.0 <= found.error < math.inf
    return None


ANALYSES = (lumped_steady, lumped_transient, multibody_transient, floquet_multipliers)
BODIES = (multibody_transient,)
#: Analyses that may refuse a variation, by the reason why; everything else has to be answered.
MAY_REFUSE = {
    # More oscillations in a mesh cycle than can be followed to the tolerance.
    **dict.fromkeys(("1e-6 rpm", "bearings 1e30", "inertia 1e-15", "inertia 1e9", "mass 1e-15"), ANALYSES),
    "width 1e-9": ANALYSES,
    "pair stiffness 1e11": (floquet_multipliers,),
    "modulus 2000": (multibody_transient, floquet_multipliers),
    "10 rpm": BODIES,
    "1 rpm": (lumped_transient, multibody_transient, floquet_multipliers),
    # The coefficient of friction that the law gives is beyond 1.
    **dict.fromkeys(("viscosity 1e-9", "viscosity 1e5", "roughness 50"), ANALYSES),
    # The static load turns the gears by more than a tooth, so that no pair carries it where it touches.
    **dict.fromkeys(("pair stiffness 1e-6", "pair stiffness 1", "modulus 1e-6"), ANALYSES),
    **dict.fromkeys(("torque 1e6", "torque 1e9", "bearings 1", "bearings 1e-6", "ratio 200:1"), ANALYSES),
    # Or by less than the rounding of their positions.
    **dict.fromkeys(("brake 1e9", "torque 1e-9", "brake 1e-9"), BODIES),
}


def check_refusal(name, analysis, error):
    assert len(str(error)) > 40  # says what is wrong and what to try
    assert analysis in MAY_REFUSE.get(name, ()), error


@pytest.mark.slow
@pytest.mark.parametrize("analysis", ANALYSES, ids=lambda function: function.__name__)
@pytest.mark.parametrize("name", [*VARIATIONS, *FORMS])
def test_an_answer_or_a_refusal(within, name, analysis):
    with warnings.catch_warnings(), within(SECONDS if not LONG else 10 * SECONDS):
        warnings.simplefilter("ignore", LawRangeWarning)
        try:
            pair = FORMS[name]() if name in FORMS else load_gear_pair("nasa_28_28").with_(VARIATIONS[name])
            run = analysis(pair)
        except SpurcheckError as error:
            check_refusal(name, analysis, error)
            return
    if run is not None:
        for variable in run.data_vars:
            assert np.isfinite(run[variable].to_numpy()).all(), variable
        for key, value in run.attrs.items():
            assert not isinstance(value, float) or math.isfinite(value), key


@pytest.mark.parametrize("turns", [0.0, 1e3, -1e12, 1e20, -1e30, 1e300])
def test_the_phase_of_the_mesh_stays_within_a_pitch_after_any_number_of_turns(turns):
    # The loop over the pairs in contact adds pitches to the phase: a phase far outside would never end it.
    pitch = 9.373e-3
    side = Side(flank=1.0, radius_p=41e-3, radius_g=41e-3, pitch=pitch, chi=0.1, overlap=0.2)
    turn = Turn(psi=1.2, grown=30e-3, phi_p=2 * math.pi * turns, phi_g=0.3, rolled=0.0)
    rho, _ = mesh_phase(side, turn)
    assert 0.0 <= rho <= pitch


@pytest.mark.parametrize("path", ["density", "youngs_modulus", "face_width", "mass", "inertia"])
@pytest.mark.parametrize("power", [-300, 300])
def test_sizes_that_no_gear_has_are_refused_by_name(path, power):
    # Each overflowed, or divided by zero, somewhere in the models.
    for gear in GEARS:
        with pytest.raises(SpurcheckError, match=f"{gear}.{path}"):
            load_gear_pair("nasa_28_28").with_({f"{gear}.{path}": 10.0**power})


@pytest.mark.parametrize("field", ["mass", "inertia"])
def test_a_gear_lighter_than_any_of_its_size_is_refused(field):
    # 1e-12 kg m^2 is within the range of the field, but not for a gear of 89 mm.
    with pytest.raises(SpurcheckError, match=f"gear.{field}.*solid disc"):
        load_gear_pair("nasa_28_28").with_({f"gear.{field}": 1e-8})
