"""spurcheck sweep: many cases of one pair, in parallel, resumable."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.commands import options as opt
from validation.commands.terminal import (
    FAILED,
    INTERRUPTED,
    fail,
    guarded,
    progress_bar,
    show,
    stderr,
    stdout,
)

if TYPE_CHECKING:
    from validation.studies import Study


@guarded
def sweep(
    study: Path,
    output: Annotated[
        Path | None, opt.output("Output folder; default: the study file's name + '-sweep'.")
    ] = None,
    resume: bool = False,
    retry_failed: bool = False,
    workers: int | None = None,
    case_seconds: float | None = None,
    dry_run: bool = False,
) -> None:
    """Compute every case of a study: a grid or samples of any parameters, one analysis per case.

    Every computed case is stored at once. After a kill or a full disk the same command with --resume
    continues and gives the same result. A failed case is recorded and the sweep goes on. The results
    are results.nc in the output folder (NetCDF, over the axes of the study).

    The exit code is 1 when a case failed, 3 when the store or the workers failed, 130 when interrupted.

    [bold]Examples[/bold]
    spurcheck sweep study.toml --workers 8
    spurcheck sweep study.toml --resume

    Parameters
    ----------
    study STUDY : Study file (TOML).
    resume : Go on where an earlier run in that folder ended.
    retry_failed : With --resume: compute the failed cases again.
    workers : Worker processes; default: one per core. 0: this process, where a crash ends the sweep.
    case_seconds : Longest time of a case in seconds on this machine; a longer one is ended and recorded.
    dry_run : Check the study, count its cases, estimate the time.
    """
    from lumped.cache import cores
    from validation.studies import load_study, run_sweep

    # The folder's name never comes from inside the file.
    folder = output if output is not None else Path(f"{study.stem}-sweep")
    loaded_study = load_study(study)
    processes = cores() if workers is None else workers
    description = f"{loaded_study.count} cases, {loaded_study.analysis}, on {processes} worker(s)"
    stderr().print(f"{loaded_study.name}: {description} -> {folder}")
    if dry_run:
        _estimate(loaded_study, processes)
        return
    with progress_bar("sweep") as tell:

        def progress(done: int, total: int, failed: int) -> None:
            tell(done / total, f"{done} of {total} cases, {failed} failed")

        try:
            summary = run_sweep(
                loaded_study,
                folder,
                workers=processes,
                resume=resume,
                retry_failed=retry_failed,
                case_seconds=case_seconds,
                progress=progress,
            )
        except KeyboardInterrupt:
            fail(f"Stopped; what was computed is in {folder}: run the command with --resume.", INTERRUPTED)
    show("", "status | >cases", ((s.name.lower().replace("_", " "), str(n)) for s, n in summary.statuses))
    console = stdout()
    for case, text in summary.failures:
        console.print(f"case {case}: {text.partition(chr(10))[0]}", style="red")
    if (more := summary.failed - len(summary.failures)) > 0:
        console.print(f"... and {more} more: see status in the results")
    console.print(
        f"{summary.computed} computed, {summary.before} kept from before, in {summary.seconds:.3g} s "
        f"-> {summary.results}"
    )
    raise typer.Exit(FAILED if summary.failed else 0)


def _estimate(study: Study, processes: int) -> None:
    """Print the estimated time of a sweep.

    Three cases are timed. One case is computed before them, because the first case may compile.
    """
    from validation.studies.cases import CaseList, StudyEvaluator
    from validation.studies.workers import evaluate_chunk

    cases = CaseList(study)
    evaluator = StudyEvaluator.of(study)
    numbers = [study.count // 2, 0, study.count // 3, study.count - 1]
    values = cases.values(numbers)
    evaluate_chunk(evaluator, numbers[:1], values[:1])
    seconds = evaluate_chunk(evaluator, numbers[1:], values[1:]).seconds / 3.0
    hours = seconds * study.count / max(processes, 1) / 3600.0
    stderr().print(f"about {seconds:.2g} s a case, {hours:.2g} hours in all on {max(processes, 1)} worker(s)")
