"""Does `spurcheck init --teeth` write a complete file of the user's own pair, and nothing of a preset?"""

import re
import tomllib

import pytest
from typer.testing import CliRunner

from lumped import State, load_gear_pair
from lumped.schema.files import preset_names
from lumped.schema.pair import leaf_paths
from validation.cli import app
from validation.exchange import parameter_text
from validation.exchange.new_pair_file import GIVEN, new_pair_text, reasons

OWN = {"--teeth": "19/41", "--module": "2.5", "--face-width": "20", "--speed": "1450", "--torque": "80"}
DRAWING = {
    "teeth": "19/41", "basic_rack.module": 2.5, "gears.face_width": 20.0, "operating.pinion_speed": 1450.0,
    "operating.pinion_torque": 80.0,
}  # fmt: skip


def init(*more):
    options = [part for key, value in OWN.items() if key not in more for part in (key, value)]
    return CliRunner().invoke(app, ["init", *options, *more])


def test_the_file_holds_what_was_given_and_says_why_the_rest_is_assumed(tmp_path):
    path = tmp_path / "mypair.toml"
    result = init("--set", "bearings.stiffness=300 N/um", "--oil", "vg220", "--law", "II", "-o", str(path))
    assert result.exit_code == 0, result.output
    pair = load_gear_pair(path)
    values = leaf_paths(pair)
    sources = dict(pair.sources)
    expected = {
        "name": "mypair", "pinion.teeth": 19, "gear.teeth": 41, "basic_rack.module": 2.5,
        "pinion.face_width": 20.0, "gear.face_width": 20.0, "operating.pinion_speed": 1450.0,
        "operating.pinion_torque": 80.0, "bearings.gear.oloa_stiffness": 3e8,
        "lubricant.viscosity_law.iso_vg": 220, "friction.law": "benedict_kelley",
    }  # fmt: skip
    for key, value in expected.items():
        assert values[key] == value
        assert key == "name" or sources[key] == GIVEN
    sizes = {f"{gear}.{size}" for gear in ("pinion", "gear") for size in ("profile_shift", "tip_alteration")}
    assert {*sources, *pair.assumed} == set(values) - {"name", "description"} | sizes
    assert not {*sources} & {*pair.assumed}
    assert {*sources.values()} == {GIVEN}
    assert {*reasons(pair)} == {*pair.assumed}
    text = path.read_text(encoding="utf-8").splitlines()
    lines = [line.split("# ")[1] for line in text if " = " in line and "assumed: " in line]
    assert len(lines) == len(pair.assumed)
    assert lines.count("um, assumed: ground flanks") == 2
    assert "assumed: usual for steel gears, 0.03 to 0.17" in lines
    assert "centre_distance" not in values


def test_what_options_do_not_name_is_set_and_counts_as_given():
    """Profile shift, unlike face widths, a section as a table, one bearing of four, a given backlash."""
    relief = "pinion.tip_relief={amount = 15, start_roll_angle = 36}"
    more = ["pinion.profile_shift=0.4", "gear.face_width=18", "mesh.stiffness.model=energy", relief]
    more += ["bearings.pinion.loa_stiffness='200 N/um'", "mesh.backlash=0.05"]
    result = init(*[part for one in more for part in ("--set", one)], "--teeth", "13/41", "-o", "-")
    pair = load_gear_pair(tomllib.loads(result.output))
    assert pair.profile_shifts == (0.4, 0.0)
    assert (pair.pinion.face_width, pair.gear.face_width) == (0.02, 0.018)
    # The second spring of the pinion follows from the first, as of 8 balls; the gear's bearings are assumed.
    assert (pair.bearings.pinion.loa_stiffness, pair.bearings.pinion.oloa_stiffness) == (2e8, 0.46 * 2e8)
    assert pair.bearings.gear.type == "ball"
    assert (pair.mesh.stiffness.model, pair.mesh.backlash) == ("energy", 0.05e-3)
    from_user = {path for path, source in dict(pair.sources).items() if source == GIVEN}
    assert from_user >= {"pinion.profile_shift", "gear.face_width", "mesh.stiffness.model"}
    assert from_user >= {"pinion.tip_relief.amount", "bearings.pinion.loa_stiffness"}
    assert not from_user & {"gear.profile_shift", "bearings.pinion.oloa_stiffness", "mesh.stiffness.scale"}


