"""What agreement between the lumped and the multibody model is expected, and why: tolerances as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

Metric = Literal["maximum_over_span", "remainder_l2", "relative_l2"]
Group = Literal["dte", "x", "y", "normal_load", "friction_force"]

#: Quantity -> group that shares a tolerance.
GROUPS: Mapping[str, Group] = MappingProxyType(
    {
        "dte": "dte",
        "x_p": "x",
        "x_g": "x",
        "y_p": "y",
        "y_g": "y",
        "normal_load": "normal_load",
        "friction_force": "friction_force",
    }
)


@dataclass(frozen=True)
class Tolerance:
    """Limit of one metric.

    Attributes
    ----------
    metric : name of the metric that is judged
    limit : largest value that agrees
    reason : why this limit
    """

    metric: Metric
    limit: float
    reason: str


_INTEGRATION = "the same equations, assembled and integrated independently: only integration error may remain"
_SMALL = f"{_INTEGRATION}; the quantity is about mu times the loads that carry the error, so ten times more"

#: Linear fidelity: limits of the largest difference over peak to peak.
LINEAR: Mapping[Group, Tolerance] = MappingProxyType(
    {
        "dte": Tolerance("maximum_over_span", 1e-6, _INTEGRATION),
        "x": Tolerance("maximum_over_span", 1e-6, _INTEGRATION),
        "normal_load": Tolerance("maximum_over_span", 1e-6, _INTEGRATION),
        "y": Tolerance("maximum_over_span", 1e-5, _SMALL),
        "friction_force": Tolerance("maximum_over_span", 1e-5, _SMALL),
    }
)

#: Beyond this relative L2 of the transmission error the lumped motion no longer describes the exact one.
LOST = 0.5
LOST_REASON = (
    "with the transmission error so different the lumped motion no longer describes the exact one, even "
    "where finite motions account for the difference"
)


def tolerance(
    quantity: str, fidelity: str, shift: float, largest: float = 0.0, unpredicted: float = 0.0
) -> Tolerance:
    """Limit for one quantity.

    At fidelity "exact" what finite motions change first of all is predicted
    (``validation.cross_check.finite_motion``) and taken off. What is left has the shift as a factor too,
    times displacements over lengths of the machine, or is of second order: the shift times what the effects
    change to first order, because one effect acts on what another has changed. So it must be smaller than
    the shift times one and the first-order change, whatever the quantity, the pair and its stiffness.
    The second part is small but where forces that cancel in the nominal motion do not in the actual one.

    Parameters
    ----------
    quantity : a key of ``GROUPS``
    fidelity : "linear" or "exact"
    shift : mean distance by which wind-up and bearing deflection move the contact along the line of action,
        over the base pitch; the small parameter of every finite-motion effect
    largest : sum over the effects of the largest first-order change (``first_order.Effects.largest``); not
        counted where it is infinite, because no displaced motion exists
    unpredicted : largest first-order change by the effects that could not be predicted
    """
    group = GROUPS[quantity]
    if fidelity == "linear":
        return LINEAR[group]
    reason = (
        f"finite motions shift the contact by {shift:.2e} of a base pitch; what they change first "
        f"of all, at most {largest:.2e}, is predicted and taken off, and the rest must be smaller than the "
        "shift times one and this change"
    )
    if unpredicted:
        reason += (
            f"; no motion of its own was found for all effects, so the most that the others change to first "
            f"order, {unpredicted:.2e}, is allowed too"
        )
    second = largest if np.isfinite(largest) else 0.0
    return Tolerance("remainder_l2", shift * (1.0 + second) + unpredicted, reason)


def raw_tolerance(largest: float, shift: float) -> Tolerance:
    """Limit of the whole difference of one quantity at fidelity "exact".

    Parameters
    ----------
    largest : sum over the effects of the largest first-order change (``first_order.Effects.largest``)
    shift : as for ``tolerance``
    """
    return Tolerance(
        "relative_l2",
        largest + shift,
        f"sum over the finite-motion effects of the largest change that each can make to first order, "
        f"{largest:.2e}, and the shift of the contact over the base pitch, {shift:.2e}",
    )
