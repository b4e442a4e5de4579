"""Can a file that somebody else wrote run code, or write outside the output folder?"""

from __future__ import annotations

import os
import sys

import pytest

from lumped import load_gear_pair
from lumped.errors import ParameterError
from validation.studies import load_study, run_sweep

HOSTILE_NAMES = [
    "../../outside",
    "/tmp/outside",
    "$(touch outside)",
    "`touch outside`",
    "__import__('os').system('touch outside')",
    "{{ cycler.__init__.__globals__.os.system('touch outside') }}",
    "<script>alert(1)</script>",
    "[/bold][link=file:///etc/passwd]x",
    "=cmd|' /C calc'!A0",
]


def files_below(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def study(**changes):
    data = {
        "name": "s",
        "gear_pair": "nasa_28_28",
        "analysis": "geometry",
        "outputs": ["contact_ratio"],
        "axes": [{"field": "speed_rpm", "values": [1000, 2000]}],
    }
    return load_study(data | changes)


@pytest.mark.parametrize("name", HOSTILE_NAMES)
def test_text_in_a_study_is_only_text(tmp_path, monkeypatch, name):
    inner = tmp_path / "a" / "b"  # two folders deep, so that ../../outside is seen
    inner.mkdir(parents=True)
    monkeypatch.chdir(inner)
    pair = load_gear_pair("nasa_28_28").with_(name=name, description=name)
    run_sweep(study(name=name, description=name, gear_pair=pair), inner / "out")
    assert files_below(tmp_path) == [f"a/b/out/{file}" for file in (".lock", "results.nc", "store.sqlite")]
    assert not os.path.exists("/tmp/outside")


@pytest.mark.parametrize("text", ["a\x1b]0;owned\x07b", "a\0b", "a\x9b31m"])
@pytest.mark.parametrize("field", ["name", "description"])
def test_text_has_no_control_characters(field, text):
    for load in (load_gear_pair("nasa_28_28").with_, study):
        with pytest.raises(ParameterError, match="control characters") as caught:
            load(**{field: text})
        assert text not in str(caught.value)


@pytest.mark.parametrize("name", HOSTILE_NAMES)
def test_an_axis_is_named_by_a_word(name):
    with pytest.raises(ParameterError, match=r"axes\.0\.name"):
        study(axes=[{"field": "speed_rpm", "name": name, "values": [1]}])


@pytest.mark.parametrize(
    "field",
    [
        "__class__",
        "operating.__class__",
        "model_config",
        "with_",
        "operating.pinion_speed.real",
        "name",
        "sources",
    ],
)
def test_a_field_is_a_field_of_the_schema(field):
    with pytest.raises(ParameterError, match="field"):
        study(axes=[{"field": field, "values": [1]}])


@pytest.mark.skipif(sys.platform == "win32", reason="symbolic links")
def test_a_link_in_the_place_of_the_result_is_not_followed(tmp_path):
    target = tmp_path / "precious"
    target.write_text("do not touch")
    run_sweep(study(), tmp_path / "out")
    (tmp_path / "out" / "results.nc").unlink()
    os.symlink(target, tmp_path / "out" / "results.nc")
    run_sweep(study(), tmp_path / "out", resume=True)
    assert target.read_text() == "do not touch"
