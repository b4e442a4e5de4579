"""The posterior of a pair: what records say about each input, and what they do not say.

Source: Kennedy and O'Hagan, J. R. Statist. Soc. B 63 (2001) 425, section 4.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import xarray as xr
from scipy.special import ndtr

from lumped.display.result import DisplayedResult, no_variables
from lumped.labelling import labelled_dataset, provenance
from lumped.model.periodic_system import supports_of
from lumped.schema.pair import GearPair, field_values, validated
from lumped.schema.posterior import ERROR, FROM_RECORD
from validation.calibrate.data import Data, Unexplained, first_channel, names_of, words_of
from validation.calibrate.forms import pair_of
from validation.calibrate.machines import Machines
from validation.calibrate.mixture import Component, moments
from validation.prediction.machines import with_errors
from validation.prediction.motion import QUANTITIES
from validation.prediction.uncertain_input import Input
from validation.prediction.uncertainty import PERCENTILES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from validation.calibrate.next_test import Candidate

#: The records do not know an input whose posterior keeps more than this share of the prior width.
UNKNOWN = 0.9
#: A form is known from this probability on.
KNOWN_FORM = 0.95
#: Shape of the tail of the weights from which the weights are not used.
RELIABLE = 0.7
#: A list of a TOML file on several lines.
_LIST = re.compile(r"\[\n((?:    [^\n]*,\n)+)\]")
#: Digits of the values in a file.
_DIGITS = 7


@dataclass(frozen=True, eq=False, repr=False)
class Posterior(DisplayedResult):
    """What records say about the assumed inputs of a pair.

    Attributes
    ----------
    prior : the pair as it was before the records
    inputs : the varied inputs
    records : the records as data
    components : normal distributions of the mixture, the most probable first
    machines : possible machines that the records leave
    discrepancy : whether a discrepancy of the model was allowed
    """

    shown: ClassVar = ("identified", "not_identified", "forms", "unexplained", "level", "pareto_shape")
    instead: ClassVar = {
        "save": "Path('fitted.toml').write_text(posterior.pair.to_toml())",
        "to_toml": "pair.to_toml()",
        "samples": "table and results",
    }

    prior: GearPair
    inputs: tuple[Input, ...]
    records: tuple[Data, ...]
    components: tuple[Component, ...]
    machines: Machines
    discrepancy: bool

    @cached_property
    def shares(self) -> dict[str, float]:
        """Input -> standard deviation of its normal score after the records over that before, 0 to 1."""
        deviations = np.sqrt(np.diag(moments(self.components)[1]))
        return {one.field: min(float(size), 1.0) for one, size in zip(self.inputs, deviations, strict=True)}

    @property
    def identified(self) -> dict[str, float]:
        """Input -> share of its width that is left, of the inputs that the records know, least first."""
        known = {name: share for name, share in self.shares.items() if share <= UNKNOWN}
        return dict(sorted(known.items(), key=lambda row: row[1]))

    @property
    def not_identified(self) -> tuple[str, ...]:
        """Inputs that the records do not know, and the assumed backlash, which no motion in contact shows."""
        unknown = [name for name, share in self.shares.items() if share > UNKNOWN]
        beside = ["mesh.backlash"] if "mesh.backlash" in self.prior.assumed else []
        return tuple(dict.fromkeys([*unknown, *beside]))

    @cached_property
    def forms(self) -> dict[str, dict[str, float]]:
        """Field of a choice -> name -> probability after the records: stiffness model, contact, law."""
        result: dict[str, dict[str, float]] = {}
        for one in self.components:
            for field, name in one.form.fields:
                of_field = result.setdefault(field, {})
                of_field[name] = of_field.get(name, 0.0) + one.weight
        return {
            field: dict(sorted(names.items(), key=lambda row: -row[1])) for field, names in result.items()
        }

    @property
    def level(self) -> float:
        """Mean level of the discrepancy, as a share of the largest order of a channel."""
        return float(sum(one.weight * one.level for one in self.components))

    @property
    def pareto_shape(self) -> float:
        """Shape of the tail of the importance weights of the machines; above 0.7 they were not weighted."""
        return self.machines.shape

    @cached_property
    def unexplained(self) -> tuple[Unexplained, ...]:
        """Orders and values that the best fit misses by more than their noise, largest rest first."""
        best = self.components[0].minimum.motions.values
        count = sum(one.values.size // (1 + one.shifts) for one in self.records)  # curves: two parts an order
        rows: list[Unexplained] = []
        start = 0
        for record in self.records:
            size = record.values.size
            rows += record.unexplained(best[start : start + size], count)
            start += size
        return tuple(sorted(rows, key=lambda one: -one.rest))

    @cached_property
    def table(self) -> xr.Dataset:
        """Dataset over ``input``: ranges before and after the records, share of the width, what is known.

        ``before`` and ``after`` (input, percentile) are in the unit of the field, ``unit``; ``share`` is the
        standard deviation of the normal score after the records over that before.
        """
        ends = np.array(PERCENTILES) / 100.0
        before = np.array([[one.parts[0].at(float(share)) for share in ends] for one in self.inputs])
        scores = np.percentile(self.machines.z[1:], PERCENTILES, axis=0).T
        after = np.array(
            [
                [float(one.parts[0].at(float(ndtr(score)))) for score in of_input]
                for one, of_input in zip(self.inputs, scores, strict=True)
            ]
        )
        names = [one.field for one in self.inputs]
        shares = np.array([self.shares[name] for name in names])
        return labelled_dataset(
            {
                "before": (("input", "percentile"), before, "unit", "value before the records"),
                "after": (("input", "percentile"), after, "unit", "value after the records"),
                "share": ("input", shares, "1", "share of the width that is left"),
                "identified": ("input", shares <= UNKNOWN, "1", "whether the records know the input"),
                "unit": ("input", [one.unit for one in self.inputs], "1", "unit of the values"),
            },
            {
                "input": (names, "1", "uncertain input"),
                "percentile": (list(PERCENTILES), "%", "share of the machines below"),
            },
            self._provenance | {"records": words_of(self.records), "level": self.level},
        )

    @cached_property
    def results(self) -> xr.Dataset:
        """Dataset over ``machine``: page-1 numbers of the machines, with the error of the model [SI].

        ``q_percentile`` (percentile) has the percentiles of a number q. The pair is at its operating point.
        """
        numbers = [
            with_errors(one, {name: float(values[j]) for name, values in self.machines.errors.items()})
            if self.discrepancy
            else one
            for j, one in enumerate(self.machines.numbers)
        ]
        variables: dict[str, Any] = {}
        for name, (unit, words) in QUANTITIES.items():
            values = np.array([one[name] for one in numbers[1:]])
            variables[name] = ("machine", values, unit, words)
            variables[f"{name}_percentile"] = ("percentile", np.percentile(values, PERCENTILES), unit, words)
        return labelled_dataset(
            variables,
            {"percentile": (list(PERCENTILES), "%", "share of the machines below")},
            self._provenance,
        )

    @property
    def _provenance(self) -> dict[str, Any]:
        """Attributes of a dataset: what was calibrated."""
        made = {"supports": supports_of(self.prior, None), "teeth": "alike"}
        return provenance(self.prior, seed=self.machines.seed) | made

    @cached_property
    def pair(self) -> GearPair:
        """The pair with the best fit, the machines of the records in ``[posterior]``, and their sources.

        Inputs that the records know are known from now on; the other ones stay assumed.
        """
        columns, errors = self._columns()
        fitted = pair_of(self.prior, self.components[0].form).with_(
            {path: values[0] for path, values in columns.items()}
        )
        data = fitted.to_mapping()
        names = names_of(self.records)
        assumed = data.setdefault("assumed", {})
        sources = data.setdefault("sources", {})
        for path in columns:
            if self._knows(path):
                sources[path] = FROM_RECORD + names
                assumed.pop(path, None)
            else:
                sources.pop(path, None)
                assumed[path] = field_values(fitted)[path]
        stated = {path: one for path, one in data.pop("uncertainty", {}).items() if path not in columns}
        stated = {
            path: one for path, one in stated.items() if not any(c.startswith(f"{path}.") for c in columns)
        }
        data |= {"uncertainty": stated} if stated else {}
        data["posterior"] = {path: list(values) for path, values in (columns | errors).items()}
        return validated(data, f"{self.prior.name} with records")

    def _knows(self, path: str) -> bool:
        """Whether the records know a field: an input that they identify, or a choice with one clear name."""
        field = path.removesuffix(".model")
        if field in self.forms:
            return next(iter(self.forms[field].values())) >= KNOWN_FORM
        owner = next(one for one in self.inputs if any(part.field == path for part in one.parts))
        return self.shares[owner.field] <= UNKNOWN

    def _columns(self) -> tuple[dict[str, tuple[float | str, ...]], dict[str, tuple[float | str, ...]]]:
        """Field -> its values in the machines, by the predicted transmission error; errors of the model."""
        sizes = [one["dte_peak_to_peak"] for one in self.machines.numbers]
        errors = self.machines.errors if self.discrepancy else {}
        by_size = [0, *(1 + int(j) for j in np.argsort(sizes[1:], kind="stable"))]
        columns: dict[str, tuple[float | str, ...]] = {}
        for number, one in enumerate(self.inputs):
            shares = ndtr(self.machines.z[by_size, number])
            for part in one.parts:
                columns[part.field] = tuple(_rounded(part.at(float(share))) for share in shares)
        for field in self.forms:
            names = [dict(self.machines.components[j].form.fields)[field] for j in by_size]
            columns[f"{field}.model" if field == "mesh.stiffness" else field] = tuple(names)
        if "centre_distance" in columns:  # the gears stay as they are cut
            for gear, shift in zip(("pinion", "gear"), self.prior.profile_shifts, strict=True):
                columns.setdefault(f"{gear}.profile_shift", (float(shift),) * len(by_size))
        return columns, {
            f"{ERROR}{name}": tuple(_rounded(float(values[j])) for j in by_size)
            for name, values in errors.items()
        }

    @cached_property
    def next_tests(self) -> tuple[Candidate, ...]:
        """Tests that may be run next, the one that leaves least of the results of page 1 first."""
        from validation.calibrate.next_test import next_tests

        return next_tests(self)

    @property
    def sentences(self) -> tuple[str, ...]:
        """What the records say, what they do not say, what nothing explains, and how far to trust it."""
        names = names_of(self.records)
        total = len(self.inputs)
        lines = [f"The records know {len(self.identified)} of {total} uncertain inputs: {names}."]
        if self.not_identified:
            lines.append(f"They do not know: {', '.join(self.not_identified)}.")
        if self.discrepancy:
            lines.append(
                f"The model may be off by about {100.0 * self.level:.0f} % of the largest order; "
                "the ranges include this error."
            )
        else:
            lines.append("The model counts as exact: the ranges are too narrow.")
        lines += [one.words for one in self.unexplained[:3]]
        if self.pareto_shape >= RELIABLE:
            lines.append(
                "The ranges hold for data that are linear in the inputs: the weights of the machines by "
                f"their motions are not reliable (Pareto shape {self.pareto_shape:.1f}, above {RELIABLE})."
            )
        return tuple(lines)

    @property
    def recommendation(self) -> tuple[str, ...]:
        """Which run, and which sweep, would leave least of page 1: sentences out of ``next_tests``."""
        from validation.calibrate.next_test import recommendation

        return recommendation(self.next_tests)

    def text(self, *, next_test: bool = False) -> str:
        """Return the fitted pair as the text of a parameter file, with what the records say as comments.

        ``next_test``: whether the comments say which test would pay next.
        """
        from validation.exchange import parameter_text

        comments = (*self.sentences, *(self.recommendation if next_test else ()))
        text = parameter_text(self.pair.to_mapping(), comments)
        head, mark, table = text.partition("[posterior]")
        return (
            head + mark + _LIST.sub(lambda found: "[" + " ".join(found[1].split()).rstrip(",") + "]", table)
        )

    def plot(self, *variables: object) -> Figure:
        """Return the figure: the width of each input after the records, and a channel beside its fit."""
        no_variables(variables)
        from validation.plots.calibrate import calibration_figure

        channel = first_channel(self.records, self.components[0].minimum.motions.values)
        return calibration_figure(self.shares, self.identified, channel)


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
