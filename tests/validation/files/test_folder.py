"""Are result files and folders whole, which may they replace, and what is left after success and failure?"""

import csv
import os
import signal
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from lumped import ParameterError
from lumped.errors import StorageError
from validation.files import output
from validation.files.folder import CONTENTS, check_target, whole_folder


def write(out, files, **options):
    with whole_folder(out, **{"force": True, **options}) as folder:
        for name, text in files.items():
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_text(text)


def tree(folder):
    """Relative path -> text of every file, hidden ones included."""
    return {p.relative_to(folder).as_posix(): p.read_text() for p in folder.rglob("*") if p.is_file()}


def names(folder):
    return sorted(p.name for p in folder.iterdir())


def test_a_new_folder_appears_only_at_the_end(tmp_path):
    out = tmp_path / "a" / "b"
    with whole_folder(out, force=False) as folder:
        (folder / "x").write_text("1")
        assert not out.exists()
    assert names(out) == [CONTENTS, "x"]
    assert names(out.parent) == ["b"]
    (tmp_path / "empty").mkdir()
    write(tmp_path / "empty", {"x": "1"}, force=False)
    assert names(tmp_path / "empty") == [CONTENTS, "x"]


def test_force_replaces_the_earlier_results_whole(tmp_path):
    out = tmp_path / "out"
    write(out, {"page": "old", "figures/a.png": "old"})
    write(out, {"page": "new", "data/x": "new"})
    files = tree(out)
    files.pop(CONTENTS)
    assert files == {"page": "new", "data/x": "new"}
    assert names(out) == [CONTENTS, "data", "page"]
    assert names(tmp_path) == ["out"]


def test_a_folder_with_a_file_of_the_user_is_not_replaced(tmp_path):
    out = tmp_path / "out"
    write(out, {"page": "old", "figures/a.png": "old"})
    (out / "figures" / "mine.png").write_text("mine")
    before = tree(out)
    with pytest.raises(ParameterError, match=r"mine\.png.*move it elsewhere"):
        write(out, {"page": "new"})
    assert tree(out) == before


@pytest.mark.parametrize(
    "content", ["{}", "[1]", "no json", '{"format": "other", "files": []}', '{"format": "spurcheck-report"}']
)
def test_a_folder_without_a_list_of_ours_is_not_touched(tmp_path, content):
    out = tmp_path / "out"
    out.mkdir()
    (out / "report.json").write_text('{"format": "spurcheck-report"}')
    (out / CONTENTS).write_text(content)
    before = tree(out)
    with pytest.raises(ParameterError, match="nothing in it is replaced"):
        check_target(out, force=True)
    assert tree(out) == before


def test_a_failure_at_the_last_step_puts_everything_back(tmp_path, monkeypatch):
    out = tmp_path / "out"
    write(out, {"a": "old", "b": "old"})
    before = tree(out)
    rename = type(out).rename

    def move(source, target):
        if source.name == "new":
            raise OSError(28, "No space left on device")
        return rename(source, target)

    monkeypatch.setattr(type(out), "rename", move)
    with pytest.raises(StorageError, match="No space left"):
        write(out, {"a": "new", "b": "new"})
    assert tree(out) == before
    assert names(tmp_path) == ["out"]


def test_content_that_appears_meanwhile_is_not_lost(tmp_path):
    out = tmp_path / "out"
    with pytest.raises(ParameterError, match="not empty"), whole_folder(out, force=False) as folder:  # noqa: PT012
        (folder / "x").write_text("1")
        out.mkdir()
        (out / "theirs").write_text("2")
    assert names(out) == ["theirs"]
    assert names(tmp_path) == ["out"]


def test_a_full_disk_names_the_folder_and_leaves_nothing(tmp_path):
    out = tmp_path / "a" / "out"
    with pytest.raises(StorageError, match=str(out)), whole_folder(out, force=False):
        raise OSError(28, "No space left on device")
    assert names(tmp_path) == []


def test_a_file_and_a_place_below_a_file_are_refused(tmp_path):
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(ParameterError, match="This is a file"):
        check_target(file, force=True)
    with pytest.raises(ParameterError, match="cannot be written"), whole_folder(file / "out", force=False):
        raise AssertionError("no folder should be given")


KILLED = """
import sys, time
from pathlib import Path
from validation.files.folder import whole_folder

out, between = Path(sys.argv[1]), sys.argv[2] == "between"
if between:  # the two steps of the replacement
    rename = Path.rename
    def move(source, target):
        if source.name == "new":
            print("ready", flush=True)
            time.sleep(60)
        return rename(source, target)
    Path.rename = move
with whole_folder(out, force=True) as folder:
    (folder / "page").write_text("half")
    if not between:
        print("ready", flush=True)
        time.sleep(60)
"""


