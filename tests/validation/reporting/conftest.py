"""Results and chapters on few points, shared by the tests of the report, which look at words, not physics."""

import dataclasses

import pytest

from validation.reporting import build
from validation.reporting.results import QUICK, Results

TINY = dataclasses.replace(
    QUICK, samples=64, cycles=6, sweep_speeds=9, chart_speeds=4, chart_dampings=2, map_speeds=2, map_torques=2
)


@pytest.fixture(scope="package", autouse=True)
def tiny():
    """A quick report on even fewer points."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "QUICK", TINY)
        yield


@pytest.fixture(scope="package")
def computed(pair):
    """Results of everything that a full report computes."""
    return Results(pair, dataclasses.replace(TINY, full=True, paper=True))


@pytest.fixture(scope="package")
def chapters(computed):
    """Key -> content of every chapter of a full report."""
    return {chapter.key: content for chapter, content in build.written(computed, build.CHAPTERS)}


@pytest.fixture(scope="package")
def quick(computed):
    """Results of a quick report, as far as they differ from those of a full one."""
    shared = ("check", "motion", "sweep", "margins")
    made = Results(computed.pair, TINY)
    for name in shared:
        setattr(made, name, getattr(computed, name))
    return made


@pytest.fixture(scope="package")
def unstable(pair):
    """Results in the widest tongue of the default pair: largest multiplier 1.29 without mesh damping."""
    changed = pair.with_({"operating.pinion_speed": "17000 rpm", "mesh.damping_ratio": 0.0})
    return Results(changed, TINY)
