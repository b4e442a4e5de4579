"""Minima of the misfit of one form of the model, from several starts.

The misfit is chi^2 = r^T C^-1 r + z^T z: data less prediction in their covariance C, and the normal scores of
the inputs. It has several minima of nearly equal depth along the stiffness of the mesh, so there are several
starts. One shift in time of each record is free.

Source: Levenberg and Marquardt, Nocedal and Wright, Numerical Optimization, 2006, section 10.3; Broyden's
update of slopes, section 11.1.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import block_diag, cholesky, solve_triangular
from scipy.special import ndtri
from scipy.stats import qmc

from lumped.errors import LawRangeWarning, SpurcheckError
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.calibrate.data import Data, few_speeds
from validation.calibrate.forms import LIMIT, beside, level_score, machine
from validation.prediction.motion import predicted
from validation.prediction.uncertain_input import Input

#: Starts of a form: the inputs as given, then Sobol points of the prior.
STARTS = 5
_SEED = 7
#: Most steps of a start, and the gain in chi^2 that a further step must promise.
_STEPS = 10
_ENOUGH = 0.5
#: Speeds of a sweep from which the search of minima starts.
_FEW = 5
#: Minima nearer to each other than this, in standard deviations of the posterior, are one.
_SAME = 1.0


@dataclass(frozen=True, eq=False)
class Motions:
    """Predicted data of all records.

    Attributes
    ----------
    values : (n,) data in the phase of each record
    by_shift : (n, shift) slopes by the shifts of the records
    """

    values: FloatArray
    by_shift: FloatArray


@dataclass(frozen=True, eq=False)
class Minimum:
    """A minimum of the misfit.

    Attributes
    ----------
    z : (input,) normal scores
    motions : predicted data at z
    slopes : (n, input) slopes of the data at z
    chi_squared : misfit at z, in the covariance of the fit
    """

    z: FloatArray
    motions: Motions
    slopes: FloatArray
    chi_squared: float


@dataclass(frozen=True, eq=False)
class Whitened:
    """Data in units of their standard deviations, without what the shifts of the records can do.

    Attributes
    ----------
    residuals : (n,) prediction less data
    slopes : (n, input)
    log_shifts : log determinant of the information on the shifts
    """

    residuals: FloatArray
    slopes: FloatArray
    log_shifts: float


def whitened(factor: FloatArray, data: FloatArray, motions: Motions, slopes: FloatArray) -> Whitened:
    """Return residuals and slopes in a covariance, less their parts along the shifts.

    ``factor``: lower Cholesky factor of the covariance.
    """
    columns = np.column_stack([motions.values - data, slopes, motions.by_shift])
    columns = solve_triangular(factor, columns, lower=True)
    shifts = columns[:, 1 + slopes.shape[1] :]
    basis, triangle = np.linalg.qr(shifts)
    rest = columns[:, : 1 + slopes.shape[1]]
    rest = rest - basis @ (basis.T @ rest)
    sizes = np.abs(np.diag(triangle))
    return Whitened(rest[:, 0], rest[:, 1:], 2.0 * float(np.log(np.maximum(sizes, 1e-300)).sum()))


@dataclass(eq=False)
class Fit:
    """The fit of one form of the model.

    Attributes
    ----------
    pair : the pair in this form
    inputs : inputs that are varied
    records : data
    factor : (n, n) lower Cholesky factor of the covariance of the data
    tell : called after each prediction
    """

    pair: GearPair
    inputs: Sequence[Input]
    records: Sequence[Data]
    factor: FloatArray
    tell: Callable[[], None] = lambda: None
    data: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        """Collect the data of all records."""
        self.data = np.concatenate([one.values for one in self.records])

    def with_few_speeds(self) -> Fit | None:
        """Return the fit to a few speeds of each long sweep, which costs less; None: no sweep is long."""
        kept = few_speeds(self.records, _FEW)
        if len(kept) == len(self.records):
            return None
        ends = np.cumsum([0, *(one.values.size for one in self.records)])
        rows = np.concatenate([np.arange(ends[j], ends[j + 1]) for j in kept])
        covariance = (self.factor @ self.factor.T)[np.ix_(rows, rows)]
        few = [self.records[j] for j in kept]
        return Fit(self.pair, self.inputs, few, cholesky(covariance, lower=True), self.tell)

    def motions(self, z: FloatArray) -> Motions | None:
        """Return the predicted data at normal scores (input,); None: no such machine, or no motion."""
        values = []
        shifts = []
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", LawRangeWarning)
                one = machine(self.pair, self.inputs, z)
                for record in self.records:
                    at = at_record(one, self.pair, record)
                    of_record, by_shift = record.predicted(predicted(at, record.samples))
                    values.append(of_record)
                    shifts.append(by_shift)
        except SpurcheckError:
            return None
        finally:
            self.tell()
        return Motions(np.concatenate(values), np.asarray(block_diag(*shifts)))

    def slopes(self, z: FloatArray, motions: Motions) -> FloatArray:
        """Return (n, input) slopes by one-sided differences; an input without a motion beside has slope 0."""
        columns = np.zeros((self.data.size, z.size))
        for j, one in enumerate(self.inputs):
            moved = z.copy()
            moved[j] = beside(one, z[j])
            if (other := self.motions(moved)) is not None:
                difference = other.values - motions.values
                columns[:, j] = difference / (level_score(one, moved[j]) - level_score(one, z[j]))
        return columns

    def chi_squared(self, z: FloatArray, motions: Motions) -> float:
        """Return the misfit of a prediction."""
        none = np.zeros((self.data.size, 0))
        rest = whitened(self.factor, self.data, motions, none).residuals
        return float(rest @ rest + z @ z)

    def minimum(self, start: FloatArray) -> Minimum | None:
        """Return the minimum that a start leads to; the slopes are those of the minimum. None: no motion."""
        z = start
        motions = self.motions(z)
        if motions is None:
            return None
        slopes = self.slopes(z, motions)
        misfit = self.chi_squared(z, motions)
        fresh = True
        damping = 0.0
        for _ in range(_STEPS):
            step, expected = self._step(z, motions, slopes, damping)
            if misfit - expected < _ENOUGH:
                if fresh:
                    break
                slopes, fresh = self.slopes(z, motions), True
                continue
            tried = np.clip(z + step, -LIMIT, LIMIT)
            other = self.motions(tried)
            lower = np.inf if other is None else self.chi_squared(tried, other)
            if other is None or lower > misfit - 1e-9:
                if fresh:
                    damping = max(4.0 * damping, 1.0)
                else:
                    slopes, fresh = self.slopes(z, motions), True
                continue
            moved = tried - z
            change = other.values - motions.values - slopes @ moved
            slopes = slopes + np.outer(change, moved) / max(float(moved @ moved), 1e-12)
            z, motions, misfit, fresh, damping = tried, other, lower, False, damping / 4.0
        if not fresh:
            slopes = self.slopes(z, motions)
        return Minimum(z, motions, slopes, misfit)

    def _step(
        self, z: FloatArray, motions: Motions, slopes: FloatArray, damping: float
    ) -> tuple[FloatArray, float]:
        """Step of Levenberg and Marquardt, and the misfit behind it where the data are linear."""
        white = whitened(self.factor, self.data, motions, slopes)
        information = white.slopes.T @ white.slopes + (1.0 + damping) * np.eye(z.size)
        step = -np.linalg.solve(information, white.slopes.T @ white.residuals + z)
        rest = white.residuals + white.slopes @ step
        return np.asarray(step, dtype=np.float64), float(rest @ rest + (z + step) @ (z + step))

    def different(self, found: Sequence[Minimum], one: Minimum) -> bool:
        """Return whether a minimum differs from those that were found."""
        white = whitened(self.factor, self.data, one.motions, one.slopes)
        information = white.slopes.T @ white.slopes + np.eye(one.z.size)
        return all(
            float((one.z - other.z) @ information @ (one.z - other.z)) > _SAME * one.z.size for other in found
        )


def at_record(one: GearPair, pair: GearPair, record: Data) -> GearPair:
    """Return a machine of a pair at the speed and torque of a record.

    A torque that is off by 2 % at the torque of the pair is off by 2 % at the torque of the record: it is the
    same transducer.
    """
    operating = record.pair.operating
    torque = operating.pinion_torque * (one.operating.pinion_torque / pair.operating.pinion_torque)
    changes: dict[str, str] = {}
    if operating.pinion_speed != one.operating.pinion_speed:
        changes["operating.pinion_speed"] = f"{float(operating.pinion_speed)!r} rad/s"
    if torque != one.operating.pinion_torque:
        changes["operating.pinion_torque"] = f"{float(torque)!r} N*m"
    return one.with_(changes) if changes else one


def starts(inputs: int, count: int = STARTS) -> FloatArray:
    """Return (count, inputs) starts: the inputs as given, then Sobol points of the prior."""
    points = qmc.Sobol(max(inputs, 1), rng=np.random.default_rng(_SEED)).random(count - 1)
    scores = ndtri(np.clip(points[:, :inputs], 0.02, 0.98))
    return np.vstack([np.zeros((1, inputs)), scores])
