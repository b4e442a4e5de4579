"""Build the report: write the chapters, draw, render, and put the folder in place."""

from __future__ import annotations

import json
import time
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from lumped import GearPair, LawRangeWarning, load_gear_pair
from lumped.arguments import file_path, real_number
from lumped.display.progress import reported_to, shows_progress
from lumped.display.result import DisplayedResult
from lumped.errors import NumericalError, refuse
from lumped.labelling import source_hash
from lumped.model.periodic_system import Supports, with_supports
from lumped.outcomes import Absent, Outcome
from lumped.typing import Progress, ProgressRequest
from validation.files.folder import FORMAT, FORMAT_VERSION, whole_folder
from validation.files.output import write_dataset
from validation.reporting.blocks import Content, Picture, Table, Text, chapter_data, plain
from validation.reporting.chapter import Chapter, Written
from validation.reporting.effort import FULL, QUICK
from validation.reporting.facts import Fact
from validation.reporting.first_numbers import Number, first_numbers
from validation.reporting.gate import TOLERANCE, Comparison, load_report
from validation.reporting.gate import compare as compare_reports
from validation.reporting.page_one import PageOne, title
from validation.reporting.page_without_motion import first_page, static_numbers
from validation.reporting.pictures import draw_pictures
from validation.reporting.relations import failed_checks
from validation.reporting.results import Results
from validation.reporting.second_process import present_process
from validation.reporting.tables import write_tables

if TYPE_CHECKING:
    from validation.check.curves import Curves
    from validation.check.record.comparison import RecordComparison

#: Chapters that read the range over speed.
_LAST = ("contact_loss", "evidence")


@dataclass(frozen=True, repr=False)
class Report(DisplayedResult):
    """A report that was written.

    Attributes
    ----------
    folder : folder of the report
    first : contents of page 1
    failed : checks of the program that fail, one phrase each
    findings : findings about the machine, for gates: "contact", "stable", "holds", "record"
    seconds : wall time [s]
    comparison : comparison with an earlier report; None: no earlier report was given
    record : comparison with a measured record; None: no record was given
    """

    folder: Path
    first: PageOne
    failed: tuple[str, ...]
    findings: frozenset[str]
    seconds: float
    comparison: Comparison | None = None
    record: RecordComparison | None = None


@shows_progress("report")
def report(
    pair: GearPair | str | Path,
    out: str | Path,
    *,
    force: bool = False,
    quick: bool = False,
    record: str | Path | None = None,
    compare: str | Path | None = None,
    tolerance: float = TOLERANCE,
    name: str = "",
    supports: Supports | None = None,
    progress: ProgressRequest = None,
    early: Callable[[str, Sequence[Number]], None] | None = None,
) -> Report:
    """Write the verification report of a gear pair into a folder.

    The folder gets ``index.html`` (self-contained: it needs no network and no other file), ``report.json``
    (every number on the page), ``figures/`` (SVG), ``tables/`` (CSV of every table and figure, and one
    workbook) and ``data/`` (NetCDF and the parameter file). Numbers are in SI or in the unit that stands
    beside them; every variable of a dataset has the attribute ``units``. The folder is written completely
    or not at all.

    Parameters
    ----------
    pair : gear pair, preset name or parameter file
    out : folder, new or empty
    force : replace an earlier report in that folder
    quick : coarser sampling, inputs not varied, for a first look
    record : a measured record at this speed and torque: its description (TOML) or a table, as of
        ``spurcheck.check``
    compare : report.json of an earlier report, or its folder
    tolerance : relative change of a number that passes in this comparison
    name : how commands name the pair, its file or preset; default the pair's name
    supports : "springs" leaves shafts out; by default the shafts of a pair that has them, where a chapter
        does not say that it is about springs
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction and what is being done
    early : called with the title and the numbers that need neither samples nor charts, once they are known

    Raises
    ------
    ParameterError : a refused parameter or output folder, before any work
    NumericalError : a model fails in a way that no page can say; the text says what to try
    """
    progress = reported_to(progress)
    started = time.perf_counter()
    source_hash()  # of the source that runs: an edit of it meanwhile makes no other one of it
    tell: Progress = progress or (lambda fraction, stage="", /: None)
    gear_pair = with_supports(load_gear_pair(pair), supports)
    named = name or (str(pair) if isinstance(pair, (str, Path)) else gear_pair.name)
    target = file_path("out", out)
    earlier = None if compare is None else load_report(compare, quick=quick)
    real_number("--tolerance", tolerance, 0.0, 1.0, action="0.001 lets numbers change by 0.1 %.")
    measured = None if record is None else _record(record, gear_pair)  # refused before any work
    with whole_folder(target, force=force) as folder, warnings.catch_warnings():
        # The page says where a law is outside its range at the operating point; each speed and sample more
        # would say it again.
        warnings.simplefilter("ignore", LawRangeWarning)
        results = Results(
            gear_pair, QUICK if quick else FULL, named, record=measured, process=present_process()
        )
        if early is not None:
            tell(0.0, "motion")
            known = results.without_motion is None
            early(
                title(results),
                first_numbers(results.prediction) if known else static_numbers(results.static),
            )
        if results.process is not None:
            with suppress(NumericalError):  # page 1 says why
                _ = results.like_loses_contact  # for which jumps in the second process wait
        # Chapters and figures import matplotlib, for which the first numbers need not wait.
        from validation.reporting.chapters import CHAPTERS
        from validation.reporting.first_figures import first_figures
        from validation.reporting.page import render

        figures = folder / "figures"
        chapters, images = written(
            results,
            CHAPTERS,
            figures,
            lambda f, stage="", /: tell(0.9 * f, stage),
            meanwhile=lambda: _write_data(results, folder / "data"),
        )
        first = first_page(results)
        pictures: tuple[Picture, ...] = ()
        if results.without_motion is None:
            with suppress(NumericalError):  # page 1 says why
                pictures = first_figures(results)
        blocks = [block for _, content in chapters for block in content.blocks]
        every = (*pictures, *(block for block in blocks if isinstance(block, Picture)))
        images |= draw_pictures(pictures, figures, lambda share: tell(0.9 + 0.07 * share, "figures"))
        tell(0.97, "tables")
        (folder / "tables").mkdir()
        write_tables([block for block in blocks if isinstance(block, Table)], every, folder / "tables")
        data = document(results, first, chapters, quick=quick)
        data["timestamps"] = {
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "seconds": round(time.perf_counter() - started, 2),
        }
        for name, text in {
            "report.json": json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n",
            "index.html": render(first, pictures, chapters, images, data),
        }.items():
            (folder / name).write_text(text, encoding="utf-8")
    tell(1.0, "done")
    changes = None if earlier is None else compare_reports(earlier, data, tolerance)
    seconds = time.perf_counter() - started
    compared = results.measured_error if results.without_motion is None else None
    return Report(target, first, failed_checks(results), findings(results), seconds, changes, compared)


