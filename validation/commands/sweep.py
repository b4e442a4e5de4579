"""spurcheck sweep: many cases of one pair, in parallel, resumable, here or on a cluster."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from validation.commands import options as opt
from validation.commands.terminal import INTERRUPTED, NUMERICAL, fail, guarded, stderr, stdout


@guarded
def sweep(
    study: Annotated[Path, typer.Argument(metavar="STUDY", help="Study file (TOML).")],
    output: Annotated[
        Path | None, opt.output("Output folder; default: the study file's name + '-sweep'.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on where an earlier run in that folder ended.")
    ] = False,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="With --resume: compute the failed cases again.")
    ] = False,
    workers: Annotated[
        int | None,
        typer.Option(
            "--workers",
            help="Worker processes of this machine; default: one per core. 0: this process itself, which "
            "starts faster, but a case that crashes ends the sweep.",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler", metavar="tcp://HOST:PORT", help="Run on the Dask cluster of this scheduler."
        ),
    ] = None,
    other_code: Annotated[
        bool, typer.Option("--other-code", help="With --resume: also when spurcheck was changed since.")
    ] = False,
    case_seconds: Annotated[
        float | None,
        typer.Option(
            "--case-seconds", help="Longest time of a case in seconds; a longer one is ended and recorded."
        ),
    ] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Check the study and count its cases.")] = False,
) -> None:
    """Compute every case of a study: a grid or samples of any parameters, one analysis per case.

    What is computed is kept at once: after a kill, a full disk or a lost cluster the same command with
    --resume goes on and gives the same result. A failed case is recorded and the sweep goes on. The results
    are results.nc in the output folder (NetCDF, over the axes of the study).

    The exit code is 1 when a case failed, 3 when the store or the workers failed, 130 when interrupted.

    [bold]Examples[/bold]

    spurcheck sweep study.toml --workers 8

    spurcheck sweep study.toml --resume

    spurcheck sweep study.toml --scheduler tcp://head:8786
    """
    from lumped.errors import ParameterError, SpurcheckError
    from validation.studies import load_study, run_sweep
    from validation.studies.cli_sweep import SweepProgress, cores, print_summary

    console = stderr()
    # The folder's name never comes from inside the file.
    folder = output if output is not None else Path(f"{study.stem}-sweep")
    wanted = load_study(study)
    processes = cores() if workers is None else workers
    where = f"on {scheduler}" if scheduler is not None else f"on {processes} worker(s)"
    text = f"{wanted.name}: {wanted.count} cases, {wanted.analysis}, {where} -> {folder}"
    console.print(text, soft_wrap=True)
    if dry_run:
        return
    try:
        with SweepProgress(console) as progress:
            summary = run_sweep(
                wanted,
                folder,
                workers=processes,
                scheduler=scheduler,
                resume=resume,
                retry_failed=retry_failed,
                other_code=other_code,
                case_seconds=case_seconds,
                progress=progress,
                tell=progress.tell,
            )
    except ParameterError:
        raise
    except SpurcheckError as error:  # storage or workers gone
        fail(str(error), NUMERICAL)
    except KeyboardInterrupt:
        fail(f"Stopped. What was computed is in {folder}; run the same command with --resume.", INTERRUPTED)
    try:
        print_summary(summary, stdout())
        sys.stdout.flush()
    except OSError as error:
        # Else what is left in the buffer fails again, and decides the exit code, when the process ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        fail(f"The results are whole, but what they are cannot be printed: {error.strerror}.", NUMERICAL)
    raise typer.Exit(summary.exit_code)
