"""spurcheck crosscheck --grid: the regression grid of both models."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from validation.commands import options as opt
from validation.commands.terminal import conclude, progress_bar, stdout, table

if TYPE_CHECKING:
    import xarray as xr

    from validation.cross_check.grid.summary import GridSummary


def crosscheck_grid(
    output: Path | None, checkpoint: Path | None, given: list[str], strict: bool, force: bool
) -> None:
    """Run the grid, print its table and the cause of the worst point, write the dataset or the heat map.

    Parameters
    ----------
    output : file to write
    checkpoint : folder that keeps finished parts
    given : options that name one pair and have no meaning here
    strict : also fail on "explained"
    force : overwrite
    """
    from lumped.errors import refuse
    from validation.cross_check.grid.run import Grid
    from validation.cross_check.grid.run import crosscheck_grid as run
    from validation.cross_check.grid.summary import explain, failures, outside_tolerance, summarise_grid
    from validation.plots.grid import grid_figure

    if given:
        raise refuse("--grid", " ".join(given), "no options of a single pair", "The grid covers all presets.")
    target = opt.figure_or_data(output, force=force)
    with progress_bar("grid") as tell:
        result = run(checkpoint=checkpoint, progress=lambda f, _="": tell(0.95 * f))
        found = summarise_grid(result)
        causes = None
        if found.worst:
            causes = explain(Grid(), found.worst, lambda f, _="": tell(0.95 + 0.05 * f, "worst point"))
    if target is not None:
        opt.write_result(target, result, lambda: grid_figure(result))
    console = stdout()
    console.print(_tables(result))
    for line in _sentences(found, result):
        console.print(line, soft_wrap=True)
    for o in outside_tolerance(result):
        text = f"{o.quantity} left {o.left:.2g} of {o.whole:.2g}, limit {o.limit:.2g}"
        console.print(f"outside at {_named(o.point)}: {text}", soft_wrap=True, markup=False)
    for point, reason in failures(result):
        console.print(f"failed at {_named(point)}: {reason}", soft_wrap=True, markup=False)
    if causes is not None:
        _explain(found, causes)
    conclude(found.verdict, target, strict=strict)


def _tables(result: xr.Dataset) -> object:
    from rich.console import Group

    from validation.cross_check.grid.run import COMPARED, SEPARATED, STICKING
    from validation.cross_check.grid.summary import law_of_torque
    from validation.reporting.formatting import number

    # A table a pair, narrow enough for a terminal of 80 columns.
    tables = []
    for preset in result["preset"].to_numpy():
        shown = table(
            f"{preset}: points judged, separate, held by friction, failed",
            "stiffness",
            ">points",
            ">linear,\nof limit",
            ">exact\nDTE",
            ">of it\nleft",
            ">left,\nof limit",
            ">torque\nlaw off",
        )
        for stiffness in result["stiffness"].to_numpy():
            part = result.sel(preset=preset, stiffness=stiffness)
            status = part["status"]
            counts = [int((status == state).sum()) for state in (COMPARED, SEPARATED, STICKING)]
            usage, judged = part["difference"] / part["limit"], status == COMPARED
            exact = part.sel(fidelity="exact", quantity="dte").where(judged)
            used = usage.sel(fidelity="exact").where(judged).max()
            departure = abs(law_of_torque(part) - 1.0).max()
            shown.add_row(
                str(stiffness),
                " ".join(map(str, [*counts, status.size - sum(counts)])),
                number(float(usage.sel(fidelity="linear").max()), 2),
                number(float(exact["total"].max()), 2),
                f"{float(exact['difference'].max()):.1e}",
                number(float(used), 2),
                number(float(departure), 2),
            )
        tables.append(shown)
    return Group(*tables)


def _sentences(found: GridSummary, result: xr.Dataset) -> list[str]:
    from validation.cross_check.grid.run import SCALING_TOLERANCE

    seconds, workers, resumed = (result.attrs[name] for name in ("seconds", "workers", "resumed"))
    kept = f" ({resumed} points kept from before)" if resumed else ""
    return [
        f"{found.points} points in {seconds:.0f} s on {workers} processes{kept}, "
        f"{float(result['seconds'].sum()):.0f} s of processor time: {found.compared} judged, {found.parted} "
        f"of them with loss of contact; not judged: {found.separated} where teeth that part have no stable "
        f"motion of one mesh cycle, and at fidelity exact {found.sticking} where friction may hold the "
        f"teeth; {found.failed} failed.",
        f"Linear: at most {found.linear:.2g} of the tolerance, at the {found.compared + found.sticking} "
        "points where both models ran.",
        f"Exact: the transmission error differs by up to {found.whole:.2g} (relative L2); after what finite "
        f"motions must change, predicted from the lumped model alone, {found.left:.2g} is left. "
        f"{found.outside} judged points have a quantity outside its tolerance; the largest use is "
        f"{found.exact:.3g} times.",
        "Largest exact difference of the transmission error over its peak to peak: "
        f"{found.largest_judged:.3g} where judged, {found.largest:.3g} anywhere.",
        f"Law of torque at {found.scaled} points with constant friction coefficient and smooth stiffness: "
        "the fall of the difference with torque is off the expected one by at most "
        f"{100 * found.scaling:.2g} %; {100 * SCALING_TOLERANCE:g} % is allowed.",
    ]


def _explain(found: GridSummary, causes: xr.Dataset) -> None:
    from validation.reporting.formatting import number

    console = stdout()
    console.print(
        f"Worst: {_named(found.worst)}. What the difference of {number(found.largest, 3)} comes from:",
        soft_wrap=True,
    )
    shown = table("", "cause", ">alone", ">all but this")
    for cause in causes["cause"].to_numpy():
        at = causes.sel(cause=cause, quantity="dte")
        shown.add_row(str(cause), number(float(at["alone"]), 3), number(float(at["without"]), 3))
    console.print(shown)


def _named(point: Mapping[str, str | float]) -> str:
    return ", ".join(f"{axis} {value}" for axis, value in point.items())
