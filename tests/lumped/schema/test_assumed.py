"""Is a value known or assumed by the table [assumed] alone, whatever is done to the file or the pair?"""

import pickle
import tomllib
from pathlib import Path

import pytest

from lumped import ParameterError, State, load_gear_pair, preset_names
from lumped.schema.files import preset_text
from lumped.schema.pair import leaf_paths
from tests import unlike_pairs
from tests.unlike_pairs import UNLIKE, unlike_pair

FOLDER = Path(unlike_pairs.__file__).parent
FIELD = "bearings.gear.loa_stiffness"


def edited(name: str, old: str, new: str):
    """A preset as a user who changes a piece of its text has it."""
    text = preset_text(name)
    assert text.count(old) == 1, old
    return load_gear_pair(tomllib.loads(text.replace(old, new)))


def test_a_value_changed_in_the_file_is_known():
    """29/47 has four unlike bearings, all assumed; the line in [assumed] is left as it was."""
    pair = load_gear_pair("high_contact_ratio_29_47")
    other = edited("high_contact_ratio_29_47", "loa_stiffness = 2.3e8 ", "loa_stiffness = 2.4e8 ")
    assert pair.state(FIELD) is State.ASSUMED
    assert other.state(FIELD) is State.KNOWN
    assert {**pair.assumed} == {**other.assumed, FIELD: 2.3e8}


def test_a_value_without_a_line_in_the_table_is_known():
    pair = edited("high_contact_ratio_29_47", f'"{FIELD}" = 2.3e8\n', "")
    assert pair.bearings.gear.loa_stiffness == 2.3e8
    assert pair.state(FIELD) is State.KNOWN


@pytest.mark.parametrize("words", ["Assumed", "a guess", "estimated", "assumed", "measured in 2024"])
def test_words_of_a_source_decide_nothing(words):
    """The source of an assumed value does not make it known, and that of a known one does not unmake it."""
    pair = load_gear_pair("fzg_c")
    everywhere = pair.with_({"sources": dict.fromkeys(leaf_paths(pair), words)})
    assert everywhere.assumed == pair.assumed
    assert pair.state("pinion.teeth") is everywhere.state("pinion.teeth") is State.KNOWN
    assert pair.with_({"sources": {}}).assumed == pair.assumed


def test_a_default_that_the_file_does_not_write_is_assumed():
    data = load_gear_pair("nasa_art_25_31").to_mapping()
    for key in ("youngs_modulus", "bore"):
        data["pinion"].pop(key)
        data["assumed"].pop(f"pinion.{key}")
    data["gear"]["youngs_modulus"] = 206  # written, though it is the default
    del data["assumed"]["gear.youngs_modulus"]
    pair = load_gear_pair(data)
    assert pair.assumed["pinion.youngs_modulus"] == 206.0
    assert pair.assumed["pinion.bore"] == 0.0
    assert pair.state("gear.youngs_modulus") is State.KNOWN


def test_defaults_inside_lists_and_chosen_sections_are_assumed_too(shaft_tables):
    pair = load_gear_pair(FOLDER / "larger_gear_drives_contact_lost.toml").with_(shafts=shaft_tables)
    assert pair.assumed["shafts.pinion.bearings.1.loa_damping"] == 0.0
    assert pair.state("shafts.pinion.bearings.1.position") is State.KNOWN
    assert pair.assumed["mesh.stiffness.hertz"] == "weber_banaschek"
    assert pair.state("mesh.stiffness.model") is State.KNOWN
    assert "mesh.stiffness.hertz" not in pair.with_(stiffness="rectangular").assumed


@pytest.mark.parametrize("name", [*preset_names(), *UNLIKE])
def test_a_pair_that_is_written_and_read_has_the_same_states(name):
    pair = load_gear_pair(name) if name in preset_names() else unlike_pair(name)
    for again in (
        load_gear_pair(tomllib.loads(pair.to_toml())),
        load_gear_pair(pair.to_mapping()),
        pickle.loads(pickle.dumps(pair)),
        pair.with_(),
    ):
        assert again == pair
        assert hash(again) == hash(pair)
        assert again.assumed == pair.assumed
        assert len(pair.assumed) > 0
    values = leaf_paths(pair)
    # What follows from other fields is assumed, but not written.
    sizes = {f"{gear}.{size}" for gear in ("pinion", "gear") for size in ("profile_shift", "tip_alteration")}
    assert {path: pair.assumed.to_mapping()[path] for path in pair.assumed if path in values} == {
        path: values[path] for path in pair.assumed if path in values or path not in sizes
    }


