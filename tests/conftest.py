"""The order of the tests, the examples of docstrings beside them, and labels with units on every figure."""

from __future__ import annotations

import gc
import os
import re
import weakref
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from _pytest.doctest import DoctestModule

from tests.unlike_pairs import UNLIKE, unlike_pair

if TYPE_CHECKING:
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

TESTS = Path(__file__).parent
ROOT = TESTS.parent
#: What takes long, as two workers begin: the first half and the second. Each compiles other kernels, which
#: the other one finds compiled later; short tests come last, for they leave nobody waiting for one long test.
LONG = (
    (
        "floquet/orbits", "floquet/gear", "floquet/rank_one", "validation/reporting", "evidence/faults",
        "examples", "docs",
        "validation/commands", "validation/interactive", "packaging",
        "reproductions", "lumped/friction",
    ),
    (
        "multibody", "validation/cross_check", "validation/studies", "validation/files", "evidence",
        "lumped/quasi_static", "lumped/model",
    ),
)  # fmt: skip
#: A unit in brackets, or a count that is its own unit.
UNIT = re.compile(r"\[[^\]]+\]|\b(mesh cycles|mesh order|revolutions)\b")
#: What a number on an axis may look like: 1, -2.5, 10^3 in mathematical text, 5e-4.
NUMBER = re.compile(r"[-−+0-9.e\s×{}$^\\]*|.*mathdefault.*")


def pytest_sessionstart(session):
    """Draw the same random examples in every run, so that a pass can be repeated.

    For a long run set the environment variable SPURCHECK_FUZZ: it multiplies the number of examples, which
    are then drawn anew. The process that only hands out the tests needs none of this, and its workers wait
    for what it imports.
    """
    if session.config.pluginmanager.hasplugin("dsession"):
        return
    # By default the collector looks so often, as a kernel compiles, that it takes a tenth of the time.
    gc.set_threshold(20_000, 10, 10)
    from hypothesis import HealthCheck, settings

    fuzz = os.environ.get("SPURCHECK_FUZZ")
    settings.register_profile(
        "spurcheck",
        derandomize=fuzz is None,
        deadline=None,  # the first call compiles
        max_examples=25 * int(fuzz or "1"),
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large],
        print_blob=True,
    )
    settings.load_profile("spurcheck")


def pytest_collection_modifyitems(items):
    """Put ``LONG`` at the beginning of both halves of the tests: a worker gets one half, and takes from the
    end of the other's when it is done.
    """
    ranks = {name: (half, place) for half, names in enumerate(LONG) for place, name in enumerate(names)}

    def rank(item):
        folder = item.getparent(pytest.Dir).path.relative_to(TESTS)
        names = (str(Path(*folder.parts[:depth])) for depth in range(len(folder.parts), 0, -1))
        return next((ranks[name] for name in names if name in ranks), (2, 0))

    ordered = sorted(items, key=rank)
    first, second, short = ([item for item in ordered if rank(item)[0] == part] for part in range(3))
    cut = max(0, len(items) // 2 - len(first))
    items[:] = first + short[:cut] + second + short[cut:]


def pytest_collection_finish(session):
    """Spare the garbage collector what stays to the end: half a million objects of libraries and tests."""
    gc.collect()
    gc.freeze()


class FolderWithExamples(pytest.Dir):
    """A folder of tests, with the examples (``>>>``) of the folder that it tests behind its own files.

    Folders below that one are left to the folders of tests that they have.
    """

    def collect(self):
        yield from super().collect()
        tested = ROOT / self.path.relative_to(TESTS)
        for file in sorted(tested.rglob("*.py")):
            own = any(
                (TESTS / one.relative_to(ROOT)).is_dir() for one in file.parents if tested in one.parents
            )
            if not own and ">>> " in file.read_text(encoding="utf-8"):
                yield DoctestModule.from_parent(self, path=file)


def pytest_collect_directory(path, parent):
    """Give each folder of tests, ``tests/<package>/<folder>``, the examples of ``<package>/<folder>``."""
    if path.is_relative_to(TESTS) and path != TESTS and (ROOT / path.relative_to(TESTS)).is_dir():
        return FolderWithExamples.from_parent(parent, path=path)
    return None


@pytest.fixture(scope="session", params=UNLIKE)
def unlike(request):
    """Each of the six unlike pairs in turn. A test of one of them calls ``unlike_pair`` with its name."""
    return unlike_pair(request.param)


def _shown(axis: Axis) -> list[str]:
    """Texts of the ticks of an axis that can be seen."""
    return [label.get_text() for label in axis.get_ticklabels() if label.get_visible() and label.get_text()]


def missing_labels(figure: Figure) -> list[str]:
    """Complaints about axes of a figure without label, or without a unit though they show numbers.

    Insets show part of the axes they lie in and need none; of shared axes one label is enough.
    """
    found = []
    insets = {child for axes in figure.axes for child in axes.child_axes}
    for index, axes in enumerate(figure.axes):
        for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "y")):
            texts = _shown(axis)
            if axes in insets or not (axes.axison and axes.get_visible() and texts):
                continue
            shared = axes.get_shared_x_axes() if name == "x" else axes.get_shared_y_axes()
            siblings = [getattr(other, f"{name}axis").get_label_text() for other in shared.get_siblings(axes)]
            label = axis.get_label_text() or next(filter(None, siblings), "")
            if not label:
                found.append(f"axes {index}: the {name} axis has no label")
            elif all(NUMBER.fullmatch(text) for text in texts) and not UNIT.search(label):
                found.append(f"axes {index}: {label!r} states no unit")
    return found


@pytest.fixture(autouse=True, scope="session")
def labelled_figures():
    """Check every figure when it is saved: then it has been drawn, so that its ticks are known."""
    from matplotlib.figure import Figure

    save = Figure.savefig
    seen = weakref.WeakSet()

    def checked(figure, *args, **options):
        save(figure, *args, **options)
        if figure not in seen:  # a figure is often saved twice, as SVG and as PNG
            found = missing_labels(figure)
            assert not found, (args, found)
            seen.add(figure)

    Figure.savefig = checked
    yield
    Figure.savefig = save
