"""Measured records beside predictions, and the friction identified from them."""

from validation.measurements.comparison import Prediction, predict
from validation.measurements.identification import Evaluation, Identification, evaluate
from validation.measurements.record import Measurement, MeasurementSpec, load_measurement

__all__ = [
    "Evaluation",
    "Identification",
    "Measurement",
    "MeasurementSpec",
    "Prediction",
    "evaluate",
    "load_measurement",
    "predict",
]
