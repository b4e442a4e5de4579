"""A disk that takes no more: one message with the path, exit code 3, and nothing left behind."""

import os
import subprocess
import sys

import pytest

resource = pytest.importorskip("resource", reason="limits of a process are POSIX")
signal = pytest.importorskip("signal")


def limited():
    """A file may grow to 4 kB: writing more fails as on a full disk, at any place."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


@pytest.mark.parametrize("suffix", ["nc", "csv", "mat", "png"])
def test_a_result_that_does_not_fit_is_told_and_leaves_nothing(tmp_path, suffix):
    # HDF5 alone ends the process with a segmentation fault here.
    out = tmp_path / f"run.{suffix}"
    command = [sys.executable, "-m", "validation.cli", "simulate", "--cycles", "4", "-o", str(out)]
    # Without compiling: its cache could not be written either.
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "MPLBACKEND": "Agg"}
    run = subprocess.run(command, preexec_fn=limited, capture_output=True, text=True, env=environment)
    assert run.returncode == 3
    assert str(out) in run.stderr
    assert "Traceback" not in run.stderr
    assert list(tmp_path.iterdir()) == []