def _record(source: str | Path, pair: GearPair) -> Curves:
    """Read a measured record of the pair. Another speed or torque than that of the pair is refused."""
    from validation.check.curves import Curves
    from validation.check.reading.reader import read
    from validation.check.record.compare import check_record

    curves = read(source, pair)
    if not isinstance(curves, Curves):
        action = "Check values over speed by spurcheck check."
        raise refuse("record", source, "samples at one speed", action)
    record = replace(curves, role="measurement")
    check_record(record, pair)
    return record


def findings(results: Results) -> frozenset[str]:
    """Return the findings about the machine: "contact", "stable", "holds", "record".

    "contact": contact is lost. "stable": the motion is not stable. "holds": the model does not hold.
    "record": a measured record does not confirm the prediction. A pair without a motion has them all.
    """
    if results.without_motion is not None:
        return frozenset({"contact", "stable", "holds", *(() if results.record is None else ("record",))})
    lost = results.contact_lost
    unstable = not results.prediction.stable
    record = results.measured_error
    try:
        outside = bool(results.outside)
    except NumericalError:  # the assumptions could not be checked
        outside = True
    conditions = {"contact": lost, "stable": unstable, "holds": outside or lost or unstable}
    conditions["record"] = record is not None and not record.confirms
    return frozenset(name for name, holds in conditions.items() if holds)


def written(
    results: Results,
    chapters: Sequence[Chapter],
    figures: Path,
    progress: Progress,
    meanwhile: Callable[[], None] = lambda: None,
) -> tuple[tuple[Written, ...], dict[str, str]]:
    """Write the chapters, without those that the report leaves out, and draw their pictures.

    Returns the chapters, and key of a picture -> data URI. ``figures``: folder of the pictures.
    ``meanwhile`` is called before the chapters that read the range over speed, of which a second process may
    compute a part at that time.
    """
    total = sum(chapter.seconds for chapter in chapters)
    made: list[Written] = []
    images: dict[str, str] = {}
    done = shown = 0.0

    def tell(first: float, seconds: float, fraction: float, stage: str = "", /) -> None:
        nonlocal shown
        shown = max(shown, (first + fraction * seconds) / total)  # a chapter may compute several results
        progress(shown, stage)

    # Samples first, the range over speed last: a second process computes it meanwhile, and draws no pictures.
    last = False
    for chapter in sorted(chapters, key=lambda one: (one.key in _LAST) - (one.key == "how_sure")):
        if chapter.key in _LAST and not last:
            last = True
            progress(shown, "data")
            meanwhile()
        results.progress = partial(tell, done, chapter.seconds)
        content = _content(chapter, results)
        done += chapter.seconds
        if content is not None:
            made.append((chapter, content))
            pictures = [block for block in content.blocks if isinstance(block, Picture)]
            images |= draw_pictures(pictures, figures, partial(_drawing, partial(tell, done)))
    return tuple(sorted(made, key=lambda one: chapters.index(one[0]))), images


