"""Every error of the prediction in one table: numerics, model form, inputs, measurement.

ASME V&V 20-2009 separates them. The numerical error and the agreement of two programs say whether the
equations are solved right. The rows on contact, supports and tooth stiffness say how much the form of the
model matters. The range of the inputs and the measurement say how far the model is from reality.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import xarray as xr

from lumped.errors import SpurcheckError
from lumped.labelling import labelled_dataset
from lumped.model.periodic_system import without_shafts
from lumped.model.results import a_pair_pulls
from lumped.outcomes import Absent, Outcome
from lumped.schema.pair import GearPair
from validation.prediction.motion import Motion, Prediction, measured, predicted

#: Errors of ``COLUMNS`` [m, 1, N].
Sizes = tuple[float, float, float]
#: Quantities of a row. The bars of the figure show the first.
COLUMNS = ("dte_peak_to_peak", "tooth_load", "bearing_rms")


class Compared(Protocol):
    """Comparison with a record, as the budget reads it.

    ``dte_error``: E of the peak to peak of the transmission error [m]; NaN: the record has no such channel.
    """

    @property
    def dte_error(self) -> float: ...
    @property
    def words(self) -> str: ...


class BudgetResults(Protocol):
    """Results that the budget reads. The shared results of the report are of this kind."""

    pair: GearPair

    @property
    def like(self) -> Prediction: ...
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


@dataclass(frozen=True)
class Row:
    """One error of the prediction.

    Attributes
    ----------
    key : name of the row
    name : words of the row
    kind : "numerics", "form", "inputs" or "measurement"
    sizes : error of each of ``COLUMNS`` [m, 1, N]; NaN: not known
    note : what the error is, or why the error is not known
    form : name of another form of the model that is as good as the prediction; empty: there is none
    result : transmission error in this form [m]
    """

    key: str
    name: str
    kind: str
    sizes: Sizes
    note: str
    form: str = ""
    result: float = np.nan


_UNKNOWN: Sizes = (np.nan, np.nan, np.nan)
#: Rows that compare the prediction with a poorer model.
_POORER = ("linear", "contact", "supports")


def error_budget(results: BudgetResults) -> xr.Dataset:
    """Return the error budget of a pair at its operating point.

    Returns
    -------
    xarray.Dataset over ``row``: ``dte`` [m], ``share`` of the prediction's peak to peak [%], ``tooth_force``
    [N] and ``bearing_force`` [N], NaN where a row is not known; ``result`` [m], the transmission error of
    another form of the model; attributes ``names``, ``kinds``, ``notes``, ``forms``, the names of other forms
    that are no poorer, and ``largest``, the key of the largest row that is an error of the prediction itself
    """
    prediction = results.like
    rows = list(_rows(results))
    sizes = np.array([row.sizes for row in rows])
    # In a mesh that does not vibrate no error has a share.
    dte, tooth_load, bearing_force = sizes.T
    share = 100.0 * dte / (prediction.peak_to_peak or np.nan)
    texts = ("transmission error, peak to peak", "largest tooth load", "bearing force, rms")
    columns = zip(
        ("dte", "tooth_force", "bearing_force"),
        (dte, tooth_load * prediction.mean_force, bearing_force),
        ("m", "N", "N"),
        texts,
        strict=True,
    )
    # The linear model and the other contact are poorer than the prediction: their rows are not its errors.
    own_errors = np.array(
        [np.nan if row.key in _POORER else size for row, size in zip(rows, share, strict=True)]
    )
    largest = rows[0 if np.isnan(own_errors).all() else int(np.nanargmax(own_errors))]
    return labelled_dataset(
        {
            "share": ("row", share, "%", "error, share of the transmission error's peak to peak"),
            **{name: ("row", values, unit, f"error, {text}") for name, values, unit, text in columns},
            "result": ("row", [row.result for row in rows], "m", f"{texts[0]}, of another form"),
        },
        {"row": ([row.key for row in rows], "1", "error")},
        {
            "names": [row.name for row in rows],
            "kinds": [row.kind for row in rows],
            "notes": [row.note for row in rows],
            "forms": [row.form for row in rows],
            "largest": largest.key,
            "largest_name": largest.name,
        },
    )


def _apart(one: Prediction, other: Prediction | Absent) -> Sizes:
    """Differences of ``COLUMNS`` between two motions; NaN where there is no other motion."""
    if isinstance(other, Absent):
        return _UNKNOWN
    first = one.numbers
    second = other.numbers
    return tuple(abs(first[name] - second[name]) for name in COLUMNS)  # type: ignore[return-value]


def _varied(results: BudgetResults, changes: dict[str, object] | str) -> Prediction | Absent:
    """Prediction of a changed pair. ``changes`` is a text: the reason why there is no such prediction."""
    if isinstance(changes, str):
        return Absent(Outcome.FAILED, changes)
    return _predicted(lambda pair: pair.with_(changes), results.pair)


def _predicted(vary: Callable[[GearPair], GearPair], pair: GearPair) -> Prediction | Absent:
    """Prediction of a varied pair. Absent: the variation is refused, or has no motion."""
    try:
        return predicted(vary(pair))
    except SpurcheckError as error:
        return Absent(Outcome.FAILED, str(error))


def _rows(results: BudgetResults) -> Iterator[Row]:
    """All errors, in the order of the table."""
    prediction = results.like
    pair = results.pair
    linear = results.linear
    samples = results.uncertainty
    share = np.nan
    same = results.same_equations
    poorer: Prediction | Absent = (
        linear if isinstance(linear, Absent) else measured(pair, linear, Motion.LINEAR)
    )
    for motion in (prediction.cycle, linear):  # an orbit has no steps
        if not isinstance(motion, Absent) and "error_estimate" in motion.attrs:
            share = float(motion.attrs["error_estimate"])  # of every quantity
            break
    sizes = share * prediction.peak_to_peak, share * prediction.tooth_load, share * prediction.bearing_rms
    yield Row(
        "numerics",
        "numerical error",
        "numerics",
        sizes,
        "estimated, by steps of another length" if np.isfinite(share) else _note(linear, ""),
    )
    size, note = (
        (np.nan, "the second program did not run") if same is None else (same * prediction.peak_to_peak, "")
    )
    yield Row("programs", "same equations in two programs", "numerics", (size, np.nan, np.nan), note)
    notes = [
        _linear_contact(pair, linear),
        *([] if pair.shafts is None else ["on springs, not on the shafts"]),
    ]
    if prediction.motion is Motion.LINEAR:
        notes[0] = "the prediction is this motion"
    note = _note(linear, "; ".join(notes))
    yield Row("linear", "linear model, for charts", "form", _apart(prediction, poorer), note)
    has_finite_elements = pair.mesh.stiffness.model == "finite_elements"
    stiffness: dict[str, object] | str = {"mesh.stiffness": {"model": "finite_elements"}}
    if has_finite_elements:
        stiffness = "the pair has it"
    contact, form = (
        ("prescribed", "contact prescribed from A to D")
        if pair.mesh.contact == "loaded"
        else ("loaded", "contact that follows the load")
    )
    other_contact: dict[str, object] | str = {"mesh.contact": contact}
    if pair.mesh.stiffness.whole_mesh:  # a curve that is used as given decides both
        stiffness = other_contact = "the stiffness of the whole mesh is given, with its contact"
    others: tuple[tuple[str, str, str, Prediction | Absent, str], ...] = (
        ("contact", "form of the contact", "two assumptions on where teeth touch",
         _varied(results, other_contact), form),
        ("second", "exact contact and finite motions", "by the multibody model", results.second,
         "second program"),
        ("supports", "springs in place of shafts", "without the modes of the shafts",
         Absent(Outcome.FAILED, "no shafts are given") if pair.shafts is None else
         _predicted(without_shafts, pair), ""),
        ("stiffness", "tooth stiffness by finite elements", "plane finite elements of the whole gears",
         _varied(results, stiffness),
         "tooth stiffness by finite elements"),
    )  # fmt: skip
    for key, name, note, other, form in others:
        result = np.nan if isinstance(other, Absent) else other.peak_to_peak
        yield Row(key, name, "form", _apart(prediction, other), _note(other, note), form, result)
    half = _UNKNOWN
    if isinstance(samples, xr.Dataset):
        ends = np.array([samples[f"{name}_percentile"].to_numpy()[[0, -1]] for name in COLUMNS])
        half = tuple(0.5 * np.ptp(ends, axis=1))
    note = "not computed" if isinstance(samples, Absent) else "half the range of the samples"
    yield Row("inputs", "inputs, 5 to 95 %", "inputs", half, note)
    record = results.measured_error
    size = np.nan
    note = "no measurement is given"
    if record is not None:
        size = abs(record.dte_error)
        note = record.words
    yield Row("measurement", "measurement", "measurement", (size, np.nan, np.nan), note)


def _linear_contact(pair: GearPair, linear: xr.Dataset | Absent) -> str:
    """Sentence on the difference between the contact of the linear motion and of the prediction."""
    if isinstance(linear, Absent) or a_pair_pulls(pair, linear):
        return "teeth pull in the linear motion"
    return "its contact and dampers are those of the mean load"


def _note(motion: object, text: str) -> str:
    """The reason why a motion is absent, else the text."""
    return (motion.detail or str(motion)) if isinstance(motion, Absent) else text
