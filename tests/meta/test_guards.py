"""Has every refusal, range, doubt and flag its row in the table of guards, tests/guards?"""

import ast
import re
from collections import Counter
from pathlib import Path

import pytest

import lumped
from lumped.friction import LAWS
from lumped.stiffness import foundation, iso6336
from tests.guards import rows
from tests.guards.declared import DECLARED, WHOLE, fields
from tests.guards.fits import RANGES
from tests.guards.guard import GEARS
from validation.validity import flags, plausibility

ROOT = Path(lumped.__file__).parents[1]
GUARDS = tuple(rows())
#: Folders whose refusals must have rows.
FOLDERS = ("lumped/schema", "lumped/gear_geometry", "lumped/faults", "lumped/stiffness", "lumped/fields",
           "lumped/friction", "lumped/quasi_static", "lumped/path_of_contact")  # fmt: skip
#: Function that refuses -> place of the field among its arguments.
FIELD = {"refuse": 0, "FieldProblem": 0, "ToothProblem": 0, "off_shaft": 1, "uncovered": 3}
#: What is refused without a limit, by file -> names and the test that has them.
ELSEWHERE = {
    "lumped/fields/refusals.py": "words of pydantic's errors: tests/lumped/schema/test_refusals",
    "lumped/fields/text_file.py": "files: tests/lumped/schema/test_refusals, tests/hardening",
    "lumped/fields/section.py": "assignment: tests/lumped/schema/test_pair; characters: tests/hardening",
    "lumped/schema/changes.py": "short names: tests/lumped/schema/test_pair",
    "lumped/schema/files.py": "files and presets: tests/lumped/schema/test_refusals",
    "lumped/schema/posterior.py": "lists of machines: tests/validation/prediction/test_machines",
    "lumped/schema/own_laws.py": "functions and arrays of the user: tests/lumped/schema/test_own_laws",
}
#: The same of single names: (file, last part of the name) -> the test.
NAMES_ELSEWHERE = {
    ("lumped/schema/pair.py", "pair"): "a call with a position: tests/lumped/schema/test_pair",
    (
        "lumped/schema/pair.py",
        "centre_distance",
    ): "of other teeth, named first: tests/lumped/schema/test_refusals",
    (
        "lumped/schema/operating.py",
        "pinion_power",
    ): "beside a torque: tests/lumped/schema/test_operating",
    ("lumped/schema/old_formats.py", "format"): "of a later release: tests/lumped/schema/test_pair",
    (
        "lumped/schema/tolerances.py",
        "tolerance_class",
    ): "an argument: tests/lumped/schema/test_meeting_teeth",
    ("lumped/schema/teeth.py", "file"): "malformed files: tests/lumped/faults/test_schema",
    ("lumped/fields/tables.py", "file"): "malformed files: tests/lumped/stiffness/test_models",
    ("lumped/stiffness/finite_elements.py", "support"): "tests/lumped/path_of_contact/test_plane_compliance",
    ("lumped/friction/benedict_kelley.py", "maximum"): "an argument: tests/lumped/friction/test_laws",
    (
        "lumped/friction/registry.py",
        "table",
    ): "the law without its table: the row of lumped/schema/friction.py",
    ("lumped/friction/table.py", "points"): "rows of lumped/fields/tables.py, tests/lumped/fields",
    (
        "lumped/quasi_static/loaded.py",
        "loa_stiffness",
    ): "where no contact is found: tests/lumped/quasi_static/test_soft_bearings",
    (
        "lumped/quasi_static/relief_optimum.py",
        "kind",
    ): "a relief that the stiffness has in it: tests/lumped/quasi_static/test_whole_mesh",
    (
        "lumped/quasi_static/transmission_error.py",
        "extended",
    ): "an argument: tests/lumped/quasi_static/test_whole_mesh",
    ("lumped/fields/units.py", "unit"): "a unit of another kind: tests/lumped/fields/test_units",
}


