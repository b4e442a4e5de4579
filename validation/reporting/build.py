"""Build the report: write the chapters, draw, render, and put the folder in place."""

from __future__ import annotations

import base64
import json
import resource
import time
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from floquet.gear.response import ResponseBranches
from lumped import GearPair, load_gear_pair
from lumped.arguments import file_path
from lumped.typing import Progress
from validation.files.folder import FORMAT, FORMAT_VERSION, whole_folder
from validation.files.output import write_dataset
from validation.plots.motion import first_figure
from validation.plots.style import save
from validation.reporting.blocks import Answer, Picture, chapter_data, plain
from validation.reporting.chapter import Chapter, Written
from validation.reporting.chapters import CHAPTERS
from validation.reporting.gate import TOLERANCE, Comparison, checked_tolerance, failures, load_report
from validation.reporting.gate import compare as compare_reports
from validation.reporting.page import render
from validation.reporting.results import FULL, QUICK, Results
from validation.reporting.words import headline, sentence


@dataclass(frozen=True)
class Report:
    """A report that was written.

    Attributes
    ----------
    folder : where it is
    sentence : its verdict in one sentence
    verdicts : chapter -> word of its verdict
    failures : verdicts that are bad, one line each
    seconds : wall time [s]
    comparison : with an earlier report, where one was given
    """

    folder: Path
    sentence: str
    verdicts: dict[str, str]
    failures: tuple[str, ...]
    seconds: float
    comparison: Comparison | None = None


def report(
    pair: GearPair | str | Path,
    out: str | Path,
    *,
    force: bool = False,
    quick: bool = False,
    compare: str | Path | None = None,
    tolerance: float = TOLERANCE,
    progress: Progress | None = None,
) -> Report:
    """Write the verification report of a gear pair into a folder.

    The folder gets ``index.html`` (self-contained: it needs no network and no other file),
    ``report.json`` (every number shown), ``figures/`` (SVG) and ``data/`` (NetCDF and the parameter file). It
    is written whole or not at all.

    Parameters
    ----------
    pair : gear pair, preset name or parameter file
    out : folder, new or empty
    force : replace an earlier report in that folder
    quick : coarser sampling and no verification, for a first look
    compare : report.json of an earlier report, or its folder
    tolerance : relative change of a number that passes in this comparison
    progress : called with the finished fraction and what is being done

    Raises
    ------
    ParameterError : a refused parameter or output folder, before any work
    NumericalError : a model fails; the text says what to try
    """
    started = time.perf_counter()
    tell: Progress = progress or (lambda fraction, stage="", /: None)
    gear_pair = load_gear_pair(pair)
    target = file_path("out", out)
    earlier = None if compare is None else load_report(compare, quick=quick)
    checked_tolerance(tolerance)
    with whole_folder(target, force=force) as folder:
        effort = QUICK if quick else FULL
        results = Results(gear_pair, effort)
        chapters = written(results, CHAPTERS, lambda f, stage="", /: tell(0.85 * f, stage))
        computed = time.perf_counter()
        first = answer_figure(results)
        pictures = (first, *_pictures(chapters))
        images = _draw(pictures, folder / "figures", lambda f, stage="", /: tell(0.85 + 0.12 * f, stage))
        tell(0.97, "data")
        _write_data(results, chapters, folder / "data")
        data = document(results, chapters, quick=quick)
        seconds = {"compute": computed - started, "all": time.perf_counter() - started}
        data["timestamps"] = {
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "seconds": {name: round(value, 2) for name, value in seconds.items()},
            "peak_memory_MB": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, 1),
        }
        for name, text in {
            "report.json": json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n",
            "index.html": render(gear_pair, first, answers(results, chapters), chapters, images, data),
        }.items():
            (folder / name).write_text(text, encoding="utf-8")
    tell(1.0, "done")
    verdicts = {
        chapter.key: content.badge.state for chapter, content in chapters if content.badge is not None
    }
    comparison = None if earlier is None else compare_reports(earlier, data, tolerance=tolerance)
    seconds_all = time.perf_counter() - started
    return Report(target, data["verdict"], verdicts, failures(data), seconds_all, comparison)


def written(
    results: Results, chapters: tuple[Chapter, ...], progress: Progress | None = None
) -> tuple[Written, ...]:
    """Write chapters, without those that the report leaves out.

    ``chapters``: which, in their order.
    """
    total = sum(chapter.seconds for chapter in chapters)
    made: list[Written] = []
    done = shown = 0.0

    def tell(first: float, own: float, fraction: float, stage: str = "", /) -> None:
        nonlocal shown
        shown = max(shown, (first + fraction * own) / total)  # a chapter may compute several results
        if progress is not None:
            progress(shown, stage)

    for chapter in chapters:
        results.progress = partial(tell, done, chapter.seconds)
        content = chapter.write(results)
        if content is not None:
            made.append((chapter, content))
        done += chapter.seconds
    return tuple(made)


def answers(results: Results, chapters: tuple[Written, ...]) -> dict[str, Answer]:
    """Answers at the top of the report: key of the chapter that says why -> answer."""
    return {chapter.key: chapter.answer(results) for chapter, _ in chapters if chapter.answer is not None}


def document(results: Results, chapters: tuple[Written, ...], *, quick: bool) -> dict[str, Any]:
    """report.json without its timestamps: the same parameters and software give the same data."""
    return {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "gear_pair": results.pair.name,
        "description": results.pair.description,
        "quick": quick,
        "headline": headline(results),
        "verdict": sentence(results),
        "doubts": list(results.doubts),
        "answers": [
            {"question": a.question, "verdict": plain(a.badge), "text": a.text, "chapter": key}
            for key, a in answers(results, chapters).items()
        ],
        "chapters": {chapter.key: chapter_data(chapter.title, content) for chapter, content in chapters},
        "parameters": results.pair.to_mapping(),
    }


def answer_figure(results: Results) -> Picture:
    """The one figure of the first page: the answer in time and over speed."""
    check, branches = results.check, results.branches
    return Picture(
        "answer",
        "Transmission error over one mesh cycle by both models, and its peak to peak over pinion speed.",
        partial(
            first_figure,
            check.lumped,
            check.multibody["exact"],
            results.geometry.mesh_period,
            results.sweep,
            results.operating_rpm,
            results.static_load,
            branches.dataset if isinstance(branches, ResponseBranches) else None,
        ),
    )


def _pictures(chapters: tuple[Written, ...]) -> tuple[Picture, ...]:
    return tuple(block for _, content in chapters for block in content.blocks if isinstance(block, Picture))


def _draw(pictures: tuple[Picture, ...], folder: Path, tell: Progress) -> dict[str, str]:
    """Write all figures; return them as data URIs by key."""
    folder.mkdir()
    images: dict[str, str] = {}
    for done, picture in enumerate(pictures, 1):
        path = folder / f"{picture.key}.svg"
        save(picture.draw(), path)
        images[picture.key] = (
            f"data:image/svg+xml;base64,{base64.b64encode(path.read_bytes()).decode('ascii')}"
        )
        tell(done / len(pictures), "figures")
    return images


def _write_data(results: Results, chapters: tuple[Written, ...], folder: Path) -> None:
    folder.mkdir()
    for _, content in chapters:
        for name, dataset in content.data.items():
            write_dataset(dataset, folder / f"{name}.nc")
        if content.write_more is not None:
            content.write_more(folder)
    (folder / "parameters.toml").write_text(results.pair.to_toml(), encoding="utf-8")
