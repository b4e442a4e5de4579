"""Is the table of floquet/proven.py complete, and do its functions and sections exist?"""

import ast
import re
from pathlib import Path

import pytest

import floquet.proven

ROOT = Path(floquet.proven.__file__).parents[1]
ROW = re.compile(r"^\| (?!statement)(.+?) \| (\S+\.py): (\w+) \| (.+?) \|$", re.MULTILINE)
ROWS = ROW.findall(floquet.proven.__doc__ or "")
MARK = re.compile(r"\bPROVEN\b")


def definitions(path: Path) -> dict[str, str]:
    """Docstrings of the functions and classes of a file, by name."""
    kinds = (ast.FunctionDef, ast.ClassDef)
    tree = ast.parse(path.read_text())
    return {node.name: ast.get_docstring(node) or "" for node in ast.walk(tree) if isinstance(node, kinds)}


def marked() -> set[tuple[str, str]]:
    """Files and functions whose docstrings say that something is proven."""
    files = [*ROOT.glob("floquet/**/*.py"), *ROOT.glob("lumped/friction/**/*.py")]
    return {
        (path.relative_to(ROOT).as_posix(), name)
        for path in files
        for name, text in definitions(path).items()
        if MARK.search(text)
    }


def test_every_function_that_proves_is_in_the_table_and_the_other_way_round() -> None:
    assert len(ROWS) == len({statement for statement, *_ in ROWS}) > 10
    assert {(file, name) for _, file, name, _ in ROWS} == marked()


@pytest.mark.parametrize("section", sorted({section for *_, section in ROWS}))
def test_every_section_is_in_the_theory_page(section: str) -> None:
    page = (ROOT / "docs/theory/proven_bounds.md").read_text()
    assert f"## {section}\n" in page


def test_every_section_of_the_theory_page_has_a_statement() -> None:
    page = (ROOT / "docs/theory/proven_bounds.md").read_text()
    sections = set(re.findall(r"^## (.+)$", page, re.MULTILINE))
    others = {"What remains an estimate", "What a review checked"}
    assert sections - others == {section for *_, section in ROWS}
