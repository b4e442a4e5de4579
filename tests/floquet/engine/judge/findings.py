"""What the judge says of one bound."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from balls import worst_ratio  # type: ignore[import-not-found]

Disks = Sequence[tuple[complex, float]]
"""Centre and radius of a disk about each exact multiplier."""


class Finding(NamedTuple):
    """One bound against the truth."""

    kind: str  # what was tried, and by which route
    route: str
    ratio: float  # error over bound, the multipliers matched best
    wrong: bool  # whether the verdict says the opposite of the truth
    undecided: bool  # whether there is none
    certificate: str  # "proven", "estimate", or "warned" for an estimate with a warning


def finding(
    kind: str, route: str, values: np.ndarray, errors: np.ndarray, truth: Disks, certificate: str
) -> Finding:
    """Finding on multipliers with their bounds."""
    ratio, _ = worst_ratio(values, errors, truth)
    modulus = np.abs(values)
    radius = float(modulus.max())
    error = float((modulus + errors).max() - modulus.max())
    low, high = (max(abs(c) + s * r for c, r in truth) for s in (-1.0, 1.0))
    wrong = (radius + error < 1.0 and low > 1.0) or (radius - error > 1.0 and high < 1.0)
    undecided = not (radius + error < 1.0 or radius - error > 1.0)
    return Finding(kind, route, ratio, wrong, undecided, certificate)
