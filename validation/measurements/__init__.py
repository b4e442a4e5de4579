"""Measurements beside predictions: import, alignment by mesh phase, overlay metrics, identification of mu."""

from validation.measurements.alignment import Alignment, align, mesh_cycles
from validation.measurements.evaluation import Evaluation, evaluate
from validation.measurements.identification import Identification, identify_friction
from validation.measurements.overlay import overlay, overlay_metrics
from validation.measurements.prediction import Prediction, predict
from validation.measurements.record import Measurement, load_measurement
from validation.measurements.specification import MeasurementSpec
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
    "mesh_cycles",
    "overlay",
    "overlay_metrics",
    "predict",
    "synthetic_measurement",
    "write_measurement",
]
