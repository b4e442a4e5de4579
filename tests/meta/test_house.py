"""Is the layout kept: folders by subject, files that are read in one sitting, tests beside what they test?"""

from collections import Counter
from pathlib import Path

import pytest
from matplotlib.figure import Figure

ROOT = Path(__file__).parents[2]
PACKAGES = ("lumped", "multibody", "floquet", "validation")
#: Files that every folder of a package may need; everything else has a folder.
LOOSE = {
    "lumped": {"arguments", "bracket_steps", "cache", "calls", "compiler", "compiler_flags",
     "errors", "gauss_legendre", "kernel_stamps", "labelling", "linked_code", "outcomes", "path_function",
     "path_values", "public_names", "quick_compilation", "ranges", "root_in_bracket", "typing"},
    "floquet": {"proven"},
    "validation": {"stop_signals", "cli", "pytest_plugin"},
}  # fmt: skip
#: Folders of tests that belong to no single package.
QUESTIONS = {"meta", "packaging", "docs", "examples", "hardening", "evidence", "reproductions",
             "friction_factors", "unlike_pairs", "guards"}  # fmt: skip
#: Lines of a file, docstrings and blank lines included.
LONGEST = {"library": 700, "tests": 700}


def library() -> list[Path]:
    return sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


def named(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def test_files_have_a_folder() -> None:
    for package in PACKAGES:
        loose = {path.stem for path in (ROOT / package).glob("*.py")} - {"__init__"}
        assert loose <= LOOSE.get(package, set()), f"{package}: which folder do these belong to?"


def test_a_file_is_read_in_one_sitting() -> None:
    tests = sorted((ROOT / "tests").rglob("*.py"))
    sizes = [(path, LONGEST["library"]) for path in library()] + [(path, LONGEST["tests"]) for path in tests]
    long = [named(path) for path, most in sizes if len(path.read_text("utf-8").splitlines()) > most]
    assert long == []


def test_no_prefix_stands_where_a_folder_should() -> None:
    """A file does not repeat its folder's name, and three files that share a first word are a folder."""
    shared: Counter[tuple[Path, str]] = Counter()
    for path in library():
        word, joined, _ = path.stem.partition("_")
        if joined and word:
            shared[path.parent, word] += 1
            assert path.parent.name not in (word, f"{word}s"), named(path)
    crowds = [f"{named(folder)}/{word}_*" for (folder, word), count in shared.items() if count > 2]
    assert crowds == []


def test_tests_stand_in_the_folder_of_what_they_test() -> None:
    top = {path.name for path in (ROOT / "tests").iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert {*PACKAGES} <= top <= {*PACKAGES, *QUESTIONS}
    for package in PACKAGES:
        tested = {path.parent.name for path in (ROOT / "tests" / package).glob("*/test_*.py")}
        folders = {path.parent.name for path in (ROOT / package).glob("*/__init__.py")}
        assert tested == folders, f"tests/{package}"


def figure(xlabel, ylabel):
    drawn = Figure()
    axes = drawn.add_subplot()
    axes.plot([0.0, 1.0], [1e3, 1e9])
    axes.set(xlabel=xlabel, ylabel=ylabel, yscale="log")
    return drawn


@pytest.mark.parametrize(("labels", "word"), [
    (("", "stiffness [N/m]"), "x axis has no label"),
    (("speed", "stiffness [N/m]"), "states no unit"),
    (("pinion speed [rpm]", "stiffness"), "states no unit"),
])  # fmt: skip
def test_missing_labels_and_units_are_found(labels, word, tmp_path):
    with pytest.raises(AssertionError, match=word):
        figure(*labels).savefig(tmp_path / "a.png")
