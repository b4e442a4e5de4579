"""Does the mutation run make the changes that it says, draw the same ones again, and judge them rightly?"""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest

from tests.evidence.mutants.__main__ import main
from tests.evidence.mutants.drawing import WEIGHTS, draw, files
from tests.evidence.mutants.judging import Court, Limits
from tests.evidence.mutants.nearest import Nearest
from tests.evidence.mutants.operators import differs, mutations
from tests.evidence.mutants.table import Stored, argued, arguments, share_killed

ROOT = Path(__file__).parents[3]


def changed(source: str) -> set[tuple[str, str]]:
    """Operator and changed source of every mutation that is another program."""
    made = ((one.operator, one.applied(source)) for one in mutations(source))
    return {(operator, other) for operator, other in made if differs(source, other)}


@pytest.mark.parametrize(("source", "expected"), [
    ("y = a + b", {("+, - exchanged", "y = a - b"), ("term dropped", "y = a "), ("term dropped", "y =  b")}),
    ("y = (a) - (b)", {("+, - exchanged", "y = (a) + (b)"), ("term dropped", "y = (a) ")}),
    ("y = (a  # -\n - b)", {("+, - exchanged", "y = (a  # -\n + b)"), ("term dropped", "y = (a  # -\n )")}),
    ("y = a * b", {("*, / exchanged", "y = a / b")}),
    ("y = a / b", {("*, / exchanged", "y = a * b")}),
    ("y = -a", {("sign of a term", "y = +a")}),
    ("y = a < b", {("comparison reversed", "y = a > b"), ("strictness changed", "y = a <= b")}),
    ("y = a >= b", {("comparison reversed", "y = a <= b"), ("strictness changed", "y = a > b")}),
    ("y = 0.5", {("constant changed", "y = 0.475")}),
    ("y = f(3)", {("constant changed", "y = f(4)")}),
    ("y = a[0]", {("index 0, 1 exchanged", "y = a[1]")}),
    ("y = a[:, 1]", {("index 0, 1 exchanged", "y = a[:, 0]")}),
    ("y = a[2]", {("constant changed", "y = a[3]")}),
    ("y = np.minimum(a, b)", {("maximum, minimum exchanged", "y = np.maximum(a, b)")}),
    ("y = math.sin(a)", {("cos, sin exchanged", "y = math.cos(a)")}),
    ("y = abs(a)", {("abs dropped", "y = (a)")}),
    ("y = a and b", {("and, or exchanged", "y = a or b")}),
    ("y = f(a, b)", {("arguments exchanged", "y = f(b, a)")}),
    ("y = f(x.low,\n  x.high)", {("arguments exchanged", "y = f(x.high,\n  x.low)")}),
    ("if a: pass", {("condition negated", "if not (a): pass")}),
    ("y = b if not a else c", {("condition negated", "y = b if a else c")}),
    ("y = g.r_p, g.r_g", {("pinion, gear exchanged", "y = g.r_g, g.r_g"),
                          ("pinion, gear exchanged", "y = g.r_p, g.r_p")}),
    ("y = d['gear']", {("pinion, gear exchanged", "y = d['pinion']")}),
    ("µ = 'ξ'; y = µ * b", {("*, / exchanged", "µ = 'ξ'; y = µ / b")}),  # places are bytes, not letters
])  # fmt: skip
def test_each_operator_makes_its_change(source, expected):
    assert changed(source) == expected


@pytest.mark.parametrize("source", [
    '"""Sum of 1 + 2."""',
    "def __repr__(self): return 1 + 2",
    "@lru_cache(maxsize=2)\ndef f(a: Annotated[int, 1 + 2]) -> Literal[1]: return a",
    "if TYPE_CHECKING: pass",
    "raise refuse('x', 1 + 2, f'{3 + 4}', 'less')",
    "warn('x', stacklevel=2)",
    "assert a < 1",
    "y = 'a' + b",
    "y = hypot(a, b)",  # in another order the same
    "y = a.gear",  # nothing of a pinion in the file
    "y = f(pair, length)",  # of two kinds
    "y = 0.0",
    "tolerance = 1e-9",
])  # fmt: skip
def test_what_is_not_computed_or_changes_nothing_is_left_alone(source):
    assert changed(source) == set()


