"""spurcheck stability: Floquet multipliers and a stability chart."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.commands import options as opt
from validation.commands.terminal import FAILED, guarded, progress_bar, stderr, stdout, table

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from floquet.gear_tongues import LabelledRegion


@guarded
def stability(
    pair: opt.PairArgument = opt.DEFAULT_PAIR,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Chart as .nc, .csv, .mat, .png or .svg; the suffix chooses."),
    ] = None,
    axes: Annotated[
        list[str] | None,
        typer.Option(
            "--axis",
            metavar="NAME=FROM:TO:COUNT",
            help="One or two axes of the chart: speed_rpm, damping_ratio (mesh), friction_coefficient, "
            "torque [N m], stiffness_variation, contact_ratio, bearing_stiffness [N/m]. "
            "Default: speed and damping ratio.",
        ),
    ] = None,
    tongues: Annotated[
        bool,
        typer.Option(
            "--tongues", help="Name the unstable regions of the chart, in a table and in the figure."
        ),
    ] = False,
    speed: opt.Speed = None,
    torque: opt.Torque = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    force: opt.Force = False,
) -> None:
    """Decide whether the motion is stable, at the operating point and over a chart.

    The largest Floquet multiplier tells by how much a disturbance grows (above 1) or dies (below 1) per mesh
    cycle. The exit code is 1 when the operating point is not stable.

    [bold]Examples[/bold]

    spurcheck stability -o chart.png

    spurcheck stability my_pair.toml --axis speed_rpm=1000:20000:80 --axis friction_coefficient=0:0.1:6 -o
    chart.nc
    """
    from floquet.gear_pair import gear_pair_multipliers, stability_chart
    from validation.output import DATA_SUFFIXES, write_dataset
    from validation.reporting.formatting import number

    target = opt.figure_or_data(output, force=force)
    gear_pair = opt.gear_pair(pair, speed, torque, law, settings)
    grid = dict(map(_axis, axes or []))
    found = gear_pair_multipliers(gear_pair)
    console = stdout()
    shown = table(f"{gear_pair.name}: operating point", "quantity", ">value")
    shown.add_row("verdict", f"[bold]{found.verdict}[/bold]")
    shown.add_row("largest multiplier", f"{found.spectral_radius:.8f}")
    shown.add_row("bound on its error", number(found.error, 2))
    shown.add_row("margin, 1 - largest multiplier", number(1.0 - found.spectral_radius))
    console.print(shown)
    if target is not None or axes or tongues:
        grid = grid or _default_axes(gear_pair)
        with progress_bar("stability chart") as tell:
            chart = stability_chart(
                gear_pair, grid, rtol=1e-8, progress=lambda done, total: tell(done / total, "")
            )
        stable = chart["verdict"].to_numpy() == 1
        console.print(
            f"{int(stable.sum())} of {stable.size} chart points are stable; largest multiplier "
            f"{float(chart['spectral_radius'].max()):.6f}",
            soft_wrap=True,
        )
        regions = _regions(chart, gear_pair) if tongues else None
        if target is not None:
            if target.suffix.lower() in DATA_SUFFIXES:
                write_dataset(chart, target)
            else:
                _draw(chart, grid, gear_pair, target, regions)
            stderr().print(f"wrote {target}", soft_wrap=True)
    if found.verdict != "stable":
        raise typer.Exit(FAILED)


def _axis(text: str) -> tuple[str, NDArray[np.float64]]:
    """Name and values of an axis written NAME=FROM:TO:COUNT."""
    import numpy as np

    from floquet.gear_axes import gear_axis
    from lumped.errors import refuse

    name, separator, values = text.partition("=")
    parts = values.split(":")
    try:
        low, high, count = float(parts[0]), float(parts[1]), int(parts[2])
        good = separator == "=" and len(parts) == 3 and 2 <= count <= 2000 and np.isfinite([low, high]).all()
    except (ValueError, IndexError):
        good = False
    if not good or low == high:
        allowed = "NAME=FROM:TO:COUNT with different ends and a count from 2 to 2000"
        raise refuse("--axis", text, allowed, "For example --axis speed_rpm=1000:20000:80.")
    gear_axis(name.strip())  # refuses an unknown name
    return name.strip(), np.linspace(low, high, count)


def _default_axes(gear_pair: object) -> dict[str, NDArray[np.float64]]:
    from lumped import GearPair
    from validation.reporting.results import FULL, chart_axes

    assert isinstance(gear_pair, GearPair)
    return chart_axes(gear_pair, FULL)


def _regions(chart: object, gear_pair: object) -> list[LabelledRegion]:
    """Name the unstable regions and print them."""
    import xarray as xr

    from floquet.gear_tongues import label_regions
    from lumped import GearPair

    assert isinstance(chart, xr.Dataset)
    assert isinstance(gear_pair, GearPair)
    regions = label_regions(gear_pair, chart)
    names = list(map(str, chart["spectral_radius"].dims))
    shown = table(
        "unstable regions, by mode shape (w: natural frequencies)",
        "tongue",
        *(f">{name}" for name in names),
        ">largest multiplier",
        ">points",
    )
    for region in regions:
        place = [f"{region.point[name]:.6g}" for name in names]
        shown.add_row(str(region.label), *place, f"{region.radius:.6f}", str(region.nodes))
    stdout().print(shown)
    return regions


def _draw(
    chart: object,
    grid: dict[str, NDArray[np.float64]],
    gear_pair: object,
    target: Path,
    regions: list[LabelledRegion] | None,
) -> None:
    import xarray as xr

    from lumped import GearPair
    from lumped.errors import refuse
    from validation.output import whole_file
    from validation.plots import save, stability_figure

    assert isinstance(chart, xr.Dataset)
    assert isinstance(gear_pair, GearPair)
    if len(grid) != 2:
        raise refuse(
            "--output", target, "a chart of two axes for a figure", "Give two axes, or write .nc or .csv."
        )
    values = {
        "speed_rpm": gear_pair.operating.pinion_speed * 9.549296585513721,
        "damping_ratio": gear_pair.mesh.damping_ratio,
        "torque": gear_pair.operating.pinion_torque,
        "stiffness_variation": 1.0,
        "bearing_stiffness": gear_pair.bearings.pinion.loa_stiffness,
    }
    x, y = grid
    point = (values[x], values[y]) if x in values and y in values else None
    if regions is not None and "speed_rpm" in grid:
        from floquet import predicted_lines
        from validation.plots.tongue_chart import tongue_chart_figure

        other = y if x == "speed_rpm" else x
        if point is not None and x != "speed_rpm":
            point = point[::-1]
        lines = {str(tongue): speed for tongue, speed in predicted_lines(gear_pair).items()}
        figure = tongue_chart_figure(chart, other, regions, lines, point=point)
    else:
        figure = stability_figure(chart, x, y, point)
    with whole_file(target) as temporary:
        save(figure, temporary)
