"""Measurements beside predictions: import, alignment by mesh phase, overlay metrics, identification of mu."""

from validation.measurements.comparison import Alignment, align, overlay, overlay_metrics
from validation.measurements.identification import Evaluation, Identification, evaluate, identify_friction
from validation.measurements.prediction import Prediction, predict
from validation.measurements.record import Measurement, MeasurementSpec, load_measurement
from validation.measurements.synthetic import synthetic_measurement, write_measurement

__all__ = [
    "Alignment",
    "Evaluation",
    "Identification",
    "Measurement",
    "MeasurementSpec",
    "Prediction",
    "align",
    "evaluate",
    "identify_friction",
    "load_measurement",
    "overlay",
    "overlay_metrics",
    "predict",
    "synthetic_measurement",
    "write_measurement",
]
