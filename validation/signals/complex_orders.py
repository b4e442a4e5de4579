"""Complex amplitudes of a signal at orders, the shift in time between two sets of signals, and their misfit.

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

#: Samples whose waves are held at once.
_CHUNK = 20_000
#: Cycles from which on their scatter says how noise is correlated; fewer leave it white.
_FEWEST_CYCLES = 8
#: Phases of a cycle at which a waveform is read, and trial shifts in the period of the highest order.
_PHASES = 2048
_TRIALS = 16
#: Share of the static value below which an amplitude is no scale: the difference of two such amplitudes is
#: nothing that loads a tooth or a bearing.
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
        """The signal ``shift`` cycles later in its period; the covariance turns with it."""
        turn = np.exp(2j * np.pi * self.orders * shift)
        c, s = np.diag(turn.real), np.diag(turn.imag)
        turning = np.block([[c, -s], [s, c]])
        return replace(self, values=self.values * turn, covariance=turning @ self.covariance @ turning.T)

    def only(self, kept: BoolArray) -> ComplexOrders:
        """The signal of these orders (k,) alone."""
        both = np.concatenate([kept, kept])
        covariance = self.covariance[np.ix_(both, both)]
        return replace(self, orders=self.orders[kept], values=self.values[kept], covariance=covariance)

    def block(self, number: int) -> FloatArray:
        """(2, 2) covariance of the real and imaginary part of the order with this place in ``orders``."""
        at = [number, number + self.orders.size]
        return self.covariance[np.ix_(at, at)]

    def at(self, cycles: ArrayLike) -> FloatArray:
        """The signal about its mean at these cycles."""
        return np.asarray(_waves(np.asarray(cycles, dtype=float), self.orders) @ self._parts)

    @property
    def phases(self) -> FloatArray:
        """Cycles over a period at which ``at`` shows every extreme of the signal."""
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
        independent; default ``floor(cycles)``. Of 8 blocks or more the noise within one may be correlated in
        any way; of fewer it is taken as white

    Returns
    -------
    ComplexOrders

    Raises
    ------
    ParameterError : fewer than twice as many samples as numbers to fit, or samples that do not tell the
        orders apart
    """
    u, y, m = (np.asarray(one, dtype=np.float64) for one in (cycles, values, orders))
    count = 2 * m.size + 1
    if y.size < 2 * count:
        raise refuse("data", f"{y.size} samples", f"at least {2 * count}", "Sample faster, or longer.")
    parts = [slice(first, first + _CHUNK) for first in range(0, y.size, _CHUNK)]
    normal = np.zeros((count, count))
    moment = np.zeros(count)
    for part in parts:
        columns = _columns(u[part], m)
        normal += columns.T @ columns
        moment += columns.T @ y[part]
    if not np.linalg.cond(normal) < 1e10:
        action = "Sample faster, or at another rate than a whole number a cycle."
        raise refuse("data", f"samples at few phases for {m.size} orders", "more phases", action)
    inverse = np.linalg.inv(normal)
    found = inverse @ moment
    number = np.unique(np.floor(u) if blocks is None else blocks, return_inverse=True)[1]
    scores = np.zeros((int(number.max()) + 1, count))
    square = 0.0
    for part in parts:
        columns = _columns(u[part], m)
        rest = y[part] - columns @ found
        square += float(rest @ rest)
        np.add.at(scores, number[part], columns * rest[:, None])
    covariance = square / (y.size - count) * inverse
    if len(scores) >= _FEWEST_CYCLES:
        inner = scores.T @ scores * (len(scores) / (len(scores) - 1) * y.size / (y.size - count))
        covariance = inverse @ inner @ inverse
    real = found[1 : m.size + 1]
    imaginary = found[m.size + 1 :]
    spread = np.asarray(covariance[1:, 1:], dtype=np.float64)
    return ComplexOrders(m, real + 1j * imaginary, float(found[0]), spread, period)


def orders_of_period(values: ArrayLike, orders: int, period: int = 1) -> ComplexOrders:
    """Return the first complex orders of a signal at even times over ``period`` cycles, by Fourier's sums.

    The orders are 1, 2, ... over ``period``, at most ``orders`` and as many as the times show. They are
    exact up to aliasing, so their covariance is zero.
    """
    y = np.asarray(values, dtype=np.float64)
    found = np.fft.rfft(y) / y.size
    most = min(orders * period, (y.size - 1) // 2)
    number = np.arange(1, most + 1)
    return ComplexOrders(
        np.asarray(number / period, dtype=np.float64),
        2.0 * found[number],
        float(found[0].real),
        np.zeros((2 * most, 2 * most)),
        period,
    )


def channel_scale(one: float, other: float, static: float) -> float:
    """Return the amplitude that a channel's misfit is over: never zero.

    It is that of the first signal; of the second where the first is zero; at least a share ``LEAST`` of the
    static value (the static mesh force, or the mean deflection), so that rounding is no scale.
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

    The misfit falls as the correlation SUM Re(conj(U_m) V_m exp(2 pi i m s))/scale^2 over channels and orders
    rises; its largest value over all shifts of a period is taken, or over ``near`` (centre, reach).
    """
    pairs = list(zip(signals, others, scales, strict=True))
    order = np.concatenate([one.orders for one, _, _ in pairs])
    product = np.concatenate([one.values.conj() * other.values / scale**2 for one, other, scale in pairs])

    def less(shift: float) -> float:
        return -float((product @ np.exp(2j * np.pi * order * shift)).real)

    period = max(one.period for one, _, _ in pairs)
    step = 1.0 / (_TRIALS * max(float(order.max()), 1.0))
    centre, reach = near or (0.5 * period, 0.5 * period)
    trials = centre + step * np.arange(-np.ceil(reach / step), np.ceil(reach / step) + 1)
    best = float(trials[np.argmin([less(float(shift)) for shift in trials])])
    fine = minimize_scalar(less, bounds=(best - step, best + step), method="bounded", options={"xatol": 1e-9})
    shift = float(fine.x) if fine.fun <= less(best) else best
    return shift if near else float(np.mod(shift, period))


def misfit(
    signals: Sequence[ComplexOrders], others: Sequence[ComplexOrders], scales: Sequence[float]
) -> float:
    """Return the root of the mean over channels of SUM |U_m - V_m|^2/scale^2, for signals in phase.

    0 is the same motion; 1 is what no motion at all would give; the wrong sign gives 2. The means of the
    signals take no part: sensors of motion have no zero.
    """
    rows = zip(signals, others, scales, strict=True)
    squares = [(np.linalg.norm(one.values - other.values) / scale) ** 2 for one, other, scale in rows]
    return float(np.sqrt(np.mean(squares)))


def _waves(cycles: FloatArray, orders: FloatArray) -> FloatArray:
    """(n, 2k) factors of the real, then of the imaginary parts, in the signal at cycles."""
    angle = 2.0 * np.pi * np.multiply.outer(cycles, orders)
    return np.hstack([np.cos(angle), -np.sin(angle)])


def _columns(cycles: FloatArray, orders: FloatArray) -> FloatArray:
    return np.hstack([np.ones((cycles.size, 1)), _waves(cycles, orders)])
