"""Every error of the prediction in one table: numerics, model form, inputs, measurement.

ASME V&V 20-2009 separates them. The numerical error and the agreement of two programs say whether the
equations are solved right. The rows on contact, supports and tooth stiffness say how much the form of the
model matters. The range of the inputs and the measurement say how far the model is from reality.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import xarray as xr

from lumped.errors import SpurcheckError
from lumped.labelling import labelled_dataset
from lumped.outcomes import Absent
from lumped.schema.pair import GearPair
from validation.prediction.motion import Prediction, predicted

#: Quantities that a row tells: the first is the one of the bars.
COLUMNS = ("dte_peak_to_peak", "tooth_load", "bearing_rms")


class Compared(Protocol):
    """What the budget reads of a comparison with a record."""

    @property
    def error(self) -> float: ...
    @property
    def uncertainty(self) -> float: ...


class Known(Protocol):
    """What the budget reads; the report's shared results have it all."""

    pair: GearPair

    @property
    def prediction(self) -> Prediction: ...
    @property
    def linear(self) -> xr.Dataset | Absent: ...
    @property
    def second(self) -> Prediction | Absent: ...
    @property
    def same_equations(self) -> float | None: ...
    @property
    def uncertainty(self) -> xr.Dataset | Absent: ...
    @property
    def measured_error(self) -> Compared | None: ...
    @property
    def finite_elements(self) -> bool: ...


@dataclass(frozen=True)
class Row:
    """One error of the prediction: its sizes of ``COLUMNS`` [m, 1, N], NaN where they are not known.

    ``kind`` is "numerics", "form", "inputs" or "measurement"; ``note`` what it is, or why it is not known.
    """

    key: str
    name: str
    kind: str
    sizes: tuple[float, float, float]
    note: str


_UNKNOWN = (np.nan, np.nan, np.nan)
#: Rows that compare the prediction with a poorer model.
_POORER = ("linear", "contact", "supports")


def error_budget(known: Known) -> xr.Dataset:
    """Return the error budget of a pair at its operating point.

    Returns
    -------
    xarray.Dataset over ``row``: ``dte`` [m], ``share`` of the prediction's peak to peak [%], ``tooth_force``
    [N] and ``bearing_force`` [N], NaN where a row is not known; attributes ``names``, ``kinds``, ``notes``
    and ``largest``, the key of the largest row that is an error of the prediction itself
    """
    prediction = known.prediction
    rows = [make(known) for make in _ROWS]
    sizes = np.array([row.sizes for row in rows])
    share = 100.0 * sizes[:, 0] / prediction.peak_to_peak
    texts = ("transmission error, peak to peak", "largest tooth load", "bearing force, rms")
    columns = zip(
        ("dte", "tooth_force", "bearing_force"),
        (sizes[:, 0], sizes[:, 1] * prediction.static_force, sizes[:, 2]),
        ("m", "N", "N"),
        texts,
        strict=True,
    )
    # The linear model and the other contact are poorer than the prediction: no errors of it.
    own = np.array([np.nan if row.key in _POORER else size for row, size in zip(rows, share, strict=True)])
    largest = rows[int(np.nanargmax(own))]
    return labelled_dataset(
        {
            "share": ("row", share, "%", "error, share of the transmission error's peak to peak"),
            **{name: ("row", values, unit, f"error, {text}") for name, values, unit, text in columns},
        },
        {"row": ([row.key for row in rows], "1", "error")},
        {
            "names": [row.name for row in rows],
            "kinds": [row.kind for row in rows],
            "notes": [row.note for row in rows],
            "largest": largest.key,
            "largest_name": largest.name,
        },
    )


def _apart(one: Prediction, other: Prediction) -> tuple[float, float, float]:
    first, second = one.numbers, other.numbers
    return tuple(abs(first[name] - second[name]) for name in COLUMNS)  # type: ignore[return-value]


def _numerics(known: Known) -> Row:
    """Estimated error of the integration, of every quantity in the same share."""
    name, motion = "numerical error", known.prediction
    linear = known.linear
    if isinstance(linear, Absent):
        return Row("numerics", name, "numerics", _UNKNOWN, str(linear))
    error = float(linear.attrs["error_estimate"])
    sizes = (error * motion.peak_to_peak, error * motion.tooth_load, error * motion.bearing_rms)
    return Row("numerics", name, "numerics", sizes, "estimated, by steps of half the length")