class TestVariations:
    def test_a_field_that_is_named_is_known_whatever_its_value(self):
        pair = load_gear_pair("high_contact_ratio_29_47")
        for field, value in {
            FIELD: 2.3e8, "friction.law": "xu_kahraman", "gear.roughness": pair.gear.roughness,
            "friction.thresholds": [1, 4, 10], "bearings.pinion.loa_stiffness": "140 N/um",
        }.items():  # fmt: skip
            varied = pair.with_({field: value})
            assert leaf_paths(varied) == leaf_paths(pair)
            assert varied.state(field) is State.KNOWN
            assert {*pair.assumed} - {*varied.assumed} <= {field}
        assert {*pair.assumed} - {*pair.with_(bearings=pair.bearings).assumed} == {
            path for path in pair.assumed if path.startswith("bearings.")
        }

    def test_the_pair_that_is_varied_keeps_its_states(self):
        pair = load_gear_pair("fzg_c")
        before = dict(pair.assumed)
        pair.with_(damping=0.07, law="coulomb")
        assert dict(pair.assumed) == before

    def test_a_default_that_is_restored_is_assumed(self):
        pair = load_gear_pair("fzg_c").with_(friction__maximum=0.1)
        assert pair.state("friction.maximum") is State.KNOWN
        assert pair.with_(friction__maximum=None).assumed["friction.maximum"] == 0.2

    def test_the_user_may_say_what_is_assumed(self):
        pair = load_gear_pair("fzg_c")
        assuming = pair.with_(torque=90.0, assumed={"operating.pinion_torque": "90 N*m", "mesh.backlash": 17})
        assert assuming.assumed["operating.pinion_torque"] == 90.0
        assert "mesh.backlash" not in assuming.assumed  # it is another one
        assert assuming.state("mesh.damping_ratio") is State.KNOWN
        backlash = leaf_paths(pair)["mesh.backlash"]  # mm
        table = {"mesh": {"backlash": f"{1e3 * backlash:g} um"}}  # keys without marks
        assert load_gear_pair(pair.to_mapping() | {"assumed": table}).assumed["mesh.backlash"] == backlash

    def test_other_speeds_and_like_teeth_keep_the_rest(self):
        pair = load_gear_pair("nasa_art_25_31")
        speed = "operating.pinion_speed"
        assert {*pair.assumed} - {*pair.at_speed(3000.0).assumed} == {speed}
        deviated = pair.with_(
            {"gear.deviations": {"tolerance_class": 7}, "pinion.mounting": {"eccentricity": 8}}
        )
        extra = {*deviated.assumed} - {*pair.assumed}
        assert "pinion.mounting.phase" in extra
        assert deviated.healthy == load_gear_pair(deviated.healthy.to_mapping())
        assert deviated.healthy.assumed == pair.assumed


@pytest.mark.parametrize(("entry", "field", "words"), [
    ({"mesh.backlsh": 0.1}, "assumed.mesh.backlsh", "Did you mean 'backlash'"),
    ({"bearings.pinion": 1e8}, "assumed.bearings.pinion", "bearings.pinion.loa_stiffness"),
    ({"sources": "x"}, "assumed.sources", "Delete the line"),
    ({"mesh.backlash": "wide"}, "assumed.mesh.backlash", "Write the value that the field has"),
    ({"mesh.backlash": "0.1 kg"}, "assumed.mesh.backlash", "Write the value that the field has"),
    ({"mesh.backlash": True}, "assumed.mesh.backlash", "Write the value that the field has"),
    ("all", "assumed", "a table"),
])  # fmt: skip
def test_an_entry_that_can_be_no_value_of_a_field_is_refused(entry, field, words):
    with pytest.raises(ParameterError) as caught:
        load_gear_pair(load_gear_pair("fzg_c").to_mapping() | {"assumed": entry})
    assert caught.value.problems[0].field == field
    assert words in str(caught.value)


def test_the_state_of_no_field_is_refused():
    with pytest.raises(ParameterError, match="Did you mean 'backlash'"):
        load_gear_pair("fzg_c").state("mesh.backlsh")
