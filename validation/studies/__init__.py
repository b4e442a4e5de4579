"""Studies: many cases of one gear pair, in parallel, resumable, on one machine or a cluster."""

from validation.files.regular import StoreError
from validation.studies.axes import Axis
from validation.studies.load import load_study
from validation.studies.pools import SweepStopped
from validation.studies.record import Status
from validation.studies.results import read_results
from validation.studies.runner import Summary, run_sweep
from validation.studies.schema import Design, Settings, Study

__all__ = [
    "Axis",
    "Design",
    "Settings",
    "Status",
    "StoreError",
    "Study",
    "Summary",
    "SweepStopped",
    "load_study",
    "read_results",
    "run_sweep",
]
