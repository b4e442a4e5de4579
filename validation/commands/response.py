"""spurcheck response: motions over speed with unilateral contact, jumps between motions, map of the jumps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.commands import options as opt
from validation.commands.terminal import guarded, note, print_json, progress_bar, show, stdout
from validation.files.formatting import number, quantity

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from floquet import ResponseBranches
    from floquet.gear.motions import Basin
    from lumped import GearPair

_LINEAR_SPEEDS = 400
#: Values of the second axis of a map where none are given.
_VALUES = 26


@guarded
def response(
    pair: opt.AlikePair,
    files: opt.ResultFiles,
    periods: int = 3,
    seeds: int | None = None,
    map_: str | None = None,
    speeds: int = 800,
    back_side: bool = False,
    budget: float | None = None,
    supports: opt.Supports = None,
    as_json: opt.Json = False,
) -> None:
    """Follow all motions over speed, stable and unstable, with unilateral contact.

    Prints the speeds of jumps between motions on running up and down, the speeds of beats and chaos, and the
    share of start states that lead to each motion at the operating speed. The figure shows the branches, the
    jumps, beats and chaos, the linear model and the multipliers.

    --map computes a map over speed and torque, mesh damping or tip relief: loss of contact, ranges with
    several motions, speeds of jumps, and values that remove the jumps.

    All results are for a pair on the springs of 'bearings', with like teeth and the stiffness of the static
    load. A pair with shafts needs --supports springs.

    [bold]Examples[/bold]
    spurcheck response my_pair.toml --range 200..3000 -o response.png
    spurcheck response my_pair.toml --map torque=20:300:26 -o jumps.png

    Parameters
    ----------
    periods : Look for motions that repeat after 1, 2, ... up to this number of mesh cycles.
    seeds : Runs that settle, for each doubling of the speed: they find isolated motions, beats and chaos.
        Default 20; with --map 0.
    map_ NAME[=FROM:TO:COUNT] : Map the jumps over speed and torque (N m), damping_ratio (mesh) or tip_relief
        (um), and find what removes them; default 26 values of the range that is searched.
    speeds : With --map: number of speeds.
    back_side : Also let the back sides of the teeth touch.
    budget : Processor time of the search (s); speeds that are not searched then are printed. Default: no
        limit.
    """
    import numpy as np

    import floquet
    import lumped
    from floquet.gear.axes import operating_rpm
    from lumped.arguments import whole_number
    from lumped.model.periodic_system import on_springs

    pair = on_springs(pair, supports, "the response with unilateral contact")
    if map_ is not None:
        whole_number("--speeds", speeds, 2, 5000)
        _map(pair, map_, speeds, seeds or 0, files, as_json)
        return
    whole_number("--periods", periods, 1, 8)
    with progress_bar("branches") as tell:
        settling_speeds = 20 if seeds is None else seeds
        cycles = range(1, periods + 1)
        branches = floquet.response_branches(
            pair, None, cycles, seeds=settling_speeds, back_side=back_side, seconds=budget, progress=tell
        )
    if as_json:
        names = ("jumps", "attractors", "gaps", "bifurcations", "open")
        lists = {name: getattr(branches, name) for name in names}
        about = {"gear_pair": pair.name, "supports": "springs", "speeds_rpm": list(branches.speeds_rpm)}
        print_json(about | lists | {"basins": _basins(branches)})
    else:
        _print(pair, branches)
    if not back_side and any(o.reaches_back_side for o in branches.at(operating_rpm(pair))):
        note("a motion at the operating speed is larger than the backlash: try --back-side.")

    def draw() -> Figure:
        from validation.plots.contact_loss import response_figure

        linear = lumped.speed_sweep(pair, np.linspace(*branches.speeds_rpm, _LINEAR_SPEEDS))
        return response_figure(branches.dataset, linear)

    files.write(branches.dataset, draw)


def _print(pair: GearPair, branches: ResponseBranches) -> None:
    def motion(rms: float, load: float, kind: str, n: int) -> str:
        if kind == "grows":
            return "grows beyond twice the backlash"
        motion_kind = {1: "", 0: f", {kind}"}.get(n, f", repeats after {n} cycles")
        return f"{quantity(rms, 'm', 3)} rms{motion_kind}; load {quantity(load, 'N', 3)}"

    rows = [
        (
            f"{number(jump.speed_rpm, 5)} rpm",
            "up" if jump.rising else "down",
            motion(jump.dte_rms, jump.largest_load, "does not repeat", jump.n),
            motion(jump.dte_rms_after, jump.largest_load_after, jump.after, jump.n_after),
        )
        for jump in branches.jumps
    ]
    if rows:
        show(f"{pair.name} on springs: jumps", "pinion speed | running | from | to", rows)
    lines = [] if rows else ["no jumps: one stable motion leads to the next"]
    if branches.open:
        lines = [] if rows else ["no jumps were found in the time"]
        ranges = ", ".join(f"{number(low, 5)} to {number(high, 5)} rpm" for low, high in branches.open)
        lines.append(f"the time left open: {ranges}; go on with a larger --budget or a smaller --range")
    if branches.contact_kept:
        runs = branches.response.runs
        looked = f"{runs} runs from far starts found no other" if runs else "no others were looked for"
        lines.append(f"contact is never lost in these motions; {looked}{'' if runs else ' (--seeds)'}")
    for low, high in branches.gaps:
        lines.append(f"{number(low, 5)} to {number(high, 5)} rpm: no stable motion of few cycles was found")
    lines += [one.text for one in branches.attractors]
    for basin in _basins(branches):
        least, most = (number(100.0 * share, 3) for share in basin.share_interval)
        lines.append(
            f"at the operating speed {number(100.0 * basin.share, 3)} % ({least} to {most} %) of the start "
            f"states lead to {motion(basin.dte_rms, basin.largest_load, basin.kind, basin.n)}"
        )
    for line in lines:
        stdout().print(line)


def _basins(branches: ResponseBranches) -> tuple[Basin, ...]:
    """Return the share of start states that lead to each motion at the operating speed.

    Empty where the operating speed is outside the range, or where only one motion exists.
    """
    from floquet.gear.axes import operating_rpm

    low, high = branches.speeds_rpm
    shares = branches.basins() if low <= operating_rpm(branches.pair) <= high else ()
    return shares if len(shares) > 1 else ()


def _map(pair: GearPair, axis: str, speeds: int, seeds: int, files: opt.Files, as_json: bool) -> None:
    """Map the jumps over speed and a second axis, and find which values of this axis remove the jumps."""
    import numpy as np

    import floquet
    from floquet.gear.axes import speed_range

    name, values = _axis(axis, pair)
    axes = {"speed_rpm": np.linspace(*speed_range(pair), speeds), name: values}
    with progress_bar("jump map") as tell:
        jump_map = floquet.jump_map(pair, axes, seeds=seeds, progress=tell)
    with progress_bar("what removes jumps") as tell:
        branches = floquet.response_branches(pair, periods=(1, 2), seeds=0, progress=tell)
        removed = floquet.jumps_removed_by(branches, name)
    jumps = jump_map.drop_dims([name, "speed_rpm"]).to_dataframe()
    jumps = jumps.rename(columns=lambda column: column.removeprefix("jump_"))
    files.write(jump_map)
    if as_json:
        about = {"gear_pair": pair.name, "supports": "springs", "axis": name, "values": values.tolist()}
        print_json(about | {"jumps": jumps.to_dict("records"), "removed_by": removed})
        return
    unit = jump_map[name].attrs["units"].removeprefix("1")
    share_of_several = (jump_map["motions"] > 1).mean("speed_rpm").to_series()
    rows = []
    for value, share in share_of_several.items():
        jumps_at_value = jumps[jumps[name] == value].groupby(jumps["rising"].astype(bool))["speed_rpm"]
        speeds_by_direction = {
            rising: ", ".join(number(rpm, 5) for rpm in speeds) for rising, speeds in jumps_at_value
        }
        rows.append(
            (
                value,
                speeds_by_direction.get(True, ""),
                speeds_by_direction.get(False, ""),
                f"{100.0 * share:.0f} %",
            )
        )
    axis_name = jump_map[name].attrs["long_name"]
    title = f"{pair.name} on springs: jumps over {axis_name}; share of speeds with several motions"
    show(title, f">{name}{unit and f' [{unit}]'} | up at [rpm] | down at [rpm] | >share", rows)
    if not removed:
        stdout().print("the pair itself has no folds: nothing is to be removed")
    for one in removed:
        jumps_left = (
            f"{one.direction} {name}, up to {number(one.limit, 3)} {unit}".rstrip() + ": jumps are left"
        )
        no_jumps_left = f"no jumps are left from {name} = {number(one.value, 4)} {unit}".rstrip()
        stdout().print(f"{no_jumps_left} on ({one.direction} values)" if one.found else jumps_left)


def _axis(text: str, pair: GearPair) -> tuple[str, NDArray[np.float64]]:
    """Return name and values of the second axis of a map."""
    import numpy as np

    from floquet.gear.jumps import JUMP_AXES, checked_axis, search_range

    name = text.partition("=")[0].strip()
    checked_axis(pair, name, "--map")
    if "=" in text:
        return opt.axis_values(text, JUMP_AXES, "--map")
    pair_value = float(JUMP_AXES[name].own(pair))
    return name, np.linspace(*search_range(name, pair_value), _VALUES)
