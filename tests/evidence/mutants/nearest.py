"""Which tests are nearest to a module: those of its folder, then those that import it over fewest steps."""

from __future__ import annotations

import ast
from collections import defaultdict
from pathlib import Path

#: Folders of tests that judge layout, words and catalogues of lines, not what is computed.
_NO_JUDGES = (
    "tests/meta/",
    "tests/packaging/",
    "tests/docs/",
    "tests/evidence/faults/",
    "tests/evidence/mutants/",
)
_PACKAGES = ("lumped", "multibody", "floquet", "validation", "tests")
_FAR = 99


class Nearest:
    """The imports of a tree, followed from a module to the tests."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.importers: dict[str, set[str]] = defaultdict(set)
        for path in (path for name in _PACKAGES for path in (root / name).rglob("*.py*")):
            if path.suffix in (".py", ".pyi"):
                for name in _imports(path, root):
                    self.importers[name].add(_module(path.relative_to(root)))
        self.tests = sorted(
            file for path in (root / "tests").rglob("test_*.py")
            if not (file := path.relative_to(root).as_posix()).startswith(_NO_JUDGES)
        )  # fmt: skip

    def files(self, file: str) -> tuple[list[str], list[str]]:
        """Return the tests of the folder of a library's file and the other tests, both nearest first."""
        steps = 0
        reached = {_module(Path(file))}
        distance = dict.fromkeys(reached, 0)
        while reached:
            steps += 1
            reached = {one for name in reached for one in self.importers[name]} - distance.keys()
            distance |= dict.fromkeys(reached, steps)

        def rank(test: str) -> tuple[bool, int, str]:
            return Path(test).stem != f"test_{Path(file).stem}", distance.get(_module(Path(test)), _FAR), test

        of_folder = sorted(self._folder(Path(file)), key=rank)
        others = [test for test in self.tests if test not in of_folder and _module(Path(test)) in distance]
        return of_folder, sorted(others, key=rank)

    def _folder(self, file: Path) -> list[str]:
        """Tests of the folder of a file. For a file directly in a package: tests beside the folders."""
        folder = Path("tests") / file.parent
        if len(file.parts) == 2:
            return [test for test in self.tests if Path(test).parent == folder]
        while not (self.root / folder).is_dir():
            folder = folder.parent
        return [test for test in self.tests if test.startswith(f"{folder.as_posix()}/")]


def _module(file: Path) -> str:
    """Dotted name of a file; a package has that of its folder."""
    parts = [*file.parts[:-1], *([file.stem] if file.stem != "__init__" else [])]
    return ".".join(parts)


def _imports(path: Path, root: Path) -> set[str]:
    """Modules that a file imports, at the top or inside functions, completely or by name."""
    names = set()
    package = path.relative_to(root).parent.parts
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            before = package[: len(package) + 1 - node.level] if node.level else ()
            base = ".".join([*before, *([node.module] if node.module else [])])
            names |= {base, *(f"{base}.{alias.name}" for alias in node.names)}
    return names
