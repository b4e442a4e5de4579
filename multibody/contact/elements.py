"""Element laws of one tooth pair: tabulated stiffness, load and stored energy over the compression.

Sources: docs/theory/contact_energy.md, "Energy of one pair".
"""

from __future__ import annotations

import math

from lumped.typing import FloatArray
from multibody.contact.compiled import compiled

#: Below this share of the mean load a pair is linear: Hertz's logarithm would make it infinitely soft.
_LINEAR_BELOW = 1e-3
#: Newton's steps for the load of Hertz's contact, of which six are the most needed.
_MOST_STEPS = 20


@compiled
def stiffness_and_slope(table: FloatArray, xi: float) -> tuple[float, float]:
    """Stiffness of one tooth pair at xi [N/m] and its slope [N/m^2], or of another tabulated law.

    Beyond its path it is constant.

    ``table`` has one row per polynomial piece: its left end, its right end, then coefficients, highest
    power of (xi - left) first.
    """
    low, high = 0, table.shape[0] - 1
    x = min(max(xi, table[low, 0]), table[high, 1])
    while low < high:
        middle = (low + high + 1) // 2
        if x >= table[middle, 0]:
            low = middle
        else:
            high = middle - 1
    s = x - table[low, 0]
    value = slope = 0.0
    for column in range(2, table.shape[1]):
        slope = slope * s + value
        value = value * s + table[low, column]
    return value, slope if x == xi else 0.0


@compiled
def stiffness_at(table: FloatArray, xi: float) -> float:
    """Stiffness of one tooth pair at xi [N/m], see ``stiffness_and_slope``."""
    return float(stiffness_and_slope(table, xi)[0])


@compiled
def elastic_load(
    pressed: float, stiffness: float, slope: float, softening: float, nominal: float
) -> tuple[float, float, float]:
    """Load of one tooth pair, the energy it stores and the energy's slope along the path of contact.

    With N = k p the energy is U = k p^2/2. Hertz's contact by Weber and Banaschek grows stiffer with the
    load, p = N (1/k - D/2 ln(S/N_0^2)) with S = N^2 + N_1^2, which is linear below N_1. It stores
    U = N p - C with the integral C of p over N, of which k alone depends on the place
    (docs/theory/contact_energy.md, "Energy of one pair").

    Parameters
    ----------
    pressed : approach of the flanks less all gaps between them [m]
    stiffness, slope : k at the load ``nominal`` and its slope over xi [N/m], [N/m^2]
    softening : D [m/N]; 0 is a linear spring
    nominal : N_0 [N]

    Returns
    -------
    (load, energy, slope) : [N], [J], [J/m] at constant ``pressed``
    """
    if stiffness <= 0.0:
        return 0.0, 0.0, 0.0
    load = stiffness * pressed
    if softening == 0.0 or pressed <= 0.0:
        return load, 0.5 * load * pressed, 0.5 * slope * pressed * pressed
    least = (_LINEAR_BELOW * nominal) ** 2
    for _ in range(_MOST_STEPS):
        square = load * load + least
        compliance = 1.0 / stiffness - 0.5 * softening * math.log(square / nominal**2)
        step = (load * compliance - pressed) / (compliance - softening * load * load / square)
        load -= step
        if abs(step) <= 1e-15 * load:
            break
    square = load * load + least
    ends = square * (math.log(square / nominal**2) - 1.0) - least * (math.log(least / nominal**2) - 1.0)
    stored = load * pressed - 0.5 * load * load / stiffness + 0.25 * softening * ends
    return load, stored, 0.5 * slope * (load / stiffness) ** 2


@compiled
def gradual(share: float) -> float:
    """Smooth step from 0 at 0 to 1 at 1."""
    x = min(max(share, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)
