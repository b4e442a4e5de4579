"""Studies: many cases of one gear pair, in parallel, resumable, on one machine or a cluster."""

from validation.studies.analyses import Settings
from validation.studies.axes import Axis
from validation.studies.evaluate import Status
from validation.studies.load import load_study
from validation.studies.pools import SweepStopped
from validation.studies.results import read_results
from validation.studies.runner import Summary, run_sweep
from validation.studies.schema import Design, Study
from validation.studies.storage import StoreError

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
