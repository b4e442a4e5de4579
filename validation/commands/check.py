"""spurcheck check: curves of another model, or a record, beside both programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.commands import options as opt
from validation.commands.terminal import guarded, note, print_json, progress_bar, show, stdout

if TYPE_CHECKING:
    from validation.check.check import Check

#: Exit code where the curves do not agree.
_DIFFERS = 4

Theirs = Annotated[
    str | None,
    typer.Argument(
        metavar="THEIRS",
        help="Curves of the other model: .csv, .xlsx, .mat, .nc, .npz, a .toml that describes a record, "
        ".fmu, or model.py:function.",
        show_default=False,
    ),
]


@guarded
def check(
    pair: opt.Pair,
    theirs: Theirs = None,
    output: Annotated[Path | None, opt.output("Folder of the page to write, new or empty.")] = None,
    limit: str = "5%",
    explain: Annotated[
        bool, typer.Option("--explain/--no-explain", help="Search what would explain a difference.")
    ] = True,
    budget: float = 60.0,
    phase: float | None = None,
    supports: opt.Supports = None,
    as_json: opt.Json = False,
    force: opt.ForceFolder = False,
) -> None:
    """Say whether a model of your own is right, and if not, what in it may be wrong.

    The curves of your model, or of a record, are compared with both programs: first what does not move, then
    the transmission error at low speed, then the motion, channel by channel. Where they differ, named changes
    are tried until the difference is gone. The exit code is 0 if the curves agree, 4 if they do not.

    Columns bear the names of results: time, dte, x_p, mesh_force, bearing_force_x_p; a unit stands in
    brackets.

    [bold]Examples[/bold]
    spurcheck check mypair.toml theirs.csv
    spurcheck check mypair.toml theirs.mat -o check --limit 3%
    spurcheck check mypair.toml my_model.py:simulate --speed 1450

    Parameters
    ----------
    limit : Largest misfit at which the curves count as equal.
    budget : Processor time of the search for explanations, in seconds.
    phase : Mesh cycles from the moment a tooth pair enters at point A to the first sample; default: the shift
        at which the curves agree best.
    """
    from lumped.errors import refuse
    from validation.check import check as run
    from validation.files.folder import check_target

    if theirs is None:
        action = "For example: spurcheck check mypair.toml theirs.csv."
        raise refuse("THEIRS", "missing", "the curves of your model", action)
    if output is not None:
        check_target(output, force=force)
    with progress_bar("check") as tell:
        result = run(
            pair,
            theirs,
            limit=opt.number_in("--limit", limit, "1"),
            explain=explain,
            budget=budget,
            phase=phase,
            supports=supports,
            progress=tell,
        )
    if as_json:
        print_json(_as_json(result))
    else:
        _show(result)
    for remark in result.remarks:
        note(remark)
    if output is not None:
        from validation.reporting.check_page import write_check

        folder = write_check(result, output, force=force)
        stdout().print(f"page: {folder / 'index.html'}")
    if not result.agrees:
        raise typer.Exit(_DIFFERS)


def _show(result: Check) -> None:
    """Print the verdict, the channels, and the steps of the ladder."""
    from validation.check.words import percent
    from validation.files.formatting import quantity
    from validation.reporting.check_content import peaks_words

    console = stdout()
    console.print(result.words, style="bold")
    if result.problem is not None:
        headings = "channel | >theirs, peak to peak | >spurcheck | >misfit | "
        show(peaks_words(result), headings, _channel_rows(result))
        means = _mean_rows(result)
        if means:
            show("", "channel | >theirs | >spurcheck | >difference over the static value", means)
    if result.over_speed is not None:
        from validation.reporting.check_content import speed_rows

        columns = [
            (
                row.name,
                percent(row.misfit),
                f"{row.rpm:.0f} rpm",
                quantity(row.theirs, row.unit, 4),
                quantity(row.ours, row.unit, 4),
                "agrees" if row.misfit <= result.limit else "differs",
            )
            for row in speed_rows(result.over_speed)
        ]
        show("", "column | >misfit | >worst speed | >theirs there | >spurcheck there | ", columns)
    if result.static.rows:
        rows = [
            (
                row.name,
                quantity(row.theirs, row.unit, 4),
                quantity(row.ours, row.unit, 4),
                f"{100.0 * row.difference:.2g} %",
                "agrees" if row.agrees else "differs",
            )
            for row in result.static.rows
        ]
        show("", "static quantity | >theirs | >spurcheck | >difference | ", rows)
    if result.ladder is not None and result.explanations:
        steps = [("", "spurcheck as the parameter file says", percent(result.ladder.start))]
        for number, step in enumerate(result.explanations, start=1):
            steps.append((str(number), step.sentence, percent(step.misfit)))
            steps += [("", f"or: {other.sentence}", percent(other.misfit)) for other in step.alternatives]
        alone = result.ladder.others_alone
        steps += [("", f"alone: {other.sentence}", percent(other.misfit)) for other in alone]
        show("", "step | compatible with | >misfit then", steps)


def _channel_rows(result: Check) -> list[tuple[str, ...]]:
    """Rows of the channels: peaks to peak, misfit and verdict."""
    from validation.check.samples import peaks_to_peak
    from validation.check.words import percent
    from validation.files.formatting import quantity

    assert result.problem is not None
    rows: list[tuple[str, ...]] = []
    for row in result.nearer.channels:
        unit = row.channel.channel.kind.unit
        peaks = peaks_to_peak(result.problem, row)
        rows.append(
            (
                row.channel.channel.name,
                quantity(peaks.theirs, unit, 4),
                quantity(peaks.ours, unit, 4),
                percent(row.total),
                "agrees" if row.total <= result.limit else "differs",
            )
        )
    return rows


def _mean_rows(result: Check) -> list[tuple[str, ...]]:
    """Rows of the channels whose means differ by more than the limit: both means, and the difference."""
    from validation.check.words import percent
    from validation.files.formatting import quantity

    return [
        (
            f"{row.channel.channel.name}, mean",
            quantity(row.channel.orders.mean, row.channel.channel.kind.unit, 4),
            quantity(row.ours.mean, row.channel.channel.kind.unit, 4),
            percent(row.mean),
        )
        for row in result.nearer.channels
        if row.mean > result.limit
    ]


def _as_json(result: Check) -> dict[str, Any]:
    """The numbers of a check."""
    from validation.reporting.check_content import parts_of
    from validation.reporting.check_page import document

    return document(result, parts_of(result))
