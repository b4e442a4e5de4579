"""Does a damaged, huge, empty or foreign source get one clear refusal, without filling time or memory?"""

import io
import time
import warnings
import zipfile
from pathlib import Path

import h5py
import numpy as np
import openpyxl
import pandas as pd
import pytest
import scipy.io
import scipy.sparse
import xarray as xr
from hypothesis import example, given, settings
from hypothesis import strategies as st

from lumped.errors import ParameterError
from tests.validation.check.known_curves import PAIR, Known, rows
from validation.any_system import read_matrices
from validation.check.curves import Curves
from validation.check.reading.reader import SUFFIXES, TEXT_SUFFIXES, read
from validation.exchange import read_netcdf
from validation.files import hdf5, matlab

KNOWN = Known()
#: Seconds for which nobody waits in vain; a busy machine is five times slower.
SECONDS = 20.0


def read_or_refused(source):
    """Curves, or None where the source is refused by field, allowed values and action."""
    start = time.monotonic()
    result = problems = None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            result = read(source, PAIR)
    except ParameterError as error:
        problems = error.problems
    assert result is not None or problems
    for problem in problems or ():
        assert problem.field
        assert problem.allowed
        assert problem.action
        assert len(str(problem)) < 4000
    assert time.monotonic() - start < SECONDS
    return result


def check_finite(result):
    if isinstance(result, Curves):
        assert np.isfinite(result.places).all()
        assert all(np.isfinite(one.values).all() for one in result.channels)
    elif result is not None:
        assert all(np.isfinite(one.values).all() for one in result.columns)


ENDINGS = [one for one in SUFFIXES if not one.startswith(".py")]


@pytest.mark.parametrize("ending", [*ENDINGS, ".csv2", ""])
@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\n\n\n",
        b"\x00" * 100,
        bytes(range(256)) * 40,
        b"PK\x03\x04" + b"\x00" * 50,
        b"\x89HDF\r\n\x1a\n",
    ],
    ids=["empty", "blank lines", "zeros", "binary", "broken zip", "broken HDF5"],
)
def test_foreign_content_is_refused(tmp_path, ending, content):
    path = tmp_path / f"x{ending}"
    path.write_bytes(content)
    assert read_or_refused(path) is None


@pytest.mark.parametrize("ending", ENDINGS)
def test_files_that_are_missing_and_folders_are_refused(tmp_path, ending):
    assert read_or_refused(tmp_path / f"none{ending}") is None
    (tmp_path / f"folder{ending}").mkdir()
    assert read_or_refused(tmp_path / f"folder{ending}") is None


HEAD = "time [s],dte [um]\n"
BODY = rows(KNOWN.time, 1e6 * KNOWN.dte)


@pytest.mark.parametrize(("content", "words"), [
    (HEAD, "a line of headings such as"),
    (HEAD + BODY.splitlines()[0], ">= 8 samples"),
    (HEAD + BODY.replace("\n", ",\n", 3), None),
    (HEAD + BODY + "\n1,nan", "nan in row 162 after the headings, column dte [um]"),
    (HEAD + BODY + "\n1,inf", "inf in row 162"),
    (HEAD + BODY + "\n1,#DIV/0!", "row 162"),
    (HEAD + BODY + "\n1,text", "text in row 162"),
    (HEAD + BODY + "\n1", "an empty cell in row 162"),
    (HEAD + BODY + "\n1,2,3,4", "2 cells in every line"),
    (HEAD + BODY + "\n0,2", "sample 162 is not beyond"),
    (HEAD + BODY + "\n1,1e300", "< 1e+100 in SI"),
    ("time,time,dte\n" + rows(KNOWN.time, 2 * KNOWN.time, KNOWN.dte), "one column"),
    ("time,dte,dte\n" + rows(KNOWN.time, KNOWN.dte, KNOWN.dte), "one column of dte"),
    ("time,dte\n" + BODY.replace("e", "x"), "such as 'time [s], dte [um]'"),
    ("t;dte\na" + " " * 100_000 + "b;c\n", "such as"),
    ("time,dte\n" + '"' + "x" * 200_000 + ";c\n", "such as"),
    ("x" * 100_000 + ",dte\n" + BODY, "a column with one of time"),
    ("[" * 100 + ",dte\n" + BODY, "a column with one of time"),
    ("time [parsec],dte\n" + BODY, "a unit of s"),
    ("time [" + "9" * 30 + " s],dte\n" + BODY, "a unit of s"),
    ("n [rpm],dte\n" + BODY, "peak to peak, rms"),
    ("speed [rpm],dte rms [um]\n2000,1\n2000,2", "twice"),
    ("speed [rpm],dte rms [um]\n0,1\n2000,2", "speed"),
    ("speed [rpm],dte rms [um]\n1000,-1\n2000,2", ">= 0"),
    ("order,dte [um]\n0.5,1\n1.5,2", "no whole mesh order"),
    ("order,dte [um]\n1,1\n1,2", "twice"),
    ("order,dte [um],dte real [um]\n1,1,1\n2,2,2", "amplitude and phase"),
])  # fmt: skip
def test_a_damaged_text_is_refused_by_name(tmp_path, content, words):
    path = tmp_path / "x.csv"
    path.write_text(content)
    if words is None:
        assert read_or_refused(path) is not None
        return
    with pytest.raises(ParameterError) as refused:
        read(path, PAIR)
    assert words in str(refused.value)


