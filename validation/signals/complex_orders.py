"""Complex amplitudes of a signal at orders; time shift and misfit between two sets of signals.

A signal over u, in cycles, is written as mean + SUM Re(V_m exp(2 pi i m u)), m the order. |V_m| is an
amplitude, peak. The same signal s cycles later in its period has V_m exp(2 pi i m s).

Sources: least squares with a variance that holds for correlated noise, Liang and Zeger, Biometrika 73 (1986)
13-22, the clusters being the cycles of the record; docs/how_to/measured_data.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar

from lumped.errors import refuse
from lumped.typing import BoolArray, ComplexArray, FloatArray, IntArray

#: Number of samples whose waves are in memory at the same time.
_CHUNK = 20_000
#: From this number of cycles on, the scatter between cycles gives the correlation of the noise. With fewer
#: cycles the noise is assumed to be white.
_FEWEST_CYCLES = 8
#: Phases of a cycle at which a waveform is read, and trial shifts in the period of the highest order.
_PHASES = 2048
_TRIALS = 16
#: Least scale of a misfit over the static value. A smaller amplitude does not load a tooth or a bearing.
LEAST = 1e-3


@dataclass(frozen=True, eq=False)
class ComplexOrders:
    """Complex amplitudes of one signal.

    Attributes
    ----------
    orders : (k,) above 0, whole numbers over ``period``
    values : (k,) complex amplitudes V_m, peak, in the unit of the signal
    mean : of the signal
    covariance : (2k, 2k) of the real parts, then the imaginary parts; zero where the signal has no noise
    period : cycles after which the signal repeats
    """

    orders: FloatArray
    values: ComplexArray
    mean: float
    covariance: FloatArray
    period: int = 1

    @property
    def amplitudes(self) -> FloatArray:
        """(k,) |V_m|."""
        return np.abs(self.values)

    @property
    def size(self) -> float:
        """Amplitude of the whole motion about its mean, the root of SUM |V_m|^2."""
        return float(np.linalg.norm(self.values))

    def shifted(self, shift: float) -> ComplexOrders:
        """Return the signal ``shift`` cycles later in its period, with the covariance of the new parts."""
        turn = np.exp(2j * np.pi * self.orders * shift)
        if not self.covariance.any():
            return replace(self, values=self.values * turn)
        cosines = np.diag(turn.real)
        sines = np.diag(turn.imag)
        turning = np.block([[cosines, -sines], [sines, cosines]])
        return replace(self, values=self.values * turn, covariance=turning @ self.covariance @ turning.T)

    def only(self, selected: BoolArray) -> ComplexOrders:
        """Return the signal with the selected orders alone; ``selected`` (k,) is a mask."""
        selected_parts = np.concatenate([selected, selected])
        covariance = self.covariance[np.ix_(selected_parts, selected_parts)]
        return replace(
            self, orders=self.orders[selected], values=self.values[selected], covariance=covariance
        )

    def block(self, number: int) -> FloatArray:
        """Return the covariance (2, 2) of the real and imaginary part of ``orders[number]``."""
        parts = [number, number + self.orders.size]
        return self.covariance[np.ix_(parts, parts)]

    def at(self, cycles: ArrayLike) -> FloatArray:
        """Return the signal without its mean, at places in cycles."""
        return np.asarray(_waves(np.asarray(cycles, dtype=float), self.orders) @ self._parts)

    @property
    def phases(self) -> FloatArray:
        """Places [cycles] over a period, dense enough to show every extreme of the signal."""
        return np.arange(_PHASES * self.period) / _PHASES

    @property
    def peak_to_peak(self) -> float:
        """Largest less smallest value of the signal."""
        return float(np.ptp(self.at(self.phases)))

    @property
    def peak_to_peak_deviation(self) -> float:
        """Standard deviation of ``peak_to_peak`` by the covariance, to first order."""
        if not self.orders.size:
            return 0.0
        curve = self.at(self.phases)
        ends = self.phases[[int(curve.argmax()), int(curve.argmin())]]
        high, low = _waves(ends, self.orders)
        return float(np.sqrt(max((high - low) @ self.covariance @ (high - low), 0.0)))

    @property
    def _parts(self) -> FloatArray:
        return np.concatenate([self.values.real, self.values.imag])


def complex_orders(
    cycles: ArrayLike,
    values: ArrayLike,
    orders: ArrayLike,
    *,
    period: int = 1,
    blocks: IntArray | None = None,
) -> ComplexOrders:
    """Fit mean and complex orders to samples at any times by least squares.

    Parameters
    ----------
    cycles : (n,) places of the samples [cycles], at any distances
    values : (n,) samples
    orders : (k,) to fit, above 0
    period : cycles after which a signal of these orders repeats
    blocks : (n,) number of the cycle, or of the engagement, of each sample, between which noise is
        independent; default ``floor(cycles)``. With 8 blocks or more, noise within a block may be correlated
        in any way. With fewer blocks the noise is assumed to be white

    Returns
    -------
    ComplexOrders

    Raises
    ------
    ParameterError : fewer than twice as many samples as numbers to fit, or samples that do not tell the
        orders apart
    """
    u, y, m = (np.asarray(array, dtype=np.float64) for array in (cycles, values, orders))
    count = 2 * m.size + 1
    if y.size < 2 * count:
        raise refuse("data", f"{y.size} samples", f"at least {2 * count}", "Sample faster, or longer.")
    chunks = [slice(first, first + _CHUNK) for first in range(0, y.size, _CHUNK)]
    normal = np.zeros((count, count))
    moment = np.zeros(count)
    for chunk in chunks:
        columns = _columns(u[chunk], m)
        normal += columns.T @ columns
        moment += columns.T @ y[chunk]
    if not np.linalg.cond(normal) < 1e10:
        action = "Sample faster, or at another rate than a whole number a cycle."
        raise refuse("data", f"samples at few phases for {m.size} orders", "more phases", action)
    inverse = np.linalg.inv(normal)
    coefficients = inverse @ moment
    number = np.unique(np.floor(u) if blocks is None else blocks, return_inverse=True)[1]
    scores = np.zeros((int(number.max()) + 1, count))
    sum_of_squares = 0.0
    for chunk in chunks:
        columns = _columns(u[chunk], m)
        residuals = y[chunk] - columns @ coefficients
        sum_of_squares += float(residuals @ residuals)
        np.add.at(scores, number[chunk], columns * residuals[:, None])
    covariance = sum_of_squares / (y.size - count) * inverse
    if len(scores) >= _FEWEST_CYCLES:
        cluster_sum = scores.T @ scores * (len(scores) / (len(scores) - 1) * y.size / (y.size - count))
        covariance = inverse @ cluster_sum @ inverse
    real = coefficients[1 : m.size + 1]
    imaginary = coefficients[m.size + 1 :]
    covariance_of_orders = np.asarray(covariance[1:, 1:], dtype=np.float64)
    return ComplexOrders(m, real + 1j * imaginary, float(coefficients[0]), covariance_of_orders, period)


def orders_of_period(values: ArrayLike, orders: int, period: int = 1) -> ComplexOrders:
    """Return the first complex orders of a signal, by Fourier's sums.

    The samples are at even times over ``period`` cycles. The orders are 1, 2, ... over ``period``, up to
    ``orders`` or up to half the number of samples. The amplitudes are exact but for aliasing, so that the
    covariance is zero.
    """
    y = np.asarray(values, dtype=np.float64)
    spectrum = np.fft.rfft(y) / y.size
    most = min(orders * period, (y.size - 1) // 2)
    number = np.arange(1, most + 1)
    return ComplexOrders(
        np.asarray(number / period, dtype=np.float64),
        2.0 * spectrum[number],
        float(spectrum[0].real),
        np.zeros((2 * most, 2 * most)),
        period,
    )


def channel_scale(one: float, other: float, static: float) -> float:
    """Return the amplitude by which the misfit of a channel is divided. The amplitude is never zero.

    The scale is the amplitude of the first signal, ``one``. If the first signal is too small, the scale is
    the amplitude of the second signal, ``other``. If both are too small, the scale is the share ``LEAST`` of
    the static value (static mesh force or mean deflection).
    """
    least = LEAST * static
    return next((size for size in (one, other) if size > least), least)


def common_shift(
    signals: Sequence[ComplexOrders],
    others: Sequence[ComplexOrders],
    scales: Sequence[float],
    *,
    near: tuple[float, float] | None = None,
) -> float:
    """Return the one shift [cycles] of all ``others`` with which the misfit to ``signals`` is smallest.

    The misfit is smallest where the correlation SUM Re(conj(U_m) V_m exp(2 pi i m s))/scale^2 over channels
    and orders is largest. All shifts of a period are searched, or with ``near`` = (centre, reach) the shifts
    from centre - reach to centre + reach.
    """
    pairs = list(zip(signals, others, scales, strict=True))
    order = np.concatenate([one.orders for one, _, _ in pairs])
    product = np.concatenate([one.values.conj() * other.values / scale**2 for one, other, scale in pairs])

    def less(shift: float) -> float:
        return -float((product @ np.exp(2j * np.pi * order * shift)).real)

    period = max(one.period for one, _, _ in pairs)
    if near is None:
        trials, step = _trials_of_period(order, product, period)
        best = float(trials[np.argmin([less(float(shift)) for shift in trials])])
    else:
        step = 1.0 / (_TRIALS * max(float(order.max()), 1.0))
        centre, reach = near
        trials = centre + step * np.arange(-np.ceil(reach / step), np.ceil(reach / step) + 1)
        best = float(trials[np.argmin([less(float(shift)) for shift in trials])])
    fine = minimize_scalar(less, bounds=(best - step, best + step), method="bounded", options={"xatol": 1e-9})
    shift = float(fine.x) if fine.fun <= less(best) else best
    return shift if near else float(np.mod(shift, period))


def _trials_of_period(order: FloatArray, product: ComplexArray, period: int) -> tuple[FloatArray, float]:
    """Return the best trial shifts of a whole period, and the distance of two trials.

    The correlation at all trials at once is a Fourier sum, because every order is a whole number over the
    period.
    """
    number = np.round(order * period).astype(np.int64)
    count = int(2 ** np.ceil(np.log2(_TRIALS * max(int(number.max()), 1))))
    amplitudes = np.zeros(count // 2 + 1, dtype=complex)
    np.add.at(amplitudes, number, product)
    correlation = np.fft.irfft(amplitudes, count)
    step = period / count
    # Rounding of the sum could swap trials that are equally good.
    best = np.flatnonzero(correlation >= correlation.max() - 1e-9 * np.abs(correlation).max())
    return np.asarray(step * best, dtype=np.float64), step


def misfit(
    signals: Sequence[ComplexOrders], others: Sequence[ComplexOrders], scales: Sequence[float]
) -> float:
    """Return the root of the mean over channels of SUM |U_m - V_m|^2/scale^2, for signals in phase.

    The misfit is 0 for equal motions, 1 if the second motion is zero, and 2 if the second motion has the
    wrong sign. Means of the signals are not compared, because sensors of motion have no zero.
    """
    rows = zip(signals, others, scales, strict=True)
    squares = [(np.linalg.norm(one.values - other.values) / scale) ** 2 for one, other, scale in rows]
    return float(np.sqrt(np.mean(squares)))


def _waves(cycles: FloatArray, orders: FloatArray) -> FloatArray:
    """Return the waves (n, 2k) that multiply the real parts, then the imaginary parts, of the amplitudes."""
    angle = 2.0 * np.pi * np.multiply.outer(cycles, orders)
    return np.hstack([np.cos(angle), -np.sin(angle)])


def _columns(cycles: FloatArray, orders: FloatArray) -> FloatArray:
    return np.hstack([np.ones((cycles.size, 1)), _waves(cycles, orders)])