@pytest.fixture
def running(tmp_path):
    """Start a run that writes into tmp_path/out, and waits; ``between``: between both steps of replacing."""
    runs = []

    def start(how="within"):
        run = subprocess.Popen(
            [sys.executable, "-c", KILLED, str(tmp_path / "out"), how], stdout=subprocess.PIPE, text=True
        )
        runs.append(run)
        assert run.stdout.readline() == "ready\n"
        return run

    yield start
    for run in runs:
        run.kill()
        run.wait()
        run.stdout.close()


@pytest.mark.skipif(os.name != "posix", reason="locks of POSIX systems")
class TestAKilledRun:
    def test_its_folder_is_removed_by_the_next_run(self, tmp_path, running):
        run = running()
        run.kill()
        run.wait()
        assert [name[:11] for name in names(tmp_path)] == [".spurcheck-"]
        write(tmp_path / "other", {"page": "new"})
        assert names(tmp_path) == ["other"]

    def test_the_folder_of_a_run_that_goes_on_stays(self, tmp_path, running):
        running()
        before = names(tmp_path)
        write(tmp_path / "other", {"page": "new"})
        assert names(tmp_path) == sorted([*before, "other"])

    def test_earlier_results_come_back(self, tmp_path, running):
        write(tmp_path / "out", {"page": "earlier"})
        run = running("between")
        assert not (tmp_path / "out").exists()
        run.kill()
        run.wait()
        with pytest.raises(ParameterError, match="not empty"):
            write(tmp_path / "out", {"page": "new"}, force=False)
        assert tree(tmp_path / "out")["page"] == "earlier"
        assert names(tmp_path) == ["out"]

    def test_a_folder_that_is_not_ours_stays(self, tmp_path):
        (tmp_path / ".spurcheck-mine").mkdir()
        (tmp_path / ".spurcheck-mine" / "notes").write_text("of the user")
        write(tmp_path / "out", {"page": "new"})
        assert names(tmp_path) == [".spurcheck-mine", "out"]


