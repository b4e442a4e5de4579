"""Which test pays next: candidates ranked by the width that they would leave of the results of page 1.

A candidate is a run at one speed and torque with one or two channels. About each probable minimum the data
are linear, so the posterior after the candidate is known before the run: its covariance does not depend on
what will be measured. Minima that the candidate would tell apart count with the overlap of their data.

Source: Chaloner and Verdinelli, Statist. Sci. 10 (1995) 273.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from lumped.errors import SpurcheckError
from lumped.fields.units import to_stated
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.calibrate.discrepancy import (
    DEVIATION,
    discrepancy_covariance,
    noise_covariance,
)
from validation.calibrate.fit import SAMPLES, Fit, Motions, whitened
from validation.calibrate.forms import beside, level_score, machine, pair_of
from validation.calibrate.measured import ORDERS, Measured, MeasuredChannel
from validation.calibrate.mixture import Component
from validation.check.curves import Channel
from validation.check.record.compare import mean_motion
from validation.prediction.motion import predicted
from validation.prediction.uncertain_input import Input
from validation.signals.complex_orders import ComplexOrders

#: Results whose width counts.
RESULTS = ("dte_peak_to_peak", "dynamic_factor", "bearing_rms")
#: Candidates: speeds and torques over those of the pair, and channels.
_SPEEDS = (0.5, 1.0, 1.5, 2.0)
_TORQUES = (1.0, 0.5)
_CHANNELS = (("dte",), ("dte", "bearing_force_x_p"))
#: Minima that count.
_MINIMA = 3


class Calibrated(Protocol):
    """What of a posterior the candidates need: the attributes of ``Posterior``."""

    @property
    def prior(self) -> GearPair:
        """The pair before the records."""

    @property
    def inputs(self) -> tuple[Input, ...]:
        """The varied inputs."""

    @property
    def records(self) -> tuple[Measured, ...]:
        """The records."""

    @property
    def components(self) -> tuple[Component, ...]:
        """The mixture."""

    @property
    def discrepancy(self) -> bool:
        """Whether the model may be off."""


@dataclass(frozen=True)
class Candidate:
    """A test that may be run next.

    Attributes
    ----------
    speed_rpm, torque : operating point [rpm], [N m]
    channels : quantities that are recorded
    left : result -> standard deviation after the test over that before, 0 to 1
    """

    speed_rpm: float
    torque: float
    channels: tuple[str, ...]
    left: dict[str, float]

    @property
    def score(self) -> float:
        """Mean of the logarithms of what is left; the smallest is best."""
        return float(np.mean(np.log(np.maximum(list(self.left.values()), 1e-6))))

    @property
    def words(self) -> str:
        """What to record, and what the test would leave of the width of each result."""
        names = {"dte": "transmission error", "bearing_force_x_p": "force on the pinion bearing"}
        results = {
            "dte_peak_to_peak": "transmission error",
            "dynamic_factor": "dynamic factor",
            "bearing_rms": "bearing force",
        }
        what = " and ".join(names.get(one, one) for one in self.channels)
        left = ", ".join(f"{results[name]} {100.0 * share:.0f} %" for name, share in self.left.items())
        return f"{what} at {self.speed_rpm:.4g} rpm and {self.torque:.3g} N m leaves: {left}"


@dataclass(frozen=True, eq=False)
class _Local:
    """One minimum: results and data of all candidates with their slopes.

    Attributes
    ----------
    one : the most probable component of the minimum
    weight : probability of all components of the minimum
    level : their mean level of the discrepancy
    results, slopes : (result,) and (result, input) at the operating point
    """

    one: Component
    weight: float
    level: float
    results: FloatArray
    slopes: FloatArray


def next_tests(posterior: Calibrated) -> tuple[Candidate, ...]:
    """Return the candidates, the test that leaves least first.

    Parameters
    ----------
    posterior : result of ``calibrate``

    Returns
    -------
    candidates : speeds of half to twice the speed of the pair within its range, full and half torque, the
        transmission error alone or with the force on the pinion bearing; noise as in the records. The share
        that a test leaves is a standard deviation over all minima, with the discrepancy of the model
    """
    locals_ = [_local(posterior, group) for group in _minima(posterior.components)[:_MINIMA]]
    operating = posterior.prior.operating
    low, high = operating.speed_range or (0.0, np.inf)
    found = []
    for factor in _SPEEDS:
        speed = factor * operating.pinion_speed
        if not low <= speed <= high:
            continue
        for share in _TORQUES:
            torque = share * operating.pinion_torque
            for channels in _CHANNELS:
                left = _left(posterior, locals_, speed, torque, channels)
                if left is not None:
                    rpm = float(to_stated(speed, "rpm"))
                    found.append(Candidate(rpm, float(torque), channels, left))
    return tuple(sorted(found, key=lambda one: one.score))


def _minima(components: Sequence[Component]) -> list[list[Component]]:
    """Components of each minimum and form, the most probable minimum first."""
    groups: dict[tuple[object, int], list[Component]] = {}
    for one in components:
        groups.setdefault((one.form.mesh, id(one.minimum)), []).append(one)
    return sorted(groups.values(), key=lambda group: -sum(one.weight for one in group))


def _local(posterior: Calibrated, group: Sequence[Component]) -> _Local:
    """Results of page 1 at a minimum, and their slopes."""
    one = group[0]
    pair = pair_of(posterior.prior, one.form)

    def results(z: FloatArray) -> FloatArray:
        numbers = predicted(machine(pair, posterior.inputs, z)).numbers
        return np.array([numbers[name] for name in RESULTS])

    nominal = results(one.z)
    slopes = np.zeros((nominal.size, one.z.size))
    for j, of_input in enumerate(posterior.inputs):
        moved = one.z.copy()
        moved[j] = beside(of_input, one.z[j])
        step = level_score(of_input, moved[j]) - level_score(of_input, one.z[j])
        slopes[:, j] = (results(moved) - nominal) / step
    weight = sum(row.weight for row in group)
    level = sum(row.weight * row.level for row in group) / weight
    return _Local(one, weight, level, nominal, slopes)


def _left(
    posterior: Calibrated, minima: Sequence[_Local], speed: float, torque: float, channels: tuple[str, ...]
) -> dict[str, float] | None:
    """Share of the standard deviation of each result that a candidate leaves. None: no motion there."""
    before = np.zeros((len(minima), len(RESULTS)))
    after = np.zeros_like(before)
    data = []
    for row, local in enumerate(minima):
        pair = pair_of(posterior.prior, local.one.form)
        record = _record(posterior, machine(pair, posterior.inputs, local.one.z), speed, torque, channels)
        if record is None:
            return None
        both = [*posterior.records, record]
        count = sum(2 * one.orders.orders.size for one in record.channels)
        new = Fit(pair, posterior.inputs, [record], np.eye(count))
        motions = new.motions(local.one.z)
        if motions is None:
            return None
        covariance = noise_covariance(both) + local.level**2 * discrepancy_covariance(both)
        slopes = np.vstack([local.one.minimum.slopes, new.slopes(local.one.z, motions)])
        known = np.zeros(slopes.shape[0])
        shifts = np.zeros((slopes.shape[0], len(both)))
        old = slopes.shape[0] - count
        shifts[:old, : len(both) - 1] = local.one.minimum.motions.by_shift
        shifts[old:, -1] = motions.by_shift[:, 0]
        white = whitened(cholesky(covariance, lower=True), known, Motions(known, shifts), slopes)
        information = white.slopes.T @ white.slopes + np.eye(slopes.shape[1])
        spread = np.asarray(np.linalg.inv(information), dtype=np.float64)
        own = _own_errors(local, posterior.discrepancy)
        shown = _own_errors(local, posterior.discrepancy, shown="bearing_force_x_p" in channels)
        before[row] = _variance(local.slopes, local.one.covariance) + own
        after[row] = _variance(local.slopes, spread) + shown
        data.append((motions.values, covariance[old:, old:]))
    weights = np.array([one.weight for one in minima])
    weights = weights / weights.sum()
    results = np.array([one.results for one in minima])
    total_before = weights @ before
    total_after = weights @ after
    for i in range(len(minima)):
        for j in range(i):
            apart = weights[i] * weights[j] * (results[i] - results[j]) ** 2
            factor = cholesky(0.5 * (data[i][1] + data[j][1]), lower=True)
            distance = solve_triangular(factor, data[i][0] - data[j][0], lower=True)
            total_before = total_before + apart
            total_after = total_after + apart * np.exp(-0.125 * float(distance @ distance))
    share = np.sqrt(np.minimum(total_after / np.maximum(total_before, 1e-300), 1.0))
    return dict(zip(RESULTS, map(float, share), strict=True))


def _variance(slopes: FloatArray, covariance: FloatArray) -> FloatArray:
    """(result,) variance of the results by the inputs."""
    return np.asarray(np.einsum("ri,ij,rj->r", slopes, covariance, slopes))


def _own_errors(local: _Local, discrepancy: bool, *, shown: bool = False) -> FloatArray:
    """(result,) variance by the error of the model; ``shown``: the bearing force is among the channels."""
    if not discrepancy:
        return np.zeros(len(RESULTS))
    unknown = np.hypot(local.level, DEVIATION)
    sizes = np.array([local.results[0], local.results[1] - 1.0, local.results[2]])
    shares = np.array([local.level, unknown, local.level if shown else unknown])
    return np.asarray((shares * sizes) ** 2)


def _record(
    posterior: Calibrated, made: GearPair, speed: float, torque: float, channels: tuple[str, ...]
) -> Measured | None:
    """A record that is not there yet: the motion of a machine, with the noise of the records."""
    shares = [
        np.sqrt(float(np.trace(one.orders.covariance)) / (2.0 * one.orders.orders.size)) / one.scale
        for record in posterior.records
        for one in record.channels
    ]
    noise = float(np.median(shares))
    operating = {
        "operating.pinion_speed": f"{float(speed)!r} rad/s",
        "operating.pinion_torque": f"{float(torque)!r} N*m",
    }
    at = posterior.prior.with_(operating).healthy
    try:
        motion = mean_motion(predicted(made.with_(operating), SAMPLES))
    except SpurcheckError:
        return None
    measured = []
    for name in channels:
        orders = motion.orders(name, ORDERS)
        count = orders.orders.size
        scale = float(orders.amplitudes.max())
        covariance = (noise * scale) ** 2 * np.eye(2 * count)
        values = ComplexOrders(orders.orders, orders.values, orders.mean, covariance)
        measured.append(MeasuredChannel(Channel(name, name, np.zeros(8)), values, scale))
    return Measured("candidate", at, tuple(measured), None, None)