@pytest.mark.parametrize("source", [
    None, 3, "", [], [1.0, 2.0], object(), np.zeros(3), {}, {"time": 3.0}, {1: [1.0]}, pd.DataFrame(),
    xr.Dataset(), {"time": "now", "dte": [1.0] * 9}, {"time": [1.0] * 9, "dte": [None] * 9},
    {"time": np.arange(9.0), "dte": ["a"] * 9}, {"time": np.arange(9.0), "dte": np.zeros((9, 9))},
    {"time": np.arange(9.0), "normal_load": np.zeros((9, 9, 2))},
    {"time": np.arange(9.0), "dte": np.zeros(8)},
    {"time": np.arange(9.0), "dte": np.zeros(9) * 1j + 1j}, {"time": np.full(9, np.nan), "dte": np.zeros(9)},
    {"time": np.arange(9.0), "dte": np.full(9, np.nan)}, {"time": np.zeros(9), "dte": np.zeros(9)},
    {"time": np.arange(9.0), "dte": np.zeros(9), "M": np.zeros((2, 3))},
    {"time": np.arange(9.0), "dte": np.zeros(9), "contact_ratio": np.nan},
    {"time": np.arange(9.0), "dte": np.zeros(9), "pinion_speed": 4000.0},
    {"time": np.arange(9.0), "dte": np.zeros(9), "role": "record"},
    {"time": np.arange(9.0), "dte": np.zeros(9), "recurrence": 0},
    {f"a{k}": np.zeros(9) for k in range(5000)}, float, "\x00.csv", Path("/dev/zero"), Path("/dev/zero.csv"),
], ids=lambda one: type(one).__name__)  # fmt: skip
def test_a_hostile_object_is_refused(source):
    assert read_or_refused(source) is None


def test_mappings_without_end_are_refused():
    endless = {}
    endless["a"] = endless
    assert read_or_refused(endless) is None


# ---- small files that unfold ------------------------------------------------------------------------------


