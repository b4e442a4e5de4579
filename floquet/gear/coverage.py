"""Do the traced boundaries of instability hold every unstable node of a dense chart?

Sources: docs/theory/floquet.md, "Where instability is, and what it is called".
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from lumped.errors import refuse


def boundary_coverage(boundaries: xr.Dataset, chart: xr.Dataset) -> xr.Dataset:
    """Compare traced boundaries with a dense chart of the same pair, node by node.

    Parameters
    ----------
    boundaries : dataset of `stability_boundaries`
    chart : dataset of `stability_chart` over speed_rpm and the axis of the boundaries, at the same values of
        that axis and inside their range of speeds

    Returns
    -------
    Dataset over the axes of the chart: ``inside``, whether the node lies in an interval of instability;
    ``missed``, verdict unstable but not inside; ``excess``, verdict stable but inside. Attributes: the
    numbers ``unstable_nodes``, ``missed_nodes`` and ``excess_nodes``.

    Raises
    ------
    ParameterError
        The chart has other axes, or other values, than the boundaries.
    """
    axes = [str(name) for name in boundaries["lower"].dims if name != "tongue"]
    if set(chart["verdict"].dims) != {"speed_rpm", *axes}:
        raise refuse(
            "chart",
            chart["verdict"].dims,
            ", ".join(["speed_rpm", *axes]),
            "Compute the chart over the same axes.",
        )
    for name in axes:
        if not np.array_equal(chart[name].values, boundaries[name].values):
            raise refuse(
                f"chart[{name!r}]", "other values", "those of the boundaries", "Use the same values."
            )
    speed = chart["speed_rpm"]
    within = (speed >= boundaries["interval_lower"]) & (speed <= boundaries["interval_upper"])
    inside = within.any(("tongue", "interval")).transpose(*chart["verdict"].dims)
    unstable, stable = chart["verdict"] == -1, chart["verdict"] == 1
    result = xr.Dataset({"inside": inside, "missed": unstable & ~inside, "excess": stable & inside})
    return result.assign_attrs(
        unstable_nodes=int(unstable.sum()),
        missed_nodes=int(result["missed"].sum()),
        excess_nodes=int(result["excess"].sum()),
    )
