"""spurcheck crosscheck: the lumped model against the multibody model."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.commands import options as opt
from validation.commands.terminal import FAILED, guarded, progress_bar, stderr, stdout, table

if TYPE_CHECKING:
    from validation.cross_check.agreement import Agreement
    from validation.cross_check.comparison import CrossCheck

_SUFFIXES = (".json", ".png", ".svg")


@guarded
def crosscheck(
    pair: opt.PairArgument = opt.DEFAULT_PAIR,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="All metrics as .json, or the transmission errors as .png or .svg; with --grid the dataset "
            "as .nc or .csv, or the heat map as .png or .svg.",
        ),
    ] = None,
    grid: Annotated[
        bool,
        typer.Option(
            "--grid",
            help="Compare over all presets, friction laws, stiffness models, three speeds and two torques "
            "instead of one pair; takes minutes.",
        ),
    ] = False,
    checkpoint: Annotated[
        Path | None,
        typer.Option(
            help="With --grid: a folder that keeps every finished part, so that the same command goes on "
            "after an interruption.",
        ),
    ] = None,
    cycles: Annotated[int, typer.Option(help="Mesh cycles to run.")] = 40,
    samples: Annotated[int, typer.Option(help="Output times per mesh cycle.")] = 256,
    strict: Annotated[bool, typer.Option("--strict", help="Also fail on 'bounded'.")] = False,
    speed: opt.Speed = None,
    torque: opt.Torque = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    force: opt.Force = False,
) -> None:
    """Check the lumped model against the independent multibody model.

    At fidelity linear both models hold the same equations and must agree to integration error. At fidelity
    exact the gears turn through finite angles with true involute contact; the difference shows what the
    lumped model leaves out.

    Verdicts: [bold]confirmed[/bold], both within their tolerances; [bold]bounded[/bold], the equations agree
    but finite motions do more than expected; [bold]not confirmed[/bold]: exit code 1.

    [bold]Examples[/bold]

    spurcheck crosscheck

    spurcheck crosscheck my_pair.toml --speed 4000 --strict -o agreement.json

    spurcheck crosscheck --grid -o grid.nc --checkpoint grid
    """
    if grid:
        from validation.commands.crosscheck_grid import crosscheck_grid

        given = {"PAIR": pair != opt.DEFAULT_PAIR, "--speed": speed, "--torque": torque, "--law": law}
        crosscheck_grid(
            output, checkpoint, [k for k, v in (given | {"--set": settings}).items() if v], strict, force
        )
        return
    from rich.text import Text

    from lumped.errors import refuse
    from validation.cross_check.agreement import MEANINGS
    from validation.cross_check.comparison import crosscheck as run
    from validation.files.output import check_file
    from validation.reporting.formatting import number

    if checkpoint is not None:
        raise refuse("--checkpoint", checkpoint, "only with --grid", "One pair takes seconds: leave it out.")
    target = None if output is None else check_file(output, _SUFFIXES, force=force)
    gear_pair = opt.gear_pair(pair, speed, torque, law, settings)
    with progress_bar("cross-check") as tell:
        check = run(gear_pair, cycles=cycles, samples_per_cycle=samples, progress=tell)
    shown = table(
        f"{gear_pair.name}: multibody against lumped",
        "quantity",
        "multibody",
        "metric",
        ">value",
        ">tolerance",
        "verdict",
    )
    shown.columns[0].no_wrap = True
    words = {
        "maximum_over_span": "max/span",
        "remainder_l2": "left",
    }
    for a in check.agreements:
        verdict = Text("within", "green") if a.within else Text("outside", "red")
        limit = a.tolerance.limit
        metric = words[a.tolerance.metric]
        shown.add_row(a.quantity, a.fidelity, metric, number(a.judged, 3), number(limit, 3), verdict)
    console = stdout()
    console.print(shown)
    console.print("max/span: largest difference over the peak to peak of the lumped history", soft_wrap=True)
    console.print(
        "left: L2 norm of what is left of the difference, after what finite motions must change (predicted "
        "from the lumped model alone) is taken off, over that of the lumped history",
        soft_wrap=True,
    )
    if check.finite_motion is not None and not check.finite_motion.settled:
        console.print(
            "Friction may hold the teeth at zero sliding: the effect of the actual sliding velocity is not "
            "predicted.",
            soft_wrap=True,
        )
    console.print(f"[bold]{check.verdict}[/bold]: {MEANINGS[check.verdict]}", markup=True, soft_wrap=True)
    if target is not None:
        _write(check, target)
        stderr().print(f"wrote {target}", soft_wrap=True)
    if check.verdict == "not confirmed" or (strict and check.verdict != "confirmed"):
        raise typer.Exit(FAILED)


def _write(check: CrossCheck, target: Path) -> None:
    from validation.cross_check.agreement import off_switch_samples
    from validation.files.output import write_text

    if target.suffix.lower() == ".json":
        data = {"verdict": check.verdict, "agreements": [_data(a) for a in check.agreements]}
        write_text(target, json.dumps(data, indent=1, allow_nan=False) + "\n")
        return
    from validation.plots.cross_check import cross_check_figure
    from validation.plots.style import save

    keep = off_switch_samples(check.pair, check.lumped["time"].to_numpy())
    models = {str(fidelity): result for fidelity, result in check.multibody.items()}
    save(cross_check_figure(check.pair.geometry, "dte", "m", check.lumped, models, keep), target)


def _data(agreement: Agreement) -> dict[str, Any]:
    from dataclasses import asdict

    return asdict(agreement) | {"judged": agreement.judged, "within": agreement.within}
