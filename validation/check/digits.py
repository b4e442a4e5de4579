"""Values that are written with few digits: the step in which they are written.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import numpy as np

from lumped.typing import FloatArray

#: Most different values of rounded samples, how often each is repeated at least in the mean, and how near
#: to a whole number the multiples of the step are.
_FEW_VALUES = 100
_REPEATED = 4
_WHOLE = 0.02
#: Steps of written values above this share of the peak to peak are worth a sentence.
_COARSE_STEP = 0.01


def step_of_values(values: FloatArray) -> float:
    """Return the step in which values are written, as with few digits; 0 where no step shows.

    A step shows where many samples have few different values, and every difference of two values is a
    multiple of the smallest one.
    """
    different = np.unique(values)
    if different.size < 3 or different.size > _FEW_VALUES or values.size < _REPEATED * different.size:
        return 0.0
    gaps = np.diff(different)
    multiples = gaps / gaps.min()
    return float(gaps.min()) if np.abs(multiples - np.round(multiples)).max() < _WHOLE else 0.0


def coarse_step(values: FloatArray) -> float:
    """Return the step in which values are written, where it is worth a sentence; else 0."""
    step = step_of_values(values)
    return step if step > _COARSE_STEP * float(np.ptp(values)) else 0.0
