"""spurcheck crosscheck: the lumped model against the multibody model."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import typer

from validation.commands import options as opt
from validation.commands.kernels import compiling
from validation.commands.terminal import FAILED, guarded, print_json, progress_bar, show, stdout
from validation.files.formatting import number

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.figure import Figure
    from rich.text import Text

    from validation.cross_check.comparison import CrossCheck
    from validation.cross_check.verdict import Judgement

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
    from validation.cross_check.conservation import worst_of_each
    from validation.cross_check.verdict import Verdict
    from validation.cross_check.words import MEASURES, NAMES, cause_of_difference, failed_checks
    from validation.cross_check.words import whole_difference as whole

    console, name, verdict = stdout(), check.pair.name, check.verdict
    for fidelity, title in (("linear", "same equations"), ("exact", "exact contact")):
        compared = check.of(fidelity)  # type: ignore[arg-type]
        rows = ((NAMES[a.quantity], *_limited(a.difference, a.limit, a.within, 3)) for a in compared)
        show(f"{name}: {title}", "quantity | >difference | >limit | verdict", rows)
    _judged(f"{name}: conservation", worst_of_each(check.conservation))
    if (variant := check.variant) is not None:
        teeth = f"{variant.pair.pinion.teeth}/{variant.pair.gear.teeth} teeth, four unlike bearings"
        worst = max(variant.conservation, key=lambda one: one.value / one.limit)
        _judged(f"{name}: asymmetric variant, {teeth}", (variant.worst("linear").judgement, worst))
    console.print(MEASURES)
    if check.pulling:
        console.print(check.pulling)
    console.print(f"[bold]{verdict}[/bold]: {verdict.text}.", markup=True)
    if verdict is Verdict.FAILS:
        console.print(f"{failed_checks(check)}.")
    elif verdict is not Verdict.NOT_CHECKED:
        cause = cause_of_difference(check) if verdict is Verdict.DIFFERS else ""
        console.print(f"{whole(check)} {cause}".rstrip())


def _judged(title: str, checks: Iterable[Judgement]) -> None:
    rows = ((one.check, *_limited(one.value, one.limit, one.within, 2)) for one in checks)
    show(title, "check | >value | >limit | verdict", rows)


def _limited(value: float, limit: float, within: bool, digits: int) -> tuple[str, str, Text]:
    from rich.text import Text

    word = Text("within", "green") if within else Text("outside", "red")
    return number(value, digits), number(limit, digits), word


def _figure(check: CrossCheck) -> Figure:
    from validation.cross_check.agreement import off_switch_samples
    from validation.plots.motion import cross_check_figure

    keep = off_switch_samples(check.pair, check.lumped["time"].to_numpy())
    models = {str(fidelity): result for fidelity, result in check.multibody.items()}
    return cross_check_figure(check.pair.geometry, check.lumped, models, keep)
