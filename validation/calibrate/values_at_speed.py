"""Values over speed as data of a fit: peak to peak, rms or one order at each of the speeds of a sweep.

Such values have no phase, and no mesh cycles whose scatter shows the noise: the noise is stated, or assumed.

Sources: docs/how_to/calibrate.md, "What is compared".
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lumped.errors import ParameterError, SpurcheckError, refuse
from lumped.fields.units import to_stated
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.calibrate.data import LEFT_OVER, Loading, Unexplained
from validation.check.curves import SpeedColumn, ValuesOverSpeed
from validation.check.over_speed import statistic_of
from validation.check.quantities import QUANTITIES
from validation.check.record.channel import UNKNOWN, noise_factor
from validation.check.record.compare import mean_motion
from validation.files.formatting import quantity as printed
from validation.prediction.motion import Prediction, predicted
from validation.signals.fitted import Fitted

#: Standard uncertainty of a value by the numerics, and by the speed of the record, as a share of it.
_FLOOR = 5e-3
#: Noise of a value whose column states none, as a share of it.
NOISE = 0.02
#: Samples in a mesh cycle of a motion: a peak to peak is then right to 0.1 %, of 128 samples to 1 to 10 %.
SAMPLES = 1024
#: Most speeds: each costs a motion in every step of a fit.
MOST_SPEEDS = 60
#: Words of the statistics.
_WORDS = {"peak_to_peak": "peak to peak", "rms": "rms"}


@dataclass(frozen=True, eq=False)
class ValuesAtSpeed:
    """The values of a sweep at one of its speeds, as data of a fit.

    Attributes
    ----------
    name : name of the sweep
    words : name, speeds and torque of the whole sweep
    pair : the pair at this speed and at the torque of the sweep
    columns : columns of the sweep
    place : number of this speed in the columns
    """

    name: str
    words: str
    pair: GearPair
    columns: tuple[SpeedColumn, ...]
    place: int

    @property
    def quantities(self) -> frozenset[str]:
        """Quantities of the columns."""
        return frozenset(one.quantity for one in self.columns)

    @property
    def values(self) -> FloatArray:
        """(column,) values."""
        return np.array([one.values[self.place] for one in self.columns])

    @property
    def scales(self) -> FloatArray:
        """(column,) the values, of orders the largest one of their quantity at this speed.

        So a sweep through a resonance counts at each speed alike.
        """
        largest: dict[str, float] = {}
        for one, value in zip(self.columns, self.values, strict=True):
            if one.statistic == "order":
                largest[one.quantity] = max(largest.get(one.quantity, 0.0), float(value))
        return np.array(
            [
                largest[one.quantity] if one.statistic == "order" else value
                for one, value in zip(self.columns, self.values, strict=True)
            ]
        )

    @property
    def deviations(self) -> FloatArray:
        """(column,) standard deviations by noise and numerics."""
        noise = [
            NOISE * value if one.noise is None else one.noise
            for one, value in zip(self.columns, self.values, strict=True)
        ]
        return np.hypot(noise, _FLOOR * self.scales)

    @property
    def noise(self) -> FloatArray:
        """(column, column) covariance by noise and numerics."""
        return np.diag(self.deviations**2)

    @property
    def noise_shares(self) -> list[float]:
        """Standard deviations over the sizes."""
        return [float(one) for one in self.deviations / self.scales]

    @property
    def samples(self) -> int:
        """Samples in a mesh cycle: of a peak to peak more than of orders."""
        return SAMPLES

    @property
    def shifts(self) -> int:
        """None: values have no phase."""
        return 0

    @property
    def loadings(self) -> list[Loading]:
        """An error of each value; errors of one statistic are correlated over the speeds.

        Its variance is that of a part of an order, (A^2 + v^2)/2; of a peak to peak A = v.
        """
        sizes = np.sqrt(0.5 * (self.scales**2 + self.values**2))
        return [
            Loading((one.quantity, one.statistic, f"{one.order:g}"), (j,), np.array([[size]]))
            for j, (one, size) in enumerate(zip(self.columns, sizes, strict=True))
        ]

    def predicted(self, prediction: Prediction) -> tuple[FloatArray, FloatArray]:
        """Return the (column,) values of a prediction, and no slopes."""
        motion = mean_motion(prediction)
        values = np.array([statistic_of(one, motion) for one in self.columns])
        return values, np.zeros((values.size, 0))

    def fitted(self, fitted: FloatArray) -> Fitted:
        """Return the value of the first column beside the fitted one."""
        column = self.columns[0]
        kind = QUANTITIES[column.quantity]
        return Fitted(
            np.array([float(to_stated(self.pair.operating.pinion_speed, "rpm"))]),
            self.values[:1],
            self.deviations[:1],
            fitted[:1],
            f"{kind.words}, {self._statistic(column)}",
            kind.unit,
            "pinion speed [rpm]",
        )

    @staticmethod
    def _statistic(column: SpeedColumn) -> str:
        """Plain name of the values of a column."""
        return _WORDS.get(column.statistic, f"order {column.order:g}")

    def unexplained(self, fitted: FloatArray, count: int) -> Iterator[Unexplained]:
        """Values in which fitted ones (column,) miss the record by more than its noise."""
        at = f"{to_stated(self.pair.operating.pinion_speed, 'rpm'):.5g} rpm"
        limits = np.maximum(noise_factor(count) * self.deviations, LEFT_OVER * self.scales)
        rows = zip(self.columns, self.values, fitted, limits, self.scales, strict=True)
        for column, measured, ours, limit, scale in rows:
            if not abs(ours - measured) > limit:
                continue
            rest = float(abs(ours - measured) / scale)
            unit = QUANTITIES[column.quantity].unit
            sizes = [printed(float(one), unit, 3) for one in (measured, ours)]
            what = self._statistic(column)
            of = "of the largest order" if column.statistic == "order" else "of it"
            words = (
                f"{self.name}, {column.name}: {what} at {at} is {sizes[0]}, with the best inputs {sizes[1]}; "
                f"{100.0 * rest:.0f} % {of} is left over."
            )
            yield Unexplained(self.name, column.name, at, float(measured), float(ours), rest, words)


def values_at_speeds(pair: GearPair, sweep: ValuesOverSpeed) -> list[ValuesAtSpeed]:
    """Return the values of a sweep as data of a fit, one for each speed.

    Parameters
    ----------
    pair : the gear pair; speeds and torque of the sweep replace those of the pair

    Raises
    ------
    ParameterError : no column or no speed, too many speeds, a column of means or of tooth pairs, a value that
        is not above its noise, a speed at which the pair has no motion
    """
    if not sweep.columns or not sweep.speeds.size:
        raise refuse("record", "no values", "values at one or more speeds", "Name the columns of the values.")
    if sweep.speeds.size > MOST_SPEEDS:
        allowed = f"at most {MOST_SPEEDS}: each costs a motion in every step"
        raise refuse("record", f"{sweep.speeds.size} speeds", allowed, "Leave out every second row.")
    for column in sweep.columns:
        _check(column, sweep)
    torque = pair.operating.pinion_torque if sweep.pinion_torque is None else sweep.pinion_torque
    low, high = (float(to_stated(float(speed), "rpm")) for speed in sweep.speeds[[0, -1]])
    speeds = f"{sweep.speeds.size} speeds, {low:.5g} to {high:.5g} rpm" if low < high else f"{low:.5g} rpm"
    words = f"{sweep.name} ({speeds}, {torque:.4g} N m)"
    found = []
    for place, speed in enumerate(sweep.speeds):
        operating = {
            "operating.pinion_speed": f"{float(speed)!r} rad/s",
            "operating.pinion_torque": f"{float(torque)!r} N*m",
        }
        at = pair.with_(operating).healthy
        one = ValuesAtSpeed(sweep.name, words, at, sweep.columns, place)
        try:
            one.predicted(predicted(at, SAMPLES))
        except ParameterError:
            raise
        except SpurcheckError as error:
            action = f"Leave the row out. ({error})"
            refused = f"{to_stated(float(speed), 'rpm'):.5g} rpm"
            raise refuse("speed", refused, "speeds at which the pair has a motion", action) from None
        found.append(one)
    return found


def _check(column: SpeedColumn, sweep: ValuesOverSpeed) -> None:
    """Refuse a column that cannot be fitted."""
    where = f"column {column.name}"
    if QUANTITIES[column.quantity].of_tooth_pair:
        action = "Leave the column out."
        raise refuse(where, column.quantity, "quantities of the whole mesh", action)
    if column.statistic == "mean":
        action = "Leave the column out: encoders and accelerometers have no zero."
        raise refuse(where, "mean", "peak to peak, rms or an order", action)
    least = 0.0 if column.noise is None else column.noise / UNKNOWN
    if (small := np.flatnonzero(column.values <= least)).size:
        speed = to_stated(float(sweep.speeds[small[0]]), "rpm")
        allowed = f"> {least:.3g}, {1.0 / UNKNOWN:.0f} times the noise" if least else "> 0"
        refused = f"{column.values[small[0]]:.3g} at {speed:.5g} rpm"
        raise refuse(where, refused, allowed, "Leave the row out.")
