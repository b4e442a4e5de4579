"""Does a study run on a Dask cluster as on this machine, whatever scheduler and workers do meanwhile?

Scheduler and workers are processes of this machine, as a user starts them.
tests/validation/commands/test_cluster_option.py has ranges and charts.
"""

import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest

from lumped.errors import ParameterError
from validation.studies import (
    Status,
    StoreError,
    SweepStopped,
    open_cluster,
    read_results,
    run_sweep,
    runner,
    workers,
)
from validation.studies import cluster as clusters
from validation.studies.cases import CaseList, StudyEvaluator

pytest.importorskip("distributed", reason="needs distributed (extra: cluster)")
#: The event loop and the sockets of Dask may outlive a client by a moment.
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning")
HERE = Path(__file__).parent
ROOT = HERE.parents[2]
#: Longest start of a process on a busy machine [s].
PATIENCE = 120.0


def wait_until(condition, what):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, what
        time.sleep(0.05)


class Dask:
    """A scheduler and workers, all of them processes of their own.

    Attributes
    ----------
    address : of the scheduler
    """

    def __init__(self, folder):
        self._folder = folder
        self._processes = []
        file = folder / "scheduler.json"
        self.scheduler = self._start(
            "dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file)
        )
        # The file is there before its text is.
        wait_until(lambda: file.exists() and file.read_text().endswith("}"), "the scheduler does not start")
        self.address = json.loads(file.read_text())["address"]

    def _start(self, program, *arguments, **environment):
        path = os.pathsep.join([str(ROOT), str(HERE), *filter(None, [os.environ.get("PYTHONPATH")])])
        process = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{program}", *arguments, "--no-dashboard"],
            env=os.environ | {"PYTHONPATH": path} | environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd=self._folder,
        )
        self._processes.append(process)
        return process

    def worker(self, **environment):
        """Start a worker of one thread. It stays dead when it is killed: it has no nanny."""
        return self._start(
            "dask_worker", self.address, "--host", "127.0.0.1", "--nthreads", "1", "--no-nanny", **environment
        )

    def end(self):
        for process in self._processes:
            process.kill()
            process.wait()


@pytest.fixture
def dask(tmp_path):
    cluster = Dask(tmp_path)
    yield cluster
    cluster.end()


@pytest.fixture
def slowly(study, tmp_path, monkeypatch):
    """Let each case of the study take its time. Returns the folder with the numbers of the processes."""
    from odd_evaluators import Slow

    folder = tmp_path / "processes"
    folder.mkdir()

    def of(processes):
        evaluator = Slow(StudyEvaluator.of(study), folder, processes=processes)
        monkeypatch.setattr(runner, "StudyEvaluator", SimpleNamespace(of=lambda study: evaluator))
        return folder

    return of


def stored(out):
    return int((read_results(out).status != Status.MISSING).sum())


@pytest.mark.slow
def test_a_worker_is_killed_and_the_client_interrupted_and_no_row_is_missing(
    study, dask, tmp_path, monkeypatch, slowly, undisturbed
):
    """The scheduler has no worker at first. A second one joins, is killed, then the sweep is stopped."""
    folder = slowly(processes=2)
    out = tmp_path / "out"
    messages = []
    begun = []
    sizes = set()

    def tell(text):
        messages.append(text)
        begun.append(dask.worker())

    def progress(done, total, failed):
        sizes.add(cluster.workers)
        if done > 20 and len(begun) == 2 and cluster.workers == 2:
            begun[1].kill()
            begun.append("killed")
        if done > 60 and len(begun) == 3 and cluster.workers == 1:
            raise KeyboardInterrupt

    with open_cluster(dask.address, wait_seconds=PATIENCE, tell=tell) as cluster:
        assert cluster.workers == 1
        begun.append(dask.worker())
        with pytest.raises(KeyboardInterrupt):
            run_sweep(study, out, executor=cluster, progress=progress)
    assert messages == [f"{dask.address} has no workers yet: waiting for the first for up to {PATIENCE:g} s."]
    assert begun[2:] == ["killed"]
    assert sizes >= {1, 2}
    processes = {int(path.name) for path in folder.iterdir()}
    assert processes == {begun[0].pid, begun[1].pid}
    assert 60 < stored(out) < 120
    monkeypatch.undo()
    assert run_sweep(study, out, resume=True).results.read_bytes() == undisturbed


@pytest.mark.slow
@pytest.mark.parametrize("lost", ["workers", "scheduler"])
def test_a_cluster_that_is_lost_ends_the_sweep_and_says_how_to_go_on(
    study, dask, tmp_path, monkeypatch, slowly, undisturbed, lost
):
    slowly(processes=1)
    worker = dask.worker()
    told = []
    with open_cluster(dask.address, wait_seconds=PATIENCE, tell=told.append) as cluster:
        cluster._wait_seconds = 1.5

        def progress(done, total, failed):
            if done == 1:
                (worker if lost == "workers" else dask.scheduler).kill()

        words = {"workers": "had no worker for 1.5 s", "scheduler": "does not answer any more"}[lost]
        with pytest.raises(SweepStopped, match=f"{dask.address} {words}.*go on with --resume"):
            run_sweep(study, tmp_path / "out", executor=cluster, progress=progress)
    assert any("has lost all workers: waiting" in text for text in told) == (lost == "workers")
    monkeypatch.undo()
    assert 0 < stored(tmp_path / "out") < 120
    assert run_sweep(study, tmp_path / "out", resume=True).results.read_bytes() == undisturbed


