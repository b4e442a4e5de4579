"""Does the folder for a company's build work as it stands, by a second pytest that knows nothing of ours?"""

import importlib.metadata
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "examples" / "check_in_ci"


def plugin() -> list[str]:
    """Arguments that load the plugin where the package is used without being installed."""
    names = {entry.value for entry in importlib.metadata.entry_points(group="pytest11")}
    return [] if "validation.pytest_plugin" in names else ["-p", "validation.pytest_plugin"]


@pytest.mark.slow
def test_the_folder_passes_and_a_softer_mesh_does_not(tmp_path):
    copy = tmp_path / "company"
    shutil.copytree(FOLDER, copy, ignore=shutil.ignore_patterns("__pycache__"))
    # As it stands, but for the time of the search for explanations, which no test of the folder reads.
    tests = copy / "test_company_model.py"
    short = (
        tests.read_text()
        .replace(", budget=20.0)", ")")
        .replace('"mypair.toml")', '"mypair.toml", budget=1.0)')
    )
    assert short.count("budget=1.0") == short.count("@pytest.mark.spurcheck(") == 2
    tests.write_text(short)
    environment = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-m", "pytest", "-q", *plugin()]

    def run(*more: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [*command, *more], cwd=copy, env=environment, capture_output=True, text=True, check=False
        )

    passed = run()
    assert passed.returncode == 0, passed.stdout + passed.stderr
    assert "2 passed" in passed.stdout
    model = copy / "company_model.py"
    text = model.read_text()
    assert len(text.splitlines()) <= 100
    model.write_text(text.replace("K_PAIR = 252e6", "K_PAIR = 190e6"))
    failed = run("-k", "agrees")
    assert failed.returncode == 1, failed.stdout + failed.stderr
    assert "Your model differs: misfit" in failed.stdout
    assert "dte: misfit" in failed.stdout


def test_the_workflow_runs_the_tests():
    workflow = yaml.safe_load((FOLDER / "workflow.yml").read_text(encoding="utf-8"))
    (job,) = workflow["jobs"].values()
    assert job["steps"][-1]["run"] == "pytest"
    assert "--" not in (FOLDER / "README.md").read_text(encoding="utf-8").split("```sh")[1].split("```")[0]
