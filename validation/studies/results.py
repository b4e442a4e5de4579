"""The labelled results of a study, compiled from the store, with Sobol indices on request."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from lumped.arguments import file_path
from lumped.labelling import parameters_hash
from lumped.model.periodic_system import supports_of
from lumped.typing import FloatArray
from validation.studies.analyses import ANALYSES
from validation.studies.axes import target_of
from validation.studies.cases import CaseList
from validation.studies.schema import load_study
from validation.studies.store import STORE, Status, Table, read_definition, read_table

RESULTS = "results.nc"


def read_results(folder: str | Path) -> xr.Dataset:
    """Return the present contents of a store, also during a sweep or after the sweep was killed.

    Parameters
    ----------
    folder : output folder of a sweep

    Returns
    -------
    xarray.Dataset over the axes of the grid, or over "case" for samples; see ``results_dataset``

    Raises
    ------
    StoreError, ParameterError : no store, or not one of its own study
    """
    root = file_path("folder", folder)
    cases = CaseList(load_study(read_definition(root), name=str(root / STORE)))
    return results_dataset(cases, read_table(root, cases))


def results_dataset(cases: CaseList, table: Table) -> xr.Dataset:
    """Label the outcomes of a study.

    Returns xarray.Dataset with the outputs of the study in SI and ``status``, whose attributes explain the
    numbers. Failed cases have their error text in ``failure_message`` over ``failure``, the first
    ``MAX_FAILURES`` of them. The axes are in the stated units of the fields, which their attribute
    ``units`` names. Sensitivity indices are there where the design asks for them.
    """
    study = cases.study
    dims = cases.dims
    shape = cases.shape
    result = xr.Dataset(attrs=_attributes(cases, table))
    for label, coordinate in _coordinates(cases).items():
        result = result.assign_coords({label: coordinate})
    for name, row in zip(study.outputs, table.values.T, strict=True):
        unit, text = ANALYSES[study.analysis].outputs[name]
        result[name] = xr.DataArray(row.reshape(shape), dims=dims, attrs={"units": unit, "long_name": text})
    flags = {
        "flag_values": np.array(list(Status), dtype=np.int8),
        "flag_meanings": " ".join(flag.name.lower() for flag in Status),
    }
    result["status"] = (dims, table.status.reshape(shape), {"long_name": "what became of the case"} | flags)
    failed = sorted(table.messages)
    texts = np.array([table.messages[case] for case in failed], dtype=object)
    numbers = np.array(failed, dtype=np.int64)
    result["failed_case"] = ("failure", numbers, {"long_name": "number of the failed case"})
    result["failure_message"] = ("failure", texts, {"long_name": "why the case failed"})
    return _with_sensitivity(result, cases, table)


def _coordinates(cases: CaseList) -> dict[str, xr.DataArray]:
    """Axes of the study with their values, and the numbers of the cases of a sampled study."""
    study = cases.study
    coordinates: dict[str, xr.DataArray] = {}
    if cases.grid is None:
        columns: list[Any] = cases.columns(np.arange(cases.count))
        coordinates["case"] = xr.DataArray(
            np.arange(cases.count), dims="case", attrs={"long_name": "number of the case"}
        )
    else:
        columns = list(cases.grid)
    for axis, values in zip(study.axes, columns, strict=True):
        target = target_of(axis.field[0])
        array = np.array(values, dtype=object if target.kind == "other" else None)
        attrs = {"long_name": target.long_name, "field": ", ".join(axis.field)}
        if target.unit:
            attrs["units"] = target.unit
        dim = axis.label if cases.grid is not None else "case"
        coordinates[axis.label] = xr.DataArray(array, dims=dim, attrs=attrs)
    return coordinates


def _attributes(cases: CaseList, table: Table) -> dict[str, Any]:
    study = cases.study
    pair = study.gear_pair
    as_given = ANALYSES[study.analysis].own_teeth and pair.healthy is not pair
    return {
        "title": study.name,
        "description": study.description,
        "gear_pair": pair.name,
        "teeth": "as given" if as_given else "alike",
        "supports": supports_of(pair, study.settings.supports),
        "analysis": study.analysis,
        "study": study.to_toml(),
        "study_sha256": study.sha256,
        "parameters": pair.to_toml(),
        "parameters_sha256": parameters_hash(pair),
        "cases_sha256": cases.sha256,
        # Runs with the same versions and code count once, so a resumed sweep gives the same file.
        "versions": "; ".join(dict.fromkeys(run.versions for run in table.runs)),
        "code_sha256": "; ".join(dict.fromkeys(run.code for run in table.runs)),
        "processors": "; ".join(sorted({run.processor for run in table.runs})),
    }


def _with_sensitivity(result: xr.Dataset, cases: CaseList, table: Table) -> xr.Dataset:
    """Add ``sobol_first`` and ``sobol_total`` over (output, axis).

    A failed case would bias the estimators: then there are no indices, and attribute ``sensitivity`` has
    the reason.
    """
    if not cases.study.design.sensitivity:
        return result
    failed = int(np.count_nonzero(Status.failed_among(table.status)))
    missing = int(np.count_nonzero(table.status == Status.MISSING))
    if failed or missing:
        text = f"no indices: {failed} of {cases.count} cases failed, {missing} are not computed yet"
        return result.assign_attrs(sensitivity=text)
    axes = [axis.label for axis in cases.study.axes]
    values = table.values.T
    result = result.assign_coords(
        output=("output", np.array(cases.study.outputs, dtype=object)),
        axis=("axis", np.array(axes, dtype=object)),
    )
    words = {"sobol_first": "first-order Sobol index", "sobol_total": "total Sobol index"}
    for (name, text), array in zip(words.items(), indices(values, len(axes)), strict=True):
        result[name] = (("output", "axis"), array, {"units": "1", "long_name": text})
    constant = [name for name, row in zip(cases.study.outputs, values, strict=True) if np.ptp(row) == 0.0]
    note = f"; not defined for the constant {', '.join(constant)}" if constant else ""
    return result.assign_attrs(sensitivity=f"scipy.stats.sobol_indices{note}")


def indices(values: FloatArray, axes: int) -> FloatArray:
    """Sobol indices, first order and total, (2, outputs, axes); NaN for a constant output.

    ``values`` is (outputs, n (axes + 2)) in the blocks A, B, AB_1 ... AB_axes. The estimators are those of
    Saltelli et al., Comput. Phys. Commun. 181 (2010) 259-270, Table 2 (b) and (f), as in
    ``scipy.stats.sobol_indices``.
    """
    from scipy import stats  # takes a third of a second, and most studies have no use for it

    sobol = np.full((2, len(values), axes), np.nan)
    varies = np.ptp(values, axis=1) > 0.0
    if varies.any():
        # The estimators are invariant under shift and scale. About a zero mean they lose fewer digits, and
        # their squares of numbers of order 1 neither vanish nor overflow.
        values = values[varies]
        values = (values - values.mean(axis=1, keepdims=True)) / np.ptp(values, axis=1)[:, None]
        blocks = values.reshape(len(values), axes + 2, -1).transpose(1, 0, 2)
        func: Any = {"f_A": blocks[0], "f_B": blocks[1], "f_AB": blocks[2:]}
        with np.errstate(invalid="ignore", divide="ignore"):  # A and B alike, as of one sample
            result: Any = stats.sobol_indices(func=func, n=blocks.shape[-1])
        sobol[:, varies] = np.reshape([result.first_order, result.total_order], (2, -1, axes))
    return sobol
