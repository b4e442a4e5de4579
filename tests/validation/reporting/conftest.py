"""Results and chapters on few points, shared by the tests of the report, which look at words, not physics."""

import dataclasses

import pytest

from validation.reporting import build, results
from validation.reporting.results import QUICK, Results

TINY = dataclasses.replace(
    QUICK,
    samples=64,
    cycles=6,
    sweep_speeds=9,
    chart_speeds=4,
    chart_dampings=2,
    map_speeds=2,
    map_torques=2,
    shaft_speeds=3,
)


@pytest.fixture(scope="package", autouse=True)
def tiny():
    """A quick report on even fewer points."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "QUICK", TINY)
        yield TINY


@pytest.fixture(scope="package")
def computed(pair):
    """Results of everything that a full report computes."""
    return Results(pair, dataclasses.replace(TINY, full=True))


@pytest.fixture(scope="package")
def chapters(computed):
    """Key -> content of every chapter of a full report."""
    return {chapter.key: content for chapter, content in build.written(computed, build.CHAPTERS)}


@pytest.fixture(scope="package")
def check(computed):
    """Cross-check of the default pair, that of the report."""
    return computed.check


@pytest.fixture(scope="package")
def sharing(computed):
    """Makes results of a quick report that take the long ones of ``computed``.

    All of them are computed here: a test may put a fault into the program before it asks for one.
    """
    shared = ("check", "sweep", "margins", "tooth_stiffness")
    for name in shared:
        getattr(computed, name)

    def make(pair, names=shared):
        made = Results(pair, TINY)
        for name in names:
            setattr(made, name, getattr(computed, name))
        return made

    return make


@pytest.fixture(scope="module")
def no_variant():
    """The cross-check of a report without its asymmetric variant."""
    true = results.crosscheck
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(results, "crosscheck", lambda *a, **k: true(*a, **k, variant=False))
        yield