def test_entries_of_lists_have_their_units_and_remarks():
    ball = {"loa_stiffness": 2e8, "oloa_stiffness": 2e8}
    shaft = {"segments": [{"length": 200, "diameter": 30}], "gear_position": 90}
    shaft["bearings"] = [{"position": 20} | ball, {"position": 180} | ball]
    pair = load_gear_pair("fzg_c").with_(shafts={"damping_ratio": 0.01, "pinion": shaft, "gear": shaft})
    stated = {"assumed": pair.assumed.to_mapping() | {"shafts.gear.bearings.1.position": 180}}
    text = parameter_text(pair.to_mapping() | stated)
    assert load_gear_pair(tomllib.loads(text)) == pair.with_(stated)
    places = [line.split("#")[1].strip() for line in text.splitlines() if line.startswith("position = ")]
    assert places == ["mm", "mm", "mm", "mm, assumed"]


def test_what_follows_from_the_centre_distance_is_a_comment_and_moves_with_it():
    """47/50 of module 2.5 on 122 mm: x1 + x2 = 0.3069 (ISO 21771), shared by the numbers of teeth."""
    drawing = {"teeth": "47/50", "basic_rack.module": 2.5, "gears.face_width": 20.0, "centre_distance": 122}
    drawing |= {"operating.pinion_speed": 1500.0, "operating.pinion_torque": 100.0}
    text = new_pair_text("x", drawing)
    pair = load_gear_pair(tomllib.loads(text))
    assert sum(pair.profile_shifts) == pytest.approx(0.3069, abs=0.5e-4)
    assert pair.profile_shifts[0] / pair.profile_shifts[1] == pytest.approx(50 / 47, rel=1e-12)
    lines = [line for line in text.splitlines() if line.startswith("# profile_shift = ")]
    assert [line.split()[3] for line in lines] == [f"{shift:.6g}" for shift in pair.profile_shifts]
    assert all("assumed: what the centre distance asks for" in line for line in lines)
    assert text.count("\n# tip_alteration = ") == 2
    shorter = load_gear_pair(
        tomllib.loads(text.replace("centre_distance = 122.0", "centre_distance = 121.25"))
    )
    assert shorter.profile_shifts == (0.0, 0.0)
    typed = text.replace("# profile_shift", "profile_shift")
    assert load_gear_pair(tomllib.loads(typed)).state("pinion.profile_shift") is State.KNOWN


@pytest.mark.parametrize(("teeth", "centre", "undercut"), [("13/55", 102.0, True), ("20/90", 165.0, False)])
def test_few_teeth_without_a_profile_shift_are_stock_gears(teeth, centre, undercut):
    """The centre distance is m (z_1 + z_2)/2; that undercut shortens the contact is said in the file."""
    drawing = {"teeth": teeth, "basic_rack.module": 3.0, "gears.face_width": 30.0}
    drawing |= {"operating.pinion_speed": 1500.0, "operating.pinion_torque": 100.0}
    text = new_pair_text("x", drawing)
    pair = load_gear_pair(tomllib.loads(text))
    assert pair.profile_shifts == (0.0, 0.0)
    assert 1e3 * pair.geometry.centre_distance == pytest.approx(centre, rel=1e-12)
    assert pair.assumed["pinion.profile_shift"] == 0.0
    assert "none without one" in reasons(pair)["pinion.profile_shift"]
    assert ("# - Undercut shortens contact" in text) == undercut


