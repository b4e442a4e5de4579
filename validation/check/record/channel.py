"""One channel of a record beside the prediction: differences, their uncertainties, the verdict and its words.

In the terms of ASME V&V 20-2009, eqs. 1-5-2 to 1-5-5: D is a value of the record, S the same value of the
prediction, and E = S - D. u_val is the root of the sum of the squares of three standard uncertainties: by
the noise of the record, by the inputs and by the numerics. The error of the model lies within E +- 2 u_val.
Here D and S are the peak to peak of a channel, and each of its complex orders. Limits:
docs/how_to/measured_data.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import NamedTuple

import numpy as np

from lumped.typing import BoolArray, ComplexArray, FloatArray
from validation.files.formatting import quantity as printed
from validation.signals.complex_orders import ComplexOrders, misfit

#: A difference up to this share of the measured value is no contradiction, whatever its uncertainty is.
SHARE = 0.10
#: Where 2 u_val, or 2 u of the noise, exceeds this share of the measured value, the comparison judges
#: nothing: a prediction 27 % off whose inputs leave 40 % open is neither right nor wrong.
UNKNOWN = 0.25
#: Standard uncertainty that stands for inputs that were not varied, as a share of the measured value.
NOT_VARIED = UNKNOWN / 2.0
_AT_LEAST = UNKNOWN * (1.0 - 1e-9)
#: Probability that noise alone moves any of all orders beyond the limit of that order.
_CHANCE = 0.05


class Record(Enum):
    """What a record says about the prediction. The value is the sentence that a user reads."""

    CONFIRMS = "The record confirms the prediction."
    CONTRADICTS = "The record contradicts the prediction."
    TOO_UNCERTAIN = "The comparison is too uncertain to judge the prediction."

    @property
    def text(self) -> str:
        """The sentence that a user reads."""
        return self.value


@dataclass(frozen=True)
class PeakToPeak:
    """Peak to peak of one channel: D and S of ASME V&V 20, in the unit of the channel.

    Attributes
    ----------
    measured : D, of the record
    predicted : S, of the prediction, over the orders that the record shows
    record : standard uncertainty of D by the noise of the record
    inputs : standard uncertainty of S by the inputs; a share ``NOT_VARIED`` of D where they were not varied
    numerical : standard uncertainty of S by the numerics
    """

    measured: float
    predicted: float
    record: float
    inputs: float
    numerical: float

    @property
    def error(self) -> float:
        """E = S - D."""
        return self.predicted - self.measured

    @property
    def u_val(self) -> float:
        """Standard uncertainty of E: the root of the sum of the squares of the three uncertainties."""
        return math.hypot(self.record, self.inputs, self.numerical)

    @property
    def percent(self) -> float:
        """E over the measured value [%]."""
        return 100.0 * self.error / self.measured if self.measured else math.copysign(math.inf, self.error)


class OrdersOfChannel(NamedTuple):
    """Columns (order,) of one channel, in the unit of the channel. A deviation is a standard uncertainty.

    Attributes
    ----------
    order : mesh order
    measured, predicted : amplitudes
    measured_deviation : by the noise
    predicted_deviation : by inputs and numerics; NaN where the inputs were not varied
    phase_difference : phase of the prediction less phase of the record [rad]
    phase_deviation : standard uncertainty of the phase difference [rad]; NaN where the inputs were not varied
    contradicts : 1 where the difference contradicts the prediction, else 0
    """

    order: FloatArray
    measured: FloatArray
    measured_deviation: FloatArray
    predicted: FloatArray
    predicted_deviation: FloatArray
    phase_difference: FloatArray
    phase_deviation: FloatArray
    contradicts: FloatArray


class _Uncertainties(NamedTuple):
    """Standard uncertainties (order,): of the record by noise, of the prediction by inputs and numerics."""

    record: FloatArray
    prediction: FloatArray


@dataclass(frozen=True, eq=False)
class ChannelComparison:
    """One channel of a record beside the prediction.

    Attributes
    ----------
    name : name of the channel in the record
    quantity : result variable that the channel measures
    unit : SI unit of the quantity
    words : plain name of the quantity
    measured, predicted : complex orders, both in the phase of the record
    by_inputs : (order, 2, 2) covariance of the predicted real and imaginary parts by the uncertain inputs;
        isotropic, from ``NOT_VARIED``, where the inputs were not varied
    numerical : standard uncertainty of each predicted amplitude by the numerics, as a share of the amplitude
    scale : amplitude by which differences are divided, see ``channel_scale``
    peak_to_peak : measured and predicted peak to peak
    compared : number of compared orders of all channels of the record
    varied : whether the inputs were varied
    """

    name: str
    quantity: str
    unit: str
    words: str
    measured: ComplexOrders
    predicted: ComplexOrders
    by_inputs: FloatArray
    numerical: float
    scale: float
    peak_to_peak: PeakToPeak
    compared: int
    varied: bool

    @property
    def differences(self) -> ComplexArray:
        """(order,) E = S - D of each complex order."""
        return self.predicted.values - self.measured.values

    @property
    def explained(self) -> float:
        """Share of the measured motion that the prediction explains, 1 - misfit^2, at least 0."""
        return max(1.0 - misfit([self.measured], [self.predicted], [self.scale]) ** 2, 0.0)

    @property
    def worst(self) -> int:
        """Index of the order with the largest difference."""
        return int(np.abs(self.differences).argmax())

    @cached_property
    def reach(self) -> FloatArray:
        """(order,) largest difference that the uncertainties explain.

        The uncertainties are those along the difference, in the complex plane. Inputs and numerics count
        with 2 u, noise with sqrt(2 ln(orders/0.05)) u: in 5 of 100 records noise moves any order further.
        """
        u = self._along(self.differences)
        return np.sqrt((noise_factor(self.compared) * u.record) ** 2 + (2.0 * u.prediction) ** 2)

    @property
    def contradicted_orders(self) -> BoolArray:
        """(order,) whether the difference exceeds both ``reach`` and a share ``SHARE`` of the motion."""
        return self._apart & (np.abs(self.differences) > self.reach)

    @property
    def contradicts_size(self) -> bool:
        """Whether the peak to peak differs by more than 2 u_val and by more than ``SHARE``.

        False for a noisy channel: large noise raises the peak to peak by more than the standard uncertainty.
        """
        size = self.peak_to_peak
        return not self.noisy and abs(size.error) > max(2.0 * size.u_val, self._least)

    @property
    def noisy(self) -> bool:
        """Whether the noise exceeds the share ``UNKNOWN`` of the measured motion."""
        noise = math.sqrt(max(float(np.trace(self.measured.covariance)), 0.0))
        swing = 2.0 * self.peak_to_peak.record
        return noise > UNKNOWN * self.measured.size or swing > UNKNOWN * self.peak_to_peak.measured

    @property
    def verdict(self) -> Record:
        """Verdict of this channel alone."""
        if self.contradicts_size or self.contradicted_orders.any():
            return Record.CONTRADICTS
        size = self.peak_to_peak
        # Inputs that were not varied leave as much as UNKNOWN.
        vague = abs(size.error) > self._least and 2.0 * size.u_val >= _AT_LEAST * size.measured
        vague |= bool((self._apart & (self.reach >= _AT_LEAST * self.scale)).any())
        return Record.TOO_UNCERTAIN if self.noisy or vague else Record.CONFIRMS

    @property
    def _least(self) -> float:
        """Difference of the peaks to peak up to which there is no contradiction."""
        return SHARE * max(self.peak_to_peak.measured, self.scale)

    @property
    def _apart(self) -> BoolArray:
        """(order,) whether the difference exceeds the share ``SHARE`` of the motion."""
        return np.asarray(np.abs(self.differences) > SHARE * self.scale)

    def _along(self, directions: ComplexArray) -> _Uncertainties:
        """Standard uncertainties of each order along a direction (order,) in the complex plane."""
        unit = directions / np.where(np.abs(directions) > 0.0, np.abs(directions), 1.0)
        axes = np.stack([unit.real, unit.imag], axis=1)
        by_noise = np.array([self.measured.block(j) for j in range(unit.size)])
        noise, inputs = (
            np.einsum("mi,mij,mj->m", axes, covariance, axes) for covariance in (by_noise, self.by_inputs)
        )
        numerics = (self.numerical * self.predicted.amplitudes) ** 2
        return _Uncertainties(np.sqrt(np.maximum(noise, 0.0)), np.sqrt(np.maximum(inputs, 0.0) + numerics))

    def table(self) -> OrdersOfChannel:
        """Amplitudes and phase difference of each order, with standard uncertainties.

        The uncertainty of an amplitude is along the complex amplitude, the uncertainty of a phase across it.
        """
        measured = self.measured.values
        predicted = self.predicted.values
        # The radius of the uncertainty across the complex amplitude over the amplitude is an angle.
        measured_angle = self._along(1j * measured).record / np.maximum(np.abs(measured), 1e-300)
        predicted_angle = self._along(1j * predicted).prediction / np.maximum(np.abs(predicted), 1e-300)
        across = np.hypot(np.hypot(np.zeros(measured.size), measured_angle), predicted_angle)
        varied = 1.0 if self.varied else np.nan
        return OrdersOfChannel(
            order=self.measured.orders,
            measured=np.abs(measured),
            measured_deviation=self._along(measured).record,
            predicted=np.abs(predicted),
            predicted_deviation=self._along(predicted).prediction * varied,
            phase_difference=np.angle(predicted * measured.conj()),
            phase_deviation=np.minimum(across, math.pi) * varied,
            contradicts=self.contradicted_orders.astype(np.float64),
        )

    @property
    def label(self) -> str:
        """Name of the channel with the plain name of the quantity; the transmission error is named alone."""
        return "transmission error" if self.quantity == "dte" else f"{self.name} ({self.words})"

    @property
    def size_words(self) -> str:
        """Sentence on the measured and the predicted peak to peak and their difference."""
        size = self.peak_to_peak
        start = "" if self.quantity == "dte" else f"{self.label}: "
        measured = printed(size.measured, self.unit, 3)
        predicted = printed(size.predicted, self.unit, 3)
        accuracy = ""
        if self.varied and self.verdict is Record.TOO_UNCERTAIN and size.measured > 0.0:
            accuracy = f", known to ±{200.0 * size.u_val / size.measured:.0f} %"
        text = f"{start}measured {measured}, predicted {predicted}: {apart_words(size.percent)}{accuracy}."
        return text[0].upper() + text[1:] if not start else text

    @property
    def shape_words(self) -> str:
        """Sentence on the order that contradicts most; empty where a wrong size explains all differences."""
        measured = self.measured.values
        predicted = self.predicted.values
        size = float((predicted.conj() @ measured).real) / max(float(np.linalg.norm(predicted)) ** 2, 1e-300)
        rest = np.abs(max(size, 0.0) * predicted - measured) * self.contradicted_orders
        if self.contradicts_size and not (rest > SHARE * self.scale).any():
            return ""
        rest = rest if rest.any() else np.abs(self.differences) * self.contradicted_orders
        if not rest.any():
            return ""
        j = int(rest.argmax())
        order = f"Order {self.measured.orders[j]:g}"
        owner = "" if self.quantity == "dte" else f" of {self.label}"
        difference = abs(measured[j] - predicted[j])
        if abs(abs(measured[j]) - abs(predicted[j])) > 0.5 * difference:
            amplitude = printed(float(abs(measured[j])), self.unit, 2)
            expected = printed(float(abs(predicted[j])), self.unit, 2)
            return f"{order}{owner} is {amplitude}, predicted {expected}."
        degrees = math.degrees(float(np.angle(measured[j] * np.conj(predicted[j]))))
        if abs(degrees) > 150.0:
            return f"{order}{owner} has the opposite sign: {abs(degrees):.0f} degrees from the prediction."
        verb = "leads" if degrees > 0.0 else "lags"
        return f"{order}{owner} {verb} the prediction by {abs(degrees):.0f} degrees."


def noise_factor(compared: int) -> float:
    """Return the limit of noise in standard deviations for a number of compared orders.

    In 5 of 100 records noise moves any of the ``compared`` complex orders beyond this limit.
    """
    return math.sqrt(2.0 * math.log(compared / _CHANCE))


def apart_words(percent: float) -> str:
    """Return in words how far the predicted value is from the measured one: "27 % too low"."""
    if abs(percent) < 1.0:
        return "the same within 1 %"
    if percent > 900.0:
        return "more than 10 times the measured value"
    if percent > 200.0:
        return f"{percent / 100.0 + 1.0:.1f} times the measured value"
    digits = f"{abs(percent):.0f}" if abs(percent) >= 9.5 else f"{abs(percent):.1f}"
    return f"{digits} % too {'high' if percent > 0.0 else 'low'}"
