"""Periodic matrices from a file of NumPy, MATLAB, NetCDF or of columns of text.

Sources: docs/theory/floquet.md, "A matrix as a table"; docs/how_to/any_system.md.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from floquet.engine.coefficients import square
from floquet.engine.matrix_table import BETWEEN, MatrixTable, matrix_table
from lumped.arguments import file_path, nearest, one_of, real_array, real_number, real_numbers
from lumped.errors import ParameterError, refuse, shown
from lumped.typing import FloatArray
from validation.any_system.columns import read_columns
from validation.any_system.models import FirstOrderModel, Harmonic, MatrixOfTime, SecondOrderModel
from validation.any_system.netcdf import netcdf_arrays
from validation.files.matlab import check_size, matlab_arrays

MATRIX_SUFFIXES = (".npz", ".mat", ".nc", ".csv")
_HARMONIC = re.compile(r"([ACK])_(cos|sin)_([1-9]\d{0,2})")
_FIRST_ORDER = ("A", "A_cos_1", "A_sin_1", "A_times", "A_values", "A_samples")
_SECOND_ORDER = ("M", "C", "G", "K", "K_cos_1", "K_sin_1", "K_times", "K_values", "K_samples", "C_cos_1",
                 "C_sin_1", "C_times", "C_values", "C_samples")  # fmt: skip
_NAMES = ("period", *_FIRST_ORDER, *_SECOND_ORDER)
#: What a name that has no meaning here probably is.
_INSTEAD = {
    "t": "Name times A_times and the matrices A_samples (or K_times and K_samples).",
    "time": "Name times A_times and the matrices A_samples (or K_times and K_samples).",
    "T": "Name it period.",
    "D": "Name the matrix of damping C.",
}


def read_matrices(
    path: str | Path, *, period: float | None = None, between: str = "linear"
) -> FirstOrderModel | SecondOrderModel:
    """Read A(t), or M, C(t) and K(t), over one period.

    Parameters
    ----------
    path : .npz, .mat or .nc with A, or with M and K:

        - ``A`` (n, n); or ``M``, ``K`` (n, n), and if wanted ``C``, ``G``: G times 2 pi/period is added to C.
          If the period is one turn, G is the gyroscopic matrix
        - ``A_cos_1``, ``A_sin_1``, ``A_cos_2``, ...: (n, n), times cos or sin(2 pi k t/period); also K and C
        - ``A_times`` (m,) and ``A_samples`` (m, n, n), in MATLAB (n, n, m): values at these times, added to
          A; also K and C
        - ``A_times`` (P+1,) from 0 to the period and ``A_values`` (P, n, n), in MATLAB (n, n, P): constant
          between these times, added to A; also K and C
        - ``period`` [s]; not needed where the first and the last of the samples are equal

        or .csv with columns t, A_1_1, A_1_2, ..., A_n_n: the samples
    period : of the system [s]; None: that of the file
    between : what the samples are between their times: "linear", "cubic" or "steps", see
        `floquet.sampled_matrix`

    Raises
    ------
    ParameterError : no such file, no file of that kind, an unknown or missing name, matrices of different
        shapes, times that do not increase over one period, periods that contradict each other
    """
    source = file_path("path", path)
    one_of("between", between, BETWEEN)
    fields = _fields(source)
    try:
        return _Reading(fields, period, between, matlab=source.suffix.lower() == ".mat").model()
    except ParameterError as error:
        raise ParameterError(list(error.problems), str(source)) from None


def _fields(path: Path) -> dict[str, Any]:
    """Return the arrays of the file by name. A file of another kind or a damaged file is refused."""
    suffix = path.suffix.lower()
    if suffix not in MATRIX_SUFFIXES:
        allowed = "a name ending in " + ", ".join(MATRIX_SUFFIXES)
        raise refuse("path", path, allowed, "Save the matrices by numpy.savez or MATLAB's save.")
    if not path.is_file():
        raise refuse("path", path, "a file that exists", "Check the folder and the name.")
    if suffix == ".csv":
        return read_columns(path)
    advice = "Save it again: numpy.savez, save('-v7', ...), or Dataset.to_netcdf."
    try:
        return _arrays(path)
    except Exception as error:  # noqa: BLE001  (readers raise anything of a damaged file)
        allowed = f"a {suffix} of arrays"
        raise refuse("path", path, allowed, f"{advice} ({shown(str(error), 120)})") from None


def _arrays(path: Path) -> dict[str, Any]:
    """Read the arrays of a file."""
    if path.suffix.lower() == ".mat":
        return dict(matlab_arrays(path))
    if path.suffix.lower() == ".nc":
        return netcdf_arrays(path, _known)
    with zipfile.ZipFile(path) as archive:
        check_size(sum(member.file_size for member in archive.infolist()))
    with np.load(path, allow_pickle=False) as file:
        return dict(file)


def _known(name: str) -> bool:
    """Whether a name has a meaning in a file of matrices."""
    return name in _NAMES or _HARMONIC.fullmatch(name) is not None


class _Reading:
    """The arrays of a file on their way to a model; each problem is refused by the name of its array."""

    def __init__(
        self, fields: Mapping[str, Any], period: float | None, between: str, *, matlab: bool
    ) -> None:
        self._fields = fields
        self._between = between
        self._matlab = matlab
        self._check_names()
        self._period = self._stated_period(period)

    def model(self) -> FirstOrderModel | SecondOrderModel:
        """Return the model."""
        if "M" not in self._fields:
            A = self._matrix("A", None)
            return FirstOrderModel(A, self._the_period(A))
        for name in ("M", "K"):
            if name not in self._fields and not (name == "K" and "K_times" in self._fields):
                raise refuse(name, "missing", "M, K and period", f"Save {name} too.")
        M = square("M", self._fields["M"])
        C, K = (self._matrix(name, len(M)) for name in ("C", "K"))
        G = self._constant("G", len(M))
        return SecondOrderModel(M, C, G, K, self._the_period(C, K))

    def _check_names(self) -> None:
        """Refuse unknown names, names of both kinds, and files with neither A nor M."""
        for name in self._fields:
            if not _known(name):
                advice = _INSTEAD.get(name) or nearest(name, _NAMES) or "Remove it, or correct its name."
                raise refuse(name, "an unknown name", ", ".join(_NAMES) + ", K_cos_2, ...", advice)
        first = [name for name in self._fields if name.split("_")[0] == "A"]
        second = [name for name in self._fields if name.split("_")[0] in ("M", "C", "G", "K")]
        if first and second:
            allowed = "A alone, or M, C and K"
            raise refuse(", ".join(first), f"beside {', '.join(second)}", allowed, "Leave one of them out.")
        if not first and "M" not in self._fields:
            action = "Save A of x' = A(t) x, or M and K of M x'' + C x' + K x = 0."
            raise refuse("A", "missing", "A (or A_times with A_samples), or M and K", action)

    def _stated_period(self, wanted: float | None) -> float | None:
        """The period of the file or of the argument [s]; refuses two different ones."""
        stated = None
        if "period" in self._fields:
            value = np.squeeze(self._fields["period"])
            stated = real_number("period", value, 0.0, above=True, unit="s")
        if wanted is None:
            return stated
        period = real_number("period", wanted, 0.0, above=True, unit="s")
        if stated is not None and abs(stated - period) > 1e-9 * stated:
            raise refuse(
                "period", f"{period:g} s", f"{stated:g} s, that of the file", "Leave one of them out."
            )
        return period

    def _the_period(self, *matrices: MatrixOfTime) -> float:
        """The stated period, or else that of the tables, which must agree."""
        of_tables = [one.table.period for one in matrices if one.table is not None]
        period = self._period if self._period is not None else next(iter(of_tables), None)
        if period is None:
            action = "Save period too, or name it: --period in the command, period=... in Python."
            raise refuse("period", "missing", "the length of one period, in s", action)
        for other in of_tables:
            if abs(other - period) > 1e-9 * period:
                allowed = f"{period:g} s, that of the other table"
                raise refuse("period", f"{other:g} s of one table", allowed, "Correct the times.")
        return period

    def _constant(self, name: str, n: int | None) -> FloatArray:
        """The constant part of a matrix; zeros where the file has none."""
        if name in self._fields or n is None:
            value: Any = self._fields.get(name)
            if np.ndim(value) == 3:
                action = f"Save {name}_samples with {name}_times."
                raise refuse(name, f"shape {np.shape(value)}", "one matrix (n, n)", action)
            return square(name, value, n)
        return np.zeros((n, n))

    def _matrix(self, name: str, n: int | None) -> MatrixOfTime:
        """A, C or K with all its terms; n None: any number of rows."""
        harmonics = []
        rows = n
        table = self._table(name, n)
        if table is not None:
            rows = table.rows.matrices.shape[1]
        for field, value in self._fields.items():
            match = _HARMONIC.fullmatch(field)
            if match and match[1] == name:
                amplitude = square(field, value, rows)
                rows = len(amplitude)
                harmonics.append(Harmonic(match[2], int(match[3]), amplitude))
        samples = f"{name}_samples" in self._fields
        return MatrixOfTime(self._constant(name, rows), tuple(harmonics), table, samples)

    def _table(self, name: str, n: int | None) -> MatrixTable | None:
        """The table of a matrix, or None where the file has none."""
        times, values, samples = (f"{name}_{part}" for part in ("times", "values", "samples"))
        matrices = [field for field in (values, samples) if field in self._fields]
        if times not in self._fields and not matrices:
            return None
        if times not in self._fields or len(matrices) != 1:
            present = ", ".join(field for field in (times, *matrices) if field in self._fields)
            missing = times if times not in self._fields else f"{samples} or {values}"
            allowed = f"{times} with {samples}, or with {values}"
            what = "missing" if len(matrices) < 2 else "both"
            raise refuse(missing, what, allowed, f"Save both, or neither. The file has {present}.")
        (field,) = matrices
        pieces = real_array(field, self._fields[field])
        if self._matlab and pieces.ndim >= 2:  # MATLAB drops a last dimension of one
            pieces = np.moveaxis(pieces.reshape(*pieces.shape[:2], -1), -1, 0)
        if field == samples:
            known_times = np.ravel(real_array(times, self._fields[times]))
            self._check_shape(field, pieces, known_times.size, n, times)
            return matrix_table(
                known_times,
                pieces,
                period=self._period,
                between=self._between,
                field_of_times=times,
                field_of_matrices=field,
            )
        ends = self._ends(times)
        self._check_shape(field, pieces, ends.size - 1, n, times)
        closed = np.concatenate([pieces, pieces[:1]])
        return matrix_table(
            ends, closed, period=self._period, between="steps", field_of_times=times, field_of_matrices=field
        )

    def _ends(self, times: str) -> FloatArray:
        """The ends of pieces, from 0 to the period."""
        ends = real_numbers(times, np.ravel(self._fields[times]), increasing=True, unit="s")
        period = self._period
        if period is None and ends.size > 1:
            period = float(ends[-1])
        if period is None or ends.size < 2 or ends[0] != 0.0 or abs(ends[-1] - period) > 1e-12 * period:
            end = "the period" if period is None else f"the period, {period:g} s"
            raise refuse(times, shown(ends), f"times from 0 to {end}", "Cover one period.")
        return ends

    def _check_shape(self, field: str, matrices: FloatArray, count: int, n: int | None, times: str) -> None:
        """Refuse another number or size of matrices."""
        rows = n if n is not None else (matrices.shape[1] if matrices.ndim == 3 else "n")
        if matrices.shape != (count, rows, rows):
            wanted = f"({rows}, {rows}, {count})" if self._matlab else f"({count}, {rows}, {rows})"
            shape = np.shape(self._fields[field])
            place = "between times of" if field.endswith("values") else "at each of"
            action = f"Give one matrix {place} {times}."
            if matrices.shape == (rows, rows, count):
                action = f"Put the times first: numpy.moveaxis({field}, -1, 0)."
            raise refuse(field, f"shape {shape}", wanted, action)
