"""A study: gear pair, axes, analysis and outputs; the study file and the refusals."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import tomli_w
from pydantic import BeforeValidator, Field, PlainSerializer, ValidationError, model_validator

from lumped.arguments import file_path, nearest
from lumped.errors import FieldProblem, ParameterError, refuse, shown
from lumped.fields.refusals import translated
from lumped.fields.section import Section, Text
from lumped.fields.text_file import parse_toml, read_text
from lumped.model.periodic_system import supports_of, with_supports
from lumped.schema.files import load_gear_pair, preset_names
from lumped.schema.pair import GearPair
from validation.studies.analyses import ANALYSES, AnalysisName, Settings
from validation.studies.axes import Axis, target_of

#: Most cases of one study.
MAX_CASES = 100_000_000
#: Largest study file read: a bound against a wrong path; a list of a million values fits.
MAX_FILE_BYTES = 100_000_000
#: Names in the results besides axes and outputs.
NAMES = (
    *("status", "case", "failure", "failed_case", "failure_message", "output", "axis"),
    *("sobol_first", "sobol_total"),
)


class Design(Section):
    """Which combinations of the axes are cases."""

    method: Literal["grid", "latin_hypercube", "sobol"] = Field(
        "grid", description="product of the axes' values, or samples of their ranges"
    )
    samples: Annotated[int | None, Field(ge=1, le=MAX_CASES, strict=True)] = Field(
        None, description="number of samples; a power of two for sobol"
    )
    seed: Annotated[int, Field(ge=0, le=2**63 - 1, strict=True)] = Field(
        0, description="seed of the scrambling"
    )
    sensitivity: bool = Field(
        False, description="global sensitivity indices: sobol with samples * (axes + 2) cases"
    )

    @model_validator(mode="after")
    def _fits(self) -> Self:
        grid = self.method == "grid"
        sobol = self.method == "sobol"
        samples = self.samples
        near = 1 << ((samples or 1).bit_length() - 1)
        stated = str(samples)
        power = "a power of two (the balance of a Sobol sequence)"
        cases = (
            (grid and samples is not None, "samples", stated, "none for a grid", "Remove it, or sample."),
            (not grid and samples is None, "samples", "missing", "number of samples", "Give it."),
            (sobol and samples not in (None, near), "samples", stated, power, f"Take {near} or {2 * near}."),
            (self.sensitivity and not sobol, "sensitivity", "true", "method = 'sobol'", "Change the method."),
        )
        problems = [FieldProblem(*problem) for wrong, *problem in cases if wrong]
        if problems:
            raise ParameterError(problems)
        return self


def _pair_in(value: object) -> object:
    return value.to_mapping() if isinstance(value, GearPair) else value


class Study(Section):
    """A study: everything that decides the results, and nothing about place and way of the computation."""

    name: Text = Field(min_length=1, max_length=80, description="short name")
    description: Text = Field("", max_length=2000, description="what the study is for")
    gear_pair: Annotated[GearPair, BeforeValidator(_pair_in), PlainSerializer(GearPair.to_mapping)] = Field(
        description="preset name, TOML path beside the study file, or the gear pair's sections"
    )
    analysis: AnalysisName = Field(description="what is computed for every case")
    outputs: Annotated[tuple[str, ...], Field(min_length=1)] = Field(description="what is kept of a case")
    design: Design = Field(
        default_factory=lambda: Design.model_validate({}),
        description="which combinations of the axes are cases",
    )
    axes: Annotated[tuple[Axis, ...], Field(min_length=1, max_length=32)] = Field(description="what varies")
    settings: Settings = Field(
        default_factory=lambda: Settings.model_validate({}), description="numerical settings"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        problems = _output_problems(self) + _axis_problems(self) + _support_problems(self)
        if problems:
            raise ParameterError(problems)
        return self

    @property
    def count(self) -> int:
        """Number of cases. Sensitivity indices need one block of samples for each axis, and two more."""
        design = self.design
        if design.method == "grid":
            return math.prod(len(axis.values or ()) or axis.count or 1 for axis in self.axes)
        return (design.samples or 0) * (len(self.axes) + 2 if design.sensitivity else 1)

    def to_mapping(self) -> dict[str, Any]:
        """Return the study as plain data for TOML, with the gear pair written out: nothing else is read."""
        return self.model_dump(exclude_none=True, exclude_defaults=True, mode="json")

    def to_toml(self) -> str:
        """Return the study as TOML text; reading it back gives an equal study."""
        return tomli_w.dumps(self.to_mapping())

    @property
    def sha256(self) -> str:
        """Hash of the TOML text of the study, which names the store of the study."""
        return hashlib.sha256(self.to_toml().encode()).hexdigest()


def _output_problems(study: Study) -> list[FieldProblem]:
    outputs = ANALYSES[study.analysis].outputs
    problems = [
        FieldProblem(
            f"outputs.{j}",
            shown(repr(name)),
            "one of " + ", ".join(outputs),
            nearest(name, outputs) or "Correct the name.",
        )
        for j, name in enumerate(study.outputs)
        if name not in outputs
    ]
    if len(set(study.outputs)) < len(study.outputs):
        allowed = "names that all differ"
        problems.append(FieldProblem("outputs", "a name twice", allowed, "Remove the repetition."))
    return problems


def _support_problems(study: Study) -> list[FieldProblem]:
    """Refusal of shafts that the pair does not have."""
    try:
        with_supports(study.gear_pair, study.settings.supports)
    except ParameterError as error:
        return [replace(problem, field=f"settings.{problem.field}") for problem in error.problems]
    return []


def _axis_problems(study: Study) -> list[FieldProblem]:
    """Reasons why the axes do not fit each other, the design or the analysis."""
    labels = [axis.label for axis in study.axes]
    paths = [path for axis in study.axes for path in axis.field]
    taken = {*study.outputs, *NAMES}
    grid = study.design.method == "grid"
    floquet = study.analysis == "floquet"
    on_shafts = supports_of(study.gear_pair, study.settings.supports) == "shafts"
    springs = 'Give settings.supports = "springs", or vary a field of shafts.'
    vary = "Vary friction.coefficient (law coulomb) or the stiffness model's fields instead."
    problems: list[FieldProblem] = []
    for j, axis in enumerate(study.axes):
        listed = axis.values is not None or axis.count is not None
        name = axis.label
        unique = "a name that no other axis or result has"
        needed = "values, or low, high and count, for a grid"
        cases = [
            (labels.count(name) > 1 or name in taken, "name", repr(name), unique, "Give the axis a name."),
            (grid and not listed, "count", "missing", needed, "Add it."),
            (listed and not grid, "values", "given", "low and high, for samples", "Give the range only."),
        ]
        for path in axis.field:
            twice = paths.count(path) > 1
            charted = target_of(path).floquet_only
            cases += [
                (twice, "field", repr(path), "a field that no other axis changes", "Remove one."),
                (charted and not floquet, "field", repr(path), "an axis of analysis = 'floquet'", vary),
                (on_shafts and path.startswith("bearing"), "field", repr(path), "not on shafts", springs),
            ]
        axis_problems = [FieldProblem(*problem) for wrong, *problem in cases if wrong]
        try:
            if not axis_problems:
                axis.listed()
        except ParameterError as error:
            axis_problems += error.problems
        problems += [replace(problem, field=f"axes.{j}.{problem.field}") for problem in axis_problems]
    if study.count > MAX_CASES:
        action = "Take fewer values, or split the study."
        problems.append(FieldProblem("design", f"{study.count} cases", f"<= {MAX_CASES} cases", action))
    return problems


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