def test_a_value_edited_in_the_text_is_known_and_the_rest_assumed():
    """The user of c4723bf8 typed relief, temperature and shafts, and they counted as assumed."""
    text = new_pair_text("x", DRAWING)
    pair = load_gear_pair(tomllib.loads(text))
    for field, old, new in (
        ("mesh.backlash", "backlash = 0.115 ", "backlash = 0.116 "),
        ("friction.law", 'law = "iso_14179"', 'law = "coulomb"'),
        ("mesh.stiffness.model", 'model = "finite_elements"', 'model = "rectangular"'),
    ):
        other = text.replace(old, new)
        if field == "mesh.stiffness.model":  # keys of the other model
            other = re.sub(r"\n(plane|support) = .*", "", other, count=2)
        varied = load_gear_pair(tomllib.loads(other))
        assert other != text
        assert varied.state(field) is State.KNOWN
        gone = {field} | ({"mesh.stiffness.plane", "mesh.stiffness.support"} if "model" in field else set())
        assert {*pair.assumed} - {*varied.assumed} == gone
        assert field not in reasons(varied)
    relief = text.replace("[gear]", "[pinion.tip_relief]\namount = 15\nstart_roll_angle = 30\n\n[gear]", 1)
    varied = load_gear_pair(tomllib.loads(relief))
    assert varied.state("pinion.tip_relief.amount") is State.KNOWN
    assert {*varied.assumed} - {*pair.assumed} == {"pinion.tip_relief.shape"}


@pytest.mark.parametrize("name", preset_names())
def test_a_preset_says_why_where_the_program_would_assume_it_too(name):
    """One preset is an example all of which is assumed: the program has no reason for any of it."""
    pair = load_gear_pair(name)
    known = reasons(pair)
    assert known.keys() <= pair.assumed.keys()
    assert bool(known) == (name != "high_contact_ratio_29_47")


def test_an_assumption_of_the_user_has_not_the_reason_of_the_program():
    pair = load_gear_pair(tomllib.loads(new_pair_text("x", DRAWING)))
    with_sources = pair.with_({"pinion.youngs_modulus": 3.0, "gear.roughness": 1.6})
    with_sources = with_sources.with_(
        {"assumed": with_sources.assumed.to_mapping() | {"pinion.youngs_modulus": 3.0}}
    )
    assert reasons(with_sources).keys() == with_sources.assumed.keys() - {"pinion.youngs_modulus"}
    assert reasons(with_sources)["gear.youngs_modulus"] == "steel"


@pytest.mark.parametrize(
    ("module", "backlash"),
    # 2/3 (0.06 + 0.0005 x 75 + 0.03 x 2.5) mm; at module 0.5 that is 0.065 mm, more than a tenth of it.
    [(2.5, 0.115), (0.5, 0.05)],
)
def test_an_own_pair_has_the_backlash_of_industrial_gears(module, backlash):
    drawing = {"teeth": "19/41", "basic_rack.module": module, "gears.face_width": 8.0 * module}
    drawing |= {"operating.pinion_speed": 1450.0, "operating.pinion_torque": 0.1}
    pair = load_gear_pair(tomllib.loads(new_pair_text("x", drawing)))
    assert pair.geometry.normal_backlash == pytest.approx(1e-3 * backlash)


THIN = {"gear.bore": 82.0}  # root radius 48.1 mm over 41 mm: 1.17


@pytest.mark.parametrize(
    ("stiffness", "model", "source"),
    [
        ({}, "finite_elements", "computed from the form of both gears"),
        ({"gear.bore": 30.0}, "finite_elements", "computed from the form of both gears"),
        # A thin rim on its own becomes oval: what holds its bore decides, and no drawing says it.
        (THIN, "energy", "as of a solid body"),
        (THIN | {"mesh.stiffness.model": "finite_elements"}, "finite_elements", GIVEN),
        (THIN | {"mesh.stiffness.plane": "strain"}, "finite_elements", "computed from the form"),
    ],
)
def test_the_teeth_of_a_new_pair_are_finite_elements_but_for_thin_rims(stiffness, model, source, monkeypatch):
    # What writes a file solves nothing.
    monkeypatch.setattr("lumped.elasticity.gear.flank_compliance", None)
    drawing = {"teeth": "19/41", "basic_rack.module": 2.5, "gears.face_width": 20.0}
    drawing |= {"operating.pinion_speed": 1450.0, "operating.pinion_torque": 80.0}
    pair = load_gear_pair(tomllib.loads(new_pair_text("x", drawing | stiffness)))
    assert pair.mesh.stiffness.model == model
    words = dict(pair.sources) | reasons(pair)
    assert words["mesh.stiffness.model"].startswith(source)
