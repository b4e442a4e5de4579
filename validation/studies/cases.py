"""The cases of a study: a fixed list, numbered from 0, that depends on the study alone."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from floquet.gear.axes import GEAR_AXES, GearVariation
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.studies.analyses import ANALYSES, AnalysisName, Settings
from validation.studies.axes import AxisValue
from validation.studies.schema import Study


@dataclass(frozen=True, eq=False)
class CaseList:
    """Parameters of every case by number.

    A grid is numbered in C order: the last axis runs fastest. Samples have the numbers of the draw. With
    sensitivity indices the samples are the blocks A, B, AB_1 ... AB_d of Saltelli et al., Comput. Phys.
    Commun. 181 (2010) 259-270: AB_i is A with column i of B.
    """

    study: Study

    @property
    def count(self) -> int:
        """Number of cases."""
        return self.study.count

    @cached_property
    def grid(self) -> tuple[tuple[AxisValue, ...], ...] | None:
        """Values of each axis of a grid; None for samples."""
        if self.study.design.method != "grid":
            return None
        return tuple(axis.listed() for axis in self.study.axes)

    @cached_property
    def _shares(self) -> FloatArray:
        """Samples (n, d) of the unit cube, without the sensitivity blocks AB; (n, 2 d) with them."""
        from scipy.stats import qmc  # takes a third of a second, and a grid has no use for it

        design = self.study.design
        d = len(self.study.axes)
        columns = 2 * d if design.sensitivity else d
        kind: Any = qmc.LatinHypercube if design.method == "latin_hypercube" else qmc.Sobol
        arguments: dict[str, Any] = {"rng": np.random.default_rng(design.seed)}
        if kind is qmc.Sobol:
            arguments["bits"] = 64
        assert design.samples is not None
        shares: FloatArray = kind(columns, **arguments).random(design.samples)
        return shares

    def shares(self, cases: npt.NDArray[np.int64]) -> FloatArray:
        """Samples (k, d) of the unit cube for sampled cases."""
        if not self.study.design.sensitivity:
            return self._shares[cases]
        d = len(self.study.axes)
        n = len(self._shares)
        block, row = np.divmod(cases, n)
        result = self._shares[row, :d].copy()
        result[block == 1] = self._shares[row[block == 1], d:]
        for i in range(d):
            in_block = block == i + 2
            result[in_block, i] = self._shares[row[in_block], d + i]
        return result

    def values(self, cases: npt.ArrayLike) -> list[tuple[AxisValue, ...]]:
        """Values of the axes for each of the given case numbers, in the fields' stated units."""
        return list(zip(*self.columns(cases), strict=True))

    def columns(self, cases: npt.ArrayLike) -> list[tuple[AxisValue, ...]]:
        """Values of the given cases, axis by axis."""
        numbers = np.asarray(cases, dtype=np.int64)
        if self.grid is not None:
            where = np.unravel_index(numbers, self.shape)
            return [tuple(axis[i] for i in indices) for axis, indices in zip(self.grid, where, strict=True)]
        shares = self.shares(numbers)
        return [axis.spaced(shares[:, j]) for j, axis in enumerate(self.study.axes)]

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Shape of the grid, or (count,)."""
        return (self.count,) if self.grid is None else tuple(map(len, self.grid))

    @property
    def dims(self) -> tuple[str, ...]:
        """Dimensions of the results: the axes of a grid, or "case"."""
        return ("case",) if self.grid is None else tuple(axis.label for axis in self.study.axes)

    @cached_property
    def sha256(self) -> str:
        """Hash of the parameters of all cases: a resumed sweep must have the same samples."""
        digest = hashlib.sha256(repr((self.shape, self.grid)).encode())
        if self.grid is None:
            digest.update(np.ascontiguousarray(self._shares).tobytes())
        return digest.hexdigest()


@dataclass(frozen=True)
class StudyEvaluator:
    """Computes a case: the pair, the paths of each axis, the analysis, the results and the settings."""

    pair: GearPair
    fields: tuple[tuple[str, ...], ...]
    analysis: AnalysisName
    outputs: tuple[str, ...]
    settings: Settings

    @staticmethod
    def of(study: Study) -> StudyEvaluator:
        """Return the evaluator of a study."""
        fields = tuple(axis.field for axis in study.axes)
        return StudyEvaluator(study.gear_pair, fields, study.analysis, study.outputs, study.settings)

    def variation(self, values: tuple[AxisValue, ...]) -> GearVariation:
        """Return the pair with the values of the axes. Plain fields change together: they must fit."""
        changes: dict[str, AxisValue] = {}
        charted: list[tuple[str, float]] = []
        for paths, value in zip(self.fields, values, strict=True):
            for path in paths:
                if path in GEAR_AXES:
                    charted.append((path, float(value)))
                else:
                    changes[path] = value
        variation = GearVariation.of(
            self.pair.with_(dict(changes)) if changes else self.pair, self.settings.supports
        )
        for name, number in charted:
            variation = GEAR_AXES[name].apply(variation, number)
        return variation

    def __call__(self, values: tuple[AxisValue, ...]) -> tuple[float, ...]:
        """Outputs of one case, in the study's order."""
        result = ANALYSES[self.analysis].compute(self.variation(values), self.settings)
        return tuple(float(result[name]) for name in self.outputs)
