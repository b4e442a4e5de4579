"""The options --cluster and --wait-seconds: the workers of a Dask cluster compute instead of this machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from validation.commands.terminal import note

if TYPE_CHECKING:
    from validation.studies.cluster import Cluster


def refuse_no_address(address: str | None) -> None:
    """Refuse a value of --cluster that is no address, before the parameter file is read."""
    if address is not None:
        from validation.studies.cluster import workers_on_this_machine

        workers_on_this_machine(address)


@contextmanager
def cluster_of(address: str | None, wait_seconds: float | None) -> Iterator[Cluster | None]:
    """Open the cluster of --cluster. None: the option is not there, and this machine computes.

    Parameters
    ----------
    address : value of --cluster
    wait_seconds : value of --wait-seconds, the longest time without a worker [s]; None: the default

    Raises
    ------
    ParameterError : --wait-seconds without --cluster, and what ``open_cluster`` refuses
    """
    from lumped.errors import refuse

    if address is None:
        if wait_seconds is not None:
            raise refuse("wait_seconds", wait_seconds, "none without --cluster", "Leave it out.")
        yield None
        return
    from validation.studies.cluster import WAIT_SECONDS, open_cluster

    wait = WAIT_SECONDS if wait_seconds is None else wait_seconds
    with open_cluster(address, wait_seconds=wait, tell=note) as opened:
        yield opened
