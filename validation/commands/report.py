"""spurcheck report, crosscheck: the verification report; comparison of the lumped and multibody models."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.commands import options as opt
from validation.commands.kernels import compiling, counted
from validation.commands.terminal import FAILED, guarded, print_json, progress_bar, show, stderr, stdout
from validation.files.formatting import number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from validation.cross_check.comparison import CrossCheck
    from validation.cross_check.verdict import Judgement
    from validation.reporting.first_numbers import Number
    from validation.reporting.gate import Comparison

#: Changes listed in the terminal.
_MOST = 30
#: Exit code of a finding: the machine does not meet ``--require``, or both models have different motions.
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
    supports: opt.Supports = None,
    force: opt.ForceFolder = False,
) -> None:
    """Write the verification report of a gear pair.

    One folder: index.html (opens in any browser, without network), report.json (every number), figures
    (SVG), tables (CSV and one workbook) and data (NetCDF). The report states the predicted motion, the
    uncertainty, the agreement of a second program, the stability of the motion, and the next steps. The exit
    code is 1 if a check of the program fails.

    [bold]Examples[/bold]
    spurcheck report -o report
    spurcheck report my_pair.toml --speed "3000 rpm" --torque "500 lbf*in" --range 200..6000 -o report_3000
    spurcheck report my_pair.toml -o new --compare old/report.json --tolerance 0.01 --require contact
    spurcheck report my_pair.toml --record run12.toml --require record

    Parameters
    ----------
    quick : Coarser sampling, inputs not varied, for a first look.
    require : Exit 4 unless the model holds, the motion is stable, contact is kept, or the record confirms the
        prediction: holds, stable, contact, record.
    record TOML : Description of a measured record at this speed and torque, to compare with.
    compare OLD : report.json of an earlier report, or its folder: show changes, exit 1 past tolerances.
    tolerance : With --compare: relative change of a number that passes: 1%.
    """
    from lumped.arguments import some_of
    from lumped.errors import refuse
    from validation.files.folder import check_target

    required = some_of("--require", require or (), ("holds", "stable", "contact", "record"))
    if "record" in required and record is None:
        raise refuse("--require", "record", "with a record", "Add --record FILE.")
    check_target(output, force=force)
    name, gear_pair = pair
    from validation.reporting.start import second_process

    with ExitStack() as opened:
        with progress_bar("loading", moving=False):  # the second process begins while there is one thread
            opened.enter_context(second_process())
        bar = opened.enter_context(progress_bar("report"))
        tell = opened.enter_context(counted(bar))
        tell(0.0, "loading")
        from validation.reporting import report as write  # the bar is there and the second process runs

        written = write(
            gear_pair,
            output,
            force=force,
            quick=quick,
            record=record,
            compare=compare,
            tolerance=opt.number_in("--tolerance", tolerance, "1"),
            name=name,
            supports=supports,
            progress=tell,
            early=_show_early,
        )
    console = stdout()
    first = written.first
    console.print(first.title)
    console.print(f"{first.headline} {first.reason}".strip(), style="bold")
    for row in first.numbers:
        note = f"  ({row.notes})" if row.notes else ""
        console.print(f"  {row.label}: {row.shown}{f', {row.range}' if row.range else ''}{note}")
    if written.record is not None:
        console.print(f"record: {written.record.verdict.text} {written.record.words}")
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
    """Print the first results, before the computation of uncertainty, second program and charts."""
    console = stderr()
    console.print(f"{title}\nFirst result, inputs as given:")
    for row in numbers:
        console.print(f"  {row.label}: {row.shown}")


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


@guarded
def crosscheck(
    pair: opt.Pair,
    files: opt.FigureFiles,
    limit: str = "5%",
    cycles: int = 40,
    samples: int = 256,
    supports: opt.Supports = None,
    as_json: opt.Json = False,
) -> None:
    """Check the lumped model against the independent multibody model.

    At fidelity linear both models hold the same equations and must agree to integration error, and both must
    satisfy conservation laws. At fidelity exact the gears turn through finite angles with true involute
    contact; the difference shows what the lumped model leaves out. Teeth that differ are compared over a
    revolution, or round the tooth that carries most. Both models are on the springs of 'bearings'; a pair
    with shafts needs --supports springs.

    Exit codes: 0 [bold]agrees[/bold], every difference is within its limit; 4 [bold]differs[/bold], one is
    not; 1 [bold]fails[/bold], the program is not in order; 0 [bold]not checked[/bold], the multibody model
    has no periodic motion to compare.

    [bold]Examples[/bold]
    spurcheck crosscheck
    spurcheck crosscheck my_pair.toml --speed 4000 --limit 2% -o agreement.png

    Parameters
    ----------
    limit : Largest difference that counts as agreement, as a share of the peak to peak. It holds for the
        transmission error, tooth load and motions along the line of action; motions by friction have 20%.
    cycles : Mesh cycles to run.
    samples : Output times per mesh cycle.
    """
    share = opt.number_in("--limit", limit, "1")
    with progress_bar("cross-check") as bar, compiling(bar) as tell:
        tell(0.0, "loading")
        from validation.cross_check.comparison import crosscheck as run
        from validation.cross_check.verdict import Verdict

        check = run(
            pair, cycles=cycles, samples_per_cycle=samples, limit=share, supports=supports, progress=tell
        )
    if as_json:
        agreements = [asdict(one) | {"within": one.within} for one in check.agreements]
        loss = None if check.loss is None else asdict(check.loss) | {"within": check.loss.within}
        results = {"failures": check.failures, "agreements": agreements, "loss": loss}
        print_json({"verdict": check.verdict.word, "supports": "springs", **results})
    else:
        _print(check)
    files.write(check.lumped, lambda: _figure(check))
    raise typer.Exit({Verdict.FAILS: FAILED, Verdict.DIFFERS: _FOUND}.get(check.verdict, 0))


def _print(check: CrossCheck) -> None:
    from rich.text import Text

    from validation.cross_check.conservation import worst_of_each
    from validation.cross_check.verdict import Verdict
    from validation.cross_check.words import (
        LOSS,
        MEASURES,
        NAMES,
        cause_of_difference,
        failed_checks,
        loss_difference,
    )
    from validation.cross_check.words import whole_difference as whole

    console = stdout()
    name = check.pair.name
    verdict = check.verdict
    loss = [] if check.loss is None else [(LOSS, check.loss.judgement)]
    judged: dict[str, list[tuple[str, Judgement]]] = {
        "same equations": [(NAMES[a.quantity], a.judgement) for a in check.of("linear")],
        "exact contact": [(NAMES[a.quantity], a.judgement) for a in check.of("exact")] + loss,
        "conservation": [(one.check, one) for one in worst_of_each(check.conservation)],
        "elasticity, which both models share, against second values": [
            (one.long_name, one.judgement) for one in check.stiffness
        ],
    }
    if (variant := check.variant) is not None:
        teeth = f"{variant.pair.pinion.teeth}/{variant.pair.gear.teeth}"
        worst = max(variant.conservation, key=lambda one: one.value / one.limit)
        both = (variant.worst("linear").judgement, worst)
        judged[f"asymmetric variant, {teeth} teeth, four unlike bearings"] = [(j.check, j) for j in both]
    for title, checks in judged.items():
        words = {True: Text("within", "green"), False: Text("outside", "red")}
        rows = ((what, number(j.value, 3), number(j.limit, 3), words[j.within]) for what, j in checks)
        show(f"{name} on springs: {title}", "check | >value | >limit | verdict", rows)
    console.print(MEASURES)
    if check.pulling:
        console.print(check.pulling)
    console.print(f"[bold]{verdict}[/bold]: {verdict.text}.", markup=True)
    if verdict is Verdict.FAILS:
        console.print(f"{failed_checks(check)}.")
    elif verdict is not Verdict.NOT_CHECKED:
        cause = "" if all(a.within for a in check.of("exact")) else cause_of_difference(check)
        console.print(" ".join(text for text in (whole(check), loss_difference(check), cause) if text))


def _figure(check: CrossCheck) -> Figure:
    from validation.cross_check.agreement import off_switch_samples
    from validation.plots.motion import cross_check_figure

    keep = off_switch_samples(check.pair, check.lumped["time"].to_numpy())
    models = {str(fidelity): result for fidelity, result in check.multibody.items()}
    return cross_check_figure(check.pair.geometry, check.lumped, models, keep)
