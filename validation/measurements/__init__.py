"""Measured records beside predictions, and the friction identified from them."""

from validation.measurements.channel_comparison import ChannelComparison, PeakToPeak, Record
from validation.measurements.comparing import compare_record
from validation.measurements.comparison import Prediction, predict
from validation.measurements.identification import Evaluation, Identification, evaluate
from validation.measurements.record import Measurement, MeasurementSpec, load_measurement
from validation.measurements.record_comparison import RecordComparison

__all__ = [
    "ChannelComparison",
    "Evaluation",
    "Identification",
    "Measurement",
    "MeasurementSpec",
    "PeakToPeak",
    "Prediction",
    "Record",
    "RecordComparison",
    "compare_record",
    "evaluate",
    "load_measurement",
    "predict",
]
