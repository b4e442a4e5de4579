"""The views of ``spurcheck stability``: what each computes, prints, draws and writes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from floquet import predicted_lines, stability_boundaries
from floquet.gear.axes import GEAR_AXES, chart_axes, operating_value
from floquet.gear.campbell import campbell
from floquet.gear.chart import METHODS, stability_chart
from floquet.gear.coulomb_zones import coulomb_gear_pair, stability_zones
from floquet.gear.friction_effect import friction_effect
from floquet.gear.margins import StabilityMargins, margins_dataset, stability_margins
from floquet.gear.paths import multiplier_paths
from floquet.gear.tongues import LabelledRegion, label_regions
from lumped import GearPair
from lumped.errors import refuse
from lumped.model.periodic_system import Supports
from lumped.typing import FloatArray
from validation.commands.options import write_result
from validation.commands.terminal import progress_bar, stdout, table
from validation.files.output import DATA_SUFFIXES
from validation.plots.campbell import campbell_figure
from validation.plots.multipliers import multiplier_paths_figure
from validation.plots.stability import (
    friction_effect_figure,
    mark_operating_range,
    stability_figure,
    stability_line_figure,
)
from validation.plots.tongues import (
    boundaries_figure,
    tongue_chart_figure,
    tongues_figure,
    zones_figure,
)

View = tuple[xr.Dataset, Callable[[], Figure]]
"""What is written as data, and the figure."""

_DAMPING_AXES = {"speed_rpm", "damping_ratio"}
#: Speeds and damping ratios of a chart.
_CHART = (401, 81)
_LINE = 401
_LARGEST_DIFFERENCE = 250_000
#: Views of pairs on elastic shafts.
_ON_SHAFTS = ("chart", "boundaries")


@dataclass(frozen=True, eq=False)
class Request:
    """What the command line asks for."""

    pair: GearPair
    axes: Mapping[str, FloatArray]
    operating_range: tuple[float, float] | None
    tongues: bool
    against: str
    method: str
    multipliers: bool
    targets: list[Path]
    supports: Supports

    def check(self, view: str) -> None:
        """Refuse what cannot be shown, before any work.

        Raises
        ------
        ParameterError : number of axes, method, law or supports that the view cannot take
        """
        counts, over_speed, text = VIEWS[view][1:]
        count = len(self.axes)
        without_speed = count == over_speed and "speed_rpm" not in self.axes
        if self.axes and (count not in counts or without_speed):
            raise refuse("--axis", ", ".join(self.axes), f"{text} for --view {view}", "Change the axes.")
        if self.supports == "shafts":
            self._check_on_shafts(view)
        if view == "zones":
            coulomb_gear_pair(self.pair, 0.0)  # refuses a ratio for which there is no closed form
        if self.method not in METHODS:
            raise refuse("--method", self.method, ", ".join(METHODS), "Leave it out to have it chosen.")
        if view == "laws" and self.against == self.pair.friction.law:
            raise refuse(
                "--against", self.against, "another law than that of the pair", "Choose it by --law."
            )
        figures = [path for path in self.targets if path.suffix.lower() not in DATA_SUFFIXES]
        if figures and view == "chart" and len(self.axes) > 2:
            raise refuse(
                "--output", figures[0], "a chart of one or two axes for a figure", "Write .nc or .csv."
            )

    def _check_on_shafts(self, view: str) -> None:
        """Refuse what is computed of pairs on springs only."""
        if view not in _ON_SHAFTS:
            action = f"Take --view {' or '.join(_ON_SHAFTS)}, or --supports springs."
            raise refuse("--view", view, f"{', '.join(_ON_SHAFTS)} with --supports shafts", action)
        if self.tongues:
            action = "Leave it out, or trace them over one axis with --view boundaries."
            raise refuse("--tongues", "given", "not with --supports shafts", action)
        if "bearing_stiffness" in self.axes:
            action = "Change the bearings of the shafts by --set shafts.pinion.bearings.1.loa_stiffness=..."
            raise refuse("--axis", "bearing_stiffness", "not with --supports shafts", action)
        if view == "boundaries" and not set(self.axes) - {"speed_rpm"}:
            action = "For example --axis damping_ratio=0.005:0.05:5."
            raise refuse("--axis", "none", "an axis other than speed_rpm with --supports shafts", action)

    def axis(self, name: str) -> tuple[str, FloatArray]:
        """Return the one axis asked for; else ``name`` over the range of the report's chart."""
        if self.axes:
            return next(iter(self.axes.items()))
        values = chart_axes(self.pair, *_CHART)[name]
        return name, np.linspace(values[0], values[-1], _LINE)

    def value(self, name: str) -> float:
        """Value of the operating point on an axis."""
        return operating_value(self.pair, name)


