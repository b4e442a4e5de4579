"""spurcheck floquet: multipliers and charts of any periodic system given by its matrices."""

from __future__ import annotations

from cmath import phase
from math import degrees
from pathlib import Path

import typer

from validation.commands import options as opt
from validation.commands.terminal import FAILED, guarded, print_json, progress_bar, show, stdout
from validation.files.formatting import number

_SHOWN = 12


@guarded
def floquet(
    source: Path,
    files: opt.ResultFiles,
    axis: list[str] | None = None,
    rtol: float = 1e-10,
    as_json: opt.Json = False,
) -> None:
    """Decide whether M x'' + C(t) x' + K(t) x = 0 is stable, for any matrices with one period.

    Prints the Floquet multipliers with proven bounds on their errors; the largest tells by how much a
    disturbance grows (above 1) or dies (below 1) per period. The exit code is 1 when it is not stable.

    [bold]Examples[/bold]
    spurcheck floquet rotor.npz
    spurcheck floquet rotor.mat --axis frequency=10:80:71 --axis variation=0:2:41 -o chart.png

    Parameters
    ----------
    source FILE : Matrices: .npz or .mat with M, K, period in s; if wanted C, G (times 2 pi/period in C),
        periodic terms K_cos_1, K_sin_1, ..., C_cos_1, ... and steps K_times with K_values.
    axis NAME=FROM:TO:COUNT : Axis of a chart: frequency in Hz (1/period), variation (factor on the periodic
        terms), damping (factor on C). Give it twice for a chart of two axes.
    rtol : Wanted error of the monodromy matrix.
    """
    from floquet import monodromy, scan
    from lumped.errors import refuse
    from validation.exchange.matrices import FILE_AXES, read_second_order

    if source.suffix.lower() == ".toml":
        action = f"For the gear pair of a parameter file: spurcheck stability {source}."
        raise refuse("matrices", source, "a file of matrices, .npz or .mat", action)
    grid = opt.axes_values(axis, FILE_AXES)
    if files.paths and not grid:
        raise refuse("--output", files.paths[0], "a chart to write", "Give --axis, once or twice.")
    if len(grid) > 2:
        raise refuse("--axis", ", ".join(grid), "one or two", "Leave an axis out.")
    model = read_second_order(source)
    found = monodromy(model.system(), rtol)
    if as_json:
        print_json(
            {"file": source.name, "verdict": found.verdict, "spectral_radius": found.spectral_radius}
            | {"error": found.error, "certificate": found.certificate, "period": found.period}
            | {"multipliers": [[z.real, z.imag] for z in found.multipliers.tolist()]}
            | {"multiplier_errors": found.multiplier_errors.tolist()}
        )
    else:
        pairs = zip(found.multipliers.tolist(), found.multiplier_errors.tolist(), strict=True)
        rows = [(f"{abs(z):.12g}", f"{degrees(phase(z)):.4f}", number(error, 2)) for z, error in pairs]
        show(f"{source.name}: multipliers", ">modulus | >phase [deg] | >bound on the error", rows[:_SHOWN])
        if len(rows) > _SHOWN:
            stdout().print(f"and {len(rows) - _SHOWN} smaller ones")
        stdout().print(
            f"{found.verdict}: largest multiplier {found.spectral_radius:.12g} +- {found.error:.1e}, "
            f"which is {'a proven bound' if found.certificate == 'proven' else 'an estimate'}"
        )
    if grid:
        labels = {name: (FILE_AXES[name].units, FILE_AXES[name].long_name) for name in grid}
        with progress_bar("chart") as tell:
            chart = scan(lambda at: model.system(**at), grid, labels=labels, rtol=rtol, progress=tell)
        verdict = chart["verdict"].to_numpy()
        counts = [int((verdict == k).sum()) for k in (1, 0, -1)]
        stdout().print(
            f"chart: {verdict.size} points, {counts[0]} stable, {counts[1]} undecided, {counts[2]} unstable; "
            f"largest bound on an error {float(chart['error'].max()):.1e}"
        )
        files.write(chart)
    if found.verdict != "stable":
        raise typer.Exit(FAILED)
