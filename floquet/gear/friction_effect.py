"""What each friction law does to the stability of a gear pair: difference charts.

Sources: docs/theory/floquet.md, "Where instability is, and what it is called".
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from floquet.engine.chart import Axes
from floquet.gear.axes import axis_coordinates, gear_grid
from floquet.gear.chart import stability_chart
from lumped.arguments import some_of
from lumped.errors import refuse
from lumped.friction.registry import FRICTIONAL, LAWS, file_name, law_named
from lumped.labelling import labelled_dataset
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import Progress

if TYPE_CHECKING:
    import xarray as xr


def friction_effect(
    pair: AnyPair,
    axes: Axes,
    laws: Sequence[str] = FRICTIONAL,
    *,
    reference: str = "none",
    rtol: float = 1e-9,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Difference charts: the effect of friction laws on the growth of the fastest motion.

    Growth is log(spectral radius) per mesh cycle, so that the effect of a law adds to that of damping.

    Parameters
    ----------
    pair : the gear pair
    axes : as in `stability_chart`; not friction_coefficient, which the reference law "none" lacks
    laws : friction laws to compare
    reference : law from which the differences are taken
    rtol : as in `stability_chart`
    progress : told the finished fraction

    Returns
    -------
    Dataset over ``law`` and the axes: ``growth`` [per mesh cycle]; ``growth_change`` from the reference;
    ``growth_error``, bound on the error of the change; ``verdict_change``, +1 where the law stabilises what
    was unstable, -1 where it makes unstable what was stable, 0 elsewhere (also where one is undecided).
    ``reference_growth`` over the axes. The attribute ``certificate`` is that of all charts, see
    `stability_chart`.

    Raises
    ------
    ParameterError : unknown law, or an unusable axis
    """
    pair = load_gear_pair(pair)
    grid = gear_grid(axes)
    laws = some_of("laws", laws, LAWS, kept=file_name)
    reference = law_named(reference, "reference").name
    if "friction_coefficient" in grid and reference == "none":
        raise refuse("axes", "friction_coefficient", "axes other than friction", "Choose another reference.")
    charts = []
    for index, law in enumerate((reference, *laws)):
        charts.append(stability_chart(pair, grid, friction_law=law, rtol=rtol))
        if progress is not None:
            progress((index + 1) / (len(laws) + 1))
    base, others = charts[0], charts[1:]
    kinds = {chart.attrs["certificate"] for chart in charts}
    dims = tuple(grid)
    growth = np.stack([np.log(c.spectral_radius.values) for c in others])
    error = np.stack([_log_error(c) + _log_error(base) for c in others])
    before, after = base.verdict.values, np.stack([c.verdict.values for c in others])
    flips = np.where(before * after == -1, after, 0).astype(np.int8)
    reference_growth = np.log(base.spectral_radius.values)
    full = ("law", *dims)
    return labelled_dataset(
        {
            "growth": (full, growth, "1", "growth per mesh cycle, log of the radius"),
            "growth_change": (full, growth - reference_growth, "1", "change of growth per cycle"),
            "growth_error": (full, error, "1", "bound on the error of the change"),
            "verdict_change": (full, flips, "1", "+1 stabilised, -1 destabilised"),
            "reference_growth": (dims, reference_growth, "1", f"growth per cycle, law {reference}"),
        },
        {"law": (np.array(laws, dtype=object), "1", "friction law"), **axis_coordinates(grid)},
        {
            "title": f"effect of friction on {pair.name}",
            "reference": reference,
            "certificate": kinds.pop() if len(kinds) == 1 else "mixed",
        },
    )


def _log_error(chart: xr.Dataset) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Bound on the error of log(radius): |d log r| <= e/(r - e) while e < r."""
    radius, error = chart.spectral_radius.values, chart.error.values
    return np.asarray(np.where(error < radius, error / np.maximum(radius - error, 1e-300), np.inf))
