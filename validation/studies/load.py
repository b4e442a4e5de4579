"""Reading a study: from TOML or a mapping, refused in the user's words."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from lumped.arguments import file_path
from lumped.errors import FieldProblem, ParameterError, refuse, shown
from lumped.fields.refusals import translated
from lumped.fields.text_file import parse_toml, read_text
from lumped.schema.files import load_gear_pair, preset_names
from lumped.schema.pair import GearPair
from validation.studies.schema import Study

#: Largest study file read: a bound against a wrong path; a list of a million values fits.
MAX_FILE_BYTES = 100_000_000


def load_study(source: str | Path | Mapping[str, Any] | Study, *, name: str = "") -> Study:
    """Read and validate a study.

    Parameters
    ----------
    source : path of a TOML file, TOML text (with a line end in it), a mapping, or a Study (returned as is)
    name : what to call TOML text or a mapping in errors

    Raises
    ------
    ParameterError : everything that is refused, with field, value, allowed range and next action
    """
    if isinstance(source, Study):
        return source
    if isinstance(source, Mapping):
        return _validated(dict(source), name or "mapping", Path())
    if isinstance(source, str) and "\n" in source:
        return _validated(parse_toml(source, name or "study"), name or "study", Path())
    path = file_path("study", source)
    text = read_text(path, MAX_FILE_BYTES, field="study", kind="TOML file")
    data = parse_toml(text, str(path))
    if "pinion" in data and "gear_pair" not in data:
        action = "This is a gear pair: a study names it as gear_pair. For one pair: 'spurcheck report'."
        raise refuse("study", path, "a study", action)
    return _validated(data, str(path), path.parent)


def _validated(data: dict[str, Any], source: str, folder: Path) -> Study:
    problems: list[FieldProblem] = []
    pair = data.get("gear_pair")
    try:
        if isinstance(pair, str):
            data["gear_pair"] = load_gear_pair(pair if pair in preset_names() else folder / pair)
        elif isinstance(pair, Mapping):
            data["gear_pair"] = load_gear_pair(pair)
        elif pair is not None and not isinstance(pair, GearPair):
            raise refuse("name", shown(pair), "a preset, a TOML path or a table", "Correct the gear pair.")
    except ParameterError as error:
        problems += [
            FieldProblem(f"gear_pair.{p.field}", p.value, p.allowed, p.action) for p in error.problems
        ]
        del data["gear_pair"]
    try:
        study = Study.model_validate(data)
    except ParameterError as error:
        problems += error.problems
    except ValidationError as error:
        problems += [
            p
            for p in translated(error, Study)
            if not (problems and p.field == "gear_pair" and p.value == "missing")
        ]
    except RecursionError:
        problems.append(FieldProblem("file", source, "a few levels of nesting", "Flatten it."))
    if problems:
        raise ParameterError(problems, source)
    return study
