"""Does the page of decisions name everything that the multibody model reads from the lumped model?"""

import ast
import re
from functools import cache

import pytest

from tests.docs.conftest import ROOT

PAGE = "docs/contributing/decisions.md"
HEADING = "| from `lumped` | what it is | checked by |"
#: A module of ``lumped`` in a row: every name of the module may be imported.
_MODULE = re.compile(r"`(lumped(?:\.\w+)+)`")
_NAME = re.compile(r"`(\w+)`")
_FILE = re.compile(r"`((?:tests|docs|validation|lumped|multibody)/[\w./]*)`")


@cache
def rows() -> tuple[tuple[str, str, str], ...]:
    """The rows of the table: what is read, what it is, what checks it."""
    lines = (ROOT / PAGE).read_text(encoding="utf-8").splitlines()
    first = lines.index(HEADING) + 2
    table = []
    for line in lines[first:]:
        if not line.startswith("|"):
            break
        read, what, checked = (cell.strip() for cell in line.strip("|").split(" | "))
        table.append((read, what, checked))
    return tuple(table)


@cache
def imports() -> frozenset[tuple[str, str]]:
    """Module of ``lumped`` and imported name, of every import in the multibody model, wherever in a file."""
    read = set()
    for path in sorted((ROOT / "multibody").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                whole = [alias.name for alias in node.names if alias.name.split(".")[0] == "lumped"]
                assert not whole, f"{path}: import the names of {whole[0]}, for the table of {PAGE}"
            elif isinstance(node, ast.ImportFrom) and str(node.module).split(".")[0] == "lumped":
                read |= {(str(node.module), alias.name) for alias in node.names}
    return frozenset(read)


def not_in(table: tuple[tuple[str, str, str], ...]) -> list[str]:
    """Imports that no row names, neither by name nor by module."""
    cells = " ".join(read for read, _, _ in table)
    modules = set(_MODULE.findall(cells))
    names = set(_NAME.findall(cells))
    return sorted(
        f"{module}.{name}" for module, name in imports() if module not in modules and name not in names
    )


def test_every_name_that_the_multibody_model_imports_is_in_the_table():
    assert not_in(rows()) == [], f"add a row to the table of {PAGE}, with what else checks the name"


def test_every_name_of_the_table_is_imported():
    """A row that outlives its import claims a dependence that is gone."""
    modules = {module for module, _ in imports()}
    names = {name for _, name in imports()}
    cells = " ".join(read for read, _, _ in rows())
    assert set(_MODULE.findall(cells)) <= modules
    assert set(_NAME.findall(cells)) <= names


def test_every_row_names_files_that_exist():
    missing = [file for row in rows() for file in _FILE.findall(" ".join(row)) if not (ROOT / file).exists()]
    assert missing == []


@pytest.mark.parametrize("row", range(len(rows())))
def test_a_table_without_one_row_is_seen(row):
    table = rows()
    assert not_in(table[:row] + table[row + 1 :]), f"row {table[row][0]} names nothing that is imported"


def test_an_import_beyond_the_table_is_seen(monkeypatch):
    more = imports() | {("lumped.model.powers", "losses_of")}
    monkeypatch.setitem(globals(), "imports", lambda: more)
    assert not_in(rows()) == ["lumped.model.powers.losses_of"]
