"""A disk that takes no more: one message with the path, exit code 3, and nothing left behind."""

import os
import signal
import subprocess
import sys

import pytest

resource = pytest.importorskip("resource", reason="limits of a process are POSIX")


def limited():
    """A file may grow to 4 kB: writing more fails as on a full disk, at any place."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


#: Runs the command for each file, and ends with the exit codes.
RUNS = """
import sys
from validation.cli import main
for out in sys.argv[1:]:
    sys.argv = ["spurcheck", "simulate", "--cycles", "1", "-o", out]
    try:
        main()
    except SystemExit as stop:
        print("exit code", stop.code, file=sys.stderr)
"""


def test_a_result_that_does_not_fit_is_told_and_leaves_nothing(tmp_path):
    # HDF5 alone ends the process with a segmentation fault here.
    outs = [str(tmp_path / f"run.{suffix}") for suffix in ("nc", "csv", "mat", "png")]
    # Without compiling: its cache could not be written either.
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "MPLBACKEND": "Agg"}
    command = [sys.executable, "-c", RUNS, *outs]
    run = subprocess.run(command, preexec_fn=limited, capture_output=True, text=True, env=environment)
    assert run.returncode == 0, run.stderr
    told = run.stderr.split("exit code 3")
    assert len(told) == len(outs) + 1
    assert [out in text for out, text in zip(outs, told, strict=False)] == [True] * len(outs)
    assert "Traceback" not in run.stderr
    assert list(tmp_path.iterdir()) == []
