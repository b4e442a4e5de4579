"""The labelled results of a study, compiled from its store."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from lumped.arguments import file_path
from lumped.model.results import parameters_hash
from validation.files.output import whole_file
from validation.studies.analyses import ANALYSES
from validation.studies.axes import target_of
from validation.studies.cases import CaseList
from validation.studies.evaluate import Status
from validation.studies.load import load_study
from validation.studies.sensitivity import add_sensitivity
from validation.studies.storage import STORE, storage_failure
from validation.studies.store import Table, read_definition, read_table

RESULTS = "results.nc"


def read_results(folder: str | Path) -> xr.Dataset:
    """Return what a store holds so far, also while the sweep runs or after it was killed.

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

    Returns
    -------
    xarray.Dataset with the study's outputs and ``status`` (flag meanings in its attributes); the failed cases
    with their error text in ``failure_message`` over ``failure``, the first ``store.MAX_FAILURES`` of them;
    the axes in the fields' stated units; sensitivity indices where the design asks for them
    """
    study = cases.study
    assert table.values is not None
    dims, shape = cases.dims, cases.shape
    result = xr.Dataset(attrs=_attributes(cases, table))
    for label, coordinate in _coordinates(cases).items():
        result = result.assign_coords({label: coordinate})
    for name, row in zip(study.outputs, table.values.T, strict=True):
        unit, text = ANALYSES[study.analysis].outputs[name]
        result[name] = xr.DataArray(row.reshape(shape), dims=dims, attrs={"units": unit, "long_name": text})
    result["status"] = xr.DataArray(
        table.status.reshape(shape),
        dims=dims,
        attrs={
            "long_name": "what became of the case",
            "flag_values": np.array(list(Status), dtype=np.int8),
            "flag_meanings": " ".join(flag.name.lower() for flag in Status),
        },
    )
    failed = sorted(table.messages)
    text_type = np.array([table.messages[case] for case in failed], dtype=object)
    result["failed_case"] = xr.DataArray(
        np.array(failed, dtype=np.int64), dims="failure", attrs={"long_name": "number of the failed case"}
    )
    result["failure_message"] = xr.DataArray(
        text_type, dims="failure", attrs={"long_name": "why the case failed"}
    )
    return add_sensitivity(result, cases, table.status, table.values.T)


def write_results(folder: Path, result: xr.Dataset) -> Path:
    """Write ``results.nc`` completely or not at all; the same results give the same bytes.

    Raises
    ------
    StoreError : it cannot be written
    """
    path = folder / RESULTS
    try:
        with whole_file(path) as part:
            result.to_netcdf(part, engine="h5netcdf", format="NETCDF4")
    except (OSError, RuntimeError, ValueError) as error:  # HDF5 reports a failed write in several ways
        raise storage_failure(path, "write it", error) from error
    return path


def _coordinates(cases: CaseList) -> dict[str, xr.DataArray]:
    study = cases.study
    found: dict[str, xr.DataArray] = {}
    if cases.grid is None:
        columns: list[Any] = cases.columns(np.arange(cases.count))
        found["case"] = xr.DataArray(
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
        found[axis.label] = xr.DataArray(array, dims=dim, attrs=attrs)
    return found


def _attributes(cases: CaseList, table: Table) -> dict[str, Any]:
    study = cases.study
    return {
        "title": study.name,
        "description": study.description,
        "gear_pair": study.gear_pair.name,
        "analysis": study.analysis,
        "study": study.to_toml(),
        "study_sha256": study.sha256,
        "parameters_sha256": parameters_hash(study.gear_pair),
        "cases_sha256": cases.sha256,
        # Runs with the same versions and code count once, so a resumed sweep gives the same file.
        "versions": "; ".join(dict.fromkeys(run.versions for run in table.runs)),
        "code_sha256": "; ".join(dict.fromkeys(run.code for run in table.runs)),
        "processors": "; ".join(sorted({run.processor for run in table.runs})),
    }
