"""After a fault of the disk, does resuming give the undisturbed result, byte for byte?"""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys

import pytest

from validation.studies import StoreError, run_sweep

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="mounts and limits of Linux"),
]


@pytest.fixture
def small_disk(tmp_path):
    """A disk of its own of 512 kB, with a function that changes its mount options."""
    folder = tmp_path / "disk"
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=512k", "tmpfs", str(folder)]
    if os.geteuid() != 0 or subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip("mounting a file system needs root")
    yield folder, lambda options: subprocess.run(["mount", "-o", options, str(folder)], check=True)
    subprocess.run(["umount", str(folder)], check=True)


def fill(folder):
    """Write to the disk until nothing more fits."""
    with (folder / "filler").open("ab", buffering=0) as file:
        try:
            while True:
                file.write(b"x" * 512)
        except OSError:
            pass


@pytest.mark.parametrize("when", [1, 60, 120])
def test_full_disk(small_disk, sweep_in, when):
    disk, _ = small_disk
    sweep = sweep_in(disk / "out")

    def fill_at(done, total, failed):
        if done >= when and not (disk / "filler").exists():
            fill(disk)

    with pytest.raises(StoreError, match=r"disk.*--resume"):
        run_sweep(sweep.study, sweep.out, progress=fill_at)
    fill(disk)  # what the log had taken is free again where it was in the store already
    with pytest.raises(StoreError, match=r"Free space|disk|unable to open|No space"):
        run_sweep(sweep.study, sweep.out, resume=True)
    (disk / "filler").unlink()
    before = sweep.finished()
    assert len(before) >= when
    sweep.check_resume(before)


LIMITED = """
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, (80_000, resource.RLIM_INFINITY))
"""


def test_a_file_size_limit_in_the_middle_of_the_store(sweep):
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] == resource.RLIM_INFINITY
    run = sweep.start(LIMITED)
    _, errors = run.communicate()
    assert "StoreError" in errors
    assert "--resume" in errors
    before = sweep.finished()
    assert 0 < len(before) < 120
    sweep.check_resume(before)


def test_write_permission_revoked_before_resuming(small_disk, sweep_in):
    disk, remount = small_disk
    sweep = sweep_in(disk / "out")

    def stop(done, total, failed):
        if done >= 50:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_sweep(sweep.study, sweep.out, progress=stop)
    before = sweep.finished()
    remount("remount,ro")
    with pytest.raises(StoreError, match=r"Read-only.*--resume"):
        run_sweep(sweep.study, sweep.out, resume=True)
    remount("remount,rw")
    sweep.check_resume(before)


def test_write_permission_revoked_in_the_middle(sweep):
    command = [sys.executable, *sweep.command(sweep.SLOW)]
    if os.geteuid() == 0:  # root writes wherever it likes, unless it gives up that capability
        if shutil.which("setpriv") is None:
            pytest.skip("root needs setpriv (util-linux)")
        command = ["setpriv", "--bounding-set=-dac_override,-dac_read_search", *command]
    run = subprocess.Popen(command, text=True, stderr=subprocess.PIPE)
    sweep.wait_for(lambda: len(sweep.finished()) >= 5 or run.poll() is not None, "cases")
    # The store stays open, so what is lost is the right to make the result.
    sweep.out.chmod(0o555)
    _, errors = run.communicate()
    assert "Permission denied" in errors
    assert "--resume" in errors
    sweep.out.chmod(0o755)
    before = sweep.finished()
    assert len(before) == 120
    sweep.check_resume(before)


def test_everything_but_the_store_can_be_rebuilt(sweep):
    run_sweep(sweep.study, sweep.out)
    (sweep.out / "results.nc").unlink()
    sweep.check_resume(range(120))
