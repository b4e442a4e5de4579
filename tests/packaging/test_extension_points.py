"""Does a new law, model, propagator, chapter, command or preset take as few files as the pages say?"""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

from lumped.schema.files import load_gear_pair, preset_names

ROOT = Path(__file__).parents[2]
#: A new law and a new model: new file -> its text, or registry -> (import, its name, the item added to it).
LAW = {
    "lumped/friction/rising.py": """
import numpy as np
from lumped.friction.base import FrictionLaw

LAW = FrictionLaw(
    name="rising",
    label="rising",
    formula=lambda xi, path, settings: 0.05 * np.sign(xi - path.L_XP) + 0.1 * (xi - path.L_XP) / path.L_XY,
    switches=lambda path, settings: [path.L_XP],
)
""",
    "lumped/friction/registry.py": ("from lumped.friction.rising import LAW as RISING", "LAWS", "RISING"),
}
MODEL = {
    "lumped/stiffness/triangular.py": """
from typing import Annotated, Literal
import numpy as np
from pydantic import Field
from lumped.fields.units import Quantity
from lumped.path_function import PathFunction
from lumped.stiffness.base import StiffnessModel

class TriangularStiffness(StiffnessModel):
    \"Stiffness of a tooth pair as a triangle over the path of contact.\"

    model: Literal["triangular"] = "triangular"
    peak: Annotated[float, Quantity("N/m", above=0)] = Field(description="largest stiffness")

    def curve(self, pair):
        low, high = pair.geometry.L_XA, pair.geometry.L_XD
        middle, slope = 0.5 * (low + high), self.peak / (high - low)
        coefficients = np.array([[slope, -slope], [0.5 * self.peak, self.peak]])
        return PathFunction(np.array([low, middle, high]), coefficients, np.array([middle]))
""",
    "lumped/stiffness/registry.py": (
        "from lumped.stiffness.triangular import TriangularStiffness",
        "AnyStiffness",
        "TriangularStiffness",
    ),
}
USE = """
import json, lumped, floquet
from typer.testing import CliRunner
from validation.cli import app
from validation.cross_check.comparison import crosscheck

pair = lumped.load_gear_pair("nasa_28_28").with_(friction__law="rising", mesh__relief="ignored")
assert lumped.load_gear_pair(__import__("tomllib").loads(pair.to_toml())) == pair
assert "rising" in json.dumps(lumped.json_schema())
assert 0.98 < lumped.steady_state(pair, samples_per_cycle=64).attrs["mesh_efficiency"] < 1.0
assert floquet.gear_pair_multipliers(pair).spectral_radius < 1.0
check = crosscheck(pair, cycles=6, samples_per_cycle=32, variant=False)
assert not check.failures, check.failures
wrong = CliRunner().invoke(app, ["simulate", "nasa_28_28", "--law", "risin"])
assert wrong.exit_code == 2 and "Did you mean 'rising'?" in wrong.output, wrong.output
"""
USE_MODEL = """
import json, lumped, floquet

stiffness = {"model": "triangular", "peak": "500 N/um"}
pair = lumped.load_gear_pair("nasa_28_28").with_({"mesh.stiffness": stiffness})
assert lumped.load_gear_pair(__import__("tomllib").loads(pair.to_toml())) == pair
assert "triangular" in json.dumps(lumped.json_schema())
assert abs(lumped.steady_state(pair, samples_per_cycle=64).mesh_stiffness.max() / 5e8 - 1.4) < 0.3
assert floquet.gear_pair_multipliers(pair).spectral_radius < 1.0
"""


#: A new chapter of the report with its figure, and a new command.
CHAPTER = {
    "validation/reporting/chapters/loudness.py": """
from validation.plots.loudness import loudness_figure
from validation.reporting.blocks import Content, NamedNumber, Picture, named_numbers
from validation.reporting.chapter import Chapter

def write(results):
    history = results.prediction.cycle[["dte"]]
    table = named_numbers("level", "How loud.", [NamedNumber("mean", float(history["dte"].mean()), "m")])
    return Content("It is quiet.", (table, Picture("loudness", "The sound.", history, loudness_figure)))

CHAPTER = Chapter("loudness", "Loudness", write)
""",
    "validation/plots/loudness.py": """
from validation.plots.axes import draw_curves
from validation.plots.style import one_panel

def loudness_figure(history):
    figure, ax = one_panel(2.0)
    draw_curves(ax, history, ["dte"])
    return figure
""",
    "validation/reporting/chapters/__init__.py": (
        "from validation.reporting.chapters import loudness",
        "CHAPTERS",
        "loudness",
    ),
}
WRITE = """
import dataclasses, json
from pathlib import Path
from validation.reporting import build, chapters, report

build.QUICK = dataclasses.replace(
    build.QUICK, sweep_speeds=8, chart_speeds=5, chart_dampings=3, orders_speeds=5
)
chapters.CHAPTERS = chapters.CHAPTERS[-1:]  # the others are computed by other tests
made = report("nasa_28_28", "out", quick=True)
data = json.loads(Path("out/report.json").read_text())
assert list(data["chapters"]) == ["loudness"]
assert data["chapters"]["loudness"]["level"][0]["value"]["unit"] == "m"
assert "Loudness" in Path("out/index.html").read_text()
assert Path("out/figures/loudness.svg").is_file() and Path("out/tables/figure_loudness.csv").is_file()
"""
COMMAND = {
    "validation/commands/count.py": """
from validation.commands import options as opt
from validation.commands.terminal import guarded, stdout

@guarded
def count(pair: opt.Pair) -> None:
    \"\"\"Count the teeth of a pair.

    [bold]Example[/bold]

    spurcheck count fzg_c
    \"\"\"
    stdout().print(pair.pinion.teeth + pair.gear.teeth)
""",
    "validation/cli.py": ("from validation.commands.count import count", "COMMANDS", "count"),
}
COUNT = """
import sys
from typer.testing import CliRunner
from validation.cli import app

help = CliRunner().invoke(app, ["--help"]).output
assert "Count the teeth of a pair." in help and "numpy" not in sys.modules
assert CliRunner().invoke(app, ["count", "nasa_28_28"]).stdout.strip() == "56"
"""


