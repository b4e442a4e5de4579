"""Why the exact model differs from the lumped one: its finite-motion effects, switched one at a time.

Sources: docs/theory/multibody.md, "Effects".
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lumped.labelling import labelled_dataset
from lumped.model.results import provenance
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import Progress
from multibody.contact.effects import CAUSES, DEFAULT_EFFECTS, EFFECTS
from multibody.run.flow_map import steady_state

if TYPE_CHECKING:
    import xarray as xr

_SAMPLES = 128
#: The shares that are stated err by as much.
_RTOL = 1e-7
_QUANTITIES = ("dte", "x_p", "y_p", "theta_p")
_KINDS = {"alone": "this cause alone", "without": "all causes but this"}


def attribution(pair: AnyPair, *, progress: Progress | None = None) -> xr.Dataset:
    """How much each finite-motion effect changes the periodic motion, and the momentary load in friction.

    Each motion has the brake torque that balances it: in a run from the same state every effect that changes
    the losses would also let the pair drift, and the phase with it.

    Parameters
    ----------
    pair : a validated gear pair
    progress : called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``cause`` and ``quantity``: ``alone``, the largest change when only this cause acts,
    and ``without``, the largest change when all causes but this one act; both over the peak to peak of the
    motion without any, so they are shares of the difference from the lumped model. Cause "all" is the whole
    difference: all finite motions, so not the cause "friction_load", whose ``without`` is NaN. The attribute
    ``largest`` names the finite motion that changes the transmission error most. A quantity that does not
    move without effects (y_p without friction) is NaN.
    """
    pair = load_gear_pair(pair)

    def motion(effects: set[str]) -> xr.Dataset:
        return steady_state(pair, effects=effects, samples_per_cycle=_SAMPLES, rtol=_RTOL)

    every = set(DEFAULT_EFFECTS)
    groups = {cause: {name for name in EFFECTS if EFFECTS[name].cause == cause} for cause in CAUSES}
    groups["all"] = every
    base = motion(set())
    table = {kind: np.full((len(groups), len(_QUANTITIES)), np.nan) for kind in _KINDS}
    for row, own in enumerate(groups.values()):
        for kind, effects in (("alone", own), ("without", every - own)):
            if kind == "without" and not own <= every:
                continue  # it is no part of the whole
            run = motion(effects)
            for column, name in enumerate(_QUANTITIES):
                swing = float(np.ptp(base[name].to_numpy()))
                change = float(np.abs(run[name] - base[name]).max())
                table[kind][row, column] = change / swing if swing > 0.0 else np.nan
        if progress is not None:
            progress((row + 1) / len(groups))
    causes = list(groups)
    motions = [cause for cause in CAUSES if groups[cause] <= every]
    return labelled_dataset(
        {
            kind: (("cause", "quantity"), table[kind], "1", f"largest change over peak to peak, {text}")
            for kind, text in _KINDS.items()
        },
        {
            "cause": (causes, "1", "cause of the difference"),
            "quantity": (list(_QUANTITIES), "1", "quantity that changes"),
        },
        provenance(pair, samples_per_cycle=_SAMPLES)
        | {"largest": max(motions, key=lambda cause: table["alone"][causes.index(cause), 0])},
    )
