"""Does every link, path and name on the pages lead somewhere?"""

import importlib
import re
from pathlib import Path

import pytest

import floquet
import lumped
import multibody
import validation

_LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
_PATH = re.compile(
    r"\b(?:tests|docs|examples|benchmarks|lumped|multibody|floquet|validation)/[\w/.-]+\.(?:py|md|toml)"
)
_TEST = re.compile(r"`(test_\w+\.py)`")
_NAME = re.compile(r"`((?:lumped|multibody|floquet|validation)(?:\.\w+)+)")
_INCLUDE = re.compile(r"^```\{(?:include|figure)\} (\S+)", re.MULTILINE)


def slug(heading: str) -> str:
    """Anchor of a heading as GitHub and MyST make it."""
    plain = re.sub(r"[`*_]|\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
    return re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", plain))


def anchors(page: Path) -> set[str]:
    if page.parts[-2:] == ("contributing", "index.md"):  # the site shows the file of the repository there
        page = page.parents[2] / "CONTRIBUTING.md"
    text = page.read_text(encoding="utf-8")
    labels = set(re.findall(r"^\(([\w-]+)\)=$", text, re.M))
    return {slug(heading) for heading in re.findall(r"^#+ (.+)$", text, re.M)} | labels


def test_links_inside_the_repository_resolve(page):
    for target in _LINK.findall(page.read_text(encoding="utf-8")):
        if re.match(r"[a-z]+:", target):
            continue
        place, _, anchor = target.partition("#")
        path = (page.parent / place).resolve() if place else page
        if path.name == "index.rst" and path.parent.name == "gallery":  # written by the build
            continue
        assert path.exists(), f"{target} in {page}"
        if anchor and path.suffix == ".md":
            assert anchor in anchors(path), f"{target} in {page}"


def test_files_that_are_named_exist(page, root):
    text = page.read_text(encoding="utf-8")
    for name in _PATH.findall(text):
        assert (root / name).exists(), f"{name} in {page}"
    for name in _TEST.findall(text):
        assert (page.parent / name).exists() or list((root / "tests").rglob(name)), f"{name} in {page}"


def test_python_names_exist(page):
    if page.name == "CHANGELOG.md":  # it names what is gone, too
        return
    for name in _NAME.findall(page.read_text(encoding="utf-8")):
        parts = name.split(".")
        found: object = importlib.import_module(parts[0])
        for i, part in enumerate(parts[1:], start=2):
            if not hasattr(found, part):
                found = importlib.import_module(".".join(parts[:i]))
            else:
                found = getattr(found, part)


def test_included_files_are_written_by_the_build_or_exist(page, root, monkeypatch):
    monkeypatch.syspath_prepend(str(root / "docs"))
    written = importlib.import_module("computed").writers()
    for target in _INCLUDE.findall(page.read_text(encoding="utf-8")):
        _, generated, name = target.rpartition("_generated/")
        assert name in written if generated else (page.parent / target).exists(), f"{target} in {page}"


def test_the_checks_see_what_is_broken(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("# A title, with `code`\n(label)=\n")
    assert anchors(page) == {"a-title-with-code", "label"}
    assert _LINK.findall("[a](b.md#c) ![d](e.png)") == ["b.md#c", "e.png"]
    assert _NAME.findall("`lumped.simulate(pair)`") == ["lumped.simulate"]


PACKAGES = (lumped, multibody, floquet, validation)


@pytest.mark.parametrize("package", PACKAGES, ids=lambda p: p.__name__)
def test_every_public_name_is_in_the_reference_once(package, root):
    text = (root / "docs" / "reference" / f"{package.__name__}.md").read_text(encoding="utf-8")
    listed = re.findall(r"^\.\. auto\w+:: (\S+)$", text, re.M)
    assert len(listed) == len(set(listed))
    public = {f"{package.__name__}.{name}" for name in package.__all__}
    assert public <= set(listed)


def test_every_page_is_reachable(root):
    """Every page of the site stands in a toctree."""
    pages = {p for p in root.glob("docs/**/*.md") if not {"_generated", "gallery"} & set(p.parts)}
    listed = set()
    for page in pages:
        for tree in re.findall(r"^```\{toctree\}\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S):
            entries = [line for line in tree.splitlines() if line and not line.startswith(":")]
            listed |= {(page.parent / f"{entry}.md").resolve() for entry in entries}
    assert {p.resolve() for p in pages} - listed == {(root / "docs" / "index.md").resolve()}
