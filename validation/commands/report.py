"""spurcheck report: the verification report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from validation.commands import options as opt
from validation.commands.terminal import guarded, progress_bar, stdout


@guarded
def report(
    pair: opt.PairArgument = opt.DEFAULT_PAIR,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder to write, new or empty.")] = Path(
        "spurcheck-report"
    ),
    quick: Annotated[
        bool, typer.Option("--quick", help="Coarser sampling and no verification, for a first look.")
    ] = False,
    paper: Annotated[
        bool | None,
        typer.Option(
            "--paper/--no-paper",
            help="Compare with the paper (default, unless --quick): figures, claims, errata.",
        ),
    ] = None,
    speed: opt.Speed = None,
    torque: opt.Torque = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an earlier report in that folder.")] = False,
) -> None:
    """Write the verification report of a gear pair.

    One folder: index.html (opens in any browser, without network), report.json (every number), figures (PNG
    and SVG) and data (NetCDF). It says what the lumped model predicts, whether the multibody model agrees,
    whether the motion is stable over speed, and where the model stops being valid.

    [bold]Examples[/bold]

    spurcheck report -o report

    spurcheck report my_pair.toml --speed "3000 rpm" --torque "500 lbf*in" -o report_3000
    """
    from validation.reporting import report as write
    from validation.reporting.folder import check_target

    check_target(output, force=force)
    gear_pair = opt.gear_pair(pair, speed, torque, law, settings)
    with progress_bar("report") as tell:
        written = write(gear_pair, output, force=force, quick=quick, paper=paper, progress=tell)
    console = stdout()
    console.print(written.sentence, soft_wrap=True)
    console.print(f"\nreport: {written.folder / 'index.html'} ({written.seconds:.0f} s)", soft_wrap=True)
