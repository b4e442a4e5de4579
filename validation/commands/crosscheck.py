"""spurcheck crosscheck: the lumped model against the multibody model."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import typer

from validation.commands import options as opt
from validation.commands.kernels import compiling
from validation.commands.terminal import FAILED, guarded, print_json, progress_bar, stdout, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.table import Table
    from rich.text import Text

    from validation.cross_check.comparison import CrossCheck

#: Exit code where the multibody model has another motion: a finding about the lumped model.
DIFFERS = 4


@guarded
def crosscheck(
    pair: opt.Pair,
    files: opt.FigureFiles,
    limit: str = "5%",
    cycles: int = 40,
    samples: int = 256,
    as_json: opt.Json = False,
) -> None:
    """Check the lumped model against the independent multibody model.

    At fidelity linear both models hold the same equations and must agree to integration error, and both must
    satisfy conservation laws. At fidelity exact the gears turn through finite angles with true involute
    contact; the difference shows what the lumped model leaves out. Teeth that differ are compared over a
    revolution, or round the tooth that carries most.

    Exit codes: 0 [bold]agrees[/bold], every difference is within its limit; 4 [bold]differs[/bold], one is
    not; 1 [bold]fails[/bold], the program is not in order; 0 [bold]not checked[/bold], the multibody model
    has no periodic motion to compare.

    [bold]Examples[/bold]
    spurcheck crosscheck
    spurcheck crosscheck my_pair.toml --speed 4000 --limit 2% -o agreement.png

    Parameters
    ----------
    limit : Largest difference that agrees, over the peak to peak, of the transmission error, tooth load and
        motions along the line of action; of what friction drives it is 20%.
    cycles : Mesh cycles to run.
    samples : Output times per mesh cycle.
    """
    from validation.cross_check.comparison import crosscheck as run
    from validation.cross_check.verdict import Verdict

    share = opt.number_in("--limit", limit, "1")
    with progress_bar("cross-check") as bar, compiling(bar) as tell:
        check = run(pair, cycles=cycles, samples_per_cycle=samples, limit=share, progress=tell)
    if as_json:
        agreements = [asdict(one) | {"within": one.within} for one in check.agreements]
        print_json({"verdict": check.verdict.word, "failures": check.failures, "agreements": agreements})
    else:
        _print(check)
    files.write(check.lumped, lambda: _figure(check))
    code = {Verdict.FAILS: FAILED, Verdict.DIFFERS: DIFFERS}.get(check.verdict, 0)
    if code:
        raise typer.Exit(code)


def _print(check: CrossCheck) -> None:
    from validation.cross_check.verdict import Verdict
    from validation.cross_check.words import MEASURES, cause_of_difference, failed_checks, whole_difference

    console = stdout()
    for shown in _tables(check):
        console.print(shown)
    console.print(MEASURES, soft_wrap=True)
    if check.pulling:
        console.print(check.pulling, soft_wrap=True)
    cause = cause_of_difference(check) if check.verdict is Verdict.DIFFERS else ""
    told = {
        Verdict.FAILS: f"{failed_checks(check)}.",
        Verdict.DIFFERS: f"{whole_difference(check)} {cause}".rstrip(),
        Verdict.AGREES: whole_difference(check),
    }.get(check.verdict, "")
    verdict = check.verdict
    console.print(f"[bold]{verdict}[/bold]: {verdict.text}.", markup=True, soft_wrap=True)
    if told:
        console.print(told, soft_wrap=True)


def _figure(check: CrossCheck) -> Figure:
    from validation.cross_check.agreement import off_switch_samples
    from validation.plots.motion import cross_check_figure

    keep = off_switch_samples(check.pair, check.lumped["time"].to_numpy())
    models = {str(fidelity): result for fidelity, result in check.multibody.items()}
    return cross_check_figure(check.pair.geometry, check.lumped, models, keep)


def _tables(check: CrossCheck) -> list[Table]:
    from validation.cross_check.conservation import worst_of_each
    from validation.cross_check.words import NAMES
    from validation.files.formatting import number

    name, found = check.pair.name, []
    for fidelity, title in (("linear", "same equations"), ("exact", "exact contact")):
        shown = table(f"{name}: {title}", "quantity", ">difference", ">limit", "verdict")
        for a in check.of(fidelity):  # type: ignore[arg-type]
            shown.add_row(NAMES[a.quantity], number(a.difference, 3), number(a.limit, 3), _word(a.within))
        found.append(shown)
    judged = [(f"{name}: conservation", worst_of_each(check.conservation))]
    if check.variant is not None:
        g = check.variant.pair
        title = f"{name}: asymmetric variant, {g.pinion.teeth}/{g.gear.teeth} teeth, four unlike bearings"
        worst = max(check.variant.conservation, key=lambda one: one.value / one.limit)
        judged.append((title, (check.variant.worst("linear").judgement, worst)))
    for title, checks in judged:
        shown = table(title, "check", ">value", ">limit", "verdict")
        for one in checks:
            shown.add_row(one.check, number(one.value, 2), number(one.limit, 2), _word(one.within))
        found.append(shown)
    return found


def _word(within: bool) -> Text:
    from rich.text import Text

    return Text("within", "green") if within else Text("outside", "red")
