"""What the judge says of one bound."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from balls import worst_ratio  # type: ignore[import-not-found]

Disks = Sequence[tuple[complex, float]]
"""Centre and radius of a disk about each exact multiplier."""


class Finding(NamedTuple):
    """One bound against the truth.

    Attributes
    ----------
    kind, route : what was tried, and by which route
    ratio : error over bound, the multipliers matched best
    wrong : whether the verdict says the opposite of the truth
    undecided : whether there is none
    certificate : "proven", "estimate", or "warned" for an estimate with a warning
    """

    kind: str
    route: str
    ratio: float
    wrong: bool
    undecided: bool
    certificate: str


def finding(
    kind: str, route: str, values: np.ndarray, errors: np.ndarray, truth: Disks, certificate: str
) -> Finding:
    """Finding on multipliers with their bounds."""
    ratio, _ = worst_ratio(values, errors, truth)
    modulus = np.abs(values)
    radius, error = float(modulus.max()), float((modulus + errors).max() - modulus.max())
    low, high = (max(abs(c) + s * r for c, r in truth) for s in (-1.0, 1.0))
    wrong = (radius + error < 1.0 and low > 1.0) or (radius - error > 1.0 and high < 1.0)
    undecided = not (radius + error < 1.0 or radius - error > 1.0)
    return Finding(kind, route, ratio, wrong, undecided, certificate)
