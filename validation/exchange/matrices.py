"""Matrices of mass, damping and stiffness with periodic terms, from a file of NumPy or MATLAB.

Sources: docs/how_to/any_system.md.
"""

from __future__ import annotations

import io
import math
import re
import subprocess
import sys
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import scipy.io

from floquet import FourierSeries, PeriodicMatrix, PiecewisePolynomial, SecondOrderSystem, from_second_order
from floquet.engine.chart import ChartAxis
from floquet.engine.coefficients import Coefficient, square
from lumped.arguments import file_path, nearest, real_array, real_number, real_numbers
from lumped.errors import ParameterError, refuse, shown
from lumped.typing import FloatArray

MATRIX_SUFFIXES = (".npz", ".mat")
FILE_AXES: Mapping[str, ChartAxis] = {
    "frequency": ChartAxis("Hz", "frequency of the variation", low=0.0, open_low=True),
    "variation": ChartAxis("1", "factor on the periodic terms", low=0.0),
    "damping": ChartAxis("1", "factor on C", low=0.0),
}
"""What a chart of a file can vary."""

#: Most bytes that the arrays of a file may take: matrices of some thousand states.
_MOST_BYTES = 500_000_000
#: Reads a MATLAB file in a process of its own: one wrong byte can end it. Sparse matrices become full.
_READER = """
import io, sys, numpy, scipy.io
content = io.BytesIO()
arrays = {name: value for name, value in scipy.io.loadmat(sys.argv[1]).items() if name[0] != "_"}
full = {name: value.toarray() if hasattr(value, "toarray") else value for name, value in arrays.items()}
numpy.savez(content, **full)
sys.stdout.buffer.write(content.getbuffer())
"""
_HARMONIC = re.compile(r"([CK])_(cos|sin)_([1-9]\d{0,2})")
_NAMES = ("M", "C", "G", "K", "period", "K_cos_1", "K_sin_1", "K_times", "K_values", "C_cos_1", "C_sin_1",
          "C_times", "C_values")  # fmt: skip


@dataclass(frozen=True, eq=False)
class SecondOrderModel:
    """M x'' + (C(t) + Omega G) x' + K(t) x = 0, Omega = 2 pi/period, as read from a file.

    Attributes
    ----------
    M, C, G, K : (n, n) constant parts, the means of steps included
    period : [s]
    harmonics : (of "C" or "K", "cos" or "sin", order, matrix)
    steps : (of "C" or "K", ends of the pieces as parts of the period (P+1,), matrices of mean zero (P, n, n))
    """

    M: FloatArray
    C: FloatArray
    G: FloatArray
    K: FloatArray
    period: float
    harmonics: tuple[tuple[str, str, int, FloatArray], ...]
    steps: tuple[tuple[str, FloatArray, FloatArray], ...]

    def system(
        self, *, frequency: float | None = None, variation: float = 1.0, damping: float = 1.0
    ) -> SecondOrderSystem:
        """Return the periodic system, varied as ``FILE_AXES`` say; None: as in the file."""
        T = 1.0 / frequency if frequency else self.period

        def matrix(name: str, constant: FloatArray, factor: float) -> PeriodicMatrix:
            terms: list[tuple[Coefficient, FloatArray]] = []
            for of, kind, order, B in self.harmonics:
                if of == name:
                    unit = [0.0] * (order - 1) + [1.0]
                    wave = FourierSeries(T, 0.0, unit) if kind == "cos" else FourierSeries(T, 0.0, (), unit)
                    terms.append((wave, variation * factor * B))
            for of, ends, values in self.steps:
                if of == name:
                    each = np.eye(len(values))[:, :, None]
                    terms += [
                        (PiecewisePolynomial(ends * T, one), variation * factor * B)
                        for one, B in zip(each, values, strict=True)
                    ]
            return PeriodicMatrix(constant, *terms)

        C = matrix("C", damping * self.C + 2.0 * np.pi / T * self.G, damping)
        return from_second_order(self.M, C, matrix("K", self.K, 1.0), T)


