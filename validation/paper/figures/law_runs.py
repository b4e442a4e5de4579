"""Runs of laws I to IV at the operating point of figures 4 to 6, computed once for all three."""

from __future__ import annotations

import xarray as xr

from lumped import GearPair
from validation.paper.operating_points import FIGURE_4, LAWS
from validation.paper.twins import twins


def law_runs(pair: GearPair, *, with_multibody: bool = True) -> xr.Dataset:
    """Periodic motion under laws I to IV in both models, see ``twins``; ``variant`` is the law's name.

    Parameters
    ----------
    pair : the gear pair, which the operating point of figure 4 is given to
    with_multibody : whether the multibody twin is computed too
    """
    at = FIGURE_4.of(pair)
    variants = {law: at.with_({"friction.law": law}) for law in LAWS}
    return twins(variants, with_multibody=with_multibody).rename(variant="law")
