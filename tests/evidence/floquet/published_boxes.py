"""Do verdicts agree with published boxes that hold every edge of instability of a Mathieu-like equation?

A. Fernandez, capdmathieu, 2020 (github.com/aaroncapd/capdmathieu): boxes (a, b) by interval arithmetic.
Outside of them x'' + (a + b (cos t + eps cos 2t)) x = 0 has no edge of instability. So all points of a region
that boxes enclose have one verdict. The boxes are by another program.

``python -m tests.evidence.floquet.published_boxes FOLDER`` prints the table of docs/verification/floquet.md;
FOLDER holds the files ``mathieu_*.txt`` of that work, which are not part of this repository.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import ndimage

from floquet import FourierSeries, PeriodicMatrix, from_second_order, monodromy
from lumped.typing import FloatArray, IntArray

#: File -> eps of the equation.
EPS = {"mathieu_eps0.txt": 0.0, "mathieu_eps02.txt": 0.2, "mathieu_eps1.txt": 1.0, "mathieu_eps2.txt": 2.0}
#: Digits of the published numbers.
_ROUNDED = 2e-6
#: Regions of fewer cells than this say little.
_FEWEST_CELLS = 4


class Regions(NamedTuple):
    """Cells of a chart between published boxes.

    Attributes
    ----------
    a, b : (n,), (m,) middles of the cells
    label : (n, m) number of the region of each cell, from 1 on; 0: a box
    boxes : number of boxes
    """

    a: FloatArray
    b: FloatArray
    label: IntArray
    boxes: int


def regions_of(boxes: FloatArray) -> Regions:
    """Regions between boxes (k, 4): least and largest a, least and largest b."""
    steps = [float(np.median(boxes[:, first + 1] - boxes[:, first])) for first in (0, 2)]
    low = [float(boxes[:, first].min()) for first in (0, 2)]
    counts = [round((boxes[:, first + 1].max() - low[first // 2]) / steps[first // 2]) for first in (0, 2)]
    taken = np.zeros(counts, dtype=bool)
    places = [
        np.round((boxes[:, [first, first + 1]] - low[first // 2]) / steps[first // 2]).astype(int)
        for first in (0, 2)
    ]
    for a_range, b_range in zip(*places, strict=True):
        taken[a_range[0] : a_range[1], b_range[0] : b_range[1]] = True
    label, _ = ndimage.label(~taken)
    middles = [low[axis] + (np.arange(counts[axis]) + 0.5) * steps[axis] for axis in (0, 1)]
    return Regions(middles[0], middles[1], np.asarray(label, dtype=np.int64), len(boxes))


def verdict(a: float, b: float, eps: float) -> str:
    """Verdict of the equation."""
    stiffness = PeriodicMatrix(a, (FourierSeries(2.0 * np.pi, 0.0, [1.0, eps]), b))
    return monodromy(from_second_order(1.0, 0.0, stiffness, 2.0 * np.pi)).verdict


class Judged(NamedTuple):
    """Verdicts beside the boxes of one file.

    Attributes
    ----------
    name : file
    boxes, regions : numbers of boxes and of regions that were sampled
    nodes : sampled cells by verdict
    mixed : regions with two verdicts: one of them contradicts the boxes
    """

    name: str
    boxes: int
    regions: int
    nodes: dict[str, int]
    mixed: int


def judged(path: Path, nodes: int, seed: int) -> Judged:
    """Verdicts at random cells between the boxes of a file."""
    chart = regions_of(np.loadtxt(path)[:, :4])
    sizes = np.bincount(chart.label.ravel())
    large = np.flatnonzero(sizes >= _FEWEST_CELLS)
    large = large[large > 0]
    cells = np.argwhere(np.isin(chart.label, large))
    rng = np.random.default_rng(seed)
    by_region: dict[int, set[str]] = {}
    count: dict[str, int] = {}
    for i, j in cells[rng.choice(len(cells), min(nodes, len(cells)), replace=False)]:
        found = verdict(float(chart.a[i]), float(chart.b[j]), EPS[path.name])
        count[found] = count.get(found, 0) + 1
        by_region.setdefault(int(chart.label[i, j]), set()).add(found)
    mixed = sum(len(verdicts - {"undecided"}) > 1 for verdicts in by_region.values())
    return Judged(path.name, chart.boxes, len(by_region), count, mixed)


def main(folder: Path, nodes: int = 4000) -> None:
    """Print the table."""
    for name in EPS:
        row = judged(folder / name, nodes, seed=1)
        counts = ", ".join(f"{verdict} {count}" for verdict, count in sorted(row.nodes.items()))
        print(f"{row.name}: {row.boxes} boxes, {row.regions} regions, {counts}; mixed regions {row.mixed}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
