"""Build the report: compute, draw, render, and put the folder in place."""

from __future__ import annotations

import base64
import json
import resource
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import xarray as xr

from lumped import GearPair, load_gear_pair
from validation.files.folder import FORMAT, FORMAT_VERSION, whole_folder
from validation.files.output import write_dataset
from validation.plots import save
from validation.reporting.baseline import load_report
from validation.reporting.blocks import Chapter, Picture, chapter_data, plain
from validation.reporting.chapters import CHAPTERS
from validation.reporting.chapters.changes import changes
from validation.reporting.compare import TOLERANCE, Comparison
from validation.reporting.compare import compare as compare_reports
from validation.reporting.interactive import write_interactive
from validation.reporting.judged import failures
from validation.reporting.junit import junit
from validation.reporting.page import render
from validation.reporting.results import FULL, QUICK, Results, compute
from validation.reporting.summary import summary as markdown
from validation.reporting.verdict import Summary, summarise

Progress = Callable[[float, str], None]


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
    paper: bool | None = None,
    compare: str | Path | None = None,
    tolerance: float = TOLERANCE,
    progress: Progress | None = None,
) -> Report:
    """Write the verification report of a gear pair into a folder.

    The folder gets ``index.html`` (self-contained: it needs no network and no other file),
    ``interactive.html`` (charts to explore), ``report.json`` (every number shown), ``report.junit.xml``
    (every verdict as a test case), ``summary.md``, ``figures/`` (PNG and SVG) and ``data/`` (NetCDF and the
    parameter file). It is written whole or not at all.

    Parameters
    ----------
    pair : gear pair, preset name or parameter file
    out : folder, new or empty
    force : replace an earlier report in that folder
    quick : coarser sampling and no verification, for a first look
    paper : compare with the paper: its figures, its claims, its errata, for this pair; default unless quick
    compare : report.json of an earlier report, or its folder; the report then has a chapter of changes
    tolerance : relative change of a number that passes, for that
    progress : called with the finished fraction and what is being done

    Raises
    ------
    ParameterError : a refused parameter or output folder, before any work
    NumericalError : a model fails; the text says what to try
    """
    started = time.perf_counter()
    tell = progress or (lambda fraction, text: None)
    gear_pair = load_gear_pair(pair)
    target = Path(out)
    earlier = None if compare is None else load_report(compare, quick=quick)
    if earlier is not None:
        compare_reports(earlier, earlier, tolerance=tolerance)  # refuses a tolerance before any work
    with whole_folder(target, force=force) as folder:
        effort = replace(QUICK if quick else FULL, paper=not quick if paper is None else paper)
        results = compute(gear_pair, effort, lambda f, text: tell(0.75 * f, text))
        computed = time.perf_counter()
        summary = summarise(results)
        chapters = tuple(made for write in CHAPTERS if (made := write(results)) is not None)
        comparison = None
        if earlier is not None:
            now = document(results, summary, chapters, quick=quick)
            comparison = compare_reports(earlier, now, tolerance=tolerance)
            chapters += (changes(comparison),)
        images = _draw(chapters, folder / "figures", lambda f: tell(0.75 + 0.22 * f, "figures"))
        tell(0.97, "page and data")
        _write_data(results, folder / "data")
        data = document(results, summary, chapters, quick=quick)
        data["interactive_page"] = write_interactive(results, folder)
        created = datetime.now(UTC).isoformat(timespec="seconds")
        seconds = {"compute": computed - started, "all": time.perf_counter() - started}
        data["timestamps"] = {
            "created": created,
            "seconds": {name: round(value, 2) for name, value in seconds.items()},
            "peak_memory_MB": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, 1),
        }
        text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False, sort_keys=False)
        (folder / "report.json").write_text(text + "\n", encoding="utf-8")
        page = render(results.pair, summary, chapters, images, data)
        (folder / "index.html").write_text(page, encoding="utf-8")
        (folder / "report.junit.xml").write_text(junit(data, comparison), encoding="utf-8")
        (folder / "summary.md").write_text(markdown(data, comparison), encoding="utf-8")
    tell(1.0, "done")
    verdicts = {c.key: c.badge.state for c in chapters if c.badge is not None}
    bad = tuple(f"{case.group}: {case.name}: {case.text}" for case in failures(data))
    return Report(target, summary.sentence, verdicts, bad, time.perf_counter() - started, comparison)


def document(
    results: Results, summary: Summary, chapters: tuple[Chapter, ...], *, quick: bool
) -> dict[str, Any]:
    """report.json without its timestamps: the same parameters and software give the same data."""
    return {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "gear_pair": results.pair.name,
        "description": results.pair.description,
        "quick": quick,
        "verdict": summary.sentence,
        "answers": [
            {"question": a.question, "verdict": plain(a.badge), "text": a.text, "chapter": a.chapter}
            for a in summary.answers
        ],
        "chapters": {chapter.key: chapter_data(chapter) for chapter in chapters},
        "parameters": results.pair.to_mapping(),
    }


def _draw(chapters: tuple[Chapter, ...], folder: Path, tell: Callable[[float], None]) -> dict[str, str]:
    """Write all figures; return their SVG as data URIs by key."""
    folder.mkdir()
    pictures = [block for chapter in chapters for block in chapter.blocks if isinstance(block, Picture)]
    images: dict[str, str] = {}
    for done, picture in enumerate(pictures, 1):
        figure = picture.draw()
        save(figure, folder / f"{picture.key}.svg")
        figure.set_layout_engine("none")  # placed by the first drawing: the second need not place again
        save(figure, folder / f"{picture.key}.png")
        svg = (folder / f"{picture.key}.svg").read_bytes()
        images[picture.key] = "data:image/svg+xml;base64," + base64.b64encode(svg).decode("ascii")
        tell(done / len(pictures))
    return images


def _write_data(results: Results, folder: Path) -> None:
    folder.mkdir()
    check = results.check
    samples = slice(-(check.compared_cycles * (check.lumped.sizes["time"] - 1) // check.cycles) - 1, None)
    datasets: dict[str, xr.Dataset] = {
        "periodic_motion": results.motion,
        "friction_laws": results.profile,
        "speed_sweep": results.sweep,
        "stability_chart": results.chart,
        "validity_map": results.validity,
        "cross_check_lumped": check.lumped.isel(time=samples),
    }
    physics = {
        "stiffness_components": results.mesh.components,
        "static_transmission_error": results.mesh.curves,
        "harris_map": results.mesh.harris,
        "relief_map": results.mesh.relief,
        "losses_by_law": results.mesh.losses,
    }
    datasets |= {name: data for name, data in physics.items() if data is not None}
    for fidelity, result in check.multibody.items():
        datasets[f"cross_check_{fidelity}"] = result.isel(time=samples)
    for name, dataset in datasets.items():
        write_dataset(dataset, folder / f"{name}.nc")
    if results.paper is not None:
        for record in results.paper.figures:
            record.write(folder / "paper")
    (folder / "parameters.toml").write_text(results.pair.to_toml(), encoding="utf-8")
