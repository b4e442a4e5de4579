"""Error of the prediction against a measured record, beside the uncertainty of the comparison.

Source: ASME V&V 20-2009, eqs. 1-5-2 to 1-5-5: the error of the model lies within E +- 2 u_val.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from lumped.errors import refuse
from lumped.outcomes import Absent
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.measurements.comparison import mesh_cycles
from validation.measurements.record import Measurement

#: Most mesh orders of a record that its peak to peak takes in, most per different phase of its samples, and
#: how many phases of a mesh cycle are different.
_ORDERS, _PER_PHASE, _DIFFERENT = 40, 0.3, 1000
#: Speed and torque of the record may be this share off those of the pair.
_SAME = 0.01
_PHASES = np.arange(2048) / 2048.0


@dataclass(frozen=True)
class ModelError:
    """Comparison of the transmission error's peak to peak with a record, all in metres.

    Attributes
    ----------
    simulated, measured : S of the prediction, D of the record
    numerical, inputs, record : standard uncertainties of S by its numerics and its inputs, and of D
    """

    simulated: float
    measured: float
    numerical: float
    inputs: float
    record: float

    @property
    def error(self) -> float:
        """E = S - D."""
        return self.simulated - self.measured

    @property
    def uncertainty(self) -> float:
        """u_val, the root of the sum of the squares of the three uncertainties."""
        return float(np.sqrt(self.numerical**2 + self.inputs**2 + self.record**2))

    @property
    def explained(self) -> bool:
        """Whether E is within 2 u_val: then the comparison shows no error of the model."""
        return abs(self.error) <= 2.0 * self.uncertainty


def measured_peak_to_peak(measurement: Measurement, pair: GearPair) -> tuple[float, float]:
    """Return the peak to peak of a record's transmission error, and its standard uncertainty [m].

    Mesh orders are fitted to all samples of the channel ``dte``, which averages noise over the mesh cycles.
    The rest is noise of variance s^2; a fit of p numbers to n samples errs by s sqrt(p/n), the difference of
    two by sqrt(2) of it. Refused are records of another speed or torque than the pair's, and too few samples.
    """
    spec = measurement.spec
    channel = next((one for one in spec.channel if one.quantity == "dte"), None)
    if channel is None:
        kinds = ", ".join(sorted({one.quantity for one in spec.channel}))
        raise refuse("channel", kinds, "one of the quantity dte", "Add the measured transmission error.")
    own = pair.operating
    for name, there in (("pinion_speed", spec.pinion_speed), ("pinion_torque", spec.pinion_torque)):
        here = float(getattr(own, name))
        if abs(there / here - 1.0) > _SAME:
            action = "Give the speed and the torque of the record to the pair."
            raise refuse(f"measurement.{name}", f"{there:.5g}", f"{here:.5g} within 1 %, SI", action)
    cycles, values = mesh_cycles(measurement, pair), measurement.channels[channel.name]
    # Samples that are no whole number in a mesh cycle fill in its phases.
    phases = np.unique(np.floor(_DIFFERENT * np.mod(cycles, 1.0))).size
    most = int(min(_ORDERS, _PER_PHASE * phases))
    if most < 1 or values.size < 4 * (2 * most + 1):
        raise refuse("data", f"{values.size} samples", "several in each mesh cycle", "Sample faster.")
    columns = _waves(cycles, most)
    found, *_ = np.linalg.lstsq(columns, values, rcond=None)
    rest = values - columns @ found
    freedom = values.size - found.size
    deviation = np.sqrt(2.0 * found.size / values.size * float(rest @ rest) / freedom)
    return float(np.ptp(_waves(_PHASES, most) @ found)), float(deviation)


def model_error(
    measurement: Measurement,
    pair: GearPair,
    simulated: float,
    numerical: float,
    uncertainty: xr.Dataset | Absent,
) -> ModelError:
    """Compare a predicted peak to peak and its numerical error [m] with a record.

    ``uncertainty``: samples of the uncertain inputs, whose standard deviation is taken; absent: none are
    known.
    """
    measured, record = measured_peak_to_peak(measurement, pair)
    inputs = 0.0 if isinstance(uncertainty, Absent) else float(uncertainty["dte_peak_to_peak"].std(ddof=1))
    return ModelError(simulated, measured, numerical, inputs, record)


def _waves(cycles: FloatArray, orders: int) -> FloatArray:
    """Columns 1, cos, sin of the mesh orders at mesh cycles (k,)."""
    angle = 2.0 * np.pi * np.multiply.outer(cycles, np.arange(1, orders + 1))
    return np.hstack([np.ones((cycles.size, 1)), np.cos(angle), np.sin(angle)])