def show(view: str, request: Request) -> None:
    """Compute a view, print what it says in numbers, and write it to every target."""
    data, draw = VIEWS[view][0](request)
    draw_once = cache(draw)
    for target in request.targets:
        write_result(target, data, draw_once)


def _chart(request: Request) -> View:
    pair = request.pair
    grid = dict(request.axes) or chart_axes(pair, *_CHART)
    with progress_bar("stability chart") as tell:
        chart = stability_chart(
            pair,
            grid,
            rtol=1e-8,
            method=request.method,
            store="all" if request.multipliers else "radius",
            supports=request.supports,
            progress=tell,
        )
    stable = chart["verdict"].to_numpy() == 1
    radius = chart["spectral_radius"]
    worst = radius.isel(radius.argmax(...))
    stdout().print(
        "chart: " + ", ".join(f"{n} {v.min():g} to {v.max():g} ({v.size} values)" for n, v in grid.items())
        + f"\n{int(stable.sum())} of {stable.size} points are stable; "
        + f"largest multiplier {float(worst):.6f} at "
        + ", ".join(f"{name} {float(worst[name]):.5g}" for name in grid)
        + f"\nlargest bound on an error {float(chart['error'].max()):.1e}, method {chart.attrs['method']}"
    )  # fmt: skip
    traced: StabilityMargins | None = None
    regions: list[LabelledRegion] = []
    if request.tongues and set(grid) == _DAMPING_AXES:
        traced = _traced(pair, grid["speed_rpm"])
        edges = margins_dataset(traced).rename(damping_ratio="tongue_damping", lower="tongue_lower",
                                               upper="tongue_upper")  # fmt: skip
        data = chart.merge(edges, combine_attrs="override")
    else:
        data = chart
        regions = _regions(chart, pair) if request.tongues else []

    def draw() -> Figure:
        names = list(grid)
        if len(names) == 1:
            figure = stability_line_figure(chart, names[0], request.value(names[0]))
        elif request.tongues and "speed_rpm" in grid:
            (other,) = (name for name in names if name != "speed_rpm")
            lines = {str(tongue): rpm for tongue, rpm in predicted_lines(pair).items()}
            point = (request.value("speed_rpm"), request.value(other))
            return tongue_chart_figure(
                chart, other, traced.tongues if traced else regions, lines, point=point,
                operating_range=request.operating_range,
            )  # fmt: skip
        else:
            x, y = sorted(names, key=lambda name: name != "speed_rpm")  # speed runs to the right
            figure = stability_figure(chart, x, y, (request.value(x), request.value(y)))
        if "speed_rpm" in grid:
            mark_operating_range(figure.axes[0], request.operating_range)
        return figure

    return data, draw


def _traced(pair: GearPair, speeds: FloatArray) -> StabilityMargins:
    """Trace the tongues over a range of speeds, and print them by falling critical damping."""
    with progress_bar("tongues"):
        found = stability_margins(pair, (float(speeds.min()), float(speeds.max())))
    low, high = found.speed_range
    if (above := found.above) is not None:
        stdout().print(
            f"next tongue above the range, without mesh damping: {above.label}, {above.lower:.0f} to "
            f"{above.upper:.0f} rpm, closed by a mesh damping ratio of {above.critical_damping:.6f}"
        )
    if not found.tongues:
        stdout().print(f"no tongue from {low:g} to {high:g} rpm, even without mesh damping")
        return found
    shown = table(
        "tongues without mesh damping, and what closes them (rpm; w: natural frequencies)",
        "tongue", ">from", ">to", ">multiplier", ">critical damping", ">closes at",
    )  # fmt: skip
    for tongue in sorted(found.tongues, key=lambda t: -t.critical_damping):
        shown.add_row(
            tongue.label, f"{tongue.lower:.1f}", f"{tongue.upper:.1f}", f"{tongue.radius:.6f}",
            f"{tongue.critical_damping:.6f}", f"{tongue.tip_speed:.1f}",
        )  # fmt: skip
    stdout().print(shown)
    stdout().print(
        f"Friction is held at its mean, {found.friction_coefficient:.4f}. Above a mesh damping ratio of "
        f"{found.critical_damping:.6f} every speed is stable; this pair has {found.damping:g}."
    )
    return found


def _regions(chart: xr.Dataset, pair: GearPair) -> list[LabelledRegion]:
    """Name the unstable regions of a chart, and print them."""
    regions = label_regions(pair, chart)
    names = list(map(str, chart["spectral_radius"].dims))
    headings = ("tongue", *(f">{name}" for name in names), ">largest multiplier", ">points")
    shown = table("unstable regions, by mode shape (w: natural frequencies)", *headings)
    for region in regions:
        place = [f"{region.point[name]:.6g}" for name in names]
        shown.add_row(str(region.label), *place, f"{region.radius:.6f}", str(region.nodes))
    stdout().print(shown)
    return regions


