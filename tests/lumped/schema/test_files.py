"""Is what is written read back bit for bit?"""

import json
import math
import tomllib

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lumped import load_gear_pair, preset_names
from lumped.labelling import parameters_hash
from lumped.schema.pair import leaf_paths

positive = st.floats(min_value=1e-12, max_value=1e12, allow_subnormal=False)


@pytest.mark.parametrize("name", preset_names())
def test_presets_survive_toml_json_and_mapping(name):
    pair = load_gear_pair(name)
    data = pair.to_mapping()
    assert load_gear_pair(data) == pair
    assert load_gear_pair(tomllib.loads(pair.to_toml())) == pair
    assert load_gear_pair(json.loads(json.dumps(data))) == pair
    again = load_gear_pair(tomllib.loads(pair.to_toml()))
    assert again.to_toml() == pair.to_toml()
    assert parameters_hash(again) == parameters_hash(pair)


def test_numbers_are_written_in_the_stated_unit(nasa):
    values = leaf_paths(nasa)
    assert values["basic_rack.module"] == 3.175
    assert values["basic_rack.pressure_angle"] == 20.0
    assert values["operating.pinion_speed"] == 4875.0
    assert values["pinion.tip_relief.amount"] == 23.0
    assert values["pinion.youngs_modulus"] == 206.0
    assert values["friction.sharpness"] == 50.0


# Fields of every kind of unit: a length in SI that no decimal number of millimetres gives must survive too.
FIELDS = {
    "operating.pinion_speed": st.floats(1e-3, 20000.0),
    "operating.pinion_torque": st.floats(1e-9, 1e9),
    "operating.brake_torque": st.floats(1e-9, 1e9),
    "pinion.mass": st.floats(0.01, 1e6),
    "gear.inertia": st.floats(1e-4, 1e6),
    "pinion.density": st.floats(10.0, 30000.0),
    "gear.youngs_modulus": st.floats(1e3, 2e12),
    "pinion.poisson_ratio": st.floats(0.0, 0.4999),
    "gear.roughness": st.floats(0.0, 5e-5),
    "bearings.pinion.loa_stiffness": st.floats(1e-6, 1e12),
    "bearings.gear.oloa_damping_ratio": st.floats(0.0, 2.0),
    "mesh.damping_ratio": st.floats(0.0, 1.0),
    "mesh.backlash": st.floats(0.0, 1e-3),
    "lubricant.viscosity": st.floats(1e-6, 99.0),
    "friction.sharpness": positive,
    "friction.film_length": positive,
    "pinion.tip_relief.start_roll_angle": st.floats(0.01, math.pi),
}
SI = {
    "operating.pinion_speed": "rad/s",
    "operating.pinion_torque": "N*m",
    "operating.brake_torque": "N*m",
    "pinion.mass": "kg",
    "gear.inertia": "kg*m**2",
    "pinion.density": "kg/m**3",
    "gear.youngs_modulus": "Pa",
    "gear.roughness": "m",
    "bearings.pinion.loa_stiffness": "N/m",
    "mesh.backlash": "m",
    "lubricant.viscosity": "Pa*s",
    "friction.sharpness": "1/m",
    "friction.film_length": "m",
    "pinion.tip_relief.start_roll_angle": "rad",
}


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(values=st.fixed_dictionaries(FIELDS))
def test_any_si_values_survive_toml_bit_for_bit(values):
    nasa = load_gear_pair("nasa_28_28")
    pair = nasa.with_({path: f"{value!r} {SI.get(path, '')}".strip() for path, value in values.items()})
    for path, value in values.items():
        node = pair
        for part in path.split("."):
            node = getattr(node, part)
        assert node == value, path
    again = load_gear_pair(tomllib.loads(pair.to_toml()))
    assert again == pair
    assert hash(again) == hash(pair)
    assert again.to_toml() == pair.to_toml()


# Control characters but for tab and line ends are refused.
readable = st.characters(exclude_categories=("Cc", "Cs")) | st.sampled_from("\t\n\r")


@settings(max_examples=40)
@given(text=st.text(readable, max_size=200))
def test_any_text_survives(text):
    pair = load_gear_pair("nasa_28_28").with_(description=text, sources={"mesh": text})
    assert load_gear_pair(tomllib.loads(pair.to_toml())) == pair


@pytest.mark.parametrize(
    "stiffness",
    [
        {"model": "rectangular"},
        {"model": "rectangular", "pair_stiffness": 8.1e7},
        {"model": "parabolic", "peak": 9e7, "end_ratio": 0.6, "ramp_length": 0.31},
    ],
)
def test_every_member_of_a_union_survives(nasa, stiffness):
    pair = nasa.with_(mesh__stiffness=stiffness)
    assert load_gear_pair(tomllib.loads(pair.to_toml())) == pair


def test_viscosity_law_and_given_brake_survive(nasa):
    law = {"kinematic_viscosity_40": 31.7, "kinematic_viscosity_100": 5.43, "temperature": "140.3 degF"}
    pair = nasa.with_(lubricant__viscosity_law=law, operating__brake_torque="487 lbf*in")
    assert pair.operating.brake_torque != "balanced"
    assert load_gear_pair(tomllib.loads(pair.to_toml())) == pair


def test_a_different_pair_has_a_different_hash(nasa):
    assert parameters_hash(nasa) != parameters_hash(nasa.with_(mesh__damping_ratio=0.0500000001))
