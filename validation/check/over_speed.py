"""Values over speed of another model, or of a run on a rig, beside ours: peaks to peak, rms, means, orders.

Sources: docs/how_to/check_your_model.md, "Values over speed".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from lumped.errors import NumericalError, refuse
from lumped.labelling import labelled_dataset
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.curves import SpeedColumn, ValuesOverSpeed
from validation.check.motion_curves import MotionCurves
from validation.check.origin import origin
from validation.check.quantities import QUANTITIES
from validation.check.reference import lumped_motion
from validation.signals.complex_orders import LEAST

if TYPE_CHECKING:
    import xarray as xr

#: Unit attribute of a variable whose columns differ in their unit.
_BY_COLUMN = "SI, by column"


@dataclass(frozen=True, eq=False)
class SpeedMisfit:
    """Values over speed of another model beside ours.

    Attributes
    ----------
    pair : the gear pair
    theirs : values of the other model
    ours : (column, speed) our values in SI; NaN: no motion was found there
    """

    pair: GearPair
    theirs: ValuesOverSpeed
    ours: FloatArray

    @cached_property
    def by_column(self) -> FloatArray:
        """(column,) rms of theirs less ours over the speeds, over the rms of the larger column."""
        misfits = []
        for column, ours in zip(self.theirs.columns, self.ours, strict=True):
            known = np.isfinite(ours)
            size = max(_rms(column.values[known]), _rms(ours[known]))
            misfits.append(_rms(column.values[known] - ours[known]) / size if size > 0.0 else 0.0)
        return np.asarray(misfits)

    @property
    def value(self) -> float:
        """Root of the mean of the squares over the columns."""
        return _rms(self.by_column)

    @cached_property
    def worst_speed(self) -> float:
        """Speed [rad/s] at which the columns differ most."""
        differences = np.zeros(self.theirs.speeds.size)
        for column, ours in zip(self.theirs.columns, self.ours, strict=True):
            size = max(_rms(column.values), LEAST)
            differences += np.nan_to_num(np.abs(column.values - ours)) / size
        return float(self.theirs.speeds[int(differences.argmax())])

    @cached_property
    def table(self) -> xr.Dataset:
        """Dataset over ``column`` and ``speed`` [rpm]: theirs and ours in the SI unit ``units``."""
        columns = self.theirs.columns
        dims = ("column", "speed")
        units = [QUANTITIES[column.quantity].unit for column in columns]
        theirs = np.stack([column.values for column in columns])
        return labelled_dataset(
            {
                "theirs_over_speed": (dims, theirs, _BY_COLUMN, "values of the other model"),
                "ours_over_speed": (dims, self.ours, _BY_COLUMN, "values of spurcheck"),
                "units": ("column", units, "1", "SI unit of the column"),
                "misfit": ("column", self.by_column, "1", "misfit of the column"),
            },
            {
                "column": ([column.name for column in columns], "1", "column"),
                "speed": (self.theirs.speeds * 30.0 / np.pi, "rpm", "pinion speed"),
            },
            origin(self.pair) | {"theirs": self.theirs.name, "role": self.theirs.role},
        )


def speed_misfit(
    theirs: ValuesOverSpeed, pair: GearPair, tell: Callable[[float], None] | None = None
) -> SpeedMisfit:
    """Return values over speed beside the predicted motion at each speed.

    Parameters
    ----------
    theirs : values of the other model
    pair : the gear pair; its speed is not used
    tell : told the done share

    Raises
    ------
    ParameterError : a column of tooth pairs
    NumericalError : no motion is found at any speed
    """
    for column in theirs.columns:
        if QUANTITIES[column.quantity].of_tooth_pair:
            allowed = "quantities of the whole mesh"
            raise refuse(f"column {column.name}", column.quantity, allowed, "Leave the column out.")
    ours = np.full((len(theirs.columns), theirs.speeds.size), np.nan)
    for j, speed in enumerate(theirs.speeds):
        changes = {"operating.pinion_speed": f"{float(speed)!r} rad/s"}
        if theirs.pinion_torque is not None:
            changes["operating.pinion_torque"] = f"{float(theirs.pinion_torque)!r} N*m"
        try:
            motion = lumped_motion(pair.with_(changes))
        except NumericalError:
            continue
        ours[:, j] = [statistic_of(column, motion) for column in theirs.columns]
        if tell is not None:
            tell((j + 1) / theirs.speeds.size)
    if not np.isfinite(ours).any():
        raise NumericalError("No motion is found at any of these speeds; check speeds and torque.")
    return SpeedMisfit(pair, theirs, ours)


def statistic_of(column: SpeedColumn, motion: MotionCurves) -> float:
    """Return the value of a column for a motion of ours, in SI."""
    values = motion.samples(column.quantity)
    if column.statistic == "peak_to_peak":
        return float(np.ptp(values))
    if column.statistic == "rms":
        return float(np.std(values))
    if column.statistic == "mean":
        return float(np.mean(values))
    orders = motion.orders(column.quantity, int(np.ceil(column.order)))
    place = round(column.order * motion.mesh_cycles) - 1
    if not 0 <= place < orders.orders.size or abs(orders.orders[place] - column.order) > 1e-6:
        allowed = "a whole number of mesh orders over the period of the motion"
        raise refuse(f"column {column.name}", f"order {column.order:g}", allowed, "Leave the column out.")
    return float(orders.amplitudes[place])


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if np.size(values) else 0.0
