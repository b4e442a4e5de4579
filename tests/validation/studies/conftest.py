"""A study of a few cheap cases, and its undisturbed result to compare with."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
import time
from collections.abc import Callable, Collection
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from validation.studies import Study, Summary, load_study, run_sweep, runner
from validation.studies.analyses import ANALYSES
from validation.studies.cases import CaseList, StudyEvaluator
from validation.studies.evaluate import Status
from validation.studies.storage import StoreError
from validation.studies.store import read_table

#: Worker processes find the evaluators of ``odd_evaluators`` here.
sys.path.insert(0, str(Path(__file__).parent))

Make = Callable[..., Study]


@pytest.fixture(scope="session")
def make_study() -> Make:
    """A grid of geometries: 8 x 3 x 5 = 120 cases of about a millisecond, 24 of which cannot exist."""

    def make(**changes: Any) -> Study:
        data: dict[str, Any] = {
            "name": "test",
            "gear_pair": "nasa_28_28",
            "analysis": "geometry",
            "outputs": ["contact_ratio", "mesh_frequency"],
            "axes": [
                {"field": "operating.pinion_speed", "low": 500, "high": 9000, "count": 8},
                {
                    "field": ["pinion.face_width", "gear.face_width"],
                    "name": "face_width",
                    "values": [5, 6, 8],
                },
                # 88.5 mm makes the teeth wedge: those cases fail.
                {"field": "centre_distance", "values": [88.5, 88.9, 89.0, 89.2, 89.4]},
            ],
        }
        return load_study(data | changes)

    return make


@pytest.fixture(scope="session")
def study(make_study: Make) -> Study:
    return make_study()


@pytest.fixture(scope="session")
def undisturbed(study: Study, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Bytes of the result of a run that nothing disturbed."""
    folder = tmp_path_factory.mktemp("undisturbed")
    return run_sweep(study, folder).results.read_bytes()


#: Run a sweep of the study in argv[1] into argv[2] with argv[3] workers; 0: in the process that is disturbed.
PROGRAM = """
import sys
from validation.studies import load_study, run_sweep
study = load_study(open(sys.argv[1]).read())
run_sweep(study, sys.argv[2], workers=int(sys.argv[3]), resume=True)
"""


class Sweep:
    """A sweep of the test study in a process of its own, which a test disturbs.

    Attributes
    ----------
    study, undisturbed : the study and the bytes of its undisturbed result
    out : output folder
    SLOW : program text that slows the cases down, so that a fault comes in the middle
    """

    SLOW = """
import dataclasses, time
from validation.studies import analyses
fast = analyses.ANALYSES["geometry"]
def slow(variation, settings):
    time.sleep(0.02)
    return fast.compute(variation, settings)
analyses.ANALYSES["geometry"] = dataclasses.replace(fast, compute=slow)
"""

    def __init__(self, study: Study, undisturbed: bytes, file: Path, out: Path) -> None:
        self.study, self.undisturbed, self.file, self.out = study, undisturbed, file, out
        file.write_text(study.to_toml())

    def command(self, before: str = "", workers: int = 0) -> list[str]:
        """Arguments of the interpreter for a sweep, with program text that runs before it."""
        return ["-c", before + PROGRAM, str(self.file), str(self.out), str(workers)]

    def start(self, before: str = "", workers: int = 0, **options: Any) -> subprocess.Popen[str]:
        """Start the sweep."""
        command = [sys.executable, *self.command(before, workers)]
        return subprocess.Popen(command, text=True, stderr=subprocess.PIPE, **options)

    def finished(self) -> list[int]:
        """Numbers of the cases that the store holds."""
        try:
            status = read_table(self.out, CaseList(self.study)).status
        except StoreError:  # none yet
            return []
        return [case for case, code in enumerate(status) if code != Status.MISSING]

    def wait_for(self, condition: Callable[[], bool], what: str, seconds: float = 400.0) -> None:
        """Wait until a condition holds; a process takes 5 s of processor time to start."""
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, f"waited {seconds} s for {what}"
            time.sleep(0.005)

    def check_resume(self, before: Collection[int]) -> Summary:
        """Resume: what the store holds is not computed again, and the result is the undisturbed one."""
        summary = run_sweep(self.study, self.out, resume=True)
        assert summary.before == len(set(before))
        assert summary.computed == summary.cases - summary.before
        assert summary.results.read_bytes() == self.undisturbed
        return summary


@pytest.fixture
def replace_analysis(monkeypatch: pytest.MonkeyPatch) -> Callable[[Any], None]:
    """Put another function in the place of the geometry analysis, in this process."""

    def put(function: Any) -> None:
        changed = dataclasses.replace(ANALYSES["geometry"], compute=function)
        monkeypatch.setitem(ANALYSES, "geometry", changed)

    return put


@pytest.fixture
def odd(study: Study, monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Let a case of the study do something odd, in worker processes too; see ``odd_evaluators``."""
    from odd_evaluators import Odd

    def put(what: str, case: int, note: str = "") -> None:
        evaluator = StudyEvaluator.of(study)
        (values,) = CaseList(study).values([case])
        changed = SimpleNamespace(of=lambda study: Odd(evaluator, what, values, note))
        monkeypatch.setattr(runner, "StudyEvaluator", changed)

    return put


@pytest.fixture
def sweep_in(study: Study, undisturbed: bytes, tmp_path: Path) -> Callable[[Path], Sweep]:
    """Make a sweep into a given folder."""
    return lambda out: Sweep(study, undisturbed, tmp_path / "study.toml", out)


@pytest.fixture
def sweep(sweep_in: Callable[[Path], Sweep], tmp_path: Path) -> Sweep:
    """A sweep into a folder that does not exist yet."""
    return sweep_in(tmp_path / "out")
