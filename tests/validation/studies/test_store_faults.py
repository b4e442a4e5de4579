"""Is every kind of damage of a store refused in plain words or mended, and never costs a case?"""

from __future__ import annotations

import os
import random
import shutil
import sqlite3
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from validation.cli import app
from validation.studies import StoreError, read_results, run_sweep
from validation.studies.storage import STORE

REFUSED, STOPPED = 2, 3
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="links and pipes")


def bytes_at(at, new):
    """Write bytes into a file; a negative place counts from its end."""

    def change(path):
        data = bytearray(path.read_bytes())
        start = at % len(data)
        data[start : start + len(new)] = new
        path.write_bytes(data)

    return change


def cut(size):
    return lambda path: os.truncate(path, size(path.stat().st_size))


def sql(*statements):
    def change(path):
        with sqlite3.connect(path) as db:
            for statement in statements:
                db.execute(statement)
        db.close()

    return change


def flipped(path):
    data = bytearray(path.read_bytes())
    for _ in range(20):
        data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    path.write_bytes(data)


def instead(make, end=""):
    """Put something else in the place of the store or of a file of its log."""

    def change(path):
        place = path.with_name(path.name + end)
        place.unlink(missing_ok=True)
        make(place)

    return change


def link(place):
    target = place.parent.parent / "precious"
    target.write_bytes(b"do not touch")
    place.symlink_to(target)


def other_program(place):
    sql("CREATE TABLE thesis (words)")(place)


