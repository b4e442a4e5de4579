"""A study of a few cheap cases, and its undisturbed result to compare with."""

import dataclasses
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from validation.studies import Study, load_study, run_sweep
from validation.studies.analyses import ANALYSES

Make = Callable[..., Study]

# Worker processes find the evaluators of ``odd_evaluators`` here.
sys.path.insert(0, str(Path(__file__).parent))


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
    return run_sweep(study, tmp_path_factory.mktemp("undisturbed")).results.read_bytes()


@pytest.fixture
def replace_analysis(monkeypatch: pytest.MonkeyPatch) -> Callable[[Any], None]:
    """Put another function in the place of the geometry analysis, in this process."""

    def replace_evaluator(function: Any) -> None:
        changed = dataclasses.replace(ANALYSES["geometry"], compute=function)
        monkeypatch.setitem(ANALYSES, "geometry", changed)

    return replace_evaluator
