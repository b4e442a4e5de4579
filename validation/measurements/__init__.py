"""The description of a measured record, and its samples."""

from validation.measurements.record import Measurement, MeasurementSpec, load_measurement

__all__ = ["Measurement", "MeasurementSpec", "load_measurement"]
