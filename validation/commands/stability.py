"""spurcheck stability: multipliers and stability charts of a gear pair."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import typer

from validation.commands import options as opt
from validation.commands.cluster import cluster_of
from validation.commands.terminal import FAILED, guarded, print_json, progress_bar, show, stdout
from validation.files.formatting import number

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from concurrent.futures import Executor

    import xarray as xr
    from matplotlib.figure import Figure

    from floquet.gear.chart import LabelledRegion
    from floquet.gear.tongues import TongueMargin
    from lumped import GearPair
    from lumped.typing import FloatArray

#: Speeds and damping ratios of a chart.
_CHART = (801, 201)
_BOTH = {"speed_rpm", "damping_ratio"}
View = Literal["chart", "boundaries", "campbell"]


@guarded
def stability(
    pair: opt.AlikePair,
    files: opt.ResultFiles,
    view: View = "chart",
    axis: list[str] | None = None,
    tongues: bool = False,
    prove: bool = False,
    cluster: opt.Cluster = None,
    wait_seconds: opt.WaitSeconds = None,
    supports: opt.Supports = None,
    as_json: opt.Json = False,
) -> None:
    """Decide whether the motion is stable, at the operating point and over a chart.

    The largest Floquet multiplier tells by how much a disturbance grows (above 1) or dies (below 1) per mesh
    cycle, in the linear form with like teeth. The exit code is 1 when the operating point is not stable.

    [bold]Examples[/bold]
    spurcheck stability -o chart.png
    spurcheck stability my_pair.toml --axis speed_rpm=500:20000:1000 --axis damping_ratio=0.002:0.05:1000
    --tongues -o chart.nc -o chart.pdf
    spurcheck stability my_pair.toml --prove -o proven.png
    spurcheck stability --view boundaries --axis friction_coefficient=0:0.2:9 -o boundaries.nc
    spurcheck stability my_pair.toml --axis torque=20:90:40 --axis speed_rpm=500:20000:400
    --cluster tcp://head:8786 -o chart.nc
    spurcheck stability my_pair.toml --supports springs --axis speed_rpm=500:20000:1000 -o on_springs.png

    Parameters
    ----------
    view : What to show: chart (spectral radius over axes), boundaries (tongues traced over speed and one more
        axis), campbell (frequencies over speed).
    axis NAME=FROM:TO:COUNT : Axis: speed_rpm, damping_ratio (mesh), friction_coefficient, torque [N m],
        stiffness_variation, contact_ratio, bearing_stiffness [N/m]; ends may carry a unit:
        speed_rpm=10Hz:50Hz:9. Twice for a chart; default speed and damping ratio.
    tongues : Name the unstable regions by mode pair and order; over speed and damping also find the damping
        that closes each.
    prove : Over speed and damping decide every cell between the points of the chart, too: proven stable,
        proven unstable, or unproven and then marked. Takes a few seconds.
    """
    from floquet.engine.multipliers import STABLE
    from floquet.gear.axes import GEAR_AXES, chart_axes
    from floquet.gear.multipliers import gear_pair_multipliers
    from floquet.gear.tongues import campbell
    from lumped.errors import refuse
    from lumped.model.periodic_system import supports_of

    supports_used = supports_of(pair, supports)
    grid = opt.axes_values(axis, GEAR_AXES)
    _check(view, grid, files, tongues, prove, supports_used)
    if cluster is not None and view != "chart":
        raise refuse("--cluster", cluster, "--view chart", "Leave it out: this view takes a few seconds.")
    with cluster_of(cluster, wait_seconds) as executor:
        multipliers = gear_pair_multipliers(pair, supports=supports_used)
        margin = 1.0 - multipliers.spectral_radius
        if as_json:
            point = {
                "verdict": multipliers.verdict,
                "spectral_radius": multipliers.spectral_radius,
                "error": multipliers.error,
            }
            point |= {"certificate": multipliers.certificate, "margin": margin}
            print_json({"gear_pair": pair.name, "supports": supports_used} | point)
        else:
            rows = {
                "verdict": multipliers.verdict_words,
                "largest multiplier": f"{multipliers.spectral_radius:.8f}",
                "bound on its error": f"{number(multipliers.error, 2)} ({multipliers.certificate})",
                "margin, 1 - largest multiplier": margin,
            }
            show(f"{pair.name} on {supports_used}: operating point", "quantity | >value", rows.items())
        if files.paths or axis or tongues or prove or cluster or view != "chart":
            if view == "chart":
                files.write(*_chart(pair, grid, tongues, supports_used, prove, executor))
            elif view == "boundaries":
                files.write(_boundaries(pair, grid, supports_used))
            else:
                speeds = grid.get("speed_rpm", chart_axes(pair, *_CHART)["speed_rpm"])
                files.write(campbell(pair, speeds, supports=supports_used))
        if multipliers.verdict not in STABLE:
            raise typer.Exit(FAILED)


def _check(
    view: View,
    axes: Mapping[str, FloatArray],
    files: opt.Files,
    tongues: bool,
    prove: bool,
    supports: opt.SupportsName,
) -> None:
    """Refuse what cannot be shown, before any work."""
    from floquet.gear.axes import gear_grid
    from lumped.errors import refuse
    from validation.files.output import DATA_SUFFIXES

    named = ", ".join(axes) or "none"
    others = len(set(axes) - {"speed_rpm"})
    figure = next((one for one in files.paths if one.suffix.lower() not in DATA_SUFFIXES), None)
    shafts = supports == "shafts"
    layer = "--prove" if prove else "--tongues"
    for is_wrong, option, value, allowed, action in (
        (view == "boundaries" and others != 1, "--axis", named, "one axis other than speed_rpm, with or "
         "without speed_rpm, for --view boundaries", "For example --axis damping_ratio=0.005:0.05:5."),
        (view == "campbell" and others, "--axis", named, "no axis but speed_rpm for --view campbell",
         "Leave it out."),
        (view != "chart" and (prove or tongues), layer, view, "--view chart", "Leave it out."),
        (figure and view == "chart" and len(axes) > 2, "--output", figure,
         "a chart of one or two axes for a figure", "Write .nc or .csv."),
        (shafts and (tongues or view == "campbell"), "--supports", supports,
         "springs for --tongues and --view campbell",
         "Give --supports springs, or trace tongues over one axis: --view boundaries."),
        (prove and axes and set(axes) != _BOTH, "--prove", named, "the axes speed_rpm and damping_ratio",
         "Name both or none."),
    ):  # fmt: skip
        if is_wrong:
            raise refuse(option, value, allowed, action)
    if axes:
        gear_grid(axes, supports)


def _chart(
    pair: GearPair,
    axes: Mapping[str, FloatArray],
    tongues: bool,
    supports: opt.SupportsName,
    prove: bool,
    executor: Executor | None,
) -> tuple[xr.Dataset, Callable[[], Figure]]:
    from floquet import predicted_lines
    from floquet.gear.axes import GEAR_AXES, chart_axes
    from floquet.gear.chart import stability_chart

    grid = dict(axes) or chart_axes(pair, *_CHART)
    with progress_bar("stability chart") as tell:
        chart = stability_chart(
            pair, grid, rtol=1e-8, prove=prove, supports=supports, executor=executor, progress=tell
        )
    stable = chart["verdict"].to_numpy() > 0
    radius = chart["spectral_radius"]
    worst = radius.isel(radius.argmax(...))
    stdout().print(
        "chart: " + ", ".join(f"{n} {v.min():g} to {v.max():g} ({v.size} values)" for n, v in grid.items())
        + f"\n{int(stable.sum())} of {stable.size} points are stable; "
        + f"largest multiplier {float(worst):.6f} at "
        + ", ".join(f"{name} {float(worst[name]):.5g}" for name in grid)
        + f"\n{float(chart['known'].mean()):.2%} of the points are evaluated, with an error of at "
        + f"most {float(chart['error'].where(chart['known']).max()):.1e}"
        + prove * f"\n{chart.attrs.get('proven_share', 0.0):.2%} of the area is proven, between points too"
    )  # fmt: skip
    data, regions = _tongues(pair, chart) if tongues else (chart, ())

    def draw() -> Figure:
        from validation.plots.stability import stability_figure

        operating_point = {name: GEAR_AXES[name].own(pair) for name in grid}
        lines = (
            {str(tongue): rpm for tongue, rpm in predicted_lines(pair, supports=supports).items()}
            if regions
            else {}
        )
        return stability_figure(chart, operating_point, regions, lines)

    return data, draw


def _tongues(pair: GearPair, chart: xr.Dataset) -> tuple[xr.Dataset, Sequence[TongueMargin | LabelledRegion]]:
    """Name the unstable regions of a chart and print a table. Over speed and damping, trace the tongues."""
    from floquet.gear.chart import label_regions
    from floquet.gear.tongues import stability_margins

    names = list(map(str, chart["spectral_radius"].dims))
    if set(names) != _BOTH:
        regions = label_regions(pair, chart)
        columns = " | ".join(("tongue", *(f">{name}" for name in names), ">largest multiplier", ">points"))
        points = ([f"{one.point[name]:.6g}" for name in names] for one in regions)
        rows = (
            (str(one.label), *coordinates, f"{one.radius:.6f}", str(one.nodes))
            for one, coordinates in zip(regions, points, strict=True)
        )
        show("unstable regions, by mode shape (w: natural frequencies)", columns, rows)
        return chart, regions
    with progress_bar("tongues"):
        ends = float(chart["speed_rpm"].min()), float(chart["speed_rpm"].max())
        margins = stability_margins(pair, ends, supports="springs")
    edges = margins.dataset.rename(damping_ratio="tongue_damping", lower="tongue_lower", upper="tongue_upper")
    if (above := margins.above) is not None:
        stdout().print(
            f"next tongue above the range, without mesh damping: {above.label}, {above.lower:.0f} to "
            f"{above.upper:.0f} rpm, closed by a mesh damping ratio of {above.critical_damping:.6f}"
        )
    if margins.tongues:
        show(
            "tongues without mesh damping, and what closes them (rpm; w: natural frequencies)",
            "tongue | >from | >to | >multiplier | >critical damping | >closes at",
            (
                (t.label, f"{t.lower:.1f}", f"{t.upper:.1f}", f"{t.radius:.6f}", f"{t.critical_damping:.6f}",
                 f"{t.tip_speed:.1f}")
                for t in sorted(margins.tongues, key=lambda t: -t.critical_damping)
            ),
        )  # fmt: skip
        stdout().print(
            f"Friction is constant at its mean, {margins.friction_coefficient:.4f}. "
            f"Above a mesh damping ratio of {margins.critical_damping:.6f} every speed is stable; "
            f"this pair has {margins.damping:g}."
        )
    else:
        low, high = margins.speed_range
        stdout().print(f"no tongue from {low:g} to {high:g} rpm, even without mesh damping")
    return chart.merge(edges, combine_attrs="override"), margins.tongues


def _boundaries(pair: GearPair, axes: Mapping[str, FloatArray], supports: opt.SupportsName) -> xr.Dataset:
    from floquet import stability_boundaries
    from floquet.gear.axes import GEAR_AXES, chart_axes

    grid = dict(axes)
    speeds = grid.pop("speed_rpm", chart_axes(pair, *_CHART)["speed_rpm"])
    ends = float(speeds.min()), float(speeds.max())
    (name,) = grid
    with progress_bar("boundaries") as tell:
        boundaries = stability_boundaries(pair, ends, {name: grid[name]}, supports=supports, progress=tell)
    if not boundaries.sizes["tongue"]:
        stdout().print(f"no unstable speed from {ends[0]:g} to {ends[1]:g} rpm at any value")
        return boundaries
    rows = (
        (str(one["label"].item()), str(int(one["present"].sum())), f"{float(one['lower'].min()):.1f}",
         f"{float(one['upper'].max()):.1f}", f"{float(one['peak_radius'].max()):.6f}")
        for one in (boundaries.isel(tongue=row) for row in range(boundaries.sizes["tongue"]))
    )  # fmt: skip
    columns = "tongue | >values | >from, rpm | >to, rpm | >largest multiplier"
    show(f"tongues over {GEAR_AXES[name].long_name}", columns, rows)
    return boundaries
