"""Is every public name in the reference, once, under a concept?"""

import re

import pytest

import floquet
import lumped
import multibody
import validation

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
