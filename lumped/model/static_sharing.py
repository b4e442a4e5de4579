"""Load sharing and static transmission error of teeth that differ, over their whole period.

Sources: docs/theory/teeth.md, "Statics".
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import whole_number
from lumped.labelling import labelled_dataset, provenance
from lumped.mesh.places import static_loads
from lumped.model.revolution_motion import default_samples
from lumped.model.tooth_laws import ToothLaws, mesh_tables
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.meeting_teeth import period_of, teeth_of_pairs

if TYPE_CHECKING:
    import xarray as xr


def static_sharing(pair: AnyPair, *, samples_per_cycle: int | None = None) -> xr.Dataset:
    """Static equilibrium of every meeting pair over a revolution or hunting period: docs/theory/teeth.md.

    At each position the approach delta and the loads N_n = k_n max(delta - e_n - sum_m w_nm N_m, 0) satisfy
    sum N_n = T/r_bp, where e_n is the pair's own gap with its tip corners.

    Parameters
    ----------
    pair : a validated gear pair, its teeth alike or not
    samples_per_cycle : positions in each mesh cycle; default 512, fewer where the period has many cycles

    Returns
    -------
    xarray.Dataset over ``phase`` [mesh cycles] and ``pair``: ``transmission_error`` [m], ``normal_load`` [N],
    ``pinion_tooth``, ``gear_tooth`` counted from 1; and over both teeth ``largest_load`` [N] of each pair
    of teeth that meets, NaN of others

    Raises
    ------
    NumericalError : at some position no tooth pair can carry the load
    """
    pair = load_gear_pair(pair)
    laws = ToothLaws(pair)
    period = period_of(pair)
    count = default_samples(period) if samples_per_cycle is None else samples_per_cycle
    count = whole_number("samples_per_cycle", count, 1, 65536)
    tables = mesh_tables(laws, 1.0, count)
    # With prescribed contact too, pairs touch where their own gaps close; with a stiffness of the whole mesh
    # within A to D.
    tables = tables._replace(law=tables.law._replace(prescribed=False))
    approach, pair_loads = static_loads(tables, 0, period)
    loads = pair_loads["static"].transpose(2, 0, 1)
    outputs = np.flatnonzero(tables.outputs)
    places = tables.ahead.size
    load = loads[:, :, outputs].reshape(places, -1)
    pinion, gear = teeth_of_pairs(pair, np.repeat(np.arange(period), count) - tables.ahead[:, None])
    largest = np.full((pair.pinion.teeth, pair.gear.teeth), np.nan)
    meeting = teeth_of_pairs(pair, np.arange(period) - tables.ahead[:, None])
    largest[meeting] = 0.0
    np.maximum.at(largest, meeting, loads.max(axis=2))
    phase = (np.arange(period)[:, None] + np.arange(count) / count).ravel()
    return labelled_dataset(
        {
            "transmission_error": (
                "phase",
                approach[:, outputs].ravel(),
                "m",
                "static transmission error, driven gear late",
            ),
            "normal_load": (("pair", "phase"), load, "N", "normal load of a tooth pair"),
            "pinion_tooth": (("pair", "phase"), pinion + 1, "1", "tooth of the pinion"),
            "gear_tooth": (("pair", "phase"), gear + 1, "1", "tooth of the gear"),
            "largest_load": (
                ("tooth_of_pinion", "tooth_of_gear"),
                largest,
                "N",
                "largest load of a pair of teeth",
            ),
        },
        {
            "phase": (phase, "1", "mesh cycles after pair 0 was at A"),
            "pair": (np.arange(places), "1", "tooth pair, 0 is ahead"),
            "tooth_of_pinion": (np.arange(pair.pinion.teeth) + 1, "1", "tooth of the pinion"),
            "tooth_of_gear": (np.arange(pair.gear.teeth) + 1, "1", "tooth of the gear"),
        },
        provenance(pair)
        | {"teeth": "alike" if pair.healthy is pair else "as given", "period_cycles": period},
    )
