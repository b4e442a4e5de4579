"""Is what is written read back bit for bit?"""

import json
import tomllib

import pytest
from hypothesis import given, settings
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


# Control characters but for tab and line ends are refused.
readable = st.characters(exclude_categories=("Cc", "Cs")) | st.sampled_from("\t\n\r")


@settings(max_examples=40)
@given(text=st.text(readable, max_size=200))
def test_any_text_survives(text):
    pair = load_gear_pair("nasa_28_28").with_(description=text, sources={"mesh": text})
    assert load_gear_pair(tomllib.loads(pair.to_toml())) == pair


def test_a_different_pair_has_a_different_hash(nasa):
    assert parameters_hash(nasa) != parameters_hash(nasa.with_(mesh__damping_ratio=0.0500000001))