def _boundaries(request: Request) -> View:
    pair = request.pair
    ends = chart_axes(pair, *_CHART)["speed_rpm"][[0, -1]]
    grid = dict(request.axes)
    speeds = grid.pop("speed_rpm", ends)
    name, values = next(iter(grid.items()), ("damping_ratio", speeds))
    if name == "damping_ratio" and request.supports == "springs":
        traced = _traced(pair, speeds)
        return margins_dataset(traced), lambda: tongues_figure(traced, request.operating_range)
    with progress_bar("boundaries") as tell:
        found = stability_boundaries(
            pair,
            (float(speeds.min()), float(speeds.max())),
            {name: values},
            supports=request.supports,
            progress=tell,
        )
    headings = ("tongue", ">values", ">from, rpm", ">to, rpm", ">largest multiplier")
    shown = table(f"tongues over {GEAR_AXES[name].long_name}", *headings)
    for row in range(found.sizes["tongue"]):
        part = found.isel(tongue=row)
        edges = (f"{float(part['lower'].min()):.1f}", f"{float(part['upper'].max()):.1f}")
        radius = f"{float(part['peak_radius'].max()):.6f}"
        shown.add_row(str(part["label"].item()), str(int(part["present"].sum())), *edges, radius)
    if found.sizes["tongue"]:
        stdout().print(shown)
    else:
        stdout().print(f"no unstable speed from {speeds.min():g} to {speeds.max():g} rpm at any value")
    return found, lambda: boundaries_figure(found, name, request.operating_range)


def _campbell(request: Request) -> View:
    _, speeds = request.axis("speed_rpm")
    diagram = campbell(request.pair, speeds)
    return diagram, lambda: campbell_figure(
        diagram, operating_rpm=request.value("speed_rpm"), operating_range=request.operating_range
    )


def _paths(request: Request) -> View:
    name, values = request.axis("speed_rpm")
    if name == "speed_rpm":
        # Multipliers turn with the period, so that even steps of speed lose them where it is low.
        low, high = values.min(), values.max()
        by_period = 1.0 / np.linspace(1.0 / low, 1.0 / high, _LINE)[1:-1]
        values = np.unique(np.concatenate([values, by_period]))
    with progress_bar("multipliers") as tell:
        paths = multiplier_paths(request.pair, name, values, progress=tell)
    return paths, lambda: multiplier_paths_figure(paths, request.value(name))


def _laws(request: Request) -> View:
    pair = request.pair
    grid = dict(request.axes) or chart_axes(pair, *_CHART)
    points = int(np.prod([values.size for values in grid.values()]))
    if points > _LARGEST_DIFFERENCE:
        raise refuse(
            "points of the difference chart", points, f"at most {_LARGEST_DIFFERENCE}", "Lower the counts."
        )
    law = pair.friction.law
    with progress_bar("difference of two friction laws") as tell:
        effect = friction_effect(pair, grid, [law], reference=request.against, rtol=1e-8, progress=tell)
    change = effect["growth_change"].to_numpy()
    flips = effect["verdict_change"].to_numpy()
    stdout().print(
        f"law {law} against {request.against}: growth per mesh cycle changes by {change.min():+.3e} to "
        f"{change.max():+.3e}; {int((flips == -1).sum())} points lose and {int((flips == 1).sum())} gain "
        f"stability, of {change.size}"
    )
    x, y = sorted(grid, key=lambda name: name != "speed_rpm")
    return effect, lambda: friction_effect_figure(effect, law, x, y, (request.value(x), request.value(y)))


def _zones(request: Request) -> View:
    found = stability_zones(coulomb_gear_pair(request.pair, request.value("friction_coefficient")))
    unstable = (found["spectral_radius"] > 1.0 + 1e-9).mean(("damping_ratio", "speed_ratio"))
    for case, share in zip(found["friction"].to_numpy(), unstable.to_numpy(), strict=True):
        stdout().print(f"friction {case}: unstable at {100.0 * float(share):.2f} % of the points")
    return found, lambda: zones_figure(found)


VIEWS: Mapping[str, tuple[Callable[[Request], View], tuple[int, ...], int | None, str]] = {
    "chart": (_chart, (1, 2, 3, 4, 5, 6, 7), None, "any axes"),
    "boundaries": (_boundaries, (1, 2), 2, "one axis other than speed_rpm, with or without speed_rpm,"),
    "campbell": (_campbell, (1,), 1, "the one axis speed_rpm"),
    "paths": (_paths, (1,), None, "one axis"),
    "laws": (_laws, (2,), None, "two axes"),
    "zones": (_zones, (), None, "no axis"),
}
"""View -> how it is made; how many axes it takes; which of these counts needs speed_rpm; these in words."""
