"""Do `uncertainty`, `compare` and `stability` give the same file on the workers of a cluster?"""

import pytest

from lumped import load_gear_pair
from tests.unlike_pairs import unlike_pair
from validation.exchange import read_netcdf
from validation.studies.cluster import ONE_THREAD

from .conftest import refused, run


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Parameter files of two unlike pairs, both with assumed inputs."""
    folder = tmp_path_factory.mktemp("pairs")
    for name in ("larger_gear_drives_contact_lost", "contact_ratio_1_1_large_shifts"):
        (folder / f"{name}.toml").write_text(unlike_pair(name).to_toml())
    (folder / "preset.toml").write_text(load_gear_pair("nasa_28_28").to_toml())
    return folder


@pytest.fixture(scope="module")
def address():
    """Address of a scheduler with two workers on this machine, which all commands use: a start costs 9 s."""
    distributed = pytest.importorskip("distributed", reason="needs distributed (extra: cluster)")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, protocol="tcp", dashboard_address="127.0.0.1:0", env=ONE_THREAD
    ) as cluster:
        yield cluster.scheduler_address


COMMANDS = {
    "uncertainty": ("uncertainty", "larger_gear_drives_contact_lost.toml", "--samples", 16),
    "compare": (
        *("compare", "contact_ratio_1_1_large_shifts.toml", "--variant", "mesh.damping_ratio=0.09"),
        *("--samples", 16),
    ),
    "stability": (
        *("stability", "contact_ratio_1_1_large_shifts.toml", "--axis", "torque=30:55:2"),
        *("--axis", "speed_rpm=2000:9000:11", "--axis", "damping_ratio=0:0.02:7"),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_a_cluster_writes_the_bytes_of_this_process(files, address, tmp_path, name):
    command, pair, *rest = COMMANDS[name]
    here = run(command, files / pair, *rest, "-o", tmp_path / "here.nc")
    there = run(command, files / pair, *rest, "-o", tmp_path / "there.nc", "--cluster", address)
    assert (there.exit_code, there.stdout) == (here.exit_code, here.stdout.replace("here.nc", "there.nc"))
    assert (tmp_path / "there.nc").read_bytes() == (tmp_path / "here.nc").read_bytes()
    assert read_netcdf(tmp_path / "there.nc").data_vars


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("uncertainty", "--cluster", "head"), "--cluster = head: allowed tcp://HOST:PORT"),
        (("uncertainty", "--wait-seconds", 5), "--wait-seconds = 5.0: allowed none without --cluster"),
        (("uncertainty", "--cluster", "local:2", "--seconds", 3), "--seconds = 3.0: allowed none with"),
        (("compare", "--variant", "torque=60", "--cluster", "head"), "--cluster = head: allowed tcp://"),
        (("stability", "--view", "campbell", "--cluster", "local:2"), "allowed --view chart"),
        (("stability", "--cluster", "head"), "--cluster = head: allowed tcp://HOST:PORT"),
    ],
)
def test_what_no_cluster_can_do_is_refused(files, arguments, words):
    command, *rest = arguments
    assert words in refused(command, files / "preset.toml", *rest)


@pytest.mark.parametrize("address", ["head", "local:0", "tcp://head:70000"])
@pytest.mark.parametrize("command", ["uncertainty", "compare", "stability", "sweep"])
def test_an_address_is_checked_before_a_file_is_read(tmp_path, command, address):
    words = refused(command, tmp_path / "not_there.toml", "--cluster", address)
    assert f"--cluster = {address}: allowed" in words
    assert "not_there" not in words
