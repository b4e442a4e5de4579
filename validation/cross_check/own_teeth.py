"""The cross-check of unlike teeth: both models over a revolution, or over mesh cycles round the worst tooth.

Sources: docs/theory/teeth.md, "In the multibody model".
"""

from __future__ import annotations

import numpy as np
import xarray as xr

import lumped
from lumped import GearPair
from lumped.model.periodic_system import LTVSystem
from lumped.model.revolution_motion import default_samples
from lumped.model.swing import swing, swinging
from lumped.model.tooth_laws import ToothLaws, mesh_tables
from lumped.schema.meeting_teeth import period_of
from multibody.run.simulation import at_mean_speed

#: Longest period that is compared as a whole, compared cycles of a longer period, and cycles before these, in
#: which the motion settles.
_WHOLE = 64
_WINDOW = 6
_FORGOTTEN = 10


def worst_cycle(pair: GearPair) -> int:
    """Mesh cycle with the largest static load of a tooth in the period; of a faulty tooth if there is one."""
    sharing = lumped.static_sharing(pair, samples_per_cycle=32)
    load = sharing["normal_load"].to_numpy()
    faulty = np.zeros(load.shape, dtype=bool)
    for name, gear in (("pinion", pair.pinion), ("gear", pair.gear)):
        teeth = [fault.tooth for fault in gear.faults]
        faulty |= np.isin(sharing[f"{name}_tooth"].to_numpy(), teeth)
    return int(np.where(faulty | ~faulty.any(), load, 0.0).max(axis=0).argmax()) // 32


def both_motions(pair: GearPair, samples: int) -> tuple[GearPair, xr.Dataset, xr.Dataset]:
    """Lumped and multibody motion of the same cycles at the same times.

    The first returned value is the pair with the teeth counted from the first cycle of both runs. The
    multibody model starts from the lumped motion, and the first ``_FORGOTTEN`` cycles are not compared.
    """
    period = period_of(pair)
    compared = period if period <= _WHOLE else _WINDOW
    if period > _WHOLE:
        start = worst_cycle(pair) - _FORGOTTEN - _WINDOW // 2
        teeth = (pair.pinion.teeth, pair.gear.teeth)
        first = pair.mesh.first_teeth or (1, 1)
        pair = pair.with_(
            {"mesh.first_teeth": [(n - 1 + start) % z + 1 for n, z in zip(first, teeth, strict=True)]}
        )
    samples = min(samples, default_samples(period))
    motion = lumped.steady_state(pair, contact="unilateral", supports="springs", samples_per_cycle=samples)
    number = np.arange((_FORGOTTEN + compared) * samples + 1)
    reference = motion.isel(time=number % motion.sizes["time"])
    time = reference["time"].to_numpy()[1] * np.arange(number.size)
    # Friction turns the free train further over many turns; this part is no phase of the lumped contact.
    system = LTVSystem.of(pair.healthy, "full", supports="springs")
    followed = swing(swinging(mesh_tables(ToothLaws(pair), 1.0, 1), system), time)
    exact = at_mean_speed(pair, reference, followed, samples, _FORGOTTEN // 2)
    settled = slice(_FORGOTTEN * samples, None)
    exact = exact.isel(time=settled)
    return pair, reference.isel(time=settled).assign_coords(time=exact["time"]), exact