def read_second_order(path: str | Path) -> SecondOrderModel:
    """Read M, C, K and their periodic terms.

    Parameters
    ----------
    path : .npz or .mat (up to MATLAB 7) with

        - ``M``, ``K`` (n, n) and ``period`` [s]; if wanted ``C``, and ``G``, which times 2 pi/period is added
          to C: the gyroscopic matrix where the period is one turn
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
    """What the file holds, by name."""
    if path.suffix.lower() not in MATRIX_SUFFIXES:
        allowed = "a name ending in " + ", ".join(MATRIX_SUFFIXES)
        raise refuse("path", path, allowed, "Save the matrices by numpy.savez or MATLAB's save.")
    if not path.is_file():
        raise refuse("path", path, "a file that exists", "Check the folder and the name.")
    advice = "Save it again: numpy.savez, or save('-v7', ...)."
    try:
        return _arrays(path)
    except Exception as error:  # noqa: BLE001  (readers raise anything of a damaged file)
        allowed = "a .npz of arrays or a .mat up to version 7"
        raise refuse("path", path, allowed, f"{advice} ({shown(str(error), 120)})") from None


def _arrays(path: Path) -> dict[str, Any]:
    """The arrays of a file."""
    if path.suffix.lower() == ".npz":
        with zipfile.ZipFile(path) as archive:
            _check_size(sum(member.file_size for member in archive.infolist()))
        with np.load(path, allow_pickle=False) as file:
            return dict(file)
    _check_size(sum(8 * math.prod(shape) for _, shape, _ in scipy.io.whosmat(path)))
    run = subprocess.run([sys.executable, "-P", "-c", _READER, path], capture_output=True, check=False)
    if run.returncode:
        raise ValueError(run.stderr.decode(errors="replace").strip().rpartition("\n")[2] or "it is damaged")
    with np.load(io.BytesIO(run.stdout), allow_pickle=False) as file:
        return dict(file)


def _check_size(wanted: int) -> None:
    if wanted > _MOST_BYTES:  # a small file can unfold to gigabytes
        raise ValueError(f"it claims to hold {wanted:.3g} bytes")


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
    harmonics = [
        (found[1], found[2], int(found[3]), square(name, value, n))
        for name, value in fields.items()
        if (found := _HARMONIC.fullmatch(name))
    ]
    steps: list[tuple[Literal["C", "K"], FloatArray, FloatArray]] = []
    for of in ("C", "K"):
        times = f"{of}_times"
        values = f"{of}_values"
        if (times in fields) != (values in fields):
            missing = times if values in fields else values
            raise refuse(missing, "missing", f"{times} and {values}", "Save both, or neither.")
        if times in fields:
            ends, matrices = _steps(times, fields[times], values, fields[values], n, period, matlab=matlab)
            mean = np.tensordot(np.diff(ends), matrices, axes=1)
            parts[of] = parts[of] + mean
            steps.append((of, ends, matrices - mean))
    return SecondOrderModel(M, **parts, period=period, harmonics=tuple(harmonics), steps=tuple(steps))


def _steps(
    times: str, ends: Any, values: str, matrices: Any, n: int, period: float, *, matlab: bool
) -> tuple[FloatArray, FloatArray]:
    """Ends of the pieces as parts of the period, and their matrices (P, n, n)."""
    at = real_numbers(times, np.ravel(ends), increasing=True, unit="s")
    if at.size < 2 or at[0] != 0.0 or abs(at[-1] - period) > 1e-12 * period:
        raise refuse(times, shown(at), f"times from 0 to the period, {period:g} s", "Cover one period.")
    found = real_array(values, matrices)
    if matlab:
        # MATLAB drops a last dimension of one.
        found = np.moveaxis(found.reshape(*found.shape[:2], -1), -1, 0) if found.ndim >= 2 else found
    if found.shape != (at.size - 1, n, n):
        wanted = f"({n}, {n}, {at.size - 1})" if matlab else f"({at.size - 1}, {n}, {n})"
        raise refuse(
            values, f"shape {np.shape(matrices)}", wanted, f"Give one matrix between times of {times}."
        )
    return np.append(at[:-1] / period, 1.0), found
