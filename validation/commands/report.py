"""spurcheck report: the verification report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.commands import options as opt
from validation.commands.kernels import compiling
from validation.commands.terminal import FAILED, guarded, progress_bar, stderr, stdout

if TYPE_CHECKING:
    from collections.abc import Sequence

    from validation.reporting.gate import Comparison
    from validation.reporting.page_one import Number

#: Changes listed in the terminal.
_MOST = 30
#: Exit code where a finding about the machine is one that ``--require`` forbids.
_FOUND = 4


@guarded
def report(
    pair: opt.NamedPair,
    output: Annotated[Path, opt.output("Folder to write, new or empty.")] = Path("spurcheck-report"),
    quick: bool = False,
    require: list[str] | None = None,
    record: Path | None = None,
    compare: Path | None = None,
    tolerance: str = "0.1%",
    supports: opt.SupportsName | None = None,
    force: opt.ForceFolder = False,
) -> None:
    """Write the verification report of a gear pair.

    One folder: index.html (opens in any browser, without network), report.json (every number), figures
    (SVG), tables (CSV and one workbook) and data (NetCDF). It says what the model predicts, how sure that is,
    whether a second program agrees, whether the motion is stable, and what to do next. The exit code is 1 if
    a check of the program fails.

    [bold]Examples[/bold]
    spurcheck report -o report
    spurcheck report my_pair.toml --speed "3000 rpm" --torque "500 lbf*in" --range 200..6000 -o report_3000
    spurcheck report my_pair.toml -o new --compare old/report.json --tolerance 0.01 --require contact

    Parameters
    ----------
    quick : Coarser sampling, inputs not varied, for a first look.
    require : Exit 4 unless the model holds, the motion is stable, or contact is kept: holds, stable, contact.
    record TOML : Description of a measured transmission error at this speed and torque, to compare with.
    compare OLD : report.json of an earlier report, or its folder: show changes, exit 1 past tolerances.
    tolerance : With --compare: relative change of a number that passes: 1%.
    supports : springs: leave shafts out. Default: shafts where they are given.
    """
    from lumped.arguments import some_of
    from lumped.shafts.pair import supported_shafts
    from validation.files.folder import check_target
    from validation.reporting import report as write

    required = some_of("--require", require or (), ("holds", "stable", "contact"))
    check_target(output, force=force)
    name, gear_pair = pair
    if supports == "shafts":
        supported_shafts(gear_pair)  # refuses a pair that has none
    if supports == "springs" and gear_pair.shafts is not None:
        gear_pair = gear_pair.with_(shafts=None)
    with progress_bar("report") as bar, compiling(bar) as tell:
        written = write(
            gear_pair,
            output,
            force=force,
            quick=quick,
            record=record,
            compare=compare,
            tolerance=opt.number_in("--tolerance", tolerance, "1"),
            name=name,
            progress=tell,
            early=_show_early,
        )
    console, first = stdout(), written.first
    console.print(first.title)
    console.print(f"{first.headline} {first.reason}".strip(), style="bold")
    for number in first.numbers:
        note = f"  ({number.note})" if number.note else ""
        console.print(f"  {number.label}: {number.shown}{f', {number.range}' if number.range else ''}{note}")
    for action in first.actions:
        console.print(f"next: {action.text}{f': {action.command}' if action.command else ''}")
    console.print(f"\nreport: {written.folder / 'index.html'} ({written.seconds:.0f} s)")
    if written.comparison is not None:
        _show_changes(written.comparison)
    for line in written.failed:
        console.print(f"fails: {line}")
    if written.failed or (written.comparison is not None and written.comparison.regressions):
        raise typer.Exit(FAILED)
    if missed := sorted(written.findings & set(required)):
        console.print(f"--require is not met: {', '.join(missed)}")
        raise typer.Exit(_FOUND)


def _show_early(title: str, numbers: Sequence[Number]) -> None:
    """Print what is known before the range of the inputs, the second program and the charts."""
    console = stderr()
    console.print(f"{title}\nFirst result, with the inputs as given:")
    for number in numbers:
        console.print(f"  {number.label}: {number.shown}")


def _show_changes(comparison: Comparison) -> None:
    console = stdout()
    console.print(
        f"\n{comparison.compared} values compared with the earlier report of {comparison.old_name}: "
        f"{len(comparison.changes)} changed, {len(comparison.regressions)} past tolerance"
    )
    for change in comparison.changes[:_MOST]:
        mark = "past tolerance" if change.fails else "within"
        console.print(f"  {mark}  {change}", style="red" if change.fails else None)
    if len(comparison.changes) > _MOST:
        console.print(f"  and {len(comparison.changes) - _MOST} more")