def _drawing(tell: Callable[[float, float, str], None], _: float, /) -> None:
    """Say that figures are drawn, which has no share of the bar."""
    tell(0.0, 0.0, "figures")


def _content(chapter: Chapter, results: Results) -> Content | None:
    """Contents of a chapter, or the reason why it cannot be computed. None: the report leaves it out.

    A chapter on a motion that does not exist is left out: page 1 gives the reason.
    """
    if chapter.needs_motion and results.without_motion is not None:
        return None
    try:
        return chapter.write(results)
    except NumericalError as error:
        return Content("This chapter could not be computed.", (Text(str(error)),))


def document(
    results: Results, first: PageOne, chapters: tuple[Written, ...], *, quick: bool
) -> dict[str, Any]:
    """Return report.json without its timestamps. Equal parameters and equal software give equal data."""
    return {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "gear_pair": results.pair.name,
        "description": results.pair.description,
        "quick": quick,
        "teeth": "alike" if results.given is results.pair else "as given",
        "verdict": {"kind": first.verdict.name, "headline": first.headline, "reason": first.reason},
        "numbers": {number.key: _number(number) for number in first.numbers},
        "actions": [{"text": a.text, "command": a.command, "gain": a.gain} for a in first.actions],
        "how_sure": list(first.sure),
        "facts": {fact.key: _fact(fact) for fact in first.facts},
        "warnings": list(first.warnings),
        "findings": sorted(findings(results)),
        "failed_checks": list(failed_checks(results)),
        "chapters": {chapter.key: chapter_data(chapter.title, content) for chapter, content in chapters},
        "parameters": results.given.to_mapping(),
    }


def _fact(fact: Fact) -> dict[str, Any]:
    """A fact as JSON data."""
    scope = asdict(fact.scope) | {"speeds_rpm": list(fact.scope.speeds_rpm)}
    claim = {"claim": fact.claim, "value": plain(fact.value), "unit": fact.unit}
    return claim | {"scope": scope, "computed_by": fact.computed_by}


def _number(number: Number) -> dict[str, Any]:
    """A row of the table of page 1 as JSON data."""
    sizes = {
        name: plain(float(getattr(number, name))) for name in ("value", "low", "high", "median", "second")
    }
    words = {"label": number.label, "unit": number.unit, "note": number.note, "scope": number.scope}
    return words | sizes


def _write_data(results: Results, folder: Path) -> None:
    """Write the datasets of the numbers, and the parameter file."""
    folder.mkdir()
    datasets: dict[str, Callable[[], xr.Dataset | Absent]] = {
        "prediction": lambda: results.prediction.cycle,
        "linear": lambda: results.linear,
        "second_program": lambda: _second_motion(results),
        "sweep": lambda: results.sweep,
        "uncertainty": lambda: results.uncertainty,
        "assumed_teeth": lambda: _drawn_teeth(results),
        "budget": lambda: results.budget,
        "teeth": lambda: Absent(Outcome.ALIKE) if results.teeth is None else results.teeth.motion,
        "stability": lambda: results.chart,
    }
    if results.without_motion is not None:
        sharing = results.static.sharing
        datasets = {"static": lambda: Absent(Outcome.FAILED) if sharing is None else sharing}
    else:
        with suppress(NumericalError):
            for number, branches in enumerate(results.jump_search.branches, 1):
                name = f"motions_{number}" if number > 1 else "motions"
                datasets[name] = partial(getattr, branches, "dataset")
    for name, dataset in datasets.items():
        with suppress(NumericalError):  # the chapter says why
            data = dataset()
            if not isinstance(data, Absent):
                write_dataset(data, folder / f"{name}.nc")
    (folder / "parameters.toml").write_text(results.given.to_toml(), encoding="utf-8")


def _drawn_teeth(results: Results) -> xr.Dataset | Absent:
    """Machines with teeth drawn of an assumed class."""
    teeth = results.assumed_teeth
    return Absent(Outcome.NOT_ASKED) if teeth is None else teeth


def _second_motion(results: Results) -> xr.Dataset | Absent:
    """The motion of the second program."""
    second = results.second
    return second if isinstance(second, Absent) else second.cycle
