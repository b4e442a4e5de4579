"""Motions of teeth that push only as the page shows them: every orbit, and the motion of some."""

from __future__ import annotations

import numpy as np
import xarray as xr

from floquet.gear.response import ResponseBranches
from lumped.labelling import labelled_dataset
from lumped.typing import FloatArray

#: Samples per mesh cycle of a motion, and most motions of a branch that are kept.
SAMPLES, _MOST = 48, 60


def branch_dataset(found: ResponseBranches) -> xr.Dataset:
    """Return ``dataset`` of the branches, over ``orbit``, and the transmission error of some orbits.

    Variables carry ``branch_`` before their names. ``wave_dte`` [m] is over (wave, wave_phase in mesh
    cycles), NaN behind the last cycle of a motion; ``wave_orbit`` says whose it is.
    """
    data = found.dataset
    names = {name: f"branch_{name}" for name in data.data_vars if "point" in data[name].dims}
    kept, waves, start = list[int](), list[FloatArray](), 0
    for branch in found.branches:
        count = len(branch.orbits)
        for i in np.unique(np.linspace(0, count - 1, min(count, _MOST)).round().astype(int)):
            orbit = branch.orbits[i]
            run = orbit.system.run(
                orbit.start, orbit.period, orbit.n, orbit.parameter, samples=np.arange(SAMPLES) / SAMPLES
            )
            kept.append(start + int(i))
            waves.append(run.states[:, : orbit.system.size // 2] @ orbit.system.output)
        start += count
    length = SAMPLES * max((branch.n for branch in found.branches), default=0)
    padded = np.full((len(waves), length), np.nan)
    for row, wave in zip(padded, waves, strict=True):
        row[: wave.size] = wave
    motions = labelled_dataset(
        {
            "wave_orbit": ("wave", np.array(kept, dtype=int), "1", "orbit whose motion this is"),
            "wave_dte": (("wave", "wave_phase"), padded, "m", "dynamic transmission error"),
        },
        {
            "wave": (np.arange(len(waves)), "1", "motion"),
            "wave_phase": (np.arange(length) / SAMPLES, "1", "mesh cycles"),
        },
    )
    return xr.merge([data.rename(names | {"branch": "branch", "point": "orbit"}), motions])
