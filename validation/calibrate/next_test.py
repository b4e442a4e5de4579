"""Which test pays next: candidates ranked by the width that they would leave of the results of page 1.

A candidate is a run at one speed and torque, or a sweep: runs at several speeds. Some of the machines that
the records leave take the place of the truth in turn. The records and the candidate are calibrated as if they
were the motion of this machine, with the slopes at the machine in the place of a search. The variance that is
left has all levels of the discrepancy and the forms that are not told apart. Its logarithm is averaged over
the truths.

Source: Chaloner and Verdinelli, Statist. Sci. 10 (1995) 273, section 2: the expected loss of an experiment.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy.linalg import block_diag, cholesky

from lumped.errors import SpurcheckError
from lumped.fields.units import to_stated
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.calibrate.data import Data
from validation.calibrate.discrepancy import (
    discrepancy_covariance,
    noise_covariance,
    shown_results,
    variance_of_error,
)
from validation.calibrate.fit import Fit, Minimum, Motions, at_record
from validation.calibrate.forms import Form, beside, level_score, machine, pair_of
from validation.calibrate.machines import Machines
from validation.calibrate.measured import ORDERS, SAMPLES, Measured, MeasuredChannel
from validation.calibrate.mixture import Component, by_levels, component, mixture
from validation.check.curves import Channel
from validation.check.record.compare import mean_motion
from validation.prediction.motion import predicted
from validation.prediction.uncertain_input import Input
from validation.signals.complex_orders import ComplexOrders

#: Results whose width counts.
RESULTS = ("dte_peak_to_peak", "dynamic_factor", "bearing_rms")
#: Candidates: speeds and torques over those of the pair, and channels. The longest list has all channels.
_SPEEDS = (0.5, 1.0, 1.5, 2.0)
_TORQUES = (1.0, 0.5)
_CHANNELS = (("dte",), ("dte", "bearing_force_x_p", "bearing_force_y_p"))
#: Machines that take the place of the truth.
_TRUTHS = 5


class Calibrated(Protocol):
    """What of a posterior the candidates need: the attributes of ``Posterior``."""

    @property
    def prior(self) -> GearPair:
        """The pair before the records."""

    @property
    def inputs(self) -> tuple[Input, ...]:
        """The varied inputs."""

    @property
    def records(self) -> tuple[Data, ...]:
        """The records."""

    @property
    def components(self) -> tuple[Component, ...]:
        """The mixture."""

    @property
    def machines(self) -> Machines:
        """The possible machines that the records leave."""

    @property
    def discrepancy(self) -> bool:
        """Whether the model may be off."""


@dataclass(frozen=True)
class Candidate:
    """A test that may be run next.

    Attributes
    ----------
    speeds_rpm : pinion speeds of its runs [rpm]; one, or those of a sweep
    torque : pinion torque [N m]
    channels : quantities that are recorded
    left : result -> standard deviation after the test over that before, 0 to 1
    """

    speeds_rpm: tuple[float, ...]
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
        results = {
            "dte_peak_to_peak": "transmission error",
            "dynamic_factor": "dynamic factor",
            "bearing_rms": "bearing force",
        }
        forces = " and both forces on the pinion bearing" if len(self.channels) > 1 else ""
        left = ", ".join(f"{results[name]} {100.0 * share:.0f} %" for name, share in self.left.items())
        *first, last = (f"{speed:.4g}" for speed in self.speeds_rpm)
        speeds = f"{', '.join(first)} and {last}" if first else last
        return f"transmission error{forces} at {speeds} rpm and {self.torque:.3g} N m leaves: {left}"


@dataclass(frozen=True, eq=False)
class _Truth:
    """A machine in the place of the truth.

    Attributes
    ----------
    form, z : the machine
    by_records : data of the records, as a minimum of their fit
    results, slopes : (result,) and (result, input) at the operating point
    """

    form: Form
    z: FloatArray
    by_records: Minimum
    results: FloatArray
    slopes: FloatArray


@dataclass(frozen=True, eq=False)
class _Run:
    """A run that is not there yet.

    Attributes
    ----------
    speed : pinion speed [rad/s]
    record : motion of the best machine, with the noise of the records
    minima : data at each truth, and their slopes
    """

    speed: float
    record: Measured
    minima: tuple[Minimum, ...]

    def only(self, channels: int) -> _Run:
        """Return the run with its first channels alone."""
        record = replace(self.record, channels=self.record.channels[:channels])
        return replace(
            self, record=record, minima=tuple(_rows(one, record.values.size) for one in self.minima)
        )


def next_tests(posterior: Calibrated) -> tuple[Candidate, ...]:
    """Return the candidates, the test that leaves least first.

    Parameters
    ----------
    posterior : result of ``calibrate``

    Returns
    -------
    candidates : speeds of half to twice the speed of the pair within its range, each alone and all as a
        sweep, full and half torque, the transmission error alone or with both forces on the pinion bearing;
        noise as in the records. The share that a test leaves is an expected standard deviation over that of
        page 1, with the discrepancy of the model
    """
    truths = _truths(posterior)
    before = page_one_deviations(posterior)
    operating = posterior.prior.operating
    low, high = operating.speed_range or (0.0, np.inf)
    speeds = [factor * operating.pinion_speed for factor in _SPEEDS]
    found: list[Candidate] = []
    for share in _TORQUES:
        torque = share * operating.pinion_torque
        runs = [_run(posterior, truths, speed, torque) for speed in speeds if low <= speed <= high]
        computed = [one for one in runs if one is not None]
        tests = [[one] for one in computed] + ([computed] if len(computed) > 1 else [])
        for test in tests:
            for channels in _CHANNELS:
                parts = [one.only(len(channels)) for one in test]
                minima = [_joined(truth.by_records, parts, j) for j, truth in enumerate(truths)]
                records = [*posterior.records, *(one.record for one in parts)]
                after = _deviations_after(posterior, truths, minima, records)
                left = np.minimum(after / np.maximum(before, 1e-300), 1.0)
                found.append(
                    Candidate(
                        tuple(float(to_stated(one.speed, "rpm")) for one in test), float(torque), channels,
                        dict(zip(RESULTS, map(float, left), strict=True)),
                    )
                )  # fmt: skip
    return tuple(sorted(found, key=lambda one: one.score))


def recommendation(candidates: Sequence[Candidate]) -> tuple[str, ...]:
    """Return sentences: the run that leaves least, and the sweep that leaves least."""
    runs = [one for one in candidates if len(one.speeds_rpm) == 1]
    sweeps = [one for one in candidates if len(one.speeds_rpm) > 1]
    found = [f"Next test: {one.words}." for one in runs[:1]]
    return (*found, *(f"Or a sweep: {one.words}." for one in sweeps[:1]))


def _truths(posterior: Calibrated) -> list[_Truth]:
    """Machines in the place of the truth: evenly spaced in the order of their first result."""
    machines = posterior.machines
    sizes = [one[RESULTS[0]] for one in machines.numbers[1:]]
    places = 1 + np.argsort(sizes, kind="stable")
    count = min(_TRUTHS, places.size)
    chosen = places[((np.arange(count) + 0.5) * places.size / count).astype(int)]
    return [_truth(posterior, int(j)) for j in chosen]


def _truth(posterior: Calibrated, number: int) -> _Truth:
    """A machine with the data of the records and the results of page 1, and their slopes."""
    form, z = posterior.machines.components[number].form, posterior.machines.z[number]
    pair = pair_of(posterior.prior, form)
    by_records = _about(Fit(pair, posterior.inputs, posterior.records, np.eye(0)), z)
    assert by_records is not None  # the machines of a posterior have motions at all records
    results = np.array([posterior.machines.numbers[number][name] for name in RESULTS])
    slopes = np.zeros((results.size, z.size))
    for j, one in enumerate(posterior.inputs):
        moved = z.copy()
        moved[j] = beside(one, z[j])
        step = level_score(one, moved[j]) - level_score(one, z[j])
        try:
            numbers = predicted(machine(pair, posterior.inputs, moved)).numbers
        except SpurcheckError:  # no motion there: no slope, as in the fit
            continue
        slopes[:, j] = (np.array([numbers[name] for name in RESULTS]) - results) / step
    return _Truth(form, z, by_records, results, slopes)


def _about(fit: Fit, z: FloatArray) -> Minimum | None:
    """Data at a machine and their slopes, as a minimum of the fit. None: no motion."""
    motions = fit.motions(z)
    return None if motions is None else Minimum(z, motions, fit.slopes(z, motions), np.nan)


def _run(posterior: Calibrated, truths: Sequence[_Truth], speed: float, torque: float) -> _Run | None:
    """Return the run of one operating point; None where a machine has no motion there."""
    record = _record(posterior, speed, torque)
    if record is None:
        return None
    minima = []
    for truth in truths:
        pair = pair_of(posterior.prior, truth.form)
        new = _about(Fit(pair, posterior.inputs, [record], np.eye(0)), truth.z)
        if new is None:
            return None
        minima.append(new)
    return _Run(speed, record, tuple(minima))


def _joined(old: Minimum, runs: Sequence[_Run], truth: int) -> Minimum:
    """Data of the records, then of the runs, at a truth; each run has a shift of its own."""
    parts = [old, *(one.minima[truth] for one in runs)]
    shifts = np.asarray(block_diag(*(one.motions.by_shift for one in parts)))
    values = np.concatenate([one.motions.values for one in parts])
    return Minimum(old.z, Motions(values, shifts), np.vstack([one.slopes for one in parts]), np.nan)


def page_one_deviations(posterior: Calibrated) -> FloatArray:
    """(result,) standard deviation of page 1 over the machines, with the error of the model."""
    machines = posterior.machines
    results = np.array([[one[name] for name in RESULTS] for one in machines.numbers[1:]])
    variance = results.var(axis=0)
    if posterior.discrepancy:
        for level, share in _levels(posterior).items():
            errors = [_errors(row, level, machines.shown) for row in results]
            variance = variance + share * np.mean(errors, axis=0)
    return np.asarray(np.sqrt(variance))


def _levels(posterior: Calibrated) -> dict[float, float]:
    """Level of the discrepancy -> its probability."""
    levels: dict[float, float] = {}
    for one in posterior.components:
        levels[one.level] = levels.get(one.level, 0.0) + one.weight
    return levels


def _deviations_after(
    posterior: Calibrated, truths: Sequence[_Truth], minima: Sequence[Minimum], records: Sequence[Data]
) -> FloatArray:
    """(result,) expected standard deviation of the results with the runs of a candidate as the last records.

    The geometric mean over the truths: near a resonance one machine may leave ten times as much as another.
    """
    levels = _levels(posterior)
    noise, of_model = noise_covariance(records), discrepancy_covariance(records)
    size = noise.shape[0]
    factors = {level: cholesky(noise + level**2 * of_model, lower=True) for level in levels}
    shown = shown_results(records)
    variances = []
    for truth, place in zip(truths, minima, strict=True):
        data = place.motions.values
        found = [
            one
            for level, prior in levels.items()
            for one in _explanations(truth, truths, minima, level, prior, factors[level], data)
        ]
        variances.append(_variance(mixture(by_levels(found, levels, size)), truths, minima, posterior, shown))
    return np.asarray(np.exp(0.5 * np.mean(np.log(np.maximum(variances, 1e-300)), axis=0)))


def _rows(one: Minimum, count: int) -> Minimum:
    """The first data of a minimum: fewer channels of the candidate."""
    motions = Motions(one.motions.values[:count], one.motions.by_shift[:count])
    return Minimum(one.z, motions, one.slopes[:count], np.nan)


def _explanations(
    truth: _Truth,
    truths: Sequence[_Truth],
    minima: Sequence[Minimum],
    level: float,
    prior: float,
    factor: FloatArray,
    data: FloatArray,
) -> list[Component]:
    """What explains the motion of a truth: its own minimum, and the best one of every other form."""
    best: dict[Form, Component] = {}
    for other, minimum in zip(truths, minima, strict=True):
        if other.form == truth.form and other is not truth:
            continue
        one = component(other.form, minimum, level, other.form.prior * prior, factor, data)
        if other.form not in best or one.weight > best[other.form].weight:
            best[other.form] = one
    return list(best.values())


def _variance(
    components: Sequence[Component],
    truths: Sequence[_Truth],
    minima: Sequence[Minimum],
    posterior: Calibrated,
    shown: Collection[str],
) -> FloatArray:
    """(result,) variance of the results in a mixture, with the error of the model."""
    weights, means, inside = [], [], []
    for one in components:
        truth = next(of for of, place in zip(truths, minima, strict=True) if place is one.minimum)
        mean = truth.results + truth.slopes @ (one.z - truth.z)
        spread = np.einsum("ri,ij,rj->r", truth.slopes, one.covariance, truth.slopes)
        weights.append(one.weight)
        means.append(mean)
        inside.append(spread + (_errors(mean, one.level, shown) if posterior.discrepancy else 0.0))
    share = np.array(weights)
    apart = np.array(means) - share @ np.array(means)
    return np.asarray(share @ (np.array(inside) + apart**2))


def _errors(results: FloatArray, level: float, shown: Collection[str]) -> FloatArray:
    """(result,) variance by the error of the model, which acts on the dynamic factor less 1."""
    sizes = results - np.array([name == "dynamic_factor" for name in RESULTS])
    variances = [variance_of_error(level, name in shown) for name in RESULTS]
    return np.asarray(np.array(variances) * sizes**2)


def _record(posterior: Calibrated, speed: float, torque: float) -> Measured | None:
    """A record that is not there yet: the motion of the best machine, with the noise of the records.

    None: no motion. It has all channels of the candidates.
    """
    noise = float(np.median([share for record in posterior.records for share in record.noise_shares]))
    operating = {
        "operating.pinion_speed": f"{float(speed)!r} rad/s",
        "operating.pinion_torque": f"{float(torque)!r} N*m",
    }
    machines = posterior.machines
    at = posterior.prior.with_(operating).healthy
    empty = Measured("candidate", at, (), None, None)
    try:
        best = machine(pair_of(posterior.prior, machines.components[0].form), posterior.inputs, machines.z[0])
        motion = mean_motion(predicted(at_record(best, posterior.prior, empty), SAMPLES))
    except SpurcheckError:
        return None
    measured = []
    for name in _CHANNELS[-1]:
        orders = motion.orders(name, ORDERS)
        count = orders.orders.size
        scale = float(orders.amplitudes.max())
        if scale <= 0.0:  # without friction nothing moves off the line of action
            continue
        covariance = (noise * scale) ** 2 * np.eye(2 * count)
        values = ComplexOrders(orders.orders, orders.values, orders.mean, covariance)
        measured.append(MeasuredChannel(Channel(name, name, np.zeros(8)), values, scale))
    return replace(empty, channels=tuple(measured))
