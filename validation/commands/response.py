"""spurcheck response: motions over speed where teeth may part, and the jumps between them."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.commands import options as opt
from validation.commands.terminal import guarded, note, print_json, progress_bar, stderr, stdout, table

if TYPE_CHECKING:
    import xarray as xr

    from floquet import ResponseBranches
    from lumped import GearPair

_LINEAR_SPEEDS = 400


@guarded
def response(
    pair: opt.PairArgument = opt.DEFAULT_PAIR,
    output: Annotated[
        Path | None,
        opt.output("Result file: .nc, .csv or .mat for data, .png, .svg or .pdf for the figure."),
    ] = None,
    periods: Annotated[int, typer.Option(help="Look for motions that repeat after 1 to so many cycles.")] = 3,
    seeds: Annotated[
        int, typer.Option(help="Speeds at which runs settle, to find motions apart from the others.")
    ] = 40,
    multibody: Annotated[
        int, typer.Option(help="Speeds of multibody sweeps up and down, drawn as points; some seconds each.")
    ] = 0,
    back_side: Annotated[
        bool, typer.Option("--back-side", help="Also let the back sides of the teeth touch; takes longer.")
    ] = False,
    torque: opt.Torque = None,
    speed_range: opt.Range = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    as_json: opt.Json = False,
    force: opt.Force = False,
) -> None:
    """Follow all motions over speed, stable and unstable, where teeth push and never pull.

    Prints at which speeds the pair jumps from one motion to another on running up and down, and at which it
    beats or is chaotic. The figure shows the branches, the jumps, the linear model and the multipliers.

    [bold]Examples[/bold]

    spurcheck response my_pair.toml --range 200..3000 -o response.png

    spurcheck response --multibody 40 -o response.svg
    """
    import floquet
    from lumped.arguments import whole_number

    target = opt.figure_or_data(output, force=force)
    gear_pair = opt.gear_pair(pair, None, torque, law, settings, speed_range)
    whole_number("--periods", periods, 1, 8)
    whole_number("--multibody", multibody, 0, 1000)
    with progress_bar("branches") as tell:
        found = floquet.response_branches(
            gear_pair, None, range(1, periods + 1), seeds=seeds, back_side=back_side, progress=tell
        )
    if as_json:
        print_json(
            {
                "gear_pair": gear_pair.name,
                "speeds_rpm": list(found.speeds_rpm),
                "jumps": [asdict(jump) for jump in found.jumps],
                "restless": [asdict(one) for one in found.restless],
                "bifurcations": [asdict(one) for one in found.bifurcations],
            }
        )
    else:
        _print(gear_pair, found)
    if not back_side and any(o.reaches_back_side for o in found.at(_operating(gear_pair))):
        note("a motion at the operating speed is larger than the backlash: try --back-side.")
    if target is not None:
        from validation.plots.response import response_figure

        linear, runs = _others(gear_pair, found.speeds_rpm, multibody)
        opt.write_result(target, found.dataset, lambda: response_figure(found.dataset, linear, runs))
        stderr().print(f"wrote {target}")


def _operating(pair: GearPair) -> float:
    from floquet.gear.axes import operating_rpm

    return operating_rpm(pair)


def _others(
    pair: GearPair, speeds: tuple[float, float], count: int
) -> tuple[xr.Dataset, dict[str, xr.Dataset]]:
    """The linear model over the same speeds, and multibody sweeps."""
    import numpy as np

    import lumped

    linear = lumped.speed_sweep(pair, np.linspace(*speeds, _LINEAR_SPEEDS))
    if count < 2:
        return linear, {}
    import multibody

    rising, runs = np.linspace(*speeds, count), dict[str, Any]()
    with progress_bar("multibody sweeps") as tell:
        for part, (way, values) in enumerate({"up": rising, "down": rising[::-1]}.items()):
            runs[way] = multibody.speed_sweep(
                pair, values, progress=lambda done, part=part: tell(0.5 * (part + done))
            )
    return linear, runs


def _print(pair: GearPair, found: ResponseBranches) -> None:
    from validation.reporting.formatting import number, quantity

    def motion(rms: float, load: float, kind: str, n: int) -> str:
        if kind == "grows":
            return "grows beyond twice the backlash"
        words = {1: "", 0: f", {kind}"}.get(n, f", repeats after {n} cycles")
        return f"{quantity(rms, 'm', 3)} rms{words}; load {quantity(load, 'N', 3)}"

    shown = table(f"{pair.name}: jumps", "pinion speed", "running", "from", "to")
    for jump in found.jumps:
        shown.add_row(
            f"{number(jump.speed_rpm, 5)} rpm",
            "up" if jump.rising else "down",
            motion(jump.dte_rms, jump.largest_load, "periodic", jump.n),
            motion(jump.dte_rms_after, jump.largest_load_after, jump.after, jump.n_after),
        )
    stdout().print(shown if found.jumps else "no jumps: one stable motion leads to the next")
    if found.contact_kept:
        runs = len(found.response.settled)
        stdout().print(
            f"contact is never lost: {runs} runs, from starts far from these motions, came to no other one"
            if runs
            else "contact is never lost in these motions; others were not looked for (--seeds)"
        )
    for one in found.restless:
        words = f"repeats after {one.n} cycles" if one.n else one.kind
        stdout().print(
            f"{number(one.low_rpm, 5)} to {number(one.high_rpm, 5)} rpm: no stable motion of few cycles was "
            f"found; in the middle the run {'is chaotic' if one.kind == 'chaos' else words}"
            f", {quantity(one.dte_rms, 'm', 3)} rms"
        )
