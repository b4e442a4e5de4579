"""Does a file that contradicts itself still become a draft, with just the doubtful lines marked?"""

import pytest

import lumped
from validation.exchange import gear_pair_from_rexs, parameter_text, write_rexs


def attribute(key, value, unit="none"):
    return f'<attribute id="{key}" unit="{unit}">{value}</attribute>'


def doubtful(path):
    """Fields whose lines of the draft are marked; the draft must be one that the other commands take."""
    mapping, notes = gear_pair_from_rexs(path)
    lumped.load_gear_pair(mapping)
    text = parameter_text(mapping, notes)
    marked = {key for key, source in mapping["sources"].items() if "; doubtful: " in source}
    lines = [line for line in text.partition("[sources]")[0].splitlines() if line.endswith("doubtful")]
    assert len(lines) == len(marked)
    assert bool(marked) == any(note.startswith("doubtful: ") for note in notes)
    return marked


def test_files_without_a_contradiction_have_no_doubtful_line(xml, save, preset, tmp_path):
    assert doubtful(save(xml())) == set()
    assert doubtful(write_rexs(preset, tmp_path / "pair.rexs")) == set()


@pytest.mark.parametrize("centre", ["48", "0", "52", "502"])
def test_a_centre_distance_that_no_pair_has_gives_way_to_that_of_the_teeth(xml, save, centre):
    path = save(xml().replace(">50.2<", f">{centre}<"))
    assert doubtful(path) == {"centre_distance"}
    mapping, notes = gear_pair_from_rexs(path)
    # a = m (z1 + z2) cos(alpha) / (2 cos(alpha_w)), inv(alpha_w) = inv(alpha) + 2 tan(alpha) x/(z1 + z2)
    assert mapping["centre_distance"] == pytest.approx(50.1971, abs=1e-4)
    assert f"center_distance has {centre} mm" in " ".join(notes)


def test_a_backlash_reckoned_with_a_wrong_centre_distance_goes_with_it(xml, save):
    limits = "".join(attribute(f"{key}_normal_backlash", 0.1, "mm") for key in ("minimum", "maximum"))
    path = save(xml(stage=limits).replace(">50.2<", ">0<"))
    assert doubtful(path) == {"centre_distance", "mesh.backlash"}


def test_more_backlash_than_gears_have_is_doubtful_but_kept(xml, save):
    path = save(xml().replace(">50.2<", ">51<"))
    assert doubtful(path) == {"centre_distance"}
    assert gear_pair_from_rexs(path)[0]["centre_distance"] == 51.0


@pytest.mark.parametrize("tip", ["1", "40", "48"])
def test_a_tip_diameter_that_no_pair_has_gives_way_to_that_of_the_rack(xml, save, tip):
    path = save(xml().replace(">44.2<", f">{tip}<"))
    assert doubtful(path) == {"pinion.tip_diameter"}
    assert gear_pair_from_rexs(path)[0]["pinion"]["tip_diameter"] == pytest.approx(44.4, rel=1e-12)


def test_several_wrong_values_are_left_out_together(xml, save):
    path = save(xml().replace(">2<", ">3<"))  # module 3 mm beside diameters of module 2 mm
    assert doubtful(path) == {"centre_distance", "pinion.tip_diameter"}


@pytest.mark.parametrize(
    "version", ["1.0", "1.3", "0.9", "", "one", "1.4.x", "2.1.0", "99999999999999999999.0"]
)
def test_other_versions_are_read_where_they_are_understood_and_a_note_names_them(xml, save, leaves, version):
    mapping, notes = gear_pair_from_rexs(save(xml(version=version)))
    assert leaves(mapping) == leaves(gear_pair_from_rexs(save(xml()))[0])
    assert any(f"of REXS version {version or '(not given)'};" in note for note in notes)
    assert not any("REXS version" in note for note in gear_pair_from_rexs(save(xml()))[1])


def test_flanks_of_the_first_versions_are_not_taken_for_known(xml, save):
    angle = attribute("normal_pressure_angle", 25, "deg")
    flank = f'<component id="77" type="flank_geometry">{angle}</component>'
    fields = {"pinion.profile_shift", "gear.profile_shift", "basic_rack.pressure_angle"}
    assert doubtful(save(xml(version="1.2", components=flank))) == fields
