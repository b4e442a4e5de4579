"""How much the velocity over which friction changes its sign matters: the same run with ever smaller ones.

Sources: docs/theory/multibody.md, "Friction that holds the teeth".
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import real_numbers
from lumped.errors import refuse, shown
from lumped.labelling import labelled_dataset
from lumped.model.results import provenance
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import Progress
from multibody.run.simulation import simulate

if TYPE_CHECKING:
    import xarray as xr


#: Halved from 8 mm/s on; the last is close to the default of ``multibody.contact.reversal``.
VELOCITIES = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4)
_QUANTITIES = ("dte", "x_p", "y_p")


def reversal_convergence(
    pair: AnyPair,
    cycles: int = 4,
    *,
    velocities: Sequence[float] = VELOCITIES,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Convergence of a run as friction changes its sign over a smaller and smaller velocity.

    Parameters
    ----------
    pair : a validated gear pair
    cycles : of the runs, from the static state
    velocities : falling, at least two [m/s]
    progress : called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``velocity`` [m/s] (all but the last) and ``quantity``: ``change``, the largest change
    to the run with the next velocity over the peak to peak, and ``order``, the observed order of that change
    in the velocity (NaN in the first row); over ``velocity`` alone ``force_evaluations`` per cycle

    Raises
    ------
    ParameterError : velocities that do not fall, or arguments out of range
    NumericalError : a run fails; the text says what to try
    """
    pair = load_gear_pair(pair)
    values = real_numbers("velocities", velocities, 0.0, above=True, unit="m/s")
    if values.size < 2 or (np.diff(values) >= 0.0).any():
        raise refuse("velocities", shown(velocities), "two or more, falling, > 0 m/s", "Sort them.")
    runs = []
    for number, velocity in enumerate(values):
        runs.append(simulate(pair, cycles, friction_velocity=float(velocity)))
        if progress is not None:
            progress((number + 1) / values.size)
    change = np.full((values.size - 1, len(_QUANTITIES)), np.nan)
    for column, name in enumerate(_QUANTITIES):
        span = float(np.ptp(runs[-1][name].to_numpy()))
        if span > 0.0:  # y does not move without friction
            change[:, column] = [
                float(np.abs(a[name] - b[name]).max()) / span for a, b in itertools.pairwise(runs)
            ]
    order = np.full_like(change, np.nan)
    # Change between velocities v and v' is proportional to v^p - v'^p, so to v^p for a constant ratio v/v'.
    order[1:] = np.log(change[:-1] / change[1:]) / np.log(values[:-2] / values[1:-1])[:, None]
    evaluations = np.array([run.attrs["force_evaluations"] / cycles for run in runs[:-1]])
    dims = ("velocity", "quantity")
    return labelled_dataset(
        {
            "change": (dims, change, "1", "largest change over peak to peak"),
            "order": (dims, order, "1", "observed order in the velocity"),
            "force_evaluations": ("velocity", evaluations, "1", "calls per cycle"),
        },
        {
            "velocity": (values[:-1], "m/s", "velocity over which friction changes its sign"),
            "quantity": (list(_QUANTITIES), "1", "quantity that changes"),
        },
        provenance(pair, cycles=cycles) | {"last_velocity": float(values[-1])},
    )
