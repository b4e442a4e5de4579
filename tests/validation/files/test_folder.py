"""Which folders may a report replace, and what is left after success and failure?"""

import json

import pytest

from lumped import ParameterError
from validation.files.folder import FORMAT, check_target, is_report, whole_folder


def _earlier(folder):
    folder.mkdir()
    (folder / "report.json").write_text(json.dumps({"format": FORMAT}))
    (folder / "old.txt").write_text("old")
    return folder


def test_a_new_folder_appears_only_at_the_end(tmp_path):
    out = tmp_path / "a" / "b"
    with whole_folder(out, force=False) as folder:
        (folder / "x").write_text("1")
        assert not out.exists()
    assert [p.name for p in out.iterdir()] == ["x"]
    assert [p.name for p in out.parent.iterdir()] == ["b"]


def test_an_empty_folder_is_filled(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    with whole_folder(out, force=False) as folder:
        (folder / "x").write_text("1")
    assert (out / "x").exists()


def test_force_replaces_an_earlier_report_completely(tmp_path):
    out = _earlier(tmp_path / "out")
    with whole_folder(out, force=True) as folder:
        (folder / "x").write_text("1")
    assert [p.name for p in out.iterdir()] == ["x"]
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


def test_force_does_not_replace_anything_else(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "thesis.tex").write_text("years of work")
    for content in ("{}", "[1]", "no json", '{"format": "other"}'):
        (out / "report.json").write_text(content)
        assert not is_report(out)
        with pytest.raises(ParameterError, match="does not delete"):
            check_target(out, force=True)
    assert (out / "thesis.tex").exists()


def _write_while_someone_else_does(out):
    with whole_folder(out, force=False) as folder:
        (folder / "x").write_text("1")
        out.mkdir()
        (out / "theirs").write_text("2")


def test_content_that_appears_meanwhile_is_not_lost(tmp_path):
    out = tmp_path / "out"
    with pytest.raises(ParameterError, match="not empty"):
        _write_while_someone_else_does(out)
    assert [p.name for p in out.iterdir()] == ["theirs"]
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


def test_a_file_and_a_place_below_a_file_are_refused(tmp_path):
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(ParameterError, match="This is a file"):
        check_target(file, force=True)
    with pytest.raises(ParameterError, match="cannot be written"), whole_folder(file / "out", force=False):
        raise AssertionError("no folder should be given")


def test_a_folder_that_cannot_be_made_is_refused_before_work(tmp_path, monkeypatch):
    def denied(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("tempfile.mkdtemp", denied)
    with (
        pytest.raises(ParameterError, match="Permission denied"),
        whole_folder(tmp_path / "out", force=False),
    ):
        raise AssertionError("no folder should be given")
    assert list(tmp_path.iterdir()) == []
