"""Do a new friction law, stiffness model and preset take no more files than the contributing page says?"""

from __future__ import annotations

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

#: A new law and a new model: new file -> its text, or file -> (line, the lines that replace it).
LAW = {
    "lumped/friction/rising.py": """
import numpy as np
from lumped.friction.base import FrictionLaw

LAW = FrictionLaw(
    name="rising",
    label="rising",
    signed=lambda xi, path, settings: 0.05 * np.sign(xi - path.L_XP) + 0.1 * (xi - path.L_XP) / path.L_XY,
    switches=lambda path, settings: [path.L_XP],
)
""",
    "lumped/friction/registry.py": [
        ("import one_of\n", "import one_of\nfrom lumped.friction.rising import LAW as RISING\n"),
        ("COMPOSITE)", "COMPOSITE, RISING)"),
    ],
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
    "lumped/stiffness/registry.py": [
        (
            "import TableStiffness\n",
            "import TableStiffness\nfrom lumped.stiffness.triangular import TriangularStiffness\n",
        ),
        ("| TableStiffness\n", "| TableStiffness | TriangularStiffness\n"),
    ],
}
USE = """
import json, lumped, floquet
from typer.testing import CliRunner
from validation.cli import app

pair = lumped.load_gear_pair("nasa_28_28").with_(
    {"friction.law": "rising", "mesh.stiffness": {"model": "triangular", "peak": "500 N/um"}}
)
assert lumped.load_gear_pair(__import__("tomllib").loads(pair.to_toml())) == pair
assert "rising" in json.dumps(lumped.json_schema()) and "triangular" in json.dumps(lumped.json_schema())
motion = lumped.steady_state(pair, samples_per_cycle=64)
assert abs(motion.mesh_stiffness.max() / 5e8 - 1.4) < 0.3
assert 0.98 < motion.attrs["mesh_efficiency"] < 1.0
assert floquet.gear_pair_multipliers(pair).spectral_radius < 1.0
wrong = CliRunner().invoke(app, ["simulate", "nasa_28_28", "--law", "risin"])
assert wrong.exit_code == 2 and "Did you mean 'rising'?" in wrong.output, wrong.output
print("used")
"""


def test_a_friction_law_and_a_stiffness_model_take_two_files_each(tmp_path):
    shutil.copytree(ROOT / "lumped", tmp_path / "lumped", ignore=shutil.ignore_patterns("__pycache__"))
    assert len(LAW) == len(MODEL) == 2
    for name, change in (LAW | MODEL).items():
        path = tmp_path / name
        if isinstance(change, str):
            path.write_text(change)
            continue
        text = path.read_text()
        for old, new in change:
            assert old in text, f"{name} has no {old!r}"
            text = text.replace(old, new)
        path.write_text(text)
    environment = os.environ | {"PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}"}
    done = subprocess.run(
        [sys.executable, "-c", USE], env=environment, capture_output=True, text=True, cwd=tmp_path
    )
    assert done.stdout == "used\n", done.stdout + done.stderr


@pytest.mark.parametrize("name", preset_names())
def test_a_preset_is_named_as_its_file(name):
    assert load_gear_pair(name).name == name


def test_the_places_that_contributors_are_sent_to_exist():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    for target in re.findall(r"\]\((?!http)([^)]+)\)", text):
        assert (ROOT / target).exists(), target
    for path in re.findall(r"`((?:lumped|tests|validation)/[\w/]+\.\w+)`", text):
        assert (ROOT / path).exists(), path


def test_the_version_is_the_same_everywhere():
    version = metadata.version("spurcheck")
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(rf"^version: {re.escape(version)}$", citation, re.MULTILINE)
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(rf"^## {re.escape(version)}\b", changelog, re.MULTILINE)
