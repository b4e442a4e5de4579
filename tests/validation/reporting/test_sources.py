"""Sources that the report prints beside the parameters."""

import lumped
from lumped.schema.files import preset_text
from lumped.schema.pair import leaf_paths
from validation.reporting.sources import is_assumed, source_of


def test_a_preset_source_of_a_value_edited_since_counts_as_assumed(tmp_path):
    path = tmp_path / "own.toml"
    text = preset_text("fzg_c")
    edited = text.replace("face_width = 14.0", "face_width = 20.0")
    assert edited.count("face_width = 20.0") == 2
    path.write_text(edited)
    preset, own = lumped.load_gear_pair("fzg_c"), lumped.load_gear_pair(path)
    stale = {field for field in leaf_paths(own) if is_assumed(source_of(own, field))}
    known = {field for field in leaf_paths(preset) if is_assumed(source_of(preset, field))}
    assert stale - known == {"pinion.face_width", "gear.face_width"}
    assert "fzg_c" in source_of(own, "pinion.face_width")


def test_values_without_a_source_count_as_assumed(pair):
    assert is_assumed(source_of(pair, "bearings.pinion.loa_stiffness"))  # from the section's own entry
    assert is_assumed(source_of(pair, "basic_rack.addendum_coefficient"))  # no entry at all
    assert not is_assumed(source_of(pair, "pinion.teeth"))
