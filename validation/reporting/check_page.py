"""The page of a check: a folder with index.html, check.json, figures and tables."""

from __future__ import annotations

import json
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from lumped.arguments import file_path
from lumped.fields.units import to_stated
from validation.check.check import Check, Verdict
from validation.check.words import subject
from validation.files.folder import FORMAT, whole_folder
from validation.reporting.blocks import Picture, Table, chapter_data, plain
from validation.reporting.check_content import RUNG_WORDS, CheckPart, look_first, parts_of
from validation.reporting.page import Part, environment
from validation.reporting.pictures import draw_pictures
from validation.reporting.tables import write_tables

#: Verdict -> class of the box with the verdict.
_TONES = {Verdict.AGREES: "good", Verdict.DIFFERS: "bad", Verdict.NOT_COMPARABLE: "fair"}


def write_check(check: Check, out: str | Path, *, force: bool = False) -> Path:
    """Write the page of a check into a folder, completely or not at all.

    Parameters
    ----------
    check : the check
    out : folder, new or empty
    force : replace an earlier page in that folder

    Returns
    -------
    The folder: ``index.html`` (self-contained), ``check.json``, ``figures/``, ``tables/``

    Raises
    ------
    ParameterError : a folder that must not be written
    """
    started = time.perf_counter()
    target = file_path("out", out)
    with whole_folder(target, force=force) as folder:
        parts = parts_of(check)
        blocks = [block for part in parts for block in part.content.blocks]
        pictures = [block for block in blocks if isinstance(block, Picture)]
        images = draw_pictures(pictures, folder / "figures")
        (folder / "tables").mkdir()
        tables = [block for block in blocks if isinstance(block, Table)]
        if tables:
            write_tables(tables, pictures, folder / "tables")
        data = document(check, parts)
        data["timestamps"] = {
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "seconds": round(time.perf_counter() - started, 2),
        }
        text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
        (folder / "check.json").write_text(text, encoding="utf-8")
        (folder / "index.html").write_text(_render(check, parts, images, data), encoding="utf-8")
    return target


def headline(check: Check) -> str:
    """Return the headline: the verdict, and the rung that fails."""
    if check.verdict is Verdict.NOT_COMPARABLE:
        return "Not comparable."
    if check.failed is None:
        return f"{subject(check.role)} agrees."
    return f"{subject(check.role)} differs {RUNG_WORDS[check.failed]}."


def document(check: Check, parts: tuple[CheckPart, ...]) -> dict[str, Any]:
    """Return check.json without its timestamps: every number of the page."""
    return {
        "format": f"{FORMAT}-check",
        "format_version": 1,
        "gear_pair": check.pair.name,
        "theirs": check.name,
        "role": check.role,
        "verdict": check.verdict.value,
        "failed": None if check.failed is None else check.failed.value,
        "misfit": plain(float(check.misfit)),
        "limit": check.limit,
        "words": check.words,
        "remarks": list(check.remarks),
        "look_first": list(look_first(check)),
        "explanations": [
            {
                "name": step.name,
                "factor": step.factor,
                "misfit": step.misfit,
                "sentence": step.sentence,
                "alternatives": [
                    {"name": a.name, "factor": a.factor, "misfit": a.misfit} for a in step.alternatives
                ],
            }
            for step in check.explanations
        ],
        "alone": [
            {"name": a.name, "factor": a.factor, "misfit": a.misfit, "sentence": a.sentence}
            for a in (() if check.ladder is None else check.ladder.alone)
        ],
        "chapters": {part.anchor: chapter_data(part.title, part.content) for part in parts},
        "parameters": check.pair.to_mapping(),
    }


def _render(check: Check, parts: tuple[CheckPart, ...], images: dict[str, str], data: dict[str, Any]) -> str:
    """Return index.html."""
    shown = tuple(
        Part(part.anchor, number, part.title, part.content.result, part.content.blocks)
        for number, part in enumerate(parts, start=1)
    )
    blocks = [block for part in shown for block in part.blocks]
    numbers = {
        id(block): count
        for kind in (Picture, Table)
        for count, block in enumerate((b for b in blocks if isinstance(b, kind)), start=1)
    }
    torque = f"{check.pair.operating.pinion_torque:.4g} N m"
    title = f"{check.name} beside {check.pair.name}, {_speed_words(check)}, {torque}"
    return (
        environment()
        .get_template("check.html")
        .render(
            title=title,
            headline=headline(check),
            tone=_TONES[check.verdict],
            parts=shown,
            numbers=numbers,
            images=images,
            data=data,
        )
    )


def _speed_words(check: Check) -> str:
    """The speed of the curves, or the range of speeds of values over speed."""
    if check.over_speed is None:
        return f"{to_stated(check.pair.operating.pinion_speed, 'rpm'):.4g} rpm"
    speeds = [to_stated(float(speed), "rpm") for speed in check.over_speed.theirs.speeds]
    return f"{speeds[0]:.4g} to {speeds[-1]:.4g} rpm"