def _programs(known: Known) -> Row:
    """Largest difference of the same equations in two programs."""
    name, error = "same equations in two programs", known.same_equations
    if error is None:
        return Row("programs", name, "numerics", _UNKNOWN, "the second program did not run")
    return Row("programs", name, "numerics", (error * known.prediction.peak_to_peak, np.nan, np.nan), "")


def _linear(known: Known) -> Row:
    """The linear motion, which stability and charts rest on, against the prediction."""
    name, linear = "linear model, for charts", known.linear
    if isinstance(linear, Absent):
        return Row("linear", name, "form", _UNKNOWN, str(linear))
    from validation.prediction.motion import Motion, measured

    sizes = _apart(known.prediction, measured(known.pair, linear, Motion.LINEAR))
    note = {Motion.LINEAR: "the prediction is this motion", Motion.SHAFTS: "on springs, not on the shafts"}
    return Row(
        "linear", name, "form", sizes, note.get(known.prediction.motion, "teeth pull in the linear motion")
    )


def _variation(
    key: str, name: str, note: str, changes: Callable[[GearPair], dict[str, object] | str]
) -> Callable[[Known], Row]:
    """A row that predicts a variation of the pair; a text says why there is none."""

    def make(known: Known) -> Row:
        varied = changes(known.pair)
        if isinstance(varied, str):
            return Row(key, name, "form", _UNKNOWN, varied)
        try:
            other = predicted(known.pair.with_(varied))
        except SpurcheckError as error:
            return Row(key, name, "form", _UNKNOWN, str(error))
        return Row(key, name, "form", _apart(known.prediction, other), note)

    return make


def _other_contact(pair: GearPair) -> dict[str, object] | str:
    return {"mesh.contact": "prescribed" if pair.mesh.contact == "loaded" else "loaded"}


def _springs(pair: GearPair) -> dict[str, object] | str:
    return {"shafts": None} if pair.shafts is not None else "no shafts are given"


def _elastic(known: Known) -> Row:
    name = "tooth stiffness by finite elements"
    if known.pair.mesh.stiffness.model == "finite_elements":
        return Row("stiffness", name, "form", _UNKNOWN, "the pair has it")
    if not known.finite_elements:
        return Row("stiffness", name, "form", _UNKNOWN, "left out of a quick report")
    return _variation("stiffness", name, "plane finite elements of the whole gears", _fe)(known)


def _fe(pair: GearPair) -> dict[str, object] | str:
    return {"mesh.stiffness": {"model": "finite_elements"}}


def _second(known: Known) -> Row:
    name, second = "exact contact and finite motions", known.second
    if isinstance(second, Absent):
        return Row("second", name, "form", _UNKNOWN, str(second))
    return Row("second", name, "form", _apart(known.prediction, second), "by the multibody model")


def _inputs(known: Known) -> Row:
    """Half the range from 5 to 95 % of the samples."""
    name, found = "inputs, 5 to 95 %", known.uncertainty
    if isinstance(found, Absent):
        return Row("inputs", name, "inputs", _UNKNOWN, "not computed")
    half = [0.5 * float(np.ptp(found[f"{q}_percentile"].to_numpy()[[0, -1]])) for q in COLUMNS]
    return Row("inputs", name, "inputs", (half[0], half[1], half[2]), "half the range of the samples")


def _measurement(known: Known) -> Row:
    name, found = "measurement", known.measured_error
    if found is None:
        return Row("measurement", name, "measurement", _UNKNOWN, "no measurement is given")
    note = f"prediction less record; known to ±{2e6 * found.uncertainty:.2g} µm"
    return Row("measurement", name, "measurement", (abs(found.error), np.nan, np.nan), note)


_ROWS: tuple[Callable[[Known], Row], ...] = (
    _numerics,
    _programs,
    _linear,
    _variation(
        "contact", "form of the contact", "prescribed from A to D, or following the load", _other_contact
    ),
    _second,
    _variation("supports", "springs in place of shafts", "without the modes of the shafts", _springs),
    _elastic,
    _inputs,
    _measurement,
)
