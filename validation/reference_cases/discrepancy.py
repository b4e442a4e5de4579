"""Difference of two motions of a reference case, channel by channel.

Source: docs/reference_cases.md, "What the stated discrepancies mean".
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lumped.typing import FloatArray
from validation.signals.complex_orders import channel_scale, misfit, orders_of_period

#: Highest mesh order of a discrepancy.
ORDERS = 40
#: Least discrepancy that is stated: numbers of the files have eight digits.
LEAST_STATED = 1e-8


@dataclass(frozen=True)
class Discrepancy:
    """Discrepancy of each way to a channel from its curve, as a share of the curve's amplitude.

    Each value is the root of SUM |U_m - V_m|^2 over the scale, m being the orders up to 40: U of the curve,
    V of the other motion. None: this way does not exist for the case.

    Attributes
    ----------
    lumped : of ``lumped.steady_state`` with half the step between samples
    multibody : of ``multibody`` with exact kinematics
    closed_form : of the closed form
    floquet : of the transition matrices of ``floquet``, which solve the equation without a closed form
    """

    lumped: float | None = None
    multibody: float | None = None
    closed_form: float | None = None
    floquet: float | None = None


@dataclass(frozen=True)
class StaticValues:
    """Static values of a case, which bound the scale of a channel that is nearly zero.

    Attributes
    ----------
    force : static mesh force [N]
    deflection : mean deflection of the mesh [m]
    base_radius : base radius of the pinion [m]
    """

    force: float
    deflection: float
    base_radius: float

    def of_unit(self, unit: str) -> float:
        """Return the static value of a quantity with this SI unit."""
        values = {
            "N": self.force,
            "m": self.deflection,
            "rad": self.deflection / self.base_radius,
            "N/m": self.force / self.deflection,
        }
        return values[unit]


def discrepancy_of(curve: FloatArray, other: FloatArray, static: float, period: int = 1) -> float:
    """Return the discrepancy of another motion from a curve.

    Parameters
    ----------
    curve, other : (k,) samples at the same times, which divide the period evenly
    static : static value of the channel, in its unit
    period : mesh cycles of the period
    """
    signal = orders_of_period(curve, ORDERS, period)
    second = orders_of_period(other, ORDERS, period)
    return misfit([signal], [second], [channel_scale(signal.size, second.size, static)])


def rounded_up(value: float) -> float:
    """Return a discrepancy with two significant digits, rounded up, and at least ``LEAST_STATED``."""
    if value <= LEAST_STATED:
        return LEAST_STATED
    unit = 10.0 ** (np.floor(np.log10(value)) - 1.0)
    return float(f"{np.ceil(value / unit) * unit:.2g}")


def percent(value: float | None) -> str:
    """Return a discrepancy as text in percent; an empty text for a way that does not exist."""
    if value is None:
        return ""
    return "< 0.001 %" if value < 1e-5 else f"{100.0 * value:.2g} %"


def discrepancies(
    curves: Mapping[str, FloatArray],
    others: Mapping[str, Mapping[str, FloatArray]],
    static: Mapping[str, float],
    period: int = 1,
) -> dict[str, dict[str, float]]:
    """Return channel -> way -> discrepancy, rounded up to two digits.

    Parameters
    ----------
    curves : channel -> (k,) curve
    others : way, a field of ``Discrepancy`` -> channel -> (k,) at the same times
    static : channel -> static value
    period : mesh cycles of the period
    """
    return {
        channel: {
            way: rounded_up(discrepancy_of(curve, channels[channel], static[channel], period))
            for way, channels in others.items()
            if channel in channels
        }
        for channel, curve in curves.items()
    }
