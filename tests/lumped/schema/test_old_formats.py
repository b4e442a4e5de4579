"""Does a parameter file of format 1 mean what it meant, and does reading it say where that differs today?"""

import tomllib
import warnings
from pathlib import Path

import pytest

from lumped import ParameterError, load_gear_pair
from lumped.errors import OldFormatWarning
from tests.unlike_pairs import UNLIKE, unlike_pair

TEXTS = {name: unlike_pair(name).to_toml().replace("format = 2\n", "format = 1\n", 1) for name in UNLIKE}


def saved(tmp_path: Path, text: str) -> Path:
    file = tmp_path / "old.toml"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize("head", ["format = 1\n", ""])
@pytest.mark.parametrize("name", ["rack_25_degrees_always_pushing", "unlike_teeth_finite_elements"])
def test_tips_of_an_old_file_are_full_and_it_says_what_they_are_today(tmp_path, name, head):
    today = unlike_pair(name)
    text = TEXTS[name].replace("format = 1\n", head, 1)
    with pytest.warns(OldFormatWarning, match="tips are not altered") as caught:
        old = load_gear_pair(saved(tmp_path, text))
    assert f"{1e3 * today.tip_alteration:.4g} mm" in str(caught[0].message)
    assert "Write format = 2" in str(caught[0].message)
    for wheel, teeth in zip(old.wheels, (old.pinion.teeth, old.gear.teeth), strict=True):
        rack = old.basic_rack
        full = rack.module * (0.5 * teeth + rack.addendum_coefficient + wheel.tooth.profile_shift)
        assert wheel.tip_radius == pytest.approx(full, rel=1e-14)
    # What the format meant is assumed; written again, in today's format, it means the same and says nothing.
    assert old.assumed["pinion.tip_alteration"] == 0.0
    assert old == today.with_({"pinion.tip_alteration": 0, "gear.tip_alteration": 0}).with_(
        {"sources": dict(old.sources), "assumed": old.assumed.to_mapping()}
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert load_gear_pair(saved(tmp_path, old.to_toml())) == old


def test_shifts_of_an_old_file_are_none_beside_a_centre_distance(tmp_path):
    text = TEXTS["heavily_relieved_under_load"]
    text = "".join(line for line in text.splitlines(keepends=True) if "profile_shift" not in line)
    centre_distance = load_gear_pair(tomllib.loads(text)).geometry.centre_distance * 1e3 + 0.2
    text = text.replace("format = 1\n", f"format = 1\ncentre_distance = {centre_distance!r}\n", 1)
    with pytest.warns(
        OldFormatWarning, match=r"no profile shifts are written and 0 is taken; .* asks for 0\.0"
    ):
        old = load_gear_pair(saved(tmp_path, text))
    assert old.profile_shifts == (0.0, 0.0)
    assert old.geometry.normal_backlash > old.mesh.backlash + 0.1e-3
    new = load_gear_pair(saved(tmp_path, text.replace("format = 1\n", "format = 2\n", 1)))
    assert min(new.profile_shifts) > 0.01
    assert new.geometry.normal_backlash == pytest.approx(new.mesh.backlash, abs=1e-12)


def test_an_old_file_that_gives_its_tips_means_the_same_today(tmp_path):
    pair = load_gear_pair("fzg_c")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert load_gear_pair(saved(tmp_path, pair.to_toml().replace("format = 2\n", "", 1))) == pair


@pytest.mark.parametrize("value", [0, 3, 1.0, "1", True])
def test_a_format_that_is_none_is_refused(value):
    with pytest.raises(ParameterError, match=r"format = .*allowed 1 or 2, the formats of this release"):
        load_gear_pair(load_gear_pair("fzg_c").to_mapping() | {"format": value})
