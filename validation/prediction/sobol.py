"""Scrambled Sobol points of the uncertain inputs.

Source: A. B. Owen, J. Complexity 14 (1998) 466, by ``scipy.stats.qmc``. Its import takes a quarter of a
second in each process, so the points that reports use are stored between runs.
"""

from __future__ import annotations

import numpy as np

from lumped.cache import cached
from lumped.typing import FloatArray

#: Seed of the points where nobody chooses one. Points of other seeds are not stored.
SEED = 1
#: Number of stored points; fewer points are the first of them.
_STORED = 128


def sobol_points(importance: FloatArray, samples: int, seed: int) -> FloatArray:
    """Return (samples, inputs) scrambled Sobol points; the most important inputs get the first dimensions.

    ``importance`` (inputs,): grows with the effect of an input. Few points fill the planes of later
    dimensions unevenly, see docs/verification/uncertainty.md. Inputs that are equal by symmetry keep their
    order: importance is rounded.
    """
    importance = np.round(importance, 6)
    dimensions = importance.size
    if seed == SEED and samples <= _STORED:
        inputs = repr((dimensions, _STORED, seed)).encode()
        points = cached("sobol", (), inputs, lambda: {"points": _drawn(dimensions, _STORED, seed)})["points"]
    else:
        points = _drawn(dimensions, samples, seed)
    return np.asarray(points[:samples, np.argsort(np.argsort(-importance, kind="stable"))])


def _drawn(dimensions: int, samples: int, seed: int) -> FloatArray:
    """Return (samples, dimensions) points of the library."""
    from scipy.stats import qmc

    points: FloatArray = qmc.Sobol(dimensions, rng=np.random.default_rng(seed)).random(samples)
    return points
