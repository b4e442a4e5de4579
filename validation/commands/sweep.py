"""spurcheck sweep: many cases of one pair, in parallel, resumable."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from validation.commands import options as opt
from validation.commands.cluster import cluster_of
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
    from validation.studies.cluster import Cluster


@guarded
def sweep(
    study: Path,
    output: Annotated[
        Path | None, opt.output("Output folder; default: the study file's name + '-sweep'.")
    ] = None,
    resume: bool = False,
    retry_failed: bool = False,
    workers: int | None = None,
    cluster: opt.Cluster = None,
    wait_seconds: opt.WaitSeconds = None,
    case_seconds: float | None = None,
    dry_run: bool = False,
) -> None:
    """Compute every case of a study: a grid or samples of any parameters, one analysis per case.

    Every computed case is stored at once. After a kill or a full disk the same command with --resume
    continues and gives the same result. A failed case is recorded and the sweep goes on. The results
    are results.nc in the output folder (NetCDF, over the axes of the study).

    With --cluster the cases run on the workers of a Dask cluster. Workers that join later are used too, and
    the cases of a worker that is lost run on the others.

    The exit code is 1 when a case failed, 3 when the store or the workers failed, 130 when interrupted.

    [bold]Examples[/bold]
    spurcheck sweep study.toml --workers 8
    spurcheck sweep study.toml --resume
    spurcheck sweep study.toml --cluster tcp://head:8786
    spurcheck sweep study.toml --cluster local:8

    Parameters
    ----------
    study STUDY : Study file (TOML).
    resume : Go on where an earlier run in that folder ended.
    retry_failed : With --resume: compute the failed cases again.
    workers : Worker processes; default: one per core. 0: this process, where a crash ends the sweep.
    case_seconds : Longest time of a case in seconds on this machine; a longer one is ended and recorded.
    dry_run : Check the study, count its cases, estimate the time.
    """
    from validation.studies import load_study, refuse_other_contents, run_sweep

    # The folder's name never comes from inside the file.
    folder = output if output is not None else Path(f"{study.stem}-sweep")
    loaded_study = load_study(study)
    if not dry_run:
        refuse_other_contents(folder, resume=resume)
    with _place(workers, cluster, wait_seconds) as place:
        description = f"{loaded_study.count} cases, {loaded_study.analysis}, on {place.words}"
        stderr().print(f"{loaded_study.name}: {description} -> {folder}")
        if dry_run:
            _estimate(loaded_study, place)
            return
        with progress_bar("sweep") as tell:

            def progress(done: int, total: int, failed: int) -> None:
                tell(done / total, f"{done} of {total} cases, {failed} failed")

            try:
                summary = run_sweep(
                    loaded_study,
                    folder,
                    workers=place.processes,
                    executor=place.cluster,
                    resume=resume,
                    retry_failed=retry_failed,
                    case_seconds=case_seconds,
                    progress=progress,
                )
            except KeyboardInterrupt:
                fail(
                    f"Stopped; what was computed is in {folder}: run the command with --resume.", INTERRUPTED
                )
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


class _Place(NamedTuple):
    """Where the cases run.

    Attributes
    ----------
    processes : worker processes of this machine; 0: this process, or the cluster
    cluster : cluster that computes the cases
    """

    processes: int
    cluster: Cluster | None = None

    @property
    def workers(self) -> int:
        """Number of cases that run at the same time."""
        return self.processes or 1 if self.cluster is None else self.cluster.workers

    @property
    def words(self) -> str:
        """Number of workers and the address of the cluster."""
        return f"{self.workers} worker(s)" + (f" of {self.cluster.address}" if self.cluster else "")


@contextmanager
def _place(workers: int | None, cluster: str | None, wait_seconds: float | None) -> Iterator[_Place]:
    """Open the cluster of --cluster, or take the worker processes of this machine."""
    from lumped.cache import cores
    from lumped.errors import refuse

    if workers is not None and cluster is not None:
        action = (
            "Leave it out: all workers of the cluster compute. Write --cluster local:8 for 8 of them here."
        )
        raise refuse("workers", workers, "none with --cluster", action)
    with cluster_of(cluster, wait_seconds) as opened:
        if opened is None:
            yield _Place(cores() if workers is None else workers)
        else:
            yield _Place(0, opened)


def _estimate(study: Study, place: _Place) -> None:
    """Print the estimated time of a sweep.

    Three cases are timed in this process. One case is computed before them, because the first case may
    compile.
    """
    from validation.studies.cases import CaseList, StudyEvaluator
    from validation.studies.workers import evaluate_chunk

    cases = CaseList(study)
    evaluator = StudyEvaluator.of(study)
    numbers = [study.count // 2, 0, study.count // 3, study.count - 1]
    values = cases.values(numbers)
    evaluate_chunk(evaluator, numbers[:1], values[:1])
    seconds = evaluate_chunk(evaluator, numbers[1:], values[1:]).seconds / 3.0
    hours = seconds * study.count / place.workers / 3600.0
    stderr().print(f"about {seconds:.2g} s a case, {hours:.2g} hours in all on {place.words}")
