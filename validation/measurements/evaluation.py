"""A record evaluated in one go: aligned, laid over its prediction, friction identified.

Sources: see ``identification`` (Fuller 1987).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import xarray as xr

from lumped.arguments import some_of
from lumped.friction.registry import LAWS, file_name
from lumped.schema.files import AnyPair, load_gear_pair
from validation.measurements.alignment import Alignment, align
from validation.measurements.identification import Identification, NormalSource, identify_friction
from validation.measurements.overlay import overlay, overlay_metrics
from validation.measurements.prediction import Prediction, predict
from validation.measurements.record import Measurement

#: What may be identified besides a scale on a friction law.
CONSTANT = "mu"


@dataclass(frozen=True, eq=False)
class Evaluation:
    """A record beside its prediction.

    Attributes
    ----------
    measurement : the record
    prediction : at the record's speed and torque, with the pair's friction law
    alignment : mesh phase of the record
    points : measured and predicted over the phase, see ``overlay``
    metrics : their distance with intervals, see ``overlay_metrics``
    found : identified friction, in the order asked for
    """

    measurement: Measurement
    prediction: Prediction
    alignment: Alignment
    points: xr.Dataset
    metrics: xr.Dataset
    found: tuple[Identification, ...]


def evaluate(
    measurement: Measurement,
    pair: AnyPair,
    *,
    identify: Sequence[str] = (),
    normal: NormalSource = "measured",
    zero: bool = False,
    shift: float | None = None,
) -> Evaluation:
    """Align a record, compare it with its prediction, and identify friction from it.

    Parameters
    ----------
    measurement : the record
    pair : the gear pair; speed and torque are the record's, the friction law is the pair's
    identify : "mu" for a constant coefficient, or the name of a friction law for a scale on it
    normal, zero : see ``identify_friction``
    shift : known mesh phase, see ``align``

    Raises
    ------
    ParameterError : something unknown to identify, or channels that it needs are missing
    NumericalError : the record does not fit the prediction in any phase, or carries no friction
    """
    pair = load_gear_pair(pair)
    laws = [name for name in LAWS if name != "none"]
    advice = "Name mu, a constant coefficient, or a law to scale."
    wanted = some_of("identify", identify, [CONSTANT, *laws], advice, file_name)
    spec = measurement.spec
    prediction = predict(pair, spec.pinion_speed, spec.pinion_torque, recurrence=spec.recurrence)
    phase = align(measurement, prediction, shift=shift)
    return Evaluation(
        measurement=measurement,
        prediction=prediction,
        alignment=phase,
        points=overlay(measurement, prediction, phase),
        metrics=overlay_metrics(measurement, prediction, phase),
        found=tuple(
            identify_friction(measurement, prediction, phase, law=law, normal=normal, zero=zero)
            for law in (None if name == CONSTANT else name for name in wanted)
        ),
    )
