"""spurcheck stability: Floquet multipliers, stability charts and the views beside them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from floquet.engine.propagators.registry import PROPAGATORS
from validation.commands import options as opt
from validation.commands.axes import axes_values, number_in
from validation.commands.terminal import FAILED, guarded, print_json, stderr, stdout, table

if TYPE_CHECKING:
    from floquet.gear.multipliers import GearPairMultipliers


@guarded
def stability(
    pair: opt.PairArgument = opt.DEFAULT_PAIR,
    output: Annotated[
        list[Path] | None,
        opt.output(
            "Result file, as often as needed: .nc, .csv or .mat for data, .png, .svg or .pdf for the "
            "figure; the suffix chooses."
        ),
    ] = None,
    view: Annotated[
        str,
        typer.Option(
            help="What to show: chart (spectral radius over axes), boundaries (tongues traced over speed and "
            "one more axis), campbell (frequencies over speed), paths (multipliers in the complex "
            "plane along one axis), laws (difference chart of two friction laws), zones (one degree of "
            "freedom with Coulomb friction, Vaishya and Singh)."
        ),
    ] = "chart",
    axes: Annotated[
        list[str] | None,
        typer.Option(
            "--axis",
            metavar="NAME=FROM:TO:COUNT",
            help="Axis: speed_rpm, damping_ratio (mesh), friction_coefficient, torque [N m], "
            "stiffness_variation, contact_ratio, bearing_stiffness [N/m]; ends may carry a unit: "
            "speed_rpm=10Hz:50Hz:9. Give it twice for a chart. "
            "Default of a chart: speed and damping ratio.",
        ),
    ] = None,
    tongues: Annotated[
        bool,
        typer.Option(
            "--tongues",
            help="Name the unstable regions of the chart by mode pair and order; over speed and damping also "
            "trace them and find the damping that closes each.",
        ),
    ] = False,
    operating_range: Annotated[
        str | None,
        typer.Option(
            "--operating-range", metavar="FROM:TO", help="Speeds of operation in rpm or '10Hz:50Hz', marked."
        ),
    ] = None,
    against: Annotated[
        str, typer.Option("--against", metavar="LAW", help="View laws: the law to compare with.")
    ] = "none",
    method: Annotated[
        str,
        typer.Option(
            help="How a chart is computed: auto (the faster of the next two), taylor (every point), "
            "chebyshev (interpolated between nodes, with checked error); or, as a slow, independent check, a "
            f"propagator of the general engine: {', '.join(PROPAGATORS)}."
        ),
    ] = "auto",
    multipliers: Annotated[
        bool, typer.Option("--multipliers", help="Keep all multipliers of every chart point in the data.")
    ] = False,
    supports: opt.Supports = "springs",
    speed: opt.Speed = None,
    torque: opt.Torque = None,
    speed_range: opt.Range = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    as_json: opt.Json = False,
    force: opt.Force = False,
) -> None:
    """Decide whether the motion is stable, at the operating point and over a chart.

    The largest Floquet multiplier tells by how much a disturbance grows (above 1) or dies (below 1) per mesh
    cycle. The exit code is 1 when the operating point is not stable.

    [bold]Examples[/bold]

    spurcheck stability -o chart.png

    spurcheck stability my_pair.toml --axis speed_rpm=500:20000:1000 --axis damping_ratio=0.002:0.05:1000
    --tongues --operating-range 3000:8000 -o chart.nc -o chart.pdf

    spurcheck stability --view boundaries --axis friction_coefficient=0:0.2:9 -o boundaries.nc

    spurcheck stability --view laws --law composite --against coulomb -o difference.png

    spurcheck stability my_pair.toml --supports shafts --axis speed_rpm=500:20000:1000 -o on_shafts.png
    """
    from floquet.gear.axes import GEAR_AXES
    from floquet.gear.multipliers import gear_pair_multipliers
    from lumped.friction.registry import law_named
    from validation.commands.stability_views import VIEWS, Request, show
    from validation.files.output import DATA_SUFFIXES, FIGURE_SUFFIXES, check_file

    if view not in VIEWS:
        from lumped.errors import refuse

        raise refuse("--view", view, ", ".join(VIEWS), "For example --view campbell.")
    targets = [check_file(path, DATA_SUFFIXES + FIGURE_SUFFIXES, force=force) for path in output or []]
    grid = axes_values(axes or [], GEAR_AXES)
    speeds = None if operating_range is None else _range(operating_range)
    gear_pair = opt.gear_pair(pair, speed, torque, law, settings, speed_range)
    opt.check_supports(gear_pair, supports)
    law_against = law_named(against, "--against").name
    request = Request(gear_pair, grid, speeds, tongues, law_against, method, multipliers, targets, supports)
    request.check(view)
    found = gear_pair_multipliers(gear_pair, supports=supports)
    if as_json:
        radius = found.spectral_radius
        point = {"verdict": found.verdict, "spectral_radius": radius, "error": found.error}
        point |= {"certificate": found.certificate, "margin": 1.0 - radius}
        print_json({"gear_pair": gear_pair.name, "supports": supports} | point)
    else:
        _print_point(f"{gear_pair.name} on {supports}", found)
    if targets or axes or tongues or view != "chart":
        show(view, request)
        for target in targets:
            stderr().print(f"wrote {target}")
    if found.verdict != "stable":
        raise typer.Exit(FAILED)


def _print_point(pair: str, found: GearPairMultipliers) -> None:
    from validation.reporting.formatting import number

    shown = table(f"{pair}: operating point", "quantity", ">value")
    shown.add_row("verdict", found.verdict)
    shown.add_row("largest multiplier", f"{found.spectral_radius:.8f}")
    shown.add_row("bound on its error", number(found.error, 2))
    shown.add_row("which is", found.certificate)
    shown.add_row("margin, 1 - largest multiplier", number(1.0 - found.spectral_radius))
    stdout().print(shown)


def _range(text: str) -> tuple[float, float]:
    """Range of speeds [rpm] written FROM:TO."""
    from lumped.errors import refuse

    ends = text.split(":")
    if len(ends) == 2:
        low, high = (number_in("--operating-range", end, "rpm") for end in ends)
        if 0.0 < low < high:
            return low, high
    advice = "For example --operating-range 3000:8000."
    raise refuse("--operating-range", text, "FROM:TO in rpm, 0 < FROM < TO", advice)