def _archive(path, member, size=matlab.MOST_BYTES + 1):
    """An archive of little more than nothing whose member has zeros."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive, archive.open(member, "w") as file:
        for _ in range(0, size, 10_000_000):
            file.write(bytes(10_000_000))


def _npz(path):
    header = io.BytesIO()
    description = {"descr": "<f8", "fortran_order": False, "shape": (10**6, 10**6)}
    np.lib.format.write_array_header_1_0(header, description)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("dte.npy", header.getvalue())


def _xlsx(path):
    openpyxl.Workbook().save(path)
    with (
        zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive,
        archive.open("xl/more.xml", "w") as file,
    ):
        for _ in range(51):
            file.write(bytes(10_000_000))


def _netcdf(path):
    with h5py.File(path, "w") as file:
        file.create_dataset("time", shape=(10**10,), dtype="f8", chunks=(10**5,), compression="gzip")


BOMBS = {
    "x.mat": lambda path: scipy.io.savemat(path, {"dte": scipy.sparse.csc_matrix((10_000, 10_000))}),
    "x.npz": _npz, "x.xlsx": _xlsx, "x.nc": _netcdf,
}  # fmt: skip


@pytest.mark.parametrize("name", BOMBS)
def test_a_small_file_does_not_fill_the_memory(tmp_path, name):
    BOMBS[name](tmp_path / name)
    with pytest.raises(ParameterError, match=r"claims to hold|allocate"):
        read(tmp_path / name, PAIR)


def test_an_hdf5_file_does_not_read_other_files(tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["dte"] = KNOWN.dte
    with h5py.File(tmp_path / "x.nc", "w") as file:
        file["time"] = KNOWN.time
        file["dte"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "dte")
    with pytest.raises(ParameterError, match="link"):
        read(tmp_path / "x.nc", PAIR)


def test_a_matlab_file_that_ends_its_reader_is_refused(tmp_path, monkeypatch):
    # As scipy ends with some .mat files of which one byte is wrong.
    monkeypatch.setattr(matlab, "_READER", "import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)")
    scipy.io.savemat(tmp_path / "x.mat", {"t": KNOWN.time, "dte": KNOWN.dte})
    with pytest.raises(ParameterError, match="damaged"):
        read(tmp_path / "x.mat", PAIR)


READERS = {
    "curves": lambda path: read(path, PAIR),
    "results": read_netcdf,
    "matrices": read_matrices,
}


def _endless(path):
    """Write a file of which the HDF5 library reads an attribute for ever: one size in its heap is wrong."""
    data = xr.Dataset({"dte": ("time", KNOWN.dte)}, coords={"time": KNOWN.time})
    data.to_netcdf(path, engine="h5netcdf")
    content = bytearray(path.read_bytes())
    size_of_the_first_object = content.index(b"GCOL") + 24
    content[size_of_the_first_object] = 70
    path.write_bytes(content)


@pytest.mark.parametrize("reader", READERS)
def test_an_hdf5_file_that_would_be_read_for_ever_is_refused(tmp_path, monkeypatch, reader):
    monkeypatch.setattr(hdf5, "_PATIENCE", 5.0)
    _endless(tmp_path / "x.nc")
    with pytest.raises(ParameterError, match="still reads it after 5 s"):
        READERS[reader](tmp_path / "x.nc")


@pytest.mark.parametrize("reader", READERS)
def test_an_hdf5_file_that_ends_its_reader_is_refused(tmp_path, monkeypatch, reader):
    monkeypatch.setattr(hdf5, "_READER", "import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)")
    xr.Dataset({"dte": ("time", KNOWN.dte)}).to_netcdf(tmp_path / "x.nc", engine="h5netcdf")
    with pytest.raises(ParameterError, match="ends the process that reads"):
        READERS[reader](tmp_path / "x.nc")


def test_bytes_of_a_matlab_file_may_be_wrong(tmp_path):
    path = tmp_path / "x.mat"
    scipy.io.savemat(path, {"t": KNOWN.time, "dte": KNOWN.dte})
    content = path.read_bytes()
    for place in (3, 126, 130, 150, 200, len(content) // 2, len(content) - 4):
        path.write_bytes(content[:place] + bytes([content[place] ^ 0x55]) + content[place + 1 :])
        check_finite(read_or_refused(path))
    path.write_bytes(content[: len(content) // 2])
    assert read_or_refused(path) is None


@given(
    place=st.integers(0, 4000),
    length=st.integers(0, 40),
    new=st.sampled_from(
        ["", ",", ";", "\t", "\n", '"', "'", "#", "[", "]", "(", "nan", "1e999", "é", "\x00", "-", ".."]
    )
    | st.text(max_size=8),
    ending=st.sampled_from(TEXT_SUFFIXES),
)
@example(place=0, length=0, new="", ending=".csv")
@example(place=10, length=0, new='"', ending=".csv")
@settings(max_examples=60)
def test_a_broken_text_is_read_or_refused(tmp_path_factory, place, length, new, ending):
    text = HEAD + BODY
    path = tmp_path_factory.mktemp("text") / f"x{ending}"
    broken = text[:place] + new + text[place + length :]
    path.write_text(broken, encoding="utf-8", errors="surrogatepass", newline="")
    result = read_or_refused(path)
    check_finite(result)
    assert result is not None or broken != text
