"""A matrix of which values at some times of one period are known: A(t), K(t) or C(t) as a table.

Between the times the matrix is constant, linear or a cubic spline. The result is a `PeriodicMatrix`: error
bounds are proven for the matrix so defined. How far that matrix is from the one that was sampled no program
can know; `MatrixTable.coarser`, the table of every second row, shows what the distance of the rows does.

Sources: docs/theory/floquet.md, "A matrix as a table".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline

from floquet.engine.coefficients import PeriodicMatrix, PiecewisePolynomial
from lumped.arguments import one_of, real_array, real_number
from lumped.errors import refuse, shown
from lumped.typing import BoolArray, FloatArray

_SAME_ENTRY = 1e-6  # part of the largest value of an entry by which first and last row may differ
_SAME_TIME = 1e-9  # part of the period by which the last time may miss the end of the period
_WIDEST_END = 1.5  # longest interval after the last row, in longest intervals between rows
_LEAST_OF_SPLINE = 5  # rows, of which the last one is the first one again


class Rows(NamedTuple):
    """Times and matrices over one whole period.

    Attributes
    ----------
    times : (P+1,) from the first time to the same time one period later [s]; twice the same time: a jump
    matrices : (P+1, n, n) at these times; the last one equals the first one
    """

    times: FloatArray
    matrices: FloatArray


class ChangingEntries(NamedTuple):
    """Entries of a matrix that change in time; entries that are equal, or equal but for the sign, are one.

    Attributes
    ----------
    values : (r, P+1) values of each at the times
    patterns : (r, n, n) of -1, 0 and 1: where each stands in the matrix
    """

    values: FloatArray
    patterns: FloatArray


@dataclass(frozen=True, eq=False)
class MatrixTable:
    """A periodic matrix that is a polynomial between the times of a table.

    Attributes
    ----------
    rows : the table over one whole period
    between : "steps", "linear" or "cubic": what the matrix is between two times
    """

    rows: Rows
    between: str

    @property
    def period(self) -> float:
        """T [s]."""
        return float(self.rows.times[-1] - self.rows.times[0])

    def matrix(self, period: float | None = None, variation: float = 1.0) -> PeriodicMatrix:
        """Return the matrix with another period [s], and a factor on what differs from its mean."""
        rows = self.rows
        new_period = period or self.period
        stretched = rows.times * (new_period / self.period)
        widths = np.diff(rows.times)
        pieces = np.flatnonzero(widths > 0.0)
        ends = np.append(stretched[:-1][pieces], stretched[0] + new_period)
        entries = changing_entries(rows.matrices)
        coefficients = _COEFFICIENTS[self.between](rows.times, entries.values)[:, pieces]
        means = _means(coefficients, widths[pieces] / self.period)
        constant = rows.matrices[0] * ~changes(rows.matrices)
        constant = constant + (1.0 - variation) * np.tensordot(means, entries.patterns, axes=1)
        powers = np.diff(ends)[:, None] ** np.arange(coefficients.shape[2])
        functions = (PiecewisePolynomial(ends, one / powers) for one in coefficients)
        return PeriodicMatrix(constant, *zip(functions, variation * entries.patterns, strict=True))

    def coarser(self) -> MatrixTable | None:
        """Return the table of every second row; None where that leaves no table, or with steps.

        Both rows of a jump, the first row and the last row stay.
        """
        times = self.rows.times
        jump = np.diff(times) == 0.0
        chosen = np.arange(times.size) % 2 == 0
        chosen |= np.append(jump, False) | np.append(False, jump)
        chosen[-1] = True
        least = _LEAST_OF_SPLINE if self.between == "cubic" else 3
        if self.between == "steps" or chosen.all() or chosen.sum() < least:
            return None
        return MatrixTable(Rows(times[chosen], self.rows.matrices[chosen]), self.between)


def sampled_matrix(
    times: npt.ArrayLike, matrices: npt.ArrayLike, *, period: float | None = None, between: str = "linear"
) -> PeriodicMatrix:
    """Return the periodic matrix of a table: for `PeriodicSystem`, or as C or K of `from_second_order`.

    The error bounds of its multipliers are proven for the matrix that is so defined between the times.

    Parameters
    ----------
    times : (m,) increasing, over one period [s]. A time that stands twice is a jump: the matrix before it,
        then the matrix after it; with ``between`` "linear" alone
    matrices : (m, n, n) at these times
    period : T [s]. None: the last time is the end of the period, and the last matrix equals the first one
    between : "linear"; "cubic", a periodic spline with continuous second derivative; "steps", each matrix
        holds until the next time

    Raises
    ------
    ParameterError
        Times that do not increase, another number of matrices, a last matrix at the end of the period that is
        not the first one, a period that the times exceed or do not fill, a spline with a jump.
    """
    return matrix_table(times, matrices, period=period, between=between).matrix()


def matrix_table(
    times: npt.ArrayLike,
    matrices: npt.ArrayLike,
    *,
    period: float | None = None,
    between: str = "linear",
    field_of_times: str = "times",
    field_of_matrices: str = "matrices",
) -> MatrixTable:
    """Check a table, see `sampled_matrix`; ``field_of_...``: the names of times and matrices in a refusal."""
    one_of("between", between, _COEFFICIENTS)
    known_times = _checked_times(field_of_times, times, between)
    values = real_array(field_of_matrices, matrices)
    count = known_times.size
    if values.ndim != 3 or len(values) != count or values.shape[1] != values.shape[2] or not values.size:
        wanted = f"({count}, n, n): one square matrix for each of {count} times"
        turned = values.ndim == 3 and values.shape[2] == count and values.shape[0] == values.shape[1]
        advice = "Put the times first: numpy.moveaxis(matrices, -1, 0)." if turned else "Check the shape."
        raise refuse(field_of_matrices, f"shape {values.shape}", wanted, advice)
    rows = Rows(known_times, values)
    if period is None:
        return MatrixTable(_closed(rows, field_of_matrices), between)
    T = real_number("period", period, 0.0, above=True, unit="s", action="Give the length of one cycle.")
    return MatrixTable(_continued(rows, T, field_of_times, field_of_matrices), between)


def _checked_times(field: str, times: npt.ArrayLike, between: str) -> FloatArray:
    """Times (m,) that do not fall, no three of them equal; two equal ones with "linear" alone."""
    known = np.ravel(real_array(field, times))
    steps = np.diff(known)
    fall = np.flatnonzero(steps < 0.0)
    if fall.size:
        value = f"{known[fall[0] + 1]:g} s after {known[fall[0]]:g} s"
        raise refuse(field, value, "times that increase", "Sort the rows by time.")
    repeated = np.flatnonzero(steps == 0.0)
    if repeated.size and between != "linear":
        value = f"{known[repeated[0]]:g} s twice"
        advice = 'A jump: use between = "linear". A repeated row: remove it.'
        raise refuse(field, value, f'times that differ, for between = "{between}"', advice)
    if (np.diff(repeated) == 1).any():
        value = f"{known[repeated[0]]:g} s three times"
        raise refuse(field, value, "no time more than twice", "Leave the rows before and after the jump.")
    least = _LEAST_OF_SPLINE if between == "cubic" else 2
    if known.size < least:
        raise refuse(field, f"{known.size} times", f"at least {least} times", "Give more rows.")
    return known


def _closed(rows: Rows, field: str) -> Rows:
    """Rows whose last one is the first one of the next period; refuse other rows."""
    first, last = rows.matrices[0], rows.matrices[-1]
    sizes = np.abs(rows.matrices)
    allowed = _SAME_ENTRY * sizes.max(axis=0) + 1e-12 * sizes.max()
    other = np.argwhere(np.abs(last - first) > allowed)
    if other.size:
        i, j = other[0]
        value = f"entry ({i + 1}, {j + 1}) {first[i, j]:g} in the first row, {last[i, j]:g} in the last row"
        wanted = (
            f"equal first and last rows, at {rows.times[0]:g} s and one period later, {rows.times[-1]:g} s"
        )
        action = (
            "Name the period where the last row is not its end; add the first matrix as a last row where the "
            "matrix jumps there."
        )
        raise refuse(field, value, wanted, action)
    return Rows(rows.times, np.concatenate([rows.matrices[:-1], first[None]]))


def _continued(rows: Rows, period: float, field_of_times: str, field_of_matrices: str) -> Rows:
    """Rows from the first time to one period later; refuse times that contradict the period."""
    times = rows.times
    span = float(times[-1] - times[0])
    end = float(times[0]) + period
    if span > period * (1.0 + _SAME_TIME):
        wanted = f"at least {span:g} s, from the first to the last of the {field_of_times}"
        raise refuse("period", f"{period:g} s", wanted, "Correct the period, or give the rows of one period.")
    if span >= period * (1.0 - _SAME_TIME):
        ends = np.where(times == times[-1], end, times)
        return _closed(Rows(ends, rows.matrices), field_of_matrices)
    longest = float(np.diff(times).max())
    if period - span > _WIDEST_END * longest * (1.0 + _SAME_TIME):
        wanted = (
            f"times up to the end of the period, {end:g} s, or at most {_WIDEST_END:g} intervals before it"
        )
        action = "Correct the period, or add rows; or add the first matrix as a last row at the end."
        raise refuse(field_of_times, f"{shown(f'up to {times[-1]:g} s')}", wanted, action)
    return Rows(np.append(times, end), np.concatenate([rows.matrices, rows.matrices[:1]]))


def changes(matrices: FloatArray) -> BoolArray:
    """Which entries (n, n) of matrices (k, n, n) are not the same number in all of them."""
    return np.asarray((matrices != matrices[0]).any(axis=0))


def changing_entries(matrices: FloatArray) -> ChangingEntries:
    """Return the entries of matrices (k, n, n) that change.

    A matrix that is symmetric at all times has symmetric patterns, so that symmetry stays exact.
    """
    n = matrices.shape[1]
    patterns: dict[bytes, FloatArray] = {}
    values: list[FloatArray] = []
    for i, j in np.argwhere(changes(matrices)):
        entry = matrices[:, i, j] + 0.0  # -0 becomes 0
        sign = 1.0 if entry[np.flatnonzero(entry)[0]] > 0.0 else -1.0
        key = (sign * entry + 0.0).tobytes()
        if key not in patterns:
            patterns[key] = np.zeros((n, n))
            values.append(sign * entry)
        patterns[key][i, j] = sign
    count = len(values)
    return ChangingEntries(
        np.array(values).reshape(count, len(matrices)), np.array([*patterns.values()]).reshape(count, n, n)
    )


def _steps(times: FloatArray, values: FloatArray) -> FloatArray:
    """Constants (r, P, 1): each value holds until the next time."""
    del times
    return values[:, :-1, None]


def _lines(times: FloatArray, values: FloatArray) -> FloatArray:
    """Straight lines (r, P, 2) between values (r, P+1)."""
    del times
    return np.stack([values[:, :-1], np.diff(values, axis=1)], axis=2)


def _spline(times: FloatArray, values: FloatArray) -> FloatArray:
    """Cubic polynomials (r, P, 4) of the periodic spline through values (r, P+1)."""
    widths = np.diff(times)[:, None] ** np.arange(4)
    splines = [CubicSpline(times, one, bc_type="periodic").c[::-1].T * widths for one in values]
    return np.array(splines).reshape(len(values), times.size - 1, 4)


def _means(coefficients: FloatArray, shares: FloatArray) -> FloatArray:
    """Means (r,) over the period of polynomials (r, P, d+1); shares (P,) of their intervals in the period."""
    integrals = coefficients / np.arange(1, coefficients.shape[2] + 1)
    return np.asarray(integrals.sum(axis=2) @ shares)


#: What the matrix is between two times -> the coefficients (r, P, d+1) of the powers of the share of an
#: interval, 0 to 1, of functions with values (r, P+1) at times (P+1,).
_COEFFICIENTS: dict[str, Callable[[FloatArray, FloatArray], FloatArray]] = {
    "linear": _lines,
    "cubic": _spline,
    "steps": _steps,
}
#: Names of what a matrix is between two times of a table.
BETWEEN = tuple(_COEFFICIENTS)
