"""Do imports run one way, as the architecture page says? Is the Floquet engine free of gears?"""

import ast
import functools
import graphlib
import itertools
import re
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

import floquet

ROOT = Path(floquet.__file__).parents[1]
#: Package -> what it may import.
MAY_IMPORT = {
    "lumped": set(),
    "multibody": {"lumped"},
    "floquet": {"lumped"},
    "validation": {"lumped", "multibody", "floquet"},
}
FILES = sorted(path for package in MAY_IMPORT for path in (ROOT / package).rglob("*.py"))
MODULES = {
    "spurcheck",  # the face of all packages, which none of them imports
    *(".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__") for path in FILES),
}


def named(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


@functools.cache
def imported(path: Path) -> frozenset[str]:
    """Every module of this project that a file imports, wherever in it, for types alone too."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= names & MODULES or {str(node.module)}
    return frozenset(found & MODULES)


def arrows() -> Iterator[tuple[tuple[str, ...], str, str, str]]:
    """Folder, importing entry and imported entry of it (file or folder), and the words for a message."""
    for path in FILES:
        if path.name == "__init__.py":  # the face of its folder, which re-exports
            continue
        here = path.relative_to(ROOT).with_suffix("").parts
        for module in imported(path):
            there = tuple(module.split("."))
            same = 0
            while same < min(len(here), len(there)) and here[same] == there[same]:
                same += 1
            if 0 < same < len(here):
                to = there[same] if same < len(there) else "__init__"
                yield here[:same], here[same], to, f"{named(path)} imports {module}"


def test_packages_are_imported_in_one_direction() -> None:
    against = []
    for path in FILES:
        package = path.relative_to(ROOT).parts[0]
        others = {module.split(".")[0] for module in imported(path)} - {package}
        against += [f"{named(path)} imports {name}" for name in others - MAY_IMPORT[package]]
    assert against == []


def test_inside_every_folder_arrows_form_no_circle() -> None:
    folders: dict[tuple[str, ...], dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
    words: dict[tuple[tuple[str, ...], str, str], str] = {}
    for folder, start, end, text in arrows():
        assert end != "__init__", f"{text}, which is above it: import the file that defines the name"
        folders[folder][start].add(end)
        words[folder, start, end] = text
    assert ("lumped",) in folders
    for folder, graph in folders.items():
        try:
            graphlib.TopologicalSorter(graph).prepare()
        except graphlib.CycleError as error:
            circle = error.args[1]
            steps = [words[folder, b, a] for a, b in itertools.pairwise(circle)]
            pytest.fail(f"{'/'.join(folder)}: " + "; ".join(steps))


#: What the folders that hold for any periodic system may use of the gear model: nothing that knows gears.
NO_GEARS = {
    f"lumped.{name}"
    for name in (
        "arguments",
        "cache",
        "compiler",
        "display.progress",
        "display.result",
        "errors",
        "gauss_legendre",
        "labelling",
        "typing",
    )
}


@pytest.mark.parametrize("folder", ["engine", "rank_one", "orbits"])
def test_general_folders_of_floquet_know_no_gears(folder: str) -> None:
    for path in sorted((ROOT / "floquet" / folder).rglob("*.py")):
        gears = {name for name in imported(path) if name.startswith(("lumped", "floquet.gear"))} - NO_GEARS
        assert not gears, named(path)


def test_the_tests_above_see_imports() -> None:
    assert "lumped.model.periodic_system" in imported(ROOT / "floquet" / "gear" / "multipliers.py")
    assert len(FILES) > 200


def test_functions_survive_the_import_of_all_modules() -> None:
    # Importing a submodule sets it as an attribute of the package: a function of that name must stay.
    imports = "\n".join(f"import {name}" for name in sorted(MODULES) if not name.endswith("__main__"))
    code = imports + (
        "\nimport inspect"
        "\nfor package in (lumped, multibody, floquet, validation):"
        "\n    for name in package.__all__:"
        "\n        assert not inspect.ismodule(getattr(package, name)), name"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def rows_of_the_page() -> dict[str, list[str]]:
    """Package -> files and folders in the order of its table on the architecture page, bottom to top."""
    text = (ROOT / "docs" / "contributing" / "architecture.md").read_text(encoding="utf-8")
    sections = re.findall(r"^### (\w+)\n(.*?)(?=^##)", text, re.MULTILINE | re.DOTALL)
    return {package: re.findall(r"^\| `([\w./]+)` \|", table, re.MULTILINE) for package, table in sections}


def test_the_page_names_every_folder_and_loose_file() -> None:
    pages = rows_of_the_page()
    assert list(pages) == list(MAY_IMPORT)
    for package, names in pages.items():
        top = ROOT / package
        below = [path for path in top.rglob("*") if path.is_dir() and path.name != "__pycache__"]
        there = {f"{path.relative_to(top).as_posix()}/" for path in below if any(path.iterdir())}
        there |= {path.name for path in top.glob("*.py") if path.stem != "__init__"}
        assert sorted(names) == sorted(there), f"docs/contributing/architecture.md, table of {package}"


def test_the_page_orders_them_as_the_imports_run() -> None:
    pages = rows_of_the_page()
    for (package, *inner), start, end, text in arrows():
        names = [name.rstrip("/").removesuffix(".py") for name in pages[package]]
        lower, upper = ("/".join([*inner, name]) for name in (end, start))
        if lower in names and upper in names:
            assert names.index(lower) < names.index(upper), f"{text}: its row on the page stands below"
