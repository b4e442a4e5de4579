"""Is a value that hardly can be meant named with its likely cause, and a sensible one left alone?"""

import pytest
from typer.testing import CliRunner

from lumped import load_gear_pair, preset_names
from validation.cli import app
from validation.commands.options import without_effect
from validation.validity.plausibility import doubts


@pytest.mark.parametrize("name", preset_names())
@pytest.mark.parametrize("speed", [0.2, 1.0, 2.0])
def test_a_sensible_pair_raises_no_doubt(name, speed):
    pair = load_gear_pair(name)
    rpm = speed * pair.operating.pinion_speed.to("rpm")
    assert doubts(pair.with_(operating__pinion_speed=rpm)) == ()


@pytest.mark.parametrize(("changes", "said"), [
    ({"bearings.gear.loa_stiffness": 300}, "Given in N/um? Then write '300 N/um'."),
    ({"pinion.youngs_modulus": "206 MPa"}, "pinion.youngs_modulus = 0.206 GPa is no material"),
    ({"gear.youngs_modulus": 2000}, "gear.youngs_modulus = 2000 GPa is no material"),
    ({"operating.pinion_torque": 56500}, "beyond any steel"),
    ({"operating.pinion_torque": 4875, "operating.pinion_speed": 56.5}, "Speed and torque swapped?"),
    ({"operating.pinion_torque": 56500}, "more than a tenth of the module"),
    ({"mesh.backlash": "0.5 um"}, "the backs of the teeth would touch"),
    ({"operating.pinion_speed": 1.45}, "Then write 1450."),
    ({"operating.pinion_speed": 24}, "Then write '24 Hz'."),
    ({"operating.pinion_speed": "1450 Hz"}, "Is 1450 the speed in rpm?"),
    ({"pinion.roughness": "0.4 pm"}, "pinion.roughness = 4e-07 um is that of no flank"),
    ({"gear.tip_relief": {"amount": 0.02, "start_roll_angle": 24.0}}, "Then write '0.02 mm'."),
    ({"friction.composite_roughness": 0.8}, "Delete it if the roughnesses are meant"),
    ({"bearings.pinion.oloa_stiffness": 1e16}, "the multibody model needs"),
])  # fmt: skip
def test_a_value_that_hardly_can_be_meant_is_named_with_its_cause(nasa_pair, changes, said):
    found = doubts(nasa_pair.with_(changes))
    assert any(said in one for one in found), found


def test_no_backlash_but_for_rounding_is_not_doubted():
    """The centre distance of standard gears is the mean of their pitch circles: 0.5 (17 + 53) / 2 mm."""
    own = {"basic_rack.module": 0.5, "pinion.teeth": 17, "gear.teeth": 53, "operating.pinion_torque": 0.15}
    own |= {f"{gear}.{key}": None for gear in ("pinion", "gear") for key in ("tip_relief", "mass", "inertia")}
    own |= {"description": "", "mesh.backlash": 0, "operating.speed_range": None}
    for centre_distance in (None, 17.5):
        pair = load_gear_pair("nasa_28_28").with_(own | {"centre_distance": centre_distance})
        assert not any("backlash" in one for one in doubts(pair))


@pytest.fixture(scope="module")
def nasa_pair():
    return load_gear_pair("nasa_28_28")


@pytest.mark.parametrize(("changes", "unread"), [
    ({"friction.law": "xu_kahraman", "friction.coefficient": 0.1}, ["friction.coefficient"]),
    ({"friction.law": "none", "lubricant.viscosity": 8}, ["lubricant.viscosity"]),
    ({"friction.law": "benedict_kelley", "lubricant.viscosity": 8}, []),
    ({"friction.law": "none", "mesh.relief": "static", "pinion.tip_relief.amount": 12}, []),
    ({"mesh.relief": "ignored", "pinion.tip_relief.amount": 12}, ["pinion.tip_relief.amount"]),
])  # fmt: skip
def test_a_value_that_no_law_of_the_pair_reads_is_found(nasa_pair, changes, unread):
    assert list(without_effect(nasa_pair, nasa_pair.with_(changes), changes)) == unread


def test_commands_say_it_and_go_on():
    result = CliRunner().invoke(
        app, ["simulate", "--law", "none", "--set", "friction.composite_roughness=0.8", "--cycles", "2"]
    )
    assert result.exit_code == 0
    assert "note: no gear pair is named, so this is the example nasa_28_28" in result.stderr
    assert "--set friction.composite_roughness changes nothing in the motion" in result.stderr
    assert "note: friction.composite_roughness = 0.8 um is used for the film" in result.stderr


def test_springs_that_the_shafts_contradict_are_named(nasa_pair):
    bearings = [{"position": at, "loa_stiffness": 1e8, "oloa_stiffness": 1e8} for at in (0, 100)]
    shaft = {"segments": [{"length": 100, "diameter": 60}], "gear_position": 50, "bearings": bearings}
    thin = shaft | {"segments": [{"length": 100, "diameter": 15}]}
    pair = nasa_pair.with_(shafts={"damping_ratio": 0.01, "pinion": shaft, "gear": thin})
    found = [doubt for doubt in doubts(pair) if "on its shaft" in doubt]
    assert [doubt.split(" ")[0] for doubt in found] == [
        f"bearings.gear.{d}_stiffness" for d in ("loa", "oloa")
    ]
