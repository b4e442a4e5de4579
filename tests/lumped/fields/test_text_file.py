"""Are files that cannot be read refused with the reason?"""

import pytest

from lumped.errors import ParameterError
from lumped.fields.text_file import read_bytes, read_text


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda path: None, "that exists"),
        (lambda path: path.mkdir(), "folder or a device"),
        (lambda path: path.symlink_to(path), "levels of symbolic links"),
        (lambda path: path.symlink_to("/dev/zero"), "folder or a device"),
        (lambda path: path.write_bytes(b"a = 'caf\xe9'"), "byte 8 is no UTF-8"),
        (lambda path: path.write_bytes(b"x" * 11), "<= 10 bytes"),
    ],
)
def test_files_that_are_no_text_say_why(tmp_path, make, words):
    make(tmp_path / "file")
    with pytest.raises(ParameterError, match=words) as caught:
        read_text(tmp_path / "file", 10 if "10 bytes" in words else 100, field="data", kind="CSV file")
    assert caught.value.problems[0].field == "data"
    assert str(tmp_path / "file") in caught.value.problems[0].value


@pytest.mark.parametrize(
    ("name", "words"), [("a\0b", "cannot be read: embedded null byte"), ("a" * 5000, "name too long")]
)
def test_names_that_no_file_can_have(name, words):
    with pytest.raises(ParameterError, match=words):
        read_bytes(name, 10)
