"""Does the multibody model lose the power that the lumped model loses?

Sources: docs/theory/multibody.md, "The verdict".
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import xarray as xr

from lumped import GearPair
from validation.cross_check.verdict import Judgement
from validation.prediction.motion import losses_of

#: Largest difference of the losses over the loss of the lumped motion that agrees.
LOSS_LIMIT = 0.05
#: Share of the driving power that is no loss: the relative tolerance of the integration at "exact".
_NO_LOSS = 1e-8
_REASON = (
    "power lost at all places together, over that of the lumped motion; finite motions change it by up to "
    "2 %, published coefficients of friction differ by more"
)


@dataclass(frozen=True)
class LossAgreement:
    """Mean lost powers of both motions.

    Attributes
    ----------
    lumped, multibody : place of ``validation.prediction.motion.PLACES`` -> mean power lost there [W]
    limit : largest ``difference`` within the limit
    input_power : driving power [W]; rounding of the driving power is no loss
    """

    lumped: Mapping[str, float]
    multibody: Mapping[str, float]
    limit: float = LOSS_LIMIT
    input_power: float = 0.0

    @property
    def total(self) -> float:
        """Power that the lumped motion loses [W]."""
        return sum(self.lumped.values())

    @property
    def total_multibody(self) -> float:
        """Power that the multibody motion loses [W]."""
        return sum(self.multibody.values())

    @property
    def difference(self) -> float:
        """Difference of both totals over the total of the lumped motion; infinite if only one model loses.

        A loss below ``_NO_LOSS`` of the driving power is an error of the integration.
        """
        apart = abs(self.total_multibody - self.total)
        scale = max(self.total, _NO_LOSS * self.input_power)
        return apart / scale if scale > 0.0 else (math.inf if apart > 0.0 else 0.0)

    @property
    def within(self) -> bool:
        """Whether the difference is within the limit. NaN is not within the limit."""
        return self.difference <= self.limit

    @property
    def judgement(self) -> Judgement:
        """The difference against its limit."""
        return Judgement("exact: loss", self.difference, self.limit, _REASON)


def loss_agreement(pair: GearPair, lumped: xr.Dataset, multibody: xr.Dataset) -> LossAgreement | None:
    """Compare the losses in the attributes of both motions. None: a motion has no losses there."""
    lost = losses_of(lumped.attrs)
    lost_multibody = losses_of(multibody.attrs)
    power = pair.operating.pinion_torque * pair.geometry.omega_pinion
    return LossAgreement(lost, lost_multibody, input_power=power) if lost and lost_multibody else None


def sliding_agreement(lumped: xr.Dataset, multibody: xr.Dataset) -> LossAgreement:
    """Compare the loss by sliding over the same times. Runs of unlike teeth do not repeat."""
    lost, lost_multibody = (
        {"sliding": -float(run["friction_power"].sum("pair").mean())} for run in (lumped, multibody)
    )
    return LossAgreement(lost, lost_multibody)
