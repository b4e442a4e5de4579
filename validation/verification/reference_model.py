"""Laws and static load of the multibody model against values from outside its comparison with the lumped one.

What else speaks for the multibody model does not depend on the pair: see ``tests/evidence/reference_model``.
"""

from __future__ import annotations

from dataclasses import dataclass

from lumped import GearPair
from multibody.contact.machine import circles
from validation.verification.checks import Check, check
from validation.verification.published import PublishedValue, published_values, shown


@dataclass(frozen=True, eq=False)
class ReferenceModel:
    """Every published formula at published numbers, and what must hold."""

    published: tuple[PublishedValue, ...]
    checks: tuple[Check, ...]

    @property
    def passes(self) -> bool:
        """Whether every check passes."""
        return all(check.passes for check in self.checks)


def reference_model(pair: GearPair, static_load: float) -> ReferenceModel:
    """Check the multibody model of a gear pair.

    Parameters
    ----------
    pair : a validated gear pair
    static_load : normal load of all tooth pairs at rest, as the report has it [N]
    """
    published = published_values()
    own = pair.operating.pinion_torque / circles(pair).base_pinion
    checks = (shown(published), check("static_load", abs(static_load / own - 1.0)))
    return ReferenceModel(published, checks)
