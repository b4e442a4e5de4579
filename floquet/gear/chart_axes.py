"""Speeds and damping ratios that charts of a gear pair cover; the operating point is always a node."""

from __future__ import annotations

import numpy as np

from lumped import GearPair, NumericalError
from lumped.model.averaged import Mode, modes
from lumped.typing import FloatArray


def operating_rpm(pair: GearPair) -> float:
    """Operating speed of the pinion [rpm]."""
    return float(pair.operating.pinion_speed * 30.0 / np.pi)


def speed_range(pair: GearPair, found: tuple[Mode, ...]) -> tuple[float, float]:
    """Speeds [rpm] that charts and the report cover.

    The upper end is past the operating speed by half and past the speed where the mesh frequency meets the
    highest mode of the averaged pair, which is also the widest parametric resonance 2 omega/2 below its
    first tongue.
    """
    rpm = operating_rpm(pair)
    top = max([1.5 * rpm, *(1.2 * mode.resonant_speed for mode in found)])
    # Two digits are enough for the end of an axis.
    digits = 10.0 ** (np.floor(np.log10(top)) - 1)
    top = float(np.ceil(top / digits) * digits)
    return min(0.05 * top, 0.5 * rpm), top


def chart_axes(pair: GearPair, speeds: int, dampings: int) -> dict[str, FloatArray]:
    """Nodes of the stability chart: so many speeds [rpm] and mesh damping ratios."""
    try:
        found = modes(pair)
    except NumericalError:
        found = ()
    largest = min(max(0.08, 1.5 * pair.mesh.damping_ratio), 1.0)
    return {
        "speed_rpm": with_point(np.linspace(*speed_range(pair, found), speeds), operating_rpm(pair)),
        "damping_ratio": with_point(np.linspace(0.0, largest, dampings), pair.mesh.damping_ratio),
    }


def with_point(values: FloatArray, point: float) -> FloatArray:
    """Axis values with the node nearest to a point moved onto it."""
    nodes = values.copy()
    nodes[np.argmin(np.abs(nodes - point))] = point
    return nodes
