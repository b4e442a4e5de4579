"""The labelled results of a study, compiled from its journal."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from lumped.model.results import parameters_hash
from lumped.typing import FloatArray
from validation.files.regular import StoreError, read_bytes, replaced, storage_failure
from validation.studies.axes import target_of
from validation.studies.cases import CaseList, case_list
from validation.studies.journal import Key, Scan, scan
from validation.studies.load import load_study
from validation.studies.outputs import OUTPUTS
from validation.studies.record import MEANINGS, Record, Status
from validation.studies.sensitivity import add_sensitivity

JOURNAL, STUDY, RESULTS = "journal.bin", "study.toml", "results.nc"
_MAX_STUDY_BYTES = 100_000_000


@dataclass
class Table:
    """Outcomes of all cases, filled record by record; a later record of a case replaces the earlier one.

    Attributes
    ----------
    status : (cases,) ``Status`` codes
    values : (outputs, cases), NaN where the status says that there is no result; None when not wanted
    messages : case -> error text of the failed ones
    """

    status: np.ndarray[Any, np.dtype[np.int8]]
    values: FloatArray | None
    messages: dict[int, str]

    @staticmethod
    def of(cases: CaseList, *, with_values: bool = True) -> Table:
        """Return an empty table."""
        values = np.full((len(cases.study.outputs), cases.count), np.nan) if with_values else None
        return Table(np.full(cases.count, Status.MISSING, dtype=np.int8), values, {})

    def add(self, record: Record) -> None:
        """Enter a record."""
        case = record.case
        self.status[case] = record.status
        if record.status.failed:
            self.messages[case] = record.message
        else:
            self.messages.pop(case, None)
        if self.values is not None:
            self.values[:, case] = np.nan if record.status.failed else record.values

    def counts(self) -> Counter[Status]:
        """Cases by status."""
        codes, numbers = np.unique(self.status, return_counts=True)
        return Counter({Status(int(c)): int(n) for c, n in zip(codes, numbers, strict=True)})


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
    root = Path(folder)
    text = read_bytes(root / STUDY, _MAX_STUDY_BYTES)
    cases = case_list(load_study(text.decode("utf-8", "replace"), name=str(root / STUDY)))
    table = Table.of(cases)
    found = scan(root / JOURNAL, Key(cases), table.add)
    return results_dataset(cases, table, found)


def results_dataset(cases: CaseList, table: Table, found: Scan) -> xr.Dataset:
    """Label the outcomes of a study.

    Returns
    -------
    xarray.Dataset with the study's outputs and ``status`` (flag meanings in its attributes); the cases
    without outputs with their error text in ``failure_message`` over ``failure``; the axes in the fields'
    stated units; sensitivity indices where the design asks for them
    """
    study = cases.study
    assert table.values is not None
    dims, shape = cases.dims, cases.shape
    result = xr.Dataset(attrs=_attributes(cases, found))
    for label, coordinate in _coordinates(cases).items():
        result = result.assign_coords({label: coordinate})
    for name, row in zip(study.outputs, table.values, strict=True):
        unit, text = OUTPUTS[study.analysis][name]
        result[name] = xr.DataArray(row.reshape(shape), dims=dims, attrs={"units": unit, "long_name": text})
    flags = [status for status in MEANINGS if status is not Status.SESSION]
    result["status"] = xr.DataArray(
        table.status.reshape(shape),
        dims=dims,
        attrs={
            "long_name": "what became of the case",
            "flag_values": np.array(flags, dtype=np.int8),
            "flag_meanings": " ".join(flag.name.lower() for flag in flags),
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
    return add_sensitivity(result, cases, table.status, table.values)


def write_results(folder: Path, result: xr.Dataset) -> Path:
    """Write ``results.nc`` completely or not at all; the same results give the same bytes.

    Raises
    ------
    StoreError : it cannot be written
    """
    path = folder / RESULTS
    with replaced(path) as part:
        try:
            result.to_netcdf(part, engine="h5netcdf", format="NETCDF4")
        except (RuntimeError, ValueError) as error:  # how HDF5 may report a failed write
            raise storage_failure(path, "write it", OSError(str(error))) from error
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


def _attributes(cases: CaseList, found: Scan) -> dict[str, Any]:
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
        # Runs with the same versions count once, so a resumed sweep gives the same file.
        "versions": "; ".join(dict.fromkeys(found.sessions)),
    }


__all__ = ["StoreError", "Table", "read_results", "results_dataset", "write_results"]