NOISE = random.Random(5).randbytes(4096)
#: Kind of fault -> what it does to the file of a finished sweep, and words of the refusal ("": it is mended).
FAULTS = {
    "magic zeroed": (bytes_at(0, bytes(16)), "damaged"),
    "header zeroed": (bytes_at(0, bytes(100)), "damaged"),
    "header after the magic zeroed": (bytes_at(16, bytes(84)), "damaged|another program"),
    "application and version zeroed": (bytes_at(60, bytes(12)), "damaged|another program"),
    "first page zeroed": (bytes_at(0, bytes(4096)), "damaged"),
    "first page zeroed after the header": (bytes_at(100, bytes(3996)), "damaged|cannot"),
    "all but the magic of the first page zeroed": (bytes_at(16, bytes(4080)), "damaged"),
    "first page noise": (bytes_at(0, NOISE), "damaged"),
    "page in the middle noise": (bytes_at(4096, NOISE), "damaged|cannot"),
    "last page noise": (bytes_at(-4096, NOISE), "damaged|cannot"),
    "cut in the middle": (cut(lambda size: size // 2 + 100), "damaged|cannot"),
    "cut by a byte": (cut(lambda size: size - 1), ""),
    "cut after the header": (cut(lambda size: 100), "damaged|cannot"),
    "garbage appended": (lambda path: path.write_bytes(path.read_bytes() + NOISE), ""),
    "text": (lambda path: path.write_bytes(b"not a database at all " * 100), "damaged"),
    "another program's": (instead(other_program), "another program"),
    "a later format": (sql("PRAGMA user_version=2"), "format 2.*the version that wrote it"),
    "a table dropped": (sql("DROP TABLE failure"), "no such table"),
    "a blob changed": (sql("UPDATE batch SET data = zeroblob(length(data)) WHERE id = 3"), ""),
    "a blob that is text": (sql("UPDATE batch SET data = 'text' WHERE id = 3"), ""),
    "a batch of other cases": (sql("UPDATE batch SET first = first + 1 WHERE id = 3"), ""),
    "a batch of too many cases": (sql("UPDATE batch SET count = 1000000 WHERE id = 3"), ""),
    "a text changed": (sql("UPDATE failure SET message = x'00' WHERE number = 0"), ""),
    "log of another store": (lambda path: path.with_name(f"{STORE}-wal").write_bytes(NOISE), ""),
    "link": (instead(link), "symbolic link"),
    "link of the log": (instead(link, "-wal"), "symbolic link"),
    "link of its index": (instead(link, "-shm"), "symbolic link"),
    "link of the lock": (lambda path: instead(link)(path.with_name(".lock")), "symbolic link"),
    "pipe": (instead(os.mkfifo), "not a regular file"),
    "folder": (instead(Path.mkdir), "not a regular file"),
    "pipe of the log": (instead(os.mkfifo, "-wal"), "not a regular file"),
}


@pytest.fixture
def sweep_command(tmp_path, make_study):
    """Run the command on the study or another one, in the same folder; returns exit code and text."""
    for name, study in (("same", make_study()), ("other", make_study(outputs=["base_pitch"]))):
        (tmp_path / f"{name}.toml").write_text(study.to_toml())

    def run(name):
        words = ["sweep", tmp_path / f"{name}.toml", "-o", tmp_path / "out", "--workers", "0", "--resume"]
        result = CliRunner().invoke(app, [str(word) for word in words])
        assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
        return result.exit_code, result.output.replace("\n", " ")

    return run


def content(folder):
    return {path.name: path.read_bytes() for path in folder.glob("store.sqlite") if path.is_file()}


@pytest.fixture(scope="module")
def swept(study, tmp_path_factory):
    """Folder of a finished sweep, to copy."""
    folder = tmp_path_factory.mktemp("swept") / "out"
    run_sweep(study, folder)
    return folder


@pytest.fixture
def finished(swept, tmp_path):
    """Folder of a finished sweep, to damage."""
    return shutil.copytree(swept, tmp_path / "out")


@pytest.mark.parametrize("kind", FAULTS)
def test_a_damaged_store_is_refused_and_left_as_it_is_or_mended(
    finished, tmp_path, undisturbed, sweep_command, kind
):
    change, words = FAULTS[kind]
    out = finished
    change(out / STORE)
    damaged = content(out)
    code, text = sweep_command("other")  # first, for it must not take the folder as its own
    assert code in (REFUSED, STOPPED), text
    assert content(out) == damaged
    if words:
        if "lock" not in kind:
            with pytest.raises(StoreError, match=words):
                read_results(out)
        code, text = sweep_command("same")
        assert code == STOPPED, text
        assert content(out) == damaged
    else:
        code, text = sweep_command("same")
        assert code == 1, text  # some cases of the study cannot exist
        assert (out / "results.nc").read_bytes() == undisturbed
    if (tmp_path / "precious").exists():
        assert (tmp_path / "precious").read_bytes() == b"do not touch"


@pytest.mark.parametrize("seed", range(int(os.environ.get("SPURCHECK_FUZZ", "5"))))
def test_flipped_bits_are_noticed_or_cost_nothing(finished, undisturbed, sweep_command, seed):
    random.seed(seed)
    flipped(finished / STORE)
    damaged = content(finished)
    assert sweep_command("other")[0] in (REFUSED, STOPPED)
    code, text = sweep_command("same")
    if code == 1:
        assert (finished / "results.nc").read_bytes() == undisturbed
    else:
        assert code in (REFUSED, STOPPED), text
        assert content(finished) == damaged


@pytest.mark.parametrize("what", ["cut", "emptied", "removed"])
def test_a_store_that_is_damaged_while_the_sweep_runs_is_told(study, tmp_path, sweep_command, what):
    store = tmp_path / "out" / STORE

    def damage(done, total, failed):
        if done < 60 or (tmp_path / "damaged").exists():
            return
        (tmp_path / "damaged").touch()
        if what == "removed":
            store.unlink()
        else:
            os.truncate(store, 0 if what == "emptied" else 5000)

    with pytest.raises(StoreError, match=str(store)):
        run_sweep(study, tmp_path / "out", progress=damage)
    assert sweep_command("other")[0] in (1, REFUSED, STOPPED)  # 1: a new store
