"""The schema of a study: one gear pair, what varies, how it is analysed, what is kept."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, PlainSerializer, model_validator

from lumped.errors import FieldProblem, ParameterError, shown
from lumped.fields.section import Section, Text
from lumped.schema.pair import GearPair
from validation.studies.analyses import ANALYSES, AnalysisName, Settings
from validation.studies.axes import Axis, target_of

#: Most cases of one study: bookkeeping takes about 1 byte of memory a case, results 8 bytes an output.
MAX_CASES = 1_000_000_000
#: Names in the results besides axes and outputs.
NAMES = (
    *("status", "case", "failure", "failed_case", "failure_message", "output", "axis"),
    *(f"sobol_{kind}{end}" for kind in ("first", "total") for end in ("", "_ci_low", "_ci_high")),
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
        problems = []
        if self.method == "grid" and self.samples is not None:
            problems.append(
                FieldProblem("samples", str(self.samples), "none for a grid", "Remove it, or sample.")
            )
        if self.method != "grid" and self.samples is None:
            problems.append(FieldProblem("samples", "missing", "number of samples", "Give it."))
        if self.method == "sobol" and self.samples is not None and self.samples & (self.samples - 1):
            near = 1 << (self.samples.bit_length() - 1)
            problems.append(
                FieldProblem(
                    "samples",
                    str(self.samples),
                    "a power of two (the balance of a Sobol sequence)",
                    f"Take {near} or {2 * near}.",
                )
            )
        if self.sensitivity and self.method != "sobol":
            problems.append(
                FieldProblem("sensitivity", "true", "method = 'sobol'", "Change the method or leave it out.")
            )
        if problems:
            raise ParameterError(problems)
        return self


def _pair_in(value: object) -> object:
    return value.to_mapping() if isinstance(value, GearPair) else value


def _pair_out(pair: GearPair) -> dict[str, Any]:
    return pair.to_mapping()


class Study(Section):
    """A study: everything that decides the results, nothing about where and how it runs."""

    name: Text = Field(min_length=1, max_length=80, description="short name")
    description: Text = Field("", max_length=2000, description="what the study is for")
    gear_pair: Annotated[GearPair, BeforeValidator(_pair_in), PlainSerializer(_pair_out)] = Field(
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
        problems = _output_problems(self) + _axis_problems(self)
        if problems:
            raise ParameterError(problems)
        return self

    def to_mapping(self) -> dict[str, Any]:
        """Return the study as plain data for TOML, with the gear pair written out: nothing else is read."""
        data = self.model_dump(exclude_none=True, exclude_defaults=True, mode="python")
        return {key: _lists(value) for key, value in data.items()}

    def to_toml(self) -> str:
        """Return the study as TOML text; reading it back gives an equal study."""
        import tomli_w

        return tomli_w.dumps(self.to_mapping())

    @property
    def sha256(self) -> str:
        """Hash of the study's TOML text, which names the store it belongs to."""
        return hashlib.sha256(self.to_toml().encode()).hexdigest()


def _lists(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _lists(inner) for key, inner in value.items()}
    if isinstance(value, (tuple, list)):
        return [_lists(inner) for inner in value]
    return value


def _output_problems(study: Study) -> list[FieldProblem]:
    known = ANALYSES[study.analysis].outputs
    problems = [
        FieldProblem(f"outputs.{j}", shown(repr(name)), "one of " + ", ".join(known), "Correct the name.")
        for j, name in enumerate(study.outputs)
        if name not in known
    ]
    if len(set(study.outputs)) < len(study.outputs):
        problems.append(
            FieldProblem("outputs", "a name twice", "names that all differ", "Remove the repetition.")
        )
    return problems


def _axis_problems(study: Study) -> list[FieldProblem]:
    """Reasons why the axes do not fit each other, the design or the analysis."""
    problems: list[FieldProblem] = []

    def add(field: str, value: str, allowed: str, action: str) -> None:
        problems.append(FieldProblem(field, value, allowed, action))

    labels = [axis.label for axis in study.axes]
    paths = [path for axis in study.axes for path in axis.field]
    reserved = {*study.outputs, *NAMES}
    cases = 1
    for j, axis in enumerate(study.axes):
        at = f"axes.{j}"
        if labels.count(axis.label) > 1 or axis.label in reserved:
            add(
                f"{at}.name",
                repr(axis.label),
                "a name that no other axis or result has",
                "Give the axis a name.",
            )
        for path in axis.field:
            if paths.count(path) > 1:
                add(f"{at}.field", repr(path), "a field that no other axis changes", "Remove one.")
            if target_of(path).floquet_only and study.analysis != "floquet":
                add(
                    f"{at}.field",
                    repr(path),
                    "an axis of analysis = 'floquet'",
                    "Vary friction.coefficient (law coulomb) or the stiffness model's fields instead.",
                )
        if study.design.method == "grid":
            if axis.values is None and axis.count is None:
                add(f"{at}.count", "missing", "values, or low, high and count, for a grid", "Add it.")
            cases *= len(axis.values) if axis.values is not None else axis.count or 1
        elif axis.values is not None or axis.count is not None:
            add(f"{at}.values", "given", "low and high, for samples", "Give the range only, or use a grid.")
        try:
            if not any(problem.field.startswith(f"{at}.") for problem in problems):
                axis.listed()
        except ParameterError as error:
            problems += [
                FieldProblem(f"{at}.{p.field}", p.value, p.allowed, p.action) for p in error.problems
            ]
    if study.design.method != "grid":
        cases = (study.design.samples or 0) * (len(study.axes) + 2 if study.design.sensitivity else 1)
    if cases > MAX_CASES:
        add("design", f"{cases} cases", f"<= {MAX_CASES} cases", "Take fewer values, or split the study.")
    return problems
