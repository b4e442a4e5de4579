"""Does every entry of the reference have an example, and do the examples of the pages run?

An example stands below its entry on the page, or in the docstring, where the tests of the package run it.
"""

import doctest
import importlib
import inspect
import re
import tempfile

import pytest

from tests.docs.conftest import ROOT

FOLDER = ROOT / "docs" / "reference"
PAGES = ("lumped", "multibody", "floquet", "validation")
_ENTRY = re.compile(r"^\.\. auto\w+:: (?P<name>\S+)\n(?P<body>(?:\s*\n|   .*\n)*)", re.MULTILINE)
_BLOCK = re.compile(r"^```\{eval-rst\}\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def documented(name):
    """The object of an entry: a function may hide the module of its name, as in validation.check.check."""
    parts = name.split(".")
    for length in range(len(parts) - 1, 0, -1):
        try:
            thing = importlib.import_module(".".join(parts[:length]))
            for part in parts[length:]:
                thing = getattr(thing, part)
        except (ImportError, AttributeError):
            continue
        return thing
    raise LookupError(name)


def without_example(text):
    """Names of the entries of a page that have an example neither there nor in their docstring."""
    return [
        entry["name"]
        for entry in _ENTRY.finditer(text)
        if ">>> " not in entry["body"] and ">>> " not in (inspect.getdoc(documented(entry["name"])) or "")
    ]


def failures(text, name):
    """The reports of the examples of a page that fail."""
    examples = "\n".join(_BLOCK.findall(text))
    test = doctest.DocTestParser().get_doctest(examples, {}, name, str(FOLDER / name), 0)
    assert test.examples
    reports = []
    doctest.DocTestRunner(verbose=False).run(test, out=reports.append)
    return "".join(reports)


@pytest.mark.parametrize("page", PAGES)
def test_every_entry_has_an_example(page):
    text = (FOLDER / f"{page}.md").read_text(encoding="utf-8")
    assert _ENTRY.search(text)
    assert without_example(text) == [], (
        f"write an example below each of these entries of docs/reference/{page}.md"
    )


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_the_examples_of_a_page_run(page, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    assert failures((FOLDER / f"{page}.md").read_text(encoding="utf-8"), page) == ""


def test_a_missing_and_a_wrong_example_are_seen():
    entries = ".. autofunction:: lumped.geometry\n\n.. autofunction:: lumped.bodies\n\n   >>> 1 + 1\n   3\n"
    page = f"```{{eval-rst}}\n{entries}```\n"
    assert without_example(page) == ["lumped.geometry"]
    assert "Expected:\n    3" in failures(page, "page")
    assert failures(page.replace("   3", "   2"), "page") == ""
