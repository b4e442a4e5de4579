"""Does the same study give the same bytes on a Dask cluster, also when its workers die?"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time

import pebble
import pytest

from lumped.errors import ParameterError
from validation.studies import Status, SweepStopped, dispatch, pools, run_sweep
from validation.studies import cluster as cluster_pool
from validation.studies.provenance import provenance

distributed = pytest.importorskip("distributed", reason="needs distributed (extra: cluster)")
pytestmark = [
    pytest.mark.slow,
    # The cluster's own event loop and sockets may outlive it by a moment.
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


@pytest.fixture(scope="module")
def cluster():
    """Two worker processes behind a scheduler on TCP."""
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        protocol="tcp",
        dashboard_address=":0",
        silence_logs=50,
    ) as cluster:
        yield cluster


def worker_pids(cluster):
    return {name: worker.pid for name, worker in cluster.workers.items()}


def test_a_cluster_gives_the_same_bytes_also_after_losing_a_worker(study, tmp_path, undisturbed, cluster):
    assert cluster.scheduler_address.startswith("tcp://")
    plain = run_sweep(study, tmp_path / "plain", scheduler=cluster.scheduler_address)
    assert plain.results.read_bytes() == undisturbed

    killed = []

    def kill_one(done, total, failed):
        if not killed:
            pid = next(iter(worker_pids(cluster).values()))
            os.kill(pid, signal.SIGKILL)
            killed.append(pid)

    out = tmp_path / "killed"
    summary = run_sweep(study, out, scheduler=cluster.scheduler_address, progress=kill_one)
    assert killed
    assert summary.results.read_bytes() == undisturbed


def test_a_case_that_kills_every_worker_is_found_out(study, tmp_path, cluster, odd, monkeypatch, undisturbed):
    with distributed.Client(cluster) as client:
        client.run_on_scheduler(lambda dask_scheduler: setattr(dask_scheduler, "allowed_failures", 0))
    odd("is_killed", 41)
    summary = run_sweep(study, tmp_path / "out", scheduler=cluster.scheduler_address)
    monkeypatch.undo()
    assert dict(summary.statuses)[Status.WORKER_DIED] == 1
    assert 41 in dict(summary.failures)
    again = run_sweep(study, tmp_path / "out", resume=True, retry_failed=True)
    assert again.results.read_bytes() == undisturbed


def test_a_result_lost_before_it_is_fetched_ends_its_future(tmp_path, cluster, monkeypatch):
    # The batch is done, its worker dies before the result is fetched, and computing it again kills the next.
    second = tmp_path / "computed once"

    def work(*arguments):
        if second.exists():
            os.kill(os.getpid(), signal.SIGKILL)
        second.touch()
        return os.getpid()

    monkeypatch.setattr(cluster_pool, "evaluate_on_cluster", work)
    pool = cluster_pool.DaskPool(cluster.scheduler_address)
    pool._client.run_on_scheduler(lambda dask_scheduler: setattr(dask_scheduler, "allowed_failures", 0))
    fetch, killed = pool._client._gather, []

    async def late(tasks, *arguments, **options):
        if not killed:
            (holder,) = next(iter((await pool._client.who_has(tasks)).values()))
            killed.append(pid_of[holder])
            os.kill(killed[0], signal.SIGKILL)
        return await fetch(tasks, *arguments, **options)

    pid_of = pool._client.run(os.getpid)
    pool._client._gather = late
    try:
        error = pool.submit(None, [], [], None).exception(timeout=60)
    finally:
        pool.close()
    assert killed
    assert second.exists()
    assert isinstance(error, pebble.ProcessExpired)


def test_time_limits_hold_on_threads_and_a_lost_scheduler_loses_nothing(
    study, make_study, tmp_path, undisturbed
):
    cluster = distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, protocol="tcp", dashboard_address=":0", silence_logs=50
    )
    # 100000 mesh cycles of the multibody model take minutes.
    endless = make_study(
        analysis="multibody",
        outputs=["dte_rms"],
        settings={"cycles": 100_000},
        axes=[{"field": "operating.pinion_speed", "values": [2000, 3000]}],
    )
    address = cluster.scheduler_address
    summary = run_sweep(endless, tmp_path / "endless", scheduler=address, case_seconds=1.0)
    assert dict(summary.statuses) == {Status.TIME_LIMIT: 2}
    plain = run_sweep(study, tmp_path / "plain", scheduler=address, case_seconds=60.0)
    assert plain.results.read_bytes() == undisturbed
    computed = []

    def lose(done, total, failed):
        computed.append(done)
        if len(computed) == 3:
            cluster.close()

    with pytest.raises(SweepStopped, match="--resume"):
        run_sweep(study, tmp_path / "out", scheduler=address, progress=lose)
    summary = run_sweep(study, tmp_path / "out", resume=True, workers=2)
    assert summary.before >= computed[2]
    assert summary.results.read_bytes() == undisturbed


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory):
    """Process of a scheduler, its address, and the process of its one worker; a test leaves them running."""
    known = tmp_path_factory.mktemp("scheduler") / "scheduler.json"
    options = ["--port", "0", "--dashboard-address", ":0", "--scheduler-file", str(known)]
    worker_options = ["--nthreads", "1", "--no-nanny"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    run = [sys.executable, "-m"]
    process = subprocess.Popen([*run, "distributed.cli.dask_scheduler", *options], **quiet)
    while not known.exists():
        assert process.poll() is None
        time.sleep(0.1)
    address = json.loads(known.read_text())["address"]
    worker = subprocess.Popen([*run, "distributed.cli.dask_worker", address, *worker_options], **quiet)
    yield process, address, worker
    for each in (process, worker):
        each.kill()
        each.wait()


def test_a_scheduler_that_stands_still_stops_the_sweep(study, tmp_path, scheduler, monkeypatch, undisturbed):
    process, address, _ = scheduler

    def freeze(done, total, failed):
        if thaw.ident is None:
            monkeypatch.setattr(pools, "GIVEN_UP_SECONDS", 0.5)
            monkeypatch.setattr(cluster_pool, "_ANSWER_SECONDS", 0.3)
            process.send_signal(signal.SIGSTOP)  # its connections stay open
            thaw.start()  # so that a client that waits for ever fails this test instead of hanging it

    thaw = threading.Timer(30.0, process.send_signal, [signal.SIGCONT])
    with pytest.raises(SweepStopped, match="--resume"):
        run_sweep(study, tmp_path / "out", scheduler=address, progress=freeze)
    thaw.cancel()
    process.send_signal(signal.SIGCONT)
    summary = run_sweep(study, tmp_path / "out", resume=True)
    assert summary.before > 0
    assert summary.results.read_bytes() == undisturbed


def test_a_worker_that_stands_still_is_named(study, tmp_path, scheduler, monkeypatch, undisturbed):
    monkeypatch.setattr(pools, "TOLD_SECONDS", 2.0)
    _, address, worker = scheduler
    frozen, told = [], []

    def freeze(done, total, failed):
        if not frozen:
            worker.send_signal(signal.SIGSTOP)
            frozen.append(done)

    def thaw(text):
        told.append(text)
        if "Worker" in text:
            worker.send_signal(signal.SIGCONT)

    summary = run_sweep(study, tmp_path / "out", scheduler=address, progress=freeze, tell=thaw)
    assert any("Worker tcp://" in text and "worker-ttl" in text for text in told)
    assert summary.results.read_bytes() == undisturbed


def test_a_cluster_with_other_code_is_refused(study, tmp_path, scheduler, monkeypatch):
    monkeypatch.setattr(dispatch, "provenance", lambda: provenance()._replace(code="0" * 64))
    with pytest.raises(SweepStopped, match="same code"):
        run_sweep(study, tmp_path / "out", scheduler=scheduler[1])


def test_ctrl_c_is_answered_at_once_also_by_a_scheduler_that_stands_still(study, tmp_path, scheduler):
    process, address, _ = scheduler
    asked = []

    def freeze(done, total, failed):
        if not asked:
            asked.append(time.monotonic())
            process.send_signal(signal.SIGSTOP)
            threading.Timer(1.0, os.kill, [os.getpid(), signal.SIGINT]).start()

    try:
        with pytest.raises(KeyboardInterrupt):
            run_sweep(study, tmp_path / "out", scheduler=address, progress=freeze)
        assert time.monotonic() - asked[0] < 1.0 + 2.0
    finally:
        process.send_signal(signal.SIGCONT)


def test_no_scheduler_is_refused(study, tmp_path, monkeypatch):
    monkeypatch.setattr(cluster_pool, "_CONNECT_SECONDS", 0.5)
    with pytest.raises(ParameterError, match="running scheduler"):
        run_sweep(study, tmp_path / "out", scheduler="tcp://127.0.0.1:9")
    # Without certificates, and no address at all.
    for address in ("tls://127.0.0.1:9", "nonsense://x", ""):
        with pytest.raises(ParameterError, match="running scheduler"):
            run_sweep(study, tmp_path / "out", scheduler=address)
    # One left half made would print a traceback when the interpreter ends, after 40 s.
    assert all(client.status == "closed" for client in distributed.Client._instances)


# The last test of the module, for the scheduler is gone then.
def test_the_command_says_in_one_line_that_the_scheduler_died(make_study, tmp_path, scheduler):
    process, address, worker = scheduler
    long = make_study(
        analysis="multibody",
        outputs=["dte_rms"],
        settings={"cycles": 100_000},
        axes=[{"field": "operating.pinion_speed", "values": [2000, 3000]}],
    )
    (tmp_path / "long.toml").write_text(long.to_toml())
    command = [sys.executable, "-m", "validation.cli", "sweep", "long.toml", "--scheduler", address]
    sweep = subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    with distributed.Client(address, set_as_default=False) as client:
        while not any(client.processing().values()):
            assert sweep.poll() is None, sweep.communicate()[0]
            time.sleep(0.1)
    worker.send_signal(signal.SIGSTOP)  # it computes no more while the command ends
    process.kill()
    text, _ = sweep.communicate(timeout=60)
    assert sweep.returncode == 3
    assert "--resume" in text
    assert "Traceback" not in text
