"""Matrices of mass, damping and stiffness with periodic terms, from a file of NumPy or MATLAB.

Sources: docs/how_to/any_system.md.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from floquet import FourierSeries, PeriodicMatrix, PiecewisePolynomial, SecondOrderSystem, from_second_order
from floquet.engine.chart import ChartAxis
from floquet.engine.coefficients import Coefficient, square
from lumped.arguments import file_path, nearest, real_array, real_number, real_numbers
from lumped.errors import ParameterError, refuse, shown
from lumped.typing import FloatArray
from validation.files.matlab import check_size, matlab_arrays

MATRIX_SUFFIXES = (".npz", ".mat")
FILE_AXES: Mapping[str, ChartAxis] = {
    "frequency": ChartAxis("Hz", "frequency of the variation", low=0.0, open_low=True),
    "variation": ChartAxis("1", "factor on the periodic terms", low=0.0),
    "damping": ChartAxis("1", "factor on C", low=0.0),
}
"""Axes of a chart of a file."""

_HARMONIC = re.compile(r"([CK])_(cos|sin)_([1-9]\d{0,2})")
_NAMES = ("M", "C", "G", "K", "period", "K_cos_1", "K_sin_1", "K_times", "K_values", "C_cos_1", "C_sin_1",
          "C_times", "C_values")  # fmt: skip


class Harmonic(NamedTuple):
    """Harmonic term of the matrix "C" or "K": ``amplitude`` times "cos" or "sin" of order ``order``."""

    matrix: str
    wave: str
    order: int
    amplitude: FloatArray


class Steps(NamedTuple):
    """Stepwise constant term of C or K, with mean zero over the period.

    Attributes
    ----------
    matrix : "C" or "K"
    ends : (P+1,) ends of the pieces over the period, from 0 to 1
    values : (P, n, n) matrix of each piece
    """

    matrix: str
    ends: FloatArray
    values: FloatArray


@dataclass(frozen=True, eq=False)
class SecondOrderModel:
    """M x'' + (C(t) + Omega G) x' + K(t) x = 0, Omega = 2 pi/period, as read from a file.

    Attributes
    ----------
    M, C, G, K : (n, n) constant parts, including the means of the steps
    period : [s]
    harmonics : harmonic terms of C and K
    steps : stepwise constant terms of C and K
    """

    M: FloatArray
    C: FloatArray
    G: FloatArray
    K: FloatArray
    period: float
    harmonics: tuple[Harmonic, ...]
    steps: tuple[Steps, ...]

    def system(
        self, *, frequency: float | None = None, variation: float = 1.0, damping: float = 1.0
    ) -> SecondOrderSystem:
        """Return the periodic system with the values of ``FILE_AXES``. None: value of the file."""
        T = 1.0 / frequency if frequency else self.period

        def matrix(name: str, constant: FloatArray, factor: float) -> PeriodicMatrix:
            terms: list[tuple[Coefficient, FloatArray]] = []
            for harmonic in self.harmonics:
                if harmonic.matrix == name:
                    unit = [0.0] * (harmonic.order - 1) + [1.0]
                    cosines, sines = (unit, ()) if harmonic.wave == "cos" else ((), unit)
                    terms.append(
                        (FourierSeries(T, 0.0, cosines, sines), variation * factor * harmonic.amplitude)
                    )
            for steps in self.steps:
                if steps.matrix == name:
                    indicators = np.eye(len(steps.values))[:, :, None]
                    terms += [
                        (PiecewisePolynomial(steps.ends * T, indicator), variation * factor * value)
                        for indicator, value in zip(indicators, steps.values, strict=True)
                    ]
            return PeriodicMatrix(constant, *terms)

        C = matrix("C", damping * self.C + 2.0 * np.pi / T * self.G, damping)
        return from_second_order(self.M, C, matrix("K", self.K, 1.0), T)


def read_second_order(path: str | Path) -> SecondOrderModel:
    """Read M, C, K and their periodic terms.

    Parameters
    ----------
    path : .npz or .mat with

        - ``M``, ``K`` (n, n) and ``period`` [s]; optional ``C``; optional ``G``: G times 2 pi/period is added
          to C. If the period is one turn, G is the gyroscopic matrix
        - ``K_cos_1``, ``K_sin_1``, ``K_cos_2``, ...: (n, n), times cos or sin(2 pi k t/period); also with C
        - ``K_times`` (P+1,) from 0 to the period and ``K_values`` (P, n, n), in MATLAB (n, n, P): constant
          between these times, added to K; the same with C

    Raises
    ------
    ParameterError : no such file, no file of that kind, an unknown or missing name, matrices of different
        shapes, times that do not rise from 0 to the period
    """
    source = file_path("path", path)
    fields = _fields(source)
    try:
        return _model(fields, matlab=source.suffix.lower() == ".mat")
    except ParameterError as error:
        raise ParameterError(list(error.problems), str(source)) from None


def _fields(path: Path) -> dict[str, Any]:
    """Return the arrays of the file by name. A file of another kind or a damaged file is refused."""
    if path.suffix.lower() not in MATRIX_SUFFIXES:
        allowed = "a name ending in " + ", ".join(MATRIX_SUFFIXES)
        raise refuse("path", path, allowed, "Save the matrices by numpy.savez or MATLAB's save.")
    if not path.is_file():
        raise refuse("path", path, "a file that exists", "Check the folder and the name.")
    advice = "Save it again: numpy.savez, or save('-v7', ...)."
    try:
        return _arrays(path)
    except Exception as error:  # noqa: BLE001  (readers raise anything of a damaged file)
        allowed = "a .npz of arrays or a .mat of arrays"
        raise refuse("path", path, allowed, f"{advice} ({shown(str(error), 120)})") from None


def _arrays(path: Path) -> dict[str, Any]:
    """Read the arrays of a file."""
    if path.suffix.lower() == ".mat":
        return dict(matlab_arrays(path))
    with zipfile.ZipFile(path) as archive:
        check_size(sum(member.file_size for member in archive.infolist()))
    with np.load(path, allow_pickle=False) as file:
        return dict(file)


def _model(fields: dict[str, Any], *, matlab: bool) -> SecondOrderModel:
    for name in fields:
        if name not in _NAMES and not _HARMONIC.fullmatch(name):
            advice = nearest(name, _NAMES) or "Remove it, or correct its name."
            raise refuse(name, "an unknown name", ", ".join(_NAMES) + ", K_cos_2, ...", advice)
    for name in ("M", "K", "period"):
        if name not in fields:
            raise refuse(name, "missing", "M, K and period", f"Save {name} too.")
    M = square("M", fields["M"])
    n = len(M)
    period = real_number("period", np.squeeze(fields["period"]), 0.0, above=True, unit="s")
    parts = {name: square(name, fields.get(name, np.zeros((n, n))), n) for name in ("C", "G", "K")}
    harmonics = []
    for name, value in fields.items():
        if match := _HARMONIC.fullmatch(name):
            matrix, wave, order = match.groups()
            harmonics.append(Harmonic(matrix, wave, int(order), square(name, value, n)))
    steps = []
    for matrix in ("C", "K"):
        times = f"{matrix}_times"
        values = f"{matrix}_values"
        if (times in fields) != (values in fields):
            missing = times if values in fields else values
            raise refuse(missing, "missing", f"{times} and {values}", "Save both, or neither.")
        if times in fields:
            ends, matrices = _steps(times, fields[times], values, fields[values], n, period, matlab=matlab)
            mean = np.tensordot(np.diff(ends), matrices, axes=1)
            parts[matrix] = parts[matrix] + mean
            steps.append(Steps(matrix, ends, matrices - mean))
    return SecondOrderModel(M, **parts, period=period, harmonics=tuple(harmonics), steps=tuple(steps))


def _steps(
    times: str, ends: Any, values: str, matrices: Any, n: int, period: float, *, matlab: bool
) -> tuple[FloatArray, FloatArray]:
    """Check a stepwise constant term. Returns the ends of the pieces over the period, and a matrix a piece.

    ``times``, ``values``: names of the arrays in the file.
    """
    checked_times = real_numbers(times, np.ravel(ends), increasing=True, unit="s")
    if checked_times.size < 2 or checked_times[0] != 0.0 or abs(checked_times[-1] - period) > 1e-12 * period:
        raise refuse(
            times, shown(checked_times), f"times from 0 to the period, {period:g} s", "Cover one period."
        )
    pieces = real_array(values, matrices)
    if matlab:
        # MATLAB drops a last dimension of one.
        pieces = np.moveaxis(pieces.reshape(*pieces.shape[:2], -1), -1, 0) if pieces.ndim >= 2 else pieces
    if pieces.shape != (checked_times.size - 1, n, n):
        wanted = (
            f"({n}, {n}, {checked_times.size - 1})" if matlab else f"({checked_times.size - 1}, {n}, {n})"
        )
        raise refuse(
            values, f"shape {np.shape(matrices)}", wanted, f"Give one matrix between times of {times}."
        )
    return np.append(checked_times[:-1] / period, 1.0), pieces
