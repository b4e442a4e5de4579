"""spurcheck jumps: where a pair can jump over speed and torque, damping or relief, and what removes it."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.commands import options as opt
from validation.commands.axes import axis_values
from validation.commands.terminal import guarded, print_json, progress_bar, stderr, stdout, table

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
    from numpy.typing import NDArray

    from floquet import JumpRemoval
    from lumped import GearPair

_VALUES = 26


@guarded
def jumps(
    pair: opt.PairArgument = opt.DEFAULT_PAIR,
    output: Annotated[
        Path | None,
        opt.output("Result file: .nc, .csv or .mat for data, .png, .svg or .pdf for the figure."),
    ] = None,
    axis: Annotated[
        str,
        typer.Option(
            metavar="NAME[=FROM:TO:COUNT]",
            help="What to vary beside the speed: torque [N m], damping_ratio (mesh) or tip_relief, the "
            f"amount [um]; default {_VALUES} values around the pair's own.",
        ),
    ] = "torque",
    speeds: Annotated[int, typer.Option(help="Number of speeds of the map.")] = 800,
    seeds: Annotated[
        int,
        typer.Option(
            help="Speeds at which runs settle for each value, to find motions apart from the others."
        ),
    ] = 0,
    torque: opt.Torque = None,
    speed_range: opt.Range = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    as_json: opt.Json = False,
    force: opt.Force = False,
) -> None:
    """Map where the teeth part and where the pair can jump, and find what removes the jumps.

    Over speed and torque, mesh damping or tip relief: whether contact is kept, where several motions exist
    side by side, where the pair beats, and at which speeds it jumps on running up and down.

    [bold]Examples[/bold]

    spurcheck jumps my_pair.toml --axis torque=20:300:26 -o jumps.png

    spurcheck jumps --axis damping_ratio -o jumps.nc
    """
    import numpy as np

    import floquet
    from floquet.gear.axes import speed_range as range_of
    from lumped.arguments import whole_number

    target = opt.figure_or_data(output, force=force)
    gear_pair = opt.gear_pair(pair, None, torque, law, settings, speed_range)
    whole_number("--speeds", speeds, 2, 5000)
    name, values = _axis(axis, gear_pair)
    axes = {"speed_rpm": np.linspace(*range_of(gear_pair), speeds), name: values}
    with progress_bar("jump map") as tell:
        found = floquet.jump_map(gear_pair, axes, seeds=seeds, progress=tell)
    with progress_bar("what removes jumps") as tell:
        branches = floquet.response_branches(gear_pair, periods=(1, 2), seeds=0, progress=tell)
        removed = floquet.jumps_removed_by(branches, name)
    if as_json:
        print_json(
            {
                "gear_pair": gear_pair.name,
                "axis": name,
                "values": values.tolist(),
                "jumps": _rows(found),
                "removed_by": [asdict(one) for one in removed],
            }
        )
    else:
        _print(gear_pair, found, name, removed)
    if target is not None:
        from validation.plots.jumps import jump_map_figure

        opt.write_result(target, found, lambda: jump_map_figure(found))
        stderr().print(f"wrote {target}")


def _axis(text: str, pair: GearPair) -> tuple[str, NDArray[np.float64]]:
    """Name and values of the second axis."""
    import numpy as np

    from floquet.gear.jump_map import JUMP_AXES, checked_axis

    name = text.partition("=")[0].strip()
    if "=" in text:
        name, values = axis_values(text, JUMP_AXES)
        checked_axis(pair, name)
        return name, values
    checked_axis(pair, name, "--axis")
    own = float(JUMP_AXES[name].own(pair))
    ends = {
        "torque": (0.2 * own, 3.0 * own),
        "damping_ratio": (0.2 * own, min(1.0, max(0.1, 2.4 * own))),
        "tip_relief": (0.0, max(20.0, 2.0 * own)),
    }
    return name, np.linspace(*ends[name], _VALUES)


def _rows(found: xr.Dataset) -> list[dict[str, float]]:
    names = [str(name) for name in found.data_vars if str(name).startswith("jump_")]
    return [
        {name.removeprefix("jump_"): found[name][j].item() for name in names}
        for j in range(found.sizes["jump"])
    ]


def _print(pair: GearPair, found: xr.Dataset, name: str, removed: tuple[JumpRemoval, ...]) -> None:
    from validation.reporting.formatting import number

    unit = found[name].attrs["units"]
    unit = "" if unit == "1" else f" {unit}"
    title = f"{pair.name}: jumps over {found[name].attrs['long_name']}"
    shown = table(title, f">{name}{unit and f' [{unit.strip()}]'}", "up at [rpm]", "down at [rpm]", ">share")
    for value in found[name].to_numpy():
        here = found["jump_" + name].to_numpy() == value
        ways = found["jump_rising"].to_numpy().astype(bool)
        speeds = found["jump_speed_rpm"].to_numpy()
        several = float((found["motions"].sel({name: value}) > 1).mean())
        shown.add_row(
            number(float(value), 3),
            *(", ".join(number(float(s), 5) for s in speeds[here & (ways == up)]) for up in (True, False)),
            f"{100.0 * several:.0f} %",
        )
    stdout().print(shown)
    stdout().print("share: of the speeds, where several motions exist side by side")
    if not removed:
        stdout().print("the pair itself has no folds: nothing is to be removed")
    for one in removed:
        if one.found:
            text = f"no jumps are left from {name} = {number(one.value, 4)}{unit} on ({one.direction} values)"
        else:
            text = f"{one.direction} {name}, up to {number(one.limit, 3)}{unit}: jumps are left"
        stdout().print(text)
