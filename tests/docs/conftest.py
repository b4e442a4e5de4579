"""The pages of the documentation, and the blocks of code on them."""

import importlib
import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.validation.check import motions
from validation.check import check

ROOT = Path(__file__).resolve().parents[2]
#: Written by people; what the build writes is checked by the build.
PAGES = sorted(
    path
    for path in (*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("examples/**/*.md"))
    if not {"_generated", "gallery"} & set(path.relative_to(ROOT).parts)
)
_FENCE = re.compile(r"^```([\w-]+)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_INDENTED = re.compile(r"(?:^    (?:spurcheck|make|python|pytest) .*\n)+", re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """A block of code: its language and its text."""

    language: str
    text: str

    @property
    def commands(self) -> list[str]:
        """Lines of a shell block without comments, joined where they go on."""
        lines = (re.sub(r"\s+#.*", "", line).strip() for line in self.text.replace("\\\n", " ").splitlines())
        return [line for line in lines if line and not line.startswith("#")]


def blocks(page: Path) -> list[Block]:
    """Fenced blocks, and indented ones that start with a command, in their order."""
    text = page.read_text(encoding="utf-8")
    found = [(m.start(), Block(m[1], m[2])) for m in _FENCE.finditer(text)]
    found += [(m.start(), Block("sh", m[0])) for m in _INDENTED.finditer(_FENCE.sub(_blank, text))]
    return [block for _, block in sorted(found, key=lambda item: item[0])]


def _blank(fence: re.Match[str]) -> str:
    return re.sub(r"[^\n]", " ", fence[0])


def named(page: Path) -> str:
    """Test id of a page."""
    return str(page.relative_to(ROOT))


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(autouse=True)
def short_checks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages that call ``spurcheck.check`` search explanations for two seconds: no page reads them.

    Checks of the same pair share its motions. tests/validation/check judges explanations and motions.
    """
    of_check = importlib.import_module("validation.check.check")
    for name in ("lumped_motion", "multibody_motion"):
        monkeypatch.setattr(of_check, name, getattr(motions, name))
    monkeypatch.setitem(inspect.unwrap(check).__kwdefaults__, "budget", 2.0)


@pytest.fixture(params=PAGES, ids=named)
def page(request: pytest.FixtureRequest) -> Path:
    """Every page in turn."""
    return request.param


@pytest.fixture(name="blocks", scope="session")
def read_blocks() -> Callable[[Path], list[Block]]:
    """The function that reads the blocks of a page."""
    return blocks