@pytest.mark.slow
def test_what_is_refused_before_a_case_is_computed(dask):
    """No worker in the time; a worker with other settings of the compiler; the address of a worker."""
    told = []

    def refused(address, **options):
        with pytest.raises(ParameterError) as error, open_cluster(address, tell=told.append, **options):
            pass
        (problem,) = error.value.problems
        assert (problem.field, problem.value) == ("cluster", address)
        return str(problem)

    text = refused(dask.address, wait_seconds=0.5)
    assert f"None joined in 0.5 s: start 'dask worker {dask.address} --nthreads 1', or wait longer." in text
    assert told == [f"{dask.address} has no workers yet: waiting for the first for up to 0.5 s."]
    dask.worker(NUMBA_OPT="1")
    text = refused(dask.address, wait_seconds=PATIENCE)
    assert "NUMBA_OPT=1" in text
    assert "install the same code and the same versions" in text
    worker = text.partition("The worker ")[2].partition(" ")[0]
    assert "A worker has that address: give the address that 'dask scheduler' prints." in refused(worker)


@pytest.mark.parametrize("address", [
    "head", "local", "local:x", "tcp://head", "head:0", "head:65536", "http://head:80", "tcp://a b:1", "",
])  # fmt: skip
def test_what_is_no_address_is_refused(address):
    with pytest.raises(ParameterError, match="'dask scheduler' prints its address"), open_cluster(address):
        pass


@pytest.mark.parametrize("number", [0, 1025])
def test_a_number_of_local_workers_has_a_range(number):
    with (
        pytest.raises(ParameterError, match=f"local:{number}: allowed local:1 to local:1024"),
        open_cluster(f"local:{number}"),
    ):
        pass


@pytest.mark.parametrize("listens", [False, True])
def test_what_is_no_scheduler_is_refused_in_time(listens, monkeypatch):
    """A port that nobody has, and a program that takes the connection and says nothing."""
    monkeypatch.setattr(clusters, "ANSWER_SECONDS", 0.5)
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        if listens:
            server.listen()
        start = time.monotonic()
        with (
            pytest.raises(ParameterError, match=r"no answer in 0\.5 s\. Start 'dask scheduler'"),
            open_cluster(f"tcp://127.0.0.1:{server.getsockname()[1]}"),
        ):
            pass
    assert time.monotonic() - start < 10.0


@pytest.mark.slow
def test_a_case_that_ends_its_worker_costs_itself_alone(study, tmp_path, monkeypatch, undisturbed):
    """A worker is started again after its end. The worker processes find ``odd_evaluators``."""
    import dask
    from odd_evaluators import Odd

    evaluator = StudyEvaluator.of(study)
    (values,) = CaseList(study).values([41])
    odd = Odd(evaluator, "is_killed", values)
    path = os.pathsep.join([str(ROOT), str(HERE), *filter(None, [os.environ.get("PYTHONPATH")])])
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        monkeypatch.context() as patch,
    ):
        patch.setenv("PYTHONPATH", path)
        patch.setattr(runner, "StudyEvaluator", SimpleNamespace(of=lambda study: odd))
        patch.setattr(workers, "CHUNK_SECONDS", 0.0)  # single cases: fewer workers have to die
        with open_cluster("local:2") as cluster:
            with pytest.raises(ParameterError, match="none with a cluster"):
                run_sweep(study, tmp_path / "out", executor=cluster, workers=2)
            summary = run_sweep(study, tmp_path / "out", executor=cluster)
    assert dict(summary.statuses) == {Status.OK: 95, Status.REFUSED: 24, Status.WORKER_DIED: 1}
    assert dict(summary.failures)[41] == "the worker process died on this case"
    again = run_sweep(study, tmp_path / "out", resume=True, retry_failed=True)
    assert again.results.read_bytes() == undisturbed


def test_no_thread_of_a_refused_cluster_is_left(monkeypatch):
    monkeypatch.setattr(clusters, "ANSWER_SECONDS", 0.2)
    before = threading.active_count()
    with pytest.raises(ParameterError), open_cluster("tcp://127.0.0.1:1"):
        pass
    assert threading.active_count() == before


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="signals of Linux")
def test_ctrl_c_reaches_all_processes_of_a_terminal_and_only_the_sweep_says_so(make_study, tmp_path):
    """The workers of local:N are processes of the same terminal."""
    axes = [{"field": "speed_rpm", "low": 1000, "high": 6000, "count": 2000}]
    study = make_study(analysis="lumped", outputs=["dte_rms"], axes=axes)
    (tmp_path / "study.toml").write_text(study.to_toml())
    out = tmp_path / "out"

    def begun():
        try:
            return stored(out) > 5
        except StoreError:  # none yet
            return False

    words = ["sweep", "study.toml", "-o", str(out), "--cluster", "local:1"]
    run = subprocess.Popen(
        [sys.executable, "-m", "validation.cli", *words],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])},
        text=True,
        stderr=subprocess.PIPE,
        start_new_session=True,
        # A job in the background of a shell, such as these tests, ignores Ctrl-C, and its processes with it.
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )
    wait_until(begun, "no case was computed")
    os.killpg(run.pid, signal.SIGINT)
    _, text = run.communicate(timeout=PATIENCE)
    assert run.returncode == 130
    assert "Traceback" not in text
    assert text.rstrip().endswith(f"what was computed is in {out}: run the command with --resume.")
    assert 5 < stored(out) < 2000


@pytest.mark.slow
def test_workers_of_a_script_without_its_guard_do_not_start_and_it_says_why(tmp_path):
    script = tmp_path / "unguarded.py"
    script.write_text("import spurcheck\nwith spurcheck.open_cluster('local:1'):\n    pass\n")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    ended = subprocess.run(
        [sys.executable, str(script)], env=environment, capture_output=True, text=True, timeout=PATIENCE
    )
    assert ended.returncode == 1
    assert "open_cluster under `if __name__ == '__main__':`" in ended.stderr.splitlines()[-1]
