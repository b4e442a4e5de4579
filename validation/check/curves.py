"""Curves of another model, or of a record: the one form to which every source is read, in SI.

Sources: docs/how_to/check_your_model.md, "Static rung" and "Values over speed".
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from lumped.errors import refuse
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.quantities import PAIR_LABELS, QUANTITIES, Quantity, quantity_of

#: Kind of the source. The words of a verdict differ: "your model", "the record".
Role = Literal["model", "measurement"]
#: Abscissa of the samples: times [s], or mesh cycles since any moment.
Abscissa = Literal["time", "mesh_cycles"]
#: Scalars and arrays that another model can state beside its curves: name -> SI unit. ``M`` and ``K`` are its
#: mass and stiffness matrices.
STATICS: Mapping[str, str] = {
    "contact_ratio": "1",
    "base_radius_pinion": "m",
    "base_radius_gear": "m",
    "centre_distance": "m",
    "mass_pinion": "kg",
    "mass_gear": "kg",
    "inertia_pinion": "kg*m^2",
    "inertia_gear": "kg*m^2",
    "static_force": "N",
    "natural_frequencies": "Hz",
    "M": "",
    "K": "",
}
#: Least number of samples of a channel.
FEWEST_SAMPLES = 8


@dataclass(frozen=True, eq=False)
class Channel:
    """One channel of another model.

    Attributes
    ----------
    name : name of the channel in its source
    quantity : name of its quantity in ``QUANTITIES``
    values : (k,) samples in the SI unit of the quantity
    tooth_pair : label of the tooth pair, "A" to "H"; None for a quantity of the whole mesh
    noise : standard deviation of the sensor noise in SI; None: not known
    """

    name: str
    quantity: str
    values: FloatArray
    tooth_pair: str | None = None
    noise: float | None = None

    @property
    def kind(self) -> Quantity:
        """The quantity, with its unit and plain name."""
        return quantity_of(self.quantity)


@dataclass(frozen=True, eq=False)
class Curves:
    """Motion of another model of the pair, or a measured record, at one speed and one torque.

    Attributes
    ----------
    name : short name of the source
    abscissa : kind of ``places``
    places : (k,) times [s] or mesh cycles, increasing
    channels : channels, each with k samples
    role : "model" or "measurement"
    pinion_speed : stated pinion speed [rad/s]; None: not stated
    pinion_torque : stated pinion torque [N m]; None: not stated
    recurrence : mesh cycles after which the same labelled tooth pair is in contact again; None: the teeth of
        the pinion
    statics : name in ``STATICS`` -> value in SI
    remarks : sentences on how the source was read: units that were assumed, columns that were not used
    """

    name: str
    abscissa: Abscissa
    places: FloatArray
    channels: tuple[Channel, ...]
    role: Role = "model"
    pinion_speed: float | None = None
    pinion_torque: float | None = None
    recurrence: int | None = None
    statics: Mapping[str, FloatArray] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse samples that no comparison can use."""
        if not self.channels and not self.statics:
            names = ", ".join(QUANTITIES)
            raise refuse("theirs", "no channel", f"at least one of {names}", "Name the columns by these.")
        names_given = [channel.name for channel in self.channels]
        if len(set(names_given)) != len(names_given):
            raise refuse("channel", ", ".join(names_given), "different names", "Rename one of the channels.")
        if self.channels and self.places.size < FEWEST_SAMPLES:
            allowed = f">= {FEWEST_SAMPLES} samples"
            raise refuse(self.abscissa, f"{self.places.size} samples", allowed, "Give whole mesh cycles.")
        if (back := np.flatnonzero(np.diff(self.places) <= 0.0)).size:
            refused = f"sample {back[0] + 2} is not beyond the sample before"
            raise refuse(self.abscissa, refused, "increasing values", "Sort or cut the curves.")
        for channel in self.channels:
            _check(channel, self.places.size)

    def at(self, pair: GearPair) -> GearPair:
        """Return the pair at the stated speed and torque; what is not stated remains that of the pair."""
        changes: dict[str, str] = {}
        if self.pinion_speed is not None:
            changes["operating.pinion_speed"] = f"{float(self.pinion_speed)!r} rad/s"
        if self.pinion_torque is not None:
            changes["operating.pinion_torque"] = f"{float(self.pinion_torque)!r} N*m"
        return pair.with_(changes) if changes else pair

    def of_quantity(self, quantity: str) -> tuple[Channel, ...]:
        """Return the channels of a quantity."""
        return tuple(channel for channel in self.channels if channel.quantity == quantity)


def _check(channel: Channel, samples: int) -> None:
    """Refuse a channel of another length, with values that are not finite, or without its tooth pair."""
    where = f"channel {channel.name}"
    if channel.values.shape != (samples,):
        allowed = f"shape ({samples},), as the abscissa"
        raise refuse(where, f"shape {channel.values.shape}", allowed, "Give one value for each sample.")
    if not np.isfinite(channel.values).all():
        bad = int(np.flatnonzero(~np.isfinite(channel.values))[0])
        raise refuse(
            where, f"{channel.values[bad]} in sample {bad + 1}", "finite values", "Repair the sample."
        )
    labelled = channel.tooth_pair is not None
    if channel.kind.of_tooth_pair != labelled or (labelled and str(channel.tooth_pair) not in PAIR_LABELS):
        allowed = "a label A to H" if channel.kind.of_tooth_pair else f"none for {channel.quantity}"
        raise refuse(f"{where}: tooth pair", channel.tooth_pair, allowed, "Correct the channel.")


@dataclass(frozen=True, eq=False)
class SpeedColumn:
    """One value of a motion over speed.

    Attributes
    ----------
    name : name of the column in its source
    quantity : name of the quantity in ``QUANTITIES``
    statistic : "peak_to_peak", "rms" (about the mean), "mean" or "order"
    values : (s,) in the SI unit of the quantity; amplitudes of an order are peak values
    order : mesh order, for the statistic "order"
    noise : standard deviation of a value in SI; None: not known
    """

    name: str
    quantity: str
    statistic: Literal["peak_to_peak", "rms", "mean", "order"]
    values: FloatArray
    order: float = 0.0
    noise: float | None = None


@dataclass(frozen=True, eq=False)
class ValuesOverSpeed:
    """Values of motions at several speeds of another model, or of a run on a rig.

    Attributes
    ----------
    name : short name of the source
    speeds : (s,) pinion speeds [rad/s], increasing
    columns : values at these speeds
    role : "model" or "measurement"
    pinion_torque : stated pinion torque [N m]; None: not stated
    remarks : sentences on how the source was read
    """

    name: str
    speeds: FloatArray
    columns: tuple[SpeedColumn, ...]
    role: Role = "model"
    pinion_torque: float | None = None
    remarks: tuple[str, ...] = ()
