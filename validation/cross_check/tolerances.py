"""What agreement between the lumped and the multibody model is expected, and why: tolerances as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

Metric = Literal["maximum_over_span", "remainder_l2"]
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


def tolerance(quantity: str, fidelity: str, shift: float) -> Tolerance:
    """Limit for one quantity.

    At fidelity "exact" what finite motions change first of all is predicted
    (``validation.cross_check.finite_motion``) and taken off. What is left has the shift as a factor too,
    times displacements over lengths of the machine, or is of second order. So it must be smaller than the
    shift itself, whatever the quantity, the pair and its stiffness.

    Parameters
    ----------
    quantity : a key of ``GROUPS``
    fidelity : "linear" or "exact"
    shift : mean distance by which wind-up and bearing deflection move the contact along the line of action,
        over the base pitch; the small parameter of every finite-motion effect
    """
    group = GROUPS[quantity]
    if fidelity == "linear":
        return LINEAR[group]
    return Tolerance(
        "remainder_l2",
        shift,
        f"finite motions shift the contact by {shift:.2e} of a base pitch; what they change first "
        "of all is predicted and taken off, and the rest must be smaller than the shift itself",
    )