PROPAGATOR = {
    "floquet/engine/propagators/three_eighths.py": """
from floquet.engine.propagators.one_step import ExplicitRungeKutta

A = [[0, 0, 0, 0], [1 / 3, 0, 0, 0], [-1 / 3, 1, 0, 0], [1, -1, 1, 0]]
PROPAGATOR = ExplicitRungeKutta("three_eighths", 4, A, [1 / 8, 3 / 8, 3 / 8, 1 / 8], [0, 1 / 3, 2 / 3, 1])
""",
    "floquet/engine/propagators/registry.py": (
        "from floquet.engine.propagators.three_eighths import PROPAGATOR as THREE_EIGHTHS",
        "PROPAGATORS",
        '"three_eighths": THREE_EIGHTHS',
    ),
}
USE_PROPAGATOR = """
import math, floquet
from tests.evidence.floquet.closed_forms import check_orders

found = floquet.monodromy(floquet.PeriodicSystem(lambda t: [[-1.0]], 1.0), 1e-6, method="three_eighths")
assert abs(found.spectral_radius - math.exp(-1.0)) < 1e-6
assert {"three_eighths", "gauss"} <= {check.subject.split()[-1] for check in check_orders() if check.passes}
"""


#: Part -> its changes, how many files they are, and a program that uses it. The command comes first, for its
#: program looks what is imported; the chapter last, for its program leaves only some chapters.
PARTS = {
    "command": (COMMAND, 2, COUNT), "friction law": (LAW, 2, USE), "stiffness model": (MODEL, 2, USE_MODEL),
    "propagator": (PROPAGATOR, 2, USE_PROPAGATOR), "chapter of the report": (CHAPTER, 3, WRITE),
}  # fmt: skip
#: Runs the programs, each with names of its own, and prints how each ended.
RUN = """
import json, sys, traceback
ends = {}
for part, program in json.load(open(sys.argv[1])).items():
    try:
        exec(program, {"__name__": "__main__"})
        ends[part] = ""
    except BaseException:
        ends[part] = traceback.format_exc()
json.dump(ends, open(sys.argv[2], "w"))
"""


def registered(text, imported, name, item):
    """Add an import and an item of the registry ``name`` to the text of a module, whatever else it holds."""
    lines = text.splitlines(keepends=True)
    body = ast.parse(text).body
    (value,) = (
        node.value
        for node in body
        if isinstance(node, ast.Assign | ast.AnnAssign) and re.match(rf"{name}\b", ast.unparse(node))
    )
    held = next((node for node in ast.walk(value) if isinstance(node, ast.Tuple | ast.List | ast.Dict)), None)
    if held is None:  # A | B
        last = value
        added = f" | {item}"
    else:
        last = (held.values if isinstance(held, ast.Dict) else held.elts)[-1]
        added = f", {item}"
    line = last.end_lineno - 1
    column = last.end_col_offset
    whole = lines[line].encode()
    lines[line] = whole[:column].decode() + added + whole[column:].decode()
    end = max(node.end_lineno for node in body if isinstance(node, ast.Import | ast.ImportFrom))
    return "".join([*lines[:end], imported, "\n", *lines[end:]])


@pytest.fixture(scope="module")
def ends(tmp_path_factory):
    """How the program of each part ended, in one process and a copy of the packages with all parts."""
    tmp_path = tmp_path_factory.mktemp("copy")
    for package in ("lumped", "floquet", "validation"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    for changes, _, _ in PARTS.values():
        for name, change in changes.items():
            path = tmp_path / name
            if isinstance(change, str):
                assert not path.exists()
                path.write_text(change)
                continue
            path.write_text(registered(path.read_text(), *change))
    (tmp_path / "programs.json").write_text(json.dumps({part: use for part, (_, _, use) in PARTS.items()}))
    environment = os.environ | {"PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}", "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, "-c", RUN, "programs.json", "ends.json"],
        env=environment, capture_output=True, text=True, cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((tmp_path / "ends.json").read_text())


@pytest.mark.parametrize("part", PARTS)
def test_a_new_part_takes_as_few_files_as_stated(ends, part):
    changes, files, _ = PARTS[part]
    assert len(changes) == files
    assert ends[part] == "", ends[part]


@pytest.mark.parametrize("name", preset_names())
def test_a_preset_is_named_as_its_file(name):
    assert load_gear_pair(name).name == name


def test_the_version_is_the_same_everywhere():
    version = metadata.version("spurcheck")
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(rf"^version: {re.escape(version)}$", citation, re.MULTILINE)
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(rf"^## {re.escape(version)}\b", changelog, re.MULTILINE)
