"""spurcheck floquet: multipliers and stability charts of any periodic system."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import typer

from validation.commands import options as opt
from validation.commands.terminal import FAILED, guarded, print_json, progress_bar, show, stdout
from validation.files.formatting import number

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr

    from floquet import Monodromy
    from lumped.typing import FloatArray
    from validation.any_system.models import PeriodicModel

#: Multipliers that are printed.
_SHOWN = 12


@guarded
def floquet(
    source: str,
    files: opt.ResultFiles,
    axis: list[str] | None = None,
    period: str | None = None,
    between: Literal["linear", "cubic", "steps"] | None = None,
    rtol: float = 1e-10,
    refine: bool = False,
    workers: int = 1,
    as_json: opt.Json = False,
) -> None:
    """Decide whether x' = A(t) x, or M x'' + C(t) x' + K(t) x = 0, is stable: any system with one period.

    Prints the Floquet multipliers with bounds on their errors, the growth rates and the frequencies. The
    largest multiplier tells by how much a disturbance grows (above 1) or dies (below 1) per period. Without
    damping, multipliers that are proven to stay on the unit circle are "stable (neutral)". The exit code is 1
    when the system is not stable.

    [bold]Examples[/bold]
    spurcheck floquet rotor.npz -o multipliers.png
    spurcheck floquet A.csv --period 0.2 --between cubic
    spurcheck floquet rotor.mat --axis frequency=10:80:71 --axis variation=0:2:41 -o chart.png
    spurcheck floquet blade.py:blade --axis advance_ratio=0:2:81 --axis lock_number=0:12:61 -o chart.png

    Parameters
    ----------
    source FILE : .npz, .mat or .nc with A of x' = A(t) x, or M and K, if wanted C and G (times 2 pi/period in
        C); periodic terms K_cos_1, K_sin_1, ..., steps K_times with K_values, samples K_times with K_samples;
        the same with A and C. Or .csv with columns t, A_1_1, A_1_2, .... Or FILE.py:FUNCTION, whose
        arguments are parameters with a default.
    axis NAME=FROM:TO:COUNT : Axis of a chart: frequency in Hz (1/period), variation (factor on the periodic
        terms), damping (factor on C); of a function its arguments. Give it twice for a chart of two axes.
    period SECONDS : Period in s, or '20 ms', where the file has none.
    between : What samples are between their times; default: linear.
    rtol : Wanted error of the monodromy matrix.
    refine : Compute a chart of two axes near its edges of instability alone, and interpolate the rest.
    workers : Processes that compute a chart.
    """
    from floquet import monodromy
    from floquet.engine.multipliers import STABLE
    from lumped.arguments import whole_number
    from lumped.errors import refuse
    from validation.any_system.spectrum import spectrum_dataset
    from validation.plots.stability import multipliers_figure

    whole_number("--workers", workers, 1, 1024, "Use as many as there are cores.")
    model = _model(source, period, between)
    grid = opt.axes_values(axis, model.axes)
    if refine and len(grid) != 2:
        raise refuse("--refine", f"{len(grid)} axes", "with two --axis", "Leave it out, or give two axes.")
    if len(grid) > 2:
        raise refuse("--axis", ", ".join(grid), "one or two", "Leave an axis out.")
    multipliers = monodromy(model.system(), rtol)
    spectrum = spectrum_dataset(multipliers)
    if as_json:
        print_json(_as_json(source, multipliers, spectrum))
    else:
        _show(source, multipliers, spectrum)
        _show_what_rows_leave_out(model, multipliers, rtol)
    if grid:
        files.write(_chart(model, grid, rtol, refine, workers))
    else:
        files.write(spectrum, lambda: multipliers_figure(spectrum))
    if multipliers.verdict not in STABLE:
        raise typer.Exit(FAILED)


def _model(source: str, period: str | None, between: str | None) -> PeriodicModel:
    """Return the model of a file of matrices or of a function."""
    from lumped.errors import ParameterError, refuse
    from validation.any_system.function_files import read_family
    from validation.any_system.matrix_files import read_matrices

    if source.lower().endswith(".toml"):
        action = f"For the gear pair of a parameter file: spurcheck stability {source}."
        raise refuse("matrices", source, "a file of matrices, .npz, .mat, .nc or .csv", action)
    family = read_family(source)
    if family is not None:
        for option, value in (("--period", period), ("--between", between)):
            if value is not None:
                raise refuse(
                    option, value, "a file of matrices", "The function states its period: leave it out."
                )
        return family
    seconds = None if period is None else opt.number_in("--period", period, "s")
    try:
        model = read_matrices(source, period=seconds, between=between or "linear")
    except ParameterError as error:
        raise opt.by_option(error, {"path": "FILE"}, error.source) from None
    if between is not None and not model.sampled:
        action = "Leave it out: it is for A_samples, K_samples or C_samples, and for .csv."
        raise refuse("--between", between, "a file with samples", action)
    return model


def _as_json(source: str, multipliers: Monodromy, spectrum: xr.Dataset) -> dict[str, object]:
    """Return the numbers that are printed."""
    from pathlib import Path

    return {
        "file": Path(source).name,
        "verdict": multipliers.verdict,
        "spectral_radius": multipliers.spectral_radius,
        "error": multipliers.error,
        "certificate": multipliers.certificate,
        "period": multipliers.period,
        "multipliers": [[z.real, z.imag] for z in multipliers.multipliers.tolist()],
        "multiplier_errors": multipliers.multiplier_errors.tolist(),
        "growth_rates": spectrum["growth_rate"].to_numpy().tolist(),
        "frequencies": spectrum["frequency"].to_numpy().tolist(),
    }


def _show(source: str, multipliers: Monodromy, spectrum: xr.Dataset) -> None:
    """Print the multipliers and the verdict."""
    from pathlib import Path

    names = ("modulus", "phase", "bound", "growth_rate", "frequency")
    columns = (spectrum[name].to_numpy().tolist() for name in names)
    rows = [
        (
            f"{modulus:.12g}",
            f"{phase:.4f}",
            number(bound, 2),
            "0" if abs(modulus - 1.0) <= bound else f"{growth:.6g}",  # not distinguished from 0
            f"{frequency:.6g}",
        )
        for modulus, phase, bound, growth, frequency in zip(*columns, strict=True)
    ]
    heading = ">modulus | >phase [deg] | >bound | >growth [1/s] | >frequency [Hz]"
    show(f"{Path(source).name}: multipliers", heading, rows[:_SHOWN])
    if len(rows) > _SHOWN:
        stdout().print(f"and {len(rows) - _SHOWN} smaller ones")
    stdout().print(
        f"{multipliers.verdict_words}: largest multiplier {multipliers.spectral_radius:.12g} "
        f"+- {multipliers.error:.1e}, "
        f"which is {'a proven bound' if multipliers.certificate == 'proven' else 'an estimate'}\n"
        f"period {multipliers.period:.6g} s; frequencies are known up to multiples of "
        f"1/period, {1.0 / multipliers.period:.6g} Hz"
    )


def _show_what_rows_leave_out(model: PeriodicModel, multipliers: Monodromy, rtol: float) -> None:
    """Say by how much the multipliers change with every second row of the tables."""
    import numpy as np

    from floquet import monodromy

    coarser = model.coarser()
    if coarser is None:
        return
    others = monodromy(coarser.system(), rtol).multipliers
    apart = np.abs(others[:, None] - multipliers.multipliers)
    change = float(max(apart.min(axis=0).max(), apart.min(axis=1).max()))
    stdout().print(
        f"with every second sample the multipliers change by up to {number(change, 2)}: the bounds are of "
        "the matrix between the samples, not of the matrix that was sampled"
    )


def _chart(
    model: PeriodicModel, grid: Mapping[str, FloatArray], rtol: float, refine: bool, workers: int
) -> xr.Dataset:
    """Compute a chart and print how many points have which verdict."""
    from floquet import scan
    from validation.any_system.models import SystemAt

    labels = {name: (model.axes[name].units, model.axes[name].long_name) for name in grid}
    with progress_bar("chart") as tell:
        chart = scan(
            SystemAt(model), grid, labels=labels, refine=refine, rtol=rtol, workers=workers, progress=tell
        )
    verdict = chart["verdict"].to_numpy()
    known = float(chart["known"].mean())
    neutral, stable, undecided, unstable = (int((verdict == k).sum()) for k in (2, 1, 0, -1))
    stdout().print(
        f"chart: {verdict.size} points, {stable} stable, "
        + (f"{neutral} stable (neutral), " if neutral else "")
        + f"{undecided} undecided, {unstable} unstable; "
        + ("" if known == 1.0 else f"{known:.0%} of the points are computed; ")
        + f"largest bound on an error {float(chart['error'].where(chart['known']).max()):.1e}"
    )
    return chart
