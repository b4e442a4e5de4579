"""What agreement between the lumped and the multibody model is expected, and why: tolerances as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from lumped import GearPair, geometry, mesh_elements

Metric = Literal["maximum_over_span", "relative_l2", "remainder_l2"]
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

#: Contact shift over base pitch of the 28/28 pair at 56.5 N m, where the exact limits below are stated.
REFERENCE_SHIFT = 2.1e-3
#: A pair stiffness at the ends of contact above this share of its largest value is a jump.
_JUMP = 1e-2


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

#: Exact fidelity: relative L2 at ``REFERENCE_SHIFT`` with a pair stiffness that starts from zero.
EXACT_SMOOTH: Mapping[Group, float] = MappingProxyType(
    {"dte": 3e-3, "x": 6e-3, "y": 3e-2, "normal_load": 3e-2, "friction_force": 3e-2}
)
#: Exact fidelity: relative L2 at ``REFERENCE_SHIFT`` with a pair stiffness that jumps at entry.
EXACT_JUMP: Mapping[Group, float] = MappingProxyType(
    {"dte": 4.6e-2, "x": 8e-3, "y": 7e-2, "normal_load": 0.34, "friction_force": 0.34}
)
#: Beyond this relative L2 of the transmission error the lumped motion no longer describes the exact one.
LOST = 0.5


def stiffness_jumps(pair: GearPair) -> bool:
    """Whether a tooth pair takes up its stiffness at once, so that a shifted entry moves a jump."""
    g, stiffness = geometry(pair), mesh_elements(pair).stiffness
    largest = float(stiffness(stiffness.breaks[:-1]).max())
    return float(stiffness(g.L_XA)) > _JUMP * max(largest, stiffness.mean())


def tolerance(quantity: str, fidelity: str, shift: float, jumps: bool) -> Tolerance:
    """Limit for one quantity.

    Parameters
    ----------
    quantity : a key of ``GROUPS``
    fidelity : "linear" or "exact"
    shift : mean distance by which wind-up and bearing deflection move the contact along the line of action,
        over the base pitch; the small parameter of every finite-motion effect
    jumps : whether the pair stiffness jumps at entry, see ``stiffness_jumps``
    """
    group = GROUPS[quantity]
    if fidelity == "linear":
        return LINEAR[group]
    base = (EXACT_JUMP if jumps else EXACT_SMOOTH)[group]
    kind = "jumping" if jumps else "smooth"
    reason = (
        f"finite motions shift the contact by {shift:.2e} of a base pitch; to first order the difference "
        f"grows with that: {base:g} expected at {REFERENCE_SHIFT:g} with {kind} stiffness"
    )
    limit = base * shift / REFERENCE_SHIFT
    if group in ("y", "friction_force"):
        reason += "; what is left after the predicted effect of the actual sliding velocity is judged"
        return Tolerance("remainder_l2", limit, reason)
    return Tolerance("relative_l2", limit, reason)