def test_a_change_that_is_the_same_program_is_none():
    assert not differs("y = (a)", "y = a")
    assert not differs("y = a", "y = (a")  # nor one that is no program
    assert differs("y = a", "y = b")


def test_the_draw_follows_seed_and_weights_and_is_of_files_that_compute():
    drawn = draw(ROOT, 60, 1)
    assert len({one.key for one in drawn}) == 60
    file = "lumped/gear_geometry/geometry.py"
    first, again, other = ([one.key for one in draw(ROOT, 9, seed, file)] for seed in (1, 1, 2))
    assert first == again != other
    assert Counter(one.file.partition("/")[0] for one in drawn) == WEIGHTS
    assert {one.file for one in drawn} <= set(files(ROOT))
    assert not any("reporting" in file or "commands" in file for file in files(ROOT))


MASS = """
def total(a, b):
    return a + b

def spare(a, b):
    return a * b
"""
LOOP = """
def count(n):
    while n > 0:
        n = n - 2
    return n
"""
TESTS = """
from lumped.gears.loop import count
from lumped.gears.mass import total

def test_total():
    assert total(2.0, 1.0) == 3.0

def test_count():
    assert count(2) == 0
"""


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """A small program with a line that a test checks, a line without a test, and a loop."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")  # it needs none, and they take most of the time
    contents = {
        "pyproject.toml": "[tool.pytest.ini_options]\naddopts = '--import-mode=importlib'\n",
        "lumped/gears/mass.py": MASS,
        "lumped/gears/loop.py": LOOP,
        "tests/lumped/gears/test_gears.py": TESTS,
    }
    for name, content in contents.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    return tmp_path


def mutant(tree, file, before, operator):
    """The mutant of this line and operator, from one of many seeds."""
    drawn = (one for seed in range(99) for one in draw(tree, 9, seed, file))
    return next(one for one in drawn if (one.before, one.operator) == (before, operator))


def test_an_edit_of_one_line_leaves_the_others_drawn(tree):
    file = "lumped/gears/mass.py"
    before = {one.key: one for one in draw(tree, 9, 5, file)}
    assert {one.before for one in before.values()} == {"return a + b", "return a * b"}
    (tree / file).write_text(MASS.replace("a * b", "a * b * 3"))
    after = {one.key: one for one in draw(tree, 9, 5, file)}
    (same,) = before.keys() & after.keys()
    assert (before[same].before, before[same].after) == ("return a + b", after[same].after)


def test_lines_that_move_keep_their_change(tree):
    def changes():
        drawn = (one for seed in range(20) for one in draw(tree, 9, seed, "lumped/gears/mass.py"))
        return [(one.key, one.line, one.after) for one in drawn]

    before = changes()
    (tree / "lumped/gears/mass.py").write_text("\n\n" + MASS)
    assert changes() == [(key, line + 2, after) for key, line, after in before]


def test_the_judge_says_killed_survived_and_time_out(tree, tmp_path_factory):
    court = Court(tree, tmp_path_factory.mktemp("court"), Limits(test=0.2, wall=60.0))
    killed = court.judge(mutant(tree, "lumped/gears/mass.py", "return a + b", "+, - exchanged"))
    test = "tests/lumped/gears/test_gears.py::test_total"
    assert (killed.verdict, killed.by, killed.tests) == ("killed", test, 1)
    survived = court.judge(mutant(tree, "lumped/gears/mass.py", "return a * b", "*, / exchanged"))
    assert (survived.verdict, survived.by, survived.tests) == ("survived", "", 2)
    endless = court.judge(
        mutant(tree, "lumped/gears/loop.py", "n = n - 2", "+, - exchanged")
    )  # n grows for ever
    assert endless.verdict == "killed"
    assert "test_count (time-out; " in endless.by
    for root in (court.copy, tree):
        assert (root / "lumped/gears/mass.py").read_text() == MASS
        assert (root / "lumped/gears/loop.py").read_text() == LOOP


@pytest.mark.parametrize(("wrong", "why"), [
    ("\ndef test_wrong():\n    assert total(1.0, 1.0) == 0.0\n", "test_wrong fails without the change too"),
    ("\ndef test_slow():\n    while True: pass\n", "time-out in tests/lumped/gears/test_gears.py::test_slow"),
    ("\nimport nowhere\n", "test_gears.py fails without the change too"),
])  # fmt: skip
def test_a_test_that_fails_in_the_sound_program_kills_nothing(wrong, why, tree, tmp_path_factory):
    (tree / "tests/lumped/gears/test_gears.py").write_text(TESTS + wrong)
    court = Court(tree, tmp_path_factory.mktemp("court"), Limits(test=0.2, wall=60.0))
    judged = court.judge(mutant(tree, "lumped/gears/mass.py", "return a * b", "*, / exchanged"))
    assert judged.verdict == "undecided"
    assert why in judged.by


def test_a_module_that_cannot_be_imported_is_seen(tree, tmp_path_factory):
    (tree / "lumped/gears/mass.py").write_text(MASS + "\nONE = 1 / (1 + 0)\n")
    court = Court(tree, tmp_path_factory.mktemp("court"))
    gone = next(
        one
        for seed in range(99)
        for one in draw(tree, 9, seed, "lumped/gears/mass.py")
        if "( 0)" in one.after
    )
    judged = court.judge(gone)
    assert (judged.verdict, judged.by, judged.tests) == ("killed", "tests/lumped/gears/test_gears.py", 0)


def test_a_change_that_ends_the_process_is_seen_in_the_test_that_ran(tree, tmp_path_factory):
    (tree / "lumped/gears/mass.py").write_text(
        MASS + "\nimport os\n\ndef leave(n):\n    if n > 5:\n        os.abort()\n"
    )
    test = "\nfrom lumped.gears.mass import leave\n\ndef test_leave():\n    leave(5)\n"
    (tree / "tests/lumped/gears/test_gears.py").write_text(TESTS + test)
    court = Court(tree, tmp_path_factory.mktemp("court"))
    judged = court.judge(mutant(tree, "lumped/gears/mass.py", "if n > 5:", "strictness changed"))
    test = "tests/lumped/gears/test_gears.py::test_leave (the process ends)"
    assert (judged.verdict, judged.by, judged.tests) == ("killed", test, 3)


def test_files_judge_in_the_order_of_nearness(tree, tmp_path_factory):
    """The conftest of a tree may have another order, and more than one file sees the change."""
    far = "import lumped.gears.far\n\ndef test_far():\n    assert lumped.gears.far.total(1, 1) == 2\n"
    (tree / "lumped/gears/far.py").write_text("from lumped.gears.mass import total\n")
    (tree / "tests/lumped/gears/test_far.py").write_text(far)
    order = "def pytest_collection_modifyitems(items):\n    items.sort(key=lambda item: item.name)\n"
    (tree / "conftest.py").write_text(order)
    court = Court(tree, tmp_path_factory.mktemp("court"))
    judged = court.judge(mutant(tree, "lumped/gears/mass.py", "return a + b", "+, - exchanged"))
    assert judged.by == "tests/lumped/gears/test_gears.py::test_total"


def test_time_that_ends_before_the_folder_does_decides_nothing(tree, tmp_path_factory):
    court = Court(tree, tmp_path_factory.mktemp("court"), Limits(total=0.01))
    judged = court.judge(mutant(tree, "lumped/gears/mass.py", "return a * b", "*, / exchanged"))
    assert (judged.verdict, judged.by) == ("undecided", "1 tests of the folder left out")


def test_the_nearest_tests_are_those_of_the_folder_then_by_steps_of_import():
    nearest = Nearest(ROOT)
    own, others = nearest.files("lumped/friction/misfit.py")
    assert own[0] == "tests/lumped/friction/test_misfit.py"
    assert all(file.startswith("tests/lumped/friction/") for file in own)
    assert not any(
        file.startswith(("tests/lumped/friction/", "tests/meta/", "tests/docs/")) for file in others
    )
    own, _ = nearest.files("lumped/path_function.py")
    assert own[0] == "tests/lumped/test_path_function.py"
    assert set(own) == {path.relative_to(ROOT).as_posix() for path in ROOT.glob("tests/lumped/test_*.py")}


def test_a_run_that_was_stopped_goes_on(tree, tmp_path, capsys):
    target = tmp_path / "mutants.json"
    command = ["--tree", str(tree), "--only", "lumped/gears/mass.py", "--count", "2", "-o", str(target)]
    assert main(command) in (0, 1)
    whole = json.loads(target.read_text())
    assert len(whole["mutants"]) == 2
    assert not target.with_name("mutants.json.part").exists()
    # As if it had been stopped while it wrote the second row.
    head = {name: value for name, value in whole.items() if name != "mutants"}
    known = whole["mutants"][0] | {"by": "stored"}
    lines = [json.dumps(head), json.dumps(known), '{"key": "ha']
    target.with_name("mutants.json.part").write_text("\n".join(lines))
    capsys.readouterr()
    main(command)
    again = json.loads(target.read_text())
    assert "[2/2]" in (said := capsys.readouterr().out)
    assert "[1/2]" not in said
    assert again["mutants"][0]["by"] == "stored"
    assert again["mutants"][1]["after"] == whole["mutants"][1]["after"]


def test_again_judges_only_what_was_not_killed(tree, tmp_path, capsys):
    command = ["--tree", str(tree), "--only", "lumped/gears/mass.py", "--count", "2"]
    rows = []
    for one, verdict in zip(draw(tree, 2, 1, "lumped/gears/mass.py"), ("killed", "survived"), strict=True):
        rows.append(
            {"key": one.key, "file": one.file, "line": one.line, "before": one.before, "after": one.after}
        )
        rows[-1] |= {"verdict": verdict, "by": "stored", "tests": 1, "seconds": 1.0}
    (tmp_path / "before.json").write_text(json.dumps({"mutants": rows}))
    main([*command, "--again", str(tmp_path / "before.json"), "-o", str(tmp_path / "after.json")])
    after = {one["key"]: one["by"] for one in json.loads((tmp_path / "after.json").read_text())["mutants"]}
    assert after[rows[0]["key"]] == "stored"
    assert after[rows[1]["key"]] != "stored"


def test_a_part_of_another_run_is_begun_anew(tmp_path):
    target = tmp_path / "mutants.json"
    Stored(target, {"seed": 1}).add({"key": "a"})
    assert list(Stored(target, {"seed": 1}).rows) == ["a"]
    assert list(Stored(target, {"seed": 2}).rows) == []


def test_survivors_are_argued_and_the_share_is_of_those_decided():
    verdicts = ("killed", "killed", "survived", "survived", "undecided")
    common = {"file": "f", "after": "", "by": ""}
    rows = [common | {"before": str(i), "verdict": word} for i, word in enumerate(verdicts)]
    judged = argued(rows, {("f", "3", ""): "rounds", ("f", "0", ""): "was killed all the same"})
    assert [one["verdict"] for one in judged] == ["killed", "killed", "survived", "argued", "undecided"]
    assert share_killed(judged) == 2 / 3


def test_every_argument_is_about_a_line_that_is_there():
    for file, before, _ in arguments():
        text = " ".join((ROOT / file).read_text(encoding="utf-8").split())
        assert before in text, f"{file}: {before}"