def leaf(name: str) -> str:
    """Last part of a dotted name."""
    return name.rpartition(".")[2]


def texts(node: ast.expr) -> list[str]:
    """What the first argument of a refusal may read, with {} for what is filled in."""
    if isinstance(node, ast.Constant):
        return [str(node.value)]
    if isinstance(node, ast.JoinedStr):
        return ["".join(str(one.value) if isinstance(one, ast.Constant) else "{}" for one in node.values)]
    return []


def refusals(path: Path) -> Counter[str]:
    """Last parts of the names of the fields that a file refuses, and in how many places."""
    found: Counter[str] = Counter()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FIELD:
            place = FIELD[node.func.id]
            found.update(leaf(text) for arg in node.args[place : place + 1] for text in texts(arg))
    del found[""], found["{}"]
    return found


@pytest.mark.parametrize("folder", FOLDERS)
def test_every_refusal_has_a_row(folder: str) -> None:
    missing = []
    for path in sorted((ROOT / folder).glob("*.py")):
        file = path.relative_to(ROOT).as_posix()
        known = Counter(leaf(row.names) for row in GUARDS if row.where == file)
        for name, places in refusals(path).items():
            if known[name] < places and file not in ELSEWHERE and (file, name) not in NAMES_ELSEWHERE:
                missing.append(f"{file}: {name}, {places} places, {known[name]} rows")
    assert missing == []


def test_the_lists_of_exceptions_name_what_exists() -> None:
    for file in ELSEWHERE:
        assert (ROOT / file).is_file()
    for text in (*ELSEWHERE.values(), *NAMES_ELSEWHERE.values()):
        for test in re.findall(r"tests/[\w/]+", text):
            assert (ROOT / f"{test}.py").is_file() or (ROOT / test).is_dir(), test


def test_every_number_of_a_parameter_file_has_its_range() -> None:
    declared = {pattern.format(gear=gear) for pattern in (*DECLARED, *WHOLE) for gear in GEARS}
    assert {path for path, _ in fields()} == declared


def test_every_stated_range_is_the_one_of_the_table() -> None:
    """The limits, units and names are equal. Each range has a row, but for a range that no pair can leave."""
    stated = {
        (law, r) for law, record in LAWS.items() for r in record.ranges if r.stated and not record.parts
    }
    stated |= {("iso6336", r) for r in iso6336.RANGES}
    stated |= {("foundation", r) for r in (foundation.HALF_ANGLE, foundation.BODY_RATIO)}
    stated_limits = {(where, r.quantity): (r.unit, r.low, r.high) for where, r in stated}
    assert stated_limits == RANGES
    ranges_with_row = {(Path(row.where).stem, row.names.rpartition(": ")[2]) for row in GUARDS}
    assert set(RANGES) - ranges_with_row == {
        ("xu_kahraman", "slide_to_roll")
    }  # both flanks roll the same way


def test_every_flag_has_a_row() -> None:
    known = {row.names for row in GUARDS if row.where == "validation/validity/flags.py"}
    # Stability has a verdict of its own, see tests/floquet; its flag is in validity/test_validity.
    assert set(flags._ABOUT) - known == {"stability"}


def test_every_doubt_has_a_row() -> None:
    """As many sentences as there are rows with words of their own, and every size of gears in use."""
    tree = ast.parse(Path(plausibility.__file__).read_text(encoding="utf-8"))
    sentences = {
        one.name: sum(isinstance(node, ast.Yield) for node in ast.walk(one))
        for one in tree.body
        if isinstance(one, ast.FunctionDef) and one.name not in ("_sizes", "_squared_frequencies")
    }
    words = {row.says for row in GUARDS if row.where == "validation/validity/plausibility.py"}
    of_sizes = {
        says
        for says in words
        if any(says.rstrip(" =") in size.format("{gear}") for size in plausibility._SIZES)
    }
    assert len(of_sizes) == len(plausibility._SIZES)
    assert len(words - of_sizes) == sum(sentences.values())
