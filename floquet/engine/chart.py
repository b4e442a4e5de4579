"""Stability charts: the multipliers of a family of periodic systems over a grid of parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from floquet.engine.monodromy import checked_effort, monodromy
from floquet.engine.multipliers import Spectrum, verdicts
from floquet.engine.system import PeriodicSystem
from lumped.arguments import of_type, real_numbers, some_of
from lumped.errors import NumericalError, refuse, shown
from lumped.labelling import Variable, labelled_dataset
from lumped.typing import BoolArray, FloatArray, Progress

if TYPE_CHECKING:
    import xarray as xr

Axes = Mapping[str, npt.ArrayLike]


@dataclass(frozen=True)
class ChartAxis:
    """One parameter of a chart.

    Attributes
    ----------
    units, long_name : labels of the axis
    low, high : allowed range, without its lower end where ``open_low``
    """

    units: str
    long_name: str
    low: float = field(default=-np.inf, kw_only=True)
    high: float = field(default=np.inf, kw_only=True)
    open_low: bool = field(default=False, kw_only=True)

    def check(self, name: str, values: FloatArray) -> None:
        """Raise ParameterError when a value is outside the range of the axis."""
        below = values <= self.low if self.open_low else values < self.low
        bad = values[below | (values > self.high)]
        if bad.size:
            sign = ">" if self.open_low else ">="
            allowed = f"{sign} {self.low:g}" + ("" if np.isinf(self.high) else f" and <= {self.high:g}")
            raise refuse(
                f"axes[{name!r}]",
                f"{bad[0]:g} {self.units}".removesuffix(" 1"),
                allowed,
                "Correct the axis values.",
            )


def checked_axes(axes: Axes) -> dict[str, FloatArray]:
    """Return the axes as 1-D float arrays.

    Raises
    ------
    ParameterError : no axis, or an axis that is empty, not finite, not 1-D or has repeated values
    """
    if not isinstance(axes, Mapping) or not axes:
        raise refuse("axes", shown(axes), "at least one name -> values", "Give the parameters to vary.")
    result = {}
    for name, values in axes.items():
        array = real_numbers(f"axes[{name!r}]", values)
        if np.unique(array).size != array.size:
            raise refuse(f"axes[{name!r}]", shown(values), "values that differ", "Remove the repetitions.")
        result[str(name)] = array
    return result


Family = Callable[[dict[str, float]], Spectrum | PeriodicSystem]
"""Parameters -> the periodic system there, or its multipliers."""


def scan(
    evaluate: Family,
    axes: Axes,
    *,
    labels: Mapping[str, tuple[str, str]] | None = None,
    rtol: float = 1e-8,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Evaluate the multipliers of a family of periodic systems on the product grid of the axes.

    Parameters
    ----------
    evaluate : parameters -> `PeriodicSystem`, or its `Spectrum` where that is known otherwise; every point
        must give the same number of multipliers
    axes : name -> values
    labels : name -> unit, "1" for none, and plain name of an axis
    rtol : of the monodromy matrix of a `PeriodicSystem`
    progress : told the finished fraction

    Returns
    -------
    xarray.Dataset over the axes, see `chart_dataset`

    Raises
    ------
    ParameterError : unusable axes
    NumericalError
        A point fails; the message names it.
    """
    grid = checked_axes(axes)
    names = list(grid)
    labels = dict(labels or {})
    some_of("labels", labels, names)
    rtol = checked_effort(rtol, 2)[0]
    mesh = np.stack(np.meshgrid(*grid.values(), indexing="ij"), axis=-1).reshape(-1, len(names))
    points = [dict(zip(names, map(float, row), strict=True)) for row in mesh]
    results: list[Spectrum] = []
    for point in points:
        spectrum = _at_point(evaluate, rtol, point)
        results.append(spectrum)
        if spectrum.multipliers.size != results[0].multipliers.size:
            counts = f"{spectrum.multipliers.size} multipliers at {_place(point)}"
            advice = "Keep the number of coordinates over the axes."
            raise refuse("evaluate", counts, f"{results[0].multipliers.size} as at the first point", advice)
        if progress is not None:
            progress(len(results) / len(points))
    multipliers = np.array([r.multipliers for r in results])
    errors = np.array([r.multiplier_errors for r in results])
    radius = np.array([r.spectral_radius for r in results])
    radius_error = np.array([r.error for r in results])
    proven = np.array([r.certificate == "proven" for r in results])
    chart = chart_dataset(grid, multipliers, errors, radius, radius_error, proven)
    for name, (unit, text) in labels.items():
        chart[name].attrs.update(units=unit, long_name=text)
    return chart


def _at_point(evaluate: Family, rtol: float, point: dict[str, float]) -> Spectrum:
    try:
        found = evaluate(point)
        if isinstance(found, PeriodicSystem):
            return monodromy(found, rtol)
        return of_type("evaluate", found, Spectrum, "a function that returns a PeriodicSystem or a Spectrum")
    except NumericalError as failure:
        raise NumericalError(f"at {_place(point)}: {failure}") from failure


def _place(point: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:g}" for name, value in point.items())


def chart_dataset(
    grid: Mapping[str, FloatArray],
    multipliers: npt.NDArray[np.complex128] | None,
    multiplier_errors: FloatArray | None,
    radius: FloatArray,
    radius_error: FloatArray,
    proven: BoolArray,
) -> xr.Dataset:
    """Label flat results (points in C order of the grid) as a chart.

    Returns
    -------
    Dataset with spectral_radius, error, verdict (1 stable, 0 undecided, -1 unstable) over the axes, and where
    given, multipliers, multiplier_errors over the axes and ``multiplier``. ``proven`` says where the errors
    are bounds by a theorem, the attribute ``certificate`` whether all are: "proven", "estimate" or "mixed".
    """
    shape = tuple(values.size for values in grid.values())
    dims = tuple(grid)
    bound = "bound on the error of "
    variables: dict[str, Variable] = {
        "spectral_radius": (
            dims, radius.reshape(shape), "1", "spectral radius, largest modulus of the multipliers"
        ),
        "error": (dims, radius_error.reshape(shape), "1", bound + "the spectral radius"),
        "verdict": (
            dims,
            verdicts(radius, radius_error).reshape(shape),
            "1",
            "stability verdict, undecided where the bound contains 1",
        ),
        "proven": (dims, proven.reshape(shape), "1", "whether the error is a proven bound, else an estimate"),
    }  # fmt: skip
    if multipliers is not None and multiplier_errors is not None:
        full, each = (*dims, "multiplier"), (*shape, -1)
        variables["multipliers"] = (
            full, multipliers.reshape(each), "1", "Floquet multipliers, largest modulus first"
        )  # fmt: skip
        variables["multiplier_errors"] = (
            full,
            multiplier_errors.reshape(each),
            "1",
            bound + "each multiplier",
        )
    dataset = labelled_dataset(variables, {name: (values, "", name) for name, values in grid.items()})
    dataset["verdict"].attrs.update(flag_values=[-1, 0, 1], flag_meanings="unstable undecided stable")
    dataset.attrs["certificate"] = "proven" if proven.all() else "mixed" if proven.any() else "estimate"
    return dataset
