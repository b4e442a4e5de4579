"""Studies: many cases of one gear pair, in parallel, resumable, on one machine or a cluster."""

from validation.studies.analyses import Settings
from validation.studies.axes import Axis
from validation.studies.cluster import Cluster, ClusterStopped, open_cluster
from validation.studies.results import read_results
from validation.studies.runner import Summary, refuse_other_contents, run_sweep
from validation.studies.schema import Design, Study, load_study
from validation.studies.store import Status, StoreError
from validation.studies.workers import SweepStopped

__all__ = [
    "Axis",
    "Cluster",
    "ClusterStopped",
    "Design",
    "Settings",
    "Status",
    "StoreError",
    "Study",
    "Summary",
    "SweepStopped",
    "load_study",
    "open_cluster",
    "read_results",
    "refuse_other_contents",
    "run_sweep",
]
