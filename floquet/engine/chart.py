"""Stability charts: the multipliers of a family of periodic systems over a grid of parameters."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from floquet.engine.multipliers import verdicts
from floquet.engine.spectrum import Spectrum
from lumped.arguments import real_numbers, whole_number
from lumped.errors import NumericalError, refuse, shown
from lumped.labelling import Variable, labelled_dataset
from lumped.typing import BoolArray, FloatArray, Progress

if TYPE_CHECKING:
    import xarray as xr

Axes = Mapping[str, npt.ArrayLike]


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


def scan(
    evaluate: Callable[[dict[str, float]], Spectrum],
    axes: Axes,
    *,
    n_jobs: int = 1,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Evaluate the multipliers on the product grid of the axes.

    Parameters
    ----------
    evaluate : parameters -> `Spectrum`; every point must give the same number of multipliers
    axes : name -> values
    n_jobs : processes; -1 for all cores. With more than one, ``evaluate`` must be picklable, and a script
        must start its work under ``if __name__ == "__main__":``.
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
    mesh = np.stack(np.meshgrid(*grid.values(), indexing="ij"), axis=-1).reshape(-1, len(names))
    points = [dict(zip(names, map(float, row), strict=True)) for row in mesh]
    results: list[Spectrum] = []
    n_jobs = whole_number("n_jobs", n_jobs, -1, 1024, "Use -1 for all cores.") or 1
    if n_jobs == 1:
        stream: Iterator[Spectrum] = (_at_point(evaluate, point) for point in points)
    else:
        stream = _in_processes(partial(_at_point, evaluate), points, n_jobs)
    for spectrum in stream:
        results.append(spectrum)
        if progress is not None:
            progress(len(results) / len(points))
    multipliers = np.array([r.multipliers for r in results])
    errors = np.array([r.multiplier_errors for r in results])
    radius = np.array([r.spectral_radius for r in results])
    radius_error = np.array([r.error for r in results])
    proven = np.array([r.certificate == "proven" for r in results])
    return chart_dataset(grid, multipliers, errors, radius, radius_error, proven)


def _in_processes(
    evaluate: Callable[[dict[str, float]], Spectrum], points: list[dict[str, float]], n_jobs: int
) -> Iterator[Spectrum]:
    """Spectra in order, by processes that start clean: a fork could copy a lock that a thread holds."""
    methods = multiprocessing.get_all_start_methods()
    context = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
    with ProcessPoolExecutor(n_jobs if n_jobs > 0 else None, mp_context=context) as pool:
        try:
            yield from pool.map(evaluate, points)
        finally:
            pool.shutdown(cancel_futures=True)


def _at_point(evaluate: Callable[[dict[str, float]], Spectrum], point: dict[str, float]) -> Spectrum:
    try:
        return evaluate(point)
    except NumericalError as failure:
        where = ", ".join(f"{name} = {value:g}" for name, value in point.items())
        raise NumericalError(f"at {where}: {failure}") from failure


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