@pytest.mark.skipif(os.name != "posix", reason="other systems keep a folder in use")
@pytest.mark.parametrize(
    "command", [["report", "-o", "r"], ["simulate", "nasa_28_28", "-o", "x.nc"], ["init"]]
)
def test_a_deleted_working_folder_is_named(tmp_path, command):
    here = tmp_path / "gone"
    here.mkdir()
    code = f"import os; os.chdir({str(here)!r}); os.rmdir({str(here)!r})"
    code += "; from validation.cli import main; main()"
    done = subprocess.run([sys.executable, "-c", code, *command], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "The working folder was deleted" in done.stderr
    assert "cannot be printed" not in done.stderr


def test_a_link_to_a_folder_is_not_followed(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path, target_is_directory=True)
    with pytest.raises(ParameterError, match="This is a link"):
        check_target(tmp_path / "link", force=True)


@pytest.fixture
def dataset():
    rng = np.random.default_rng(7)
    return xr.Dataset(
        {
            "dte": ("time", rng.normal(size=4) * 1e-6, {"units": "m"}),
            "load": (("pair", "time"), rng.normal(size=(2, 4)), {"units": "N"}),
            "periodic": ("time", np.array([True, False, True, True])),
            "response": ("time", rng.normal(size=4) + 1j * rng.normal(size=4), {"units": "m"}),
        },
        coords={"time": ("time", np.arange(4) * 1e-4, {"units": "s"}), "pair": [0, 1]},
        attrs={"warnings": ["one", "two"], "flag": True, "name": "n"},
    )


def test_csv_gives_every_number_back_bit_for_bit_with_its_unit(dataset, tmp_path):
    path = tmp_path / "run.csv"
    output.write_dataset(dataset, path)
    rows = list(csv.reader(path.read_text().splitlines()))
    headings = ["time [s]", "dte [m]", "load_pair0 [N]", "load_pair1 [N]", "periodic [1]"]
    assert rows[0] == [*headings, "response_real [m]", "response_imag [m]"]
    read = {heading: [row[i] for row in rows[1:]] for i, heading in enumerate(rows[0])}
    assert [float(v) for v in read["dte [m]"]] == dataset["dte"].to_numpy().tolist()
    assert [float(v) for v in read["load_pair1 [N]"]] == dataset["load"].to_numpy()[1].tolist()
    assert [float(v) for v in read["response_imag [m]"]] == dataset["response"].to_numpy().imag.tolist()


def test_netcdf_loses_nothing(dataset, tmp_path):
    output.write_dataset(dataset, tmp_path / "run.nc")
    with xr.open_dataset(tmp_path / "run.nc", engine="h5netcdf") as opened:
        back = opened.load()
    np.testing.assert_array_equal(back["load"], dataset["load"])
    np.testing.assert_array_equal(back["response_real"] + 1j * back["response_imag"], dataset["response"])
    np.testing.assert_array_equal(back["periodic"], [1, 0, 1, 1])
    assert back["dte"].attrs["units"] == "m"
    assert back.attrs == {"warnings": "one; two", "flag": 1, "name": "n"}


def _fail_while_writing(path):
    with output.whole_file(path) as temporary:
        temporary.write_text("half")
        raise RuntimeError


def test_a_failure_while_writing_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "run.txt"
    path.write_text("old")
    with pytest.raises(RuntimeError):
        _fail_while_writing(path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(os.name != "posix", reason="modes of POSIX systems")
def test_a_file_may_be_read_by_whom_the_user_lets(tmp_path):
    before = os.umask(0o027)
    try:
        output.write_text(tmp_path / "run.txt", "x")
    finally:
        os.umask(before)
    assert (tmp_path / "run.txt").stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize(
    ("error", "words"), [(OSError(30, "Read-only file system"), "Read-only"), (OSError(), "OSError")]
)
def test_a_folder_that_cannot_be_written_is_refused_with_the_reason(tmp_path, monkeypatch, error, words):
    def failing(**options):
        raise error

    monkeypatch.setattr(output.tempfile, "TemporaryFile", failing)
    with pytest.raises(ParameterError, match=rf"cannot be written \({words}"):
        output.check_file(tmp_path / "run.nc", output.DATA_SUFFIXES, force=False)


def test_a_file_that_appears_while_the_result_is_computed_stays(tmp_path):
    path = output.check_file(tmp_path / "run.txt", (".txt",), force=False)
    path.write_text("of the user")
    with pytest.raises(StorageError, match="appeared meanwhile"):
        output.write_text(path, "result", new=True)
    assert path.read_text() == "of the user"
    assert list(tmp_path.iterdir()) == [path]


def test_output_files_are_refused_before_any_work(tmp_path):
    existing = tmp_path / "old.nc"
    existing.write_text("")
    link = tmp_path / "link.nc"
    link.symlink_to(tmp_path / "nowhere.nc")
    with pytest.raises(ParameterError, match="--force"):
        output.check_file(link, output.DATA_SUFFIXES, force=False)
    (tmp_path / "folder.nc").mkdir()
    with pytest.raises(ParameterError, match="add a file name"):
        output.check_file(tmp_path / "folder.nc", output.DATA_SUFFIXES, force=True)
    for path, reason in (
        (tmp_path / "run.xlsx", r"\.nc, \.csv"),
        (existing, "--force"),
        (tmp_path, "ending in"),
        (tmp_path / "missing" / "run.nc", "Make the folder"),
    ):
        with pytest.raises(ParameterError, match=reason):
            output.check_file(path, output.DATA_SUFFIXES, force=False)
    assert output.check_file(existing, output.DATA_SUFFIXES, force=True) == existing


def limited():
    """A file may grow to 4 kB: writing more fails as on a full disk, at any place."""
    import resource  # POSIX

    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


#: Runs the command for each file, and ends with the exit codes.
RUNS = """
import sys
from validation.cli import main
for out in sys.argv[1:]:
    sys.argv = ["spurcheck", "simulate", "--cycles", "1", "--samples", "64", "-o", out]
    try:
        main()
    except SystemExit as stop:
        print("exit code", stop.code, file=sys.stderr)
"""


@pytest.mark.skipif(os.name != "posix", reason="limits of a process are POSIX")
def test_a_result_that_does_not_fit_is_told_and_leaves_nothing(tmp_path):
    # HDF5 alone ends the process with a segmentation fault here.
    outs = [str(tmp_path / f"run.{suffix}") for suffix in ("nc", "csv", "mat", "png")]
    # Without compiling: its cache could not be written either. Nor may Python keep byte code: it takes a
    # module that was cut at the limit for a whole one, and every later process fails on it.
    environment = {
        **os.environ,
        "NUMBA_DISABLE_JIT": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
        "MPLBACKEND": "Agg",
    }
    command = [sys.executable, "-c", RUNS, *outs]
    run = subprocess.run(command, preexec_fn=limited, capture_output=True, text=True, env=environment)
    assert run.returncode == 0, run.stderr
    messages = run.stderr.split("exit code 3")
    assert len(messages) == len(outs) + 1
    assert [out in text for out, text in zip(outs, messages, strict=False)] == [True] * len(outs)
    assert "Traceback" not in run.stderr
    assert list(tmp_path.iterdir()) == []
