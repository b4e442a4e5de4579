"""A pair at rest under its torque: what is known of a pair that has no motion.

Nothing here needs a motion: the load of each tooth pair, the transmission error of slow rolling, losses
without vibration, and natural frequencies. Where teeth bend too far under the torque, the largest torque
that the model carries is searched, and the natural frequencies are those under this torque.

Sources: docs/theory/validity.md, "A pair without a motion".
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from functools import cached_property

import xarray as xr

from lumped.errors import LawRangeWarning, NumericalError, ParameterError
from lumped.losses import quasi_static_losses
from lumped.model.averaged import Mode, modes
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.path_of_contact import pair_stiffness
from lumped.quasi_static import static_transmission_error
from lumped.schema.pair import GearPair

#: The search for the largest torque ends where the torque is known within this share ...
_TORQUE_STEP = 0.02
#: ... and does not go below this share of the torque of the pair.
_LEAST_TORQUE = 0.02


@dataclass(frozen=True)
class StaticPair:
    """A pair at rest under its torque, with like teeth.

    Every number is NaN where its computation fails too.

    Attributes
    ----------
    pair : gear pair with like teeth
    """

    pair: GearPair

    @property
    def supports(self) -> Supports:
        """Supports of the natural frequencies."""
        return "springs" if self.pair.shafts is None else "shafts"

    @property
    def mesh_force(self) -> float:
        """Static mesh force without friction, T_p / r_bp [N]."""
        return self.pair.operating.pinion_torque / self.pair.geometry.base_radius_pinion

    @cached_property
    def sharing(self) -> xr.Dataset | None:
        """Transmission error and loads over the mesh cycle, as of ``static_transmission_error``.

        None: the computation fails.
        """
        try:
            return static_transmission_error(self.pair)
        except (NumericalError, ParameterError):
            return None

    @property
    def peak_to_peak(self) -> float:
        """Peak to peak of the static transmission error [m]."""
        return math.nan if self.sharing is None else float(self.sharing["peak_to_peak"][0])

    @property
    def tooth_load(self) -> float:
        """Largest static load of one tooth pair over the mesh force [-]."""
        return math.nan if self.sharing is None else float(self.sharing["load_share"].max())

    @property
    def loaded_pairs(self) -> float:
        """Mean number of tooth pairs that carry load [-]."""
        return math.nan if self.sharing is None else float(self.sharing["contact_ratio"][0])

    @property
    def mesh_stiffness(self) -> float:
        """Mean stiffness of the mesh, by the stiffness of a tooth pair on its flanks [N/m]."""
        return mean_mesh_stiffness(self.pair)

    @cached_property
    def efficiency(self) -> float:
        """Mesh efficiency in slow motion, without vibration [-]."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", LawRangeWarning)
                return quasi_static_losses(self.pair).mesh_efficiency
        except (NumericalError, ParameterError):
            return math.nan

    @cached_property
    def largest_torque(self) -> float:
        """Largest torque under which the pair has a linear form, within 2 % and rounded down [N m].

        The torque of the pair, where the pair has a linear form under it. NaN: none down to 2 % of it has.
        """
        torque = self.pair.operating.pinion_torque
        if _has_linear_form(self.pair):
            return torque
        low, high = _LEAST_TORQUE, 1.0
        if not _has_linear_form(self.pair.with_(torque=low * torque)):
            return math.nan
        while high / low > 1.0 + _TORQUE_STEP:
            middle = math.sqrt(low * high)
            if _has_linear_form(self.pair.with_(torque=middle * torque)):
                low = middle
            else:
                high = middle
        return low * torque

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """Modes of the averaged pair under ``largest_torque``. Empty: none, or one is overdamped."""
        if math.isnan(self.largest_torque):
            return ()
        try:
            return modes(self.pair.with_(torque=self.largest_torque), self.supports)
        except NumericalError:
            return ()


def mean_mesh_stiffness(pair: GearPair) -> float:
    """Return the mean stiffness of a tooth pair on its flanks times the contact ratio [N/m]."""
    return float(pair_stiffness(pair).mean() * pair.geometry.contact_ratio)


def _has_linear_form(pair: GearPair) -> bool:
    """Whether the model has a linear form of the pair under its torque."""
    try:
        LTVSystem.of(pair, "mesh" if pair.shafts is None else "elastic", supports="springs")
    except (NumericalError, ParameterError):
        return False
    return True
