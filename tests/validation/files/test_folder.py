"""Which folders may results replace, what stays the user's, and what is left after success and failure?"""

import pytest

from lumped import ParameterError
from lumped.errors import StorageError
from validation.files.folder import CONTENTS, Kind, check_target, whole_folder


def write(out, files, **options):
    with whole_folder(out, **{"force": True, **options}) as folder:
        for name, text in files.items():
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_text(text)


def tree(folder):
    """Relative path -> text of every file, hidden ones included."""
    return {p.relative_to(folder).as_posix(): p.read_text() for p in folder.rglob("*") if p.is_file()}


def names(folder):
    return sorted(p.name for p in folder.iterdir())


def test_a_new_folder_appears_only_at_the_end(tmp_path):
    out = tmp_path / "a" / "b"
    with whole_folder(out, force=False) as folder:
        (folder / "x").write_text("1")
        assert not out.exists()
    assert names(out) == [CONTENTS, "x"]
    assert names(out.parent) == ["b"]


def test_an_empty_folder_is_filled(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    write(out, {"x": "1"}, force=False)
    assert names(out) == [CONTENTS, "x"]


def test_force_replaces_the_earlier_results_whole(tmp_path):
    out = tmp_path / "out"
    write(out, {"page": "old", "figures/a.png": "old"})
    write(out, {"page": "new", "data/x": "new"})
    found = tree(out)
    found.pop(CONTENTS)
    assert found == {"page": "new", "data/x": "new"}
    assert names(out) == [CONTENTS, "data", "page"]
    assert names(tmp_path) == ["out"]


def test_a_folder_with_a_file_of_the_user_is_not_replaced(tmp_path):
    out = tmp_path / "out"
    write(out, {"page": "old", "figures/a.png": "old"})
    (out / "figures" / "mine.png").write_text("mine")
    before = tree(out)
    with pytest.raises(ParameterError, match=r"mine\.png.*move it elsewhere"):
        write(out, {"page": "new"})
    assert tree(out) == before


@pytest.mark.parametrize(
    "content", ["{}", "[1]", "no json", '{"format": "other", "files": []}', '{"format": "spurcheck-report"}']
)
def test_a_folder_without_a_list_of_ours_is_not_touched(tmp_path, content):
    out = tmp_path / "out"
    out.mkdir()
    (out / "report.json").write_text('{"format": "spurcheck-report"}')
    (out / CONTENTS).write_text(content)
    before = tree(out)
    with pytest.raises(ParameterError, match="nothing in it is replaced"):
        check_target(out, force=True)
    assert tree(out) == before


def test_results_of_another_kind_are_not_replaced(tmp_path):
    out = tmp_path / "out"
    write(out, {"x": "1"}, kind=Kind("other.json", "spurcheck-other", "other result"))
    with pytest.raises(ParameterError, match="an earlier report"):
        check_target(out, force=True)


def test_a_failure_at_the_last_step_puts_everything_back(tmp_path, monkeypatch):
    out = tmp_path / "out"
    write(out, {"a": "old", "b": "old"})
    before = tree(out)
    own = type(out).rename

    def move(here, there):
        if here.name == "new":
            raise OSError(28, "No space left on device")
        return own(here, there)

    monkeypatch.setattr(type(out), "rename", move)
    with pytest.raises(StorageError, match="No space left"):
        write(out, {"a": "new", "b": "new"})
    assert tree(out) == before
    assert names(tmp_path) == ["out"]


def test_content_that_appears_meanwhile_is_not_lost(tmp_path):
    out = tmp_path / "out"
    with pytest.raises(ParameterError, match="not empty"), whole_folder(out, force=False) as folder:  # noqa: PT012
        (folder / "x").write_text("1")
        out.mkdir()
        (out / "theirs").write_text("2")
    assert names(out) == ["theirs"]
    assert names(tmp_path) == ["out"]


def test_a_full_disk_names_the_folder_and_leaves_nothing(tmp_path):
    out = tmp_path / "a" / "out"
    with pytest.raises(StorageError, match=str(out)), whole_folder(out, force=False):
        raise OSError(28, "No space left on device")
    assert names(tmp_path) == []


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
    assert names(tmp_path) == []


def test_a_link_to_a_folder_is_not_followed(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path, target_is_directory=True)
    with pytest.raises(ParameterError, match="This is a link"):
        check_target(tmp_path / "link", force=True)
