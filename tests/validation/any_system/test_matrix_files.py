"""Are matrices from a file the system that its page says, and is anything else refused by its name?"""

import io
import json
import zipfile

import numpy as np
import pytest
import scipy.io
import scipy.sparse
import xarray as xr

from floquet import monodromy
from lumped.errors import ParameterError
from tests.evidence.floquet.reference_systems import meissner_trace
from tests.validation.commands.conftest import run
from validation.any_system import read_matrices
from validation.files import matlab

T = 0.4
M = np.diag([1.0, 2.0])
K = np.array([[300.0, -100.0], [-100.0, 400.0]])
C = np.diag([0.3, 0.2])
G = np.array([[0.0, 0.2], [-0.2, 0.0]])
WAVE = np.array([[40.0, 5.0], [0.0, 20.0]])
DRAG = np.diag([0.0, 0.4])
STEPS = np.stack([np.diag([30.0, 0.0]), np.diag([0.0, 60.0]), np.zeros((2, 2))])
FIELDS = {"M": M, "K": K, "C": C, "G": G, "K_cos_1": WAVE, "C_sin_2": DRAG, "period": T}
FIELDS |= {"K_times": [0.0, 0.1, 0.3, T], "K_values": STEPS}


def test_both_formats_are_the_system_of_the_page(tmp_path):
    np.savez(tmp_path / "rotor.npz", **FIELDS)
    of_matlab = FIELDS | {"K_values": np.moveaxis(STEPS, 0, -1), "K": scipy.sparse.csc_matrix(K)}
    scipy.io.savemat(tmp_path / "rotor.mat", of_matlab)

    def stiffness(t):
        return K + np.cos(2.0 * np.pi * t / T) * WAVE + STEPS[np.searchsorted([0.1, 0.3], t)]

    def damping(t):
        return C + 2.0 * np.pi / T * G + np.sin(4.0 * np.pi * t / T) * DRAG

    for name in ("rotor.npz", "rotor.mat"):
        system = read_matrices(tmp_path / name).system()
        for t in (0.05, 0.2, 0.35):
            Q = np.linalg.inv(M @ system.coordinates)
            expected = [-Q @ B(t) @ system.coordinates for B in (stiffness, damping)]
            np.testing.assert_allclose(
                system.evaluate([t])[0, 2:], np.hstack(expected), rtol=1e-11, atol=1e-9
            )


def test_what_a_chart_varies_is_varied(tmp_path):
    # Meissner's equation: the steps have the mean 1.3, their variation is half a step of 0.4.
    steps = np.array([1.7, 0.9]).reshape(2, 1, 1)
    np.savez(tmp_path / "m.npz", M=1.0, K=0.0, C=0.5, period=3.0, K_times=[0.0, 1.5, 3.0], K_values=steps)
    model = read_matrices(tmp_path / "m.npz")
    for frequency, period in (({}, 3.0), ({"frequency": 0.2}, 5.0)):
        for factor in (0.5, 1.5):
            flow = monodromy(model.system(**frequency, variation=factor, damping=0.0))
            assert np.trace(flow.matrix) == pytest.approx(
                meissner_trace(1.3, 0.4 * factor, period), abs=1e-10
            )
    # det M = exp(-c T)
    damped = monodromy(model.system(damping=2.0))
    assert np.linalg.det(damped.matrix) == pytest.approx(np.exp(-3.0), rel=1e-10)


def _bomb(path):
    if path.suffix == ".mat":
        scipy.io.savemat(path, {"M": scipy.sparse.csc_matrix((10_000, 10_000))})
        return
    header = io.BytesIO()
    description = {"descr": "<f8", "fortran_order": False, "shape": (10**6, 10**6)}
    np.lib.format.write_array_header_1_0(header, description)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("M.npy", header.getvalue())


@pytest.mark.parametrize("suffix", [".npz", ".mat"])
def test_a_small_file_does_not_fill_the_memory(tmp_path, suffix):
    _bomb(tmp_path / f"bomb{suffix}")
    with pytest.raises(ParameterError, match=r"claims to hold 8e\+08 bytes|allocate"):
        read_matrices(tmp_path / f"bomb{suffix}")


def test_a_file_that_ends_its_reader_is_refused(tmp_path, monkeypatch):
    # As scipy ends with some .mat files of which one byte is wrong.
    monkeypatch.setattr(matlab, "_READER", "import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)")
    scipy.io.savemat(tmp_path / "rotor.mat", FIELDS)
    with pytest.raises(ParameterError, match="damaged"):
        read_matrices(tmp_path / "rotor.mat")


@pytest.mark.parametrize(("change", "field", "word"), [
    ({"K_cos1": WAVE}, "K_cos1", "K_cos_1"),
    ({"K": None, "K_times": None, "K_values": None}, "K", "missing"),
    ({"C": np.eye(3)}, "C", "(2, 2)"),
    ({"K_times": None}, "K_times", "Save both"),
    ({"K_times": [0.0, 0.3, 0.1, T]}, "K_times", "increasing"),
    ({"K_times": [0.0, 0.1, 0.3, 0.5]}, "K_times", "0.4 s"),
    ({"K_values": STEPS[:2]}, "K_values", "(3, 2, 2)"),
    ({"period": -1.0}, "period", "> 0"),
    ({"period": [1.0, 2.0]}, "period", "number"),
    ({"M": np.array(["1"])}, "M", "numbers"),
])  # fmt: skip
def test_a_wrong_field_is_refused_by_its_name(tmp_path, change, field, word):
    np.savez(tmp_path / "bad.npz", **{k: v for k, v in (FIELDS | change).items() if v is not None})
    with pytest.raises(ParameterError, match=r"bad\.npz") as refused:
        read_matrices(tmp_path / "bad.npz")
    assert refused.value.problems[0].field == field
    assert word in str(refused.value)


def test_the_command_prints_bounds_and_writes_a_chart(tmp_path):
    np.savez(tmp_path / "rotor.npz", **FIELDS)
    printed = run("floquet", tmp_path / "rotor.npz", "--json")
    data = json.loads(printed.stdout)
    exact = monodromy(read_matrices(tmp_path / "rotor.npz").system())
    assert (data["verdict"], data["certificate"], printed.exit_code) == ("stable", "proven", 0)
    assert data["multipliers"] == [[z.real, z.imag] for z in exact.multipliers]
    axes = ("--axis", "frequency=4:6:3", "--axis", "damping=0:1:2")
    made = run("floquet", tmp_path / "rotor.npz", *axes, "-o", tmp_path / "c.nc", "-o", tmp_path / "c.png")
    assert "6 points" in made.stdout
    assert (tmp_path / "c.png").stat().st_size > 5000
    with xr.open_dataset(tmp_path / "c.nc", engine="h5netcdf") as chart:
        assert chart["frequency"].attrs["units"] == "Hz"
        assert chart["spectral_radius"].shape == (3, 2)


def test_the_command_accepts_neutral_systems_and_no_others_without_damping(tmp_path):
    """Two oscillators coupled by cos: neutral with symmetric matrices at 4 Hz, unstable at a sum."""
    matrices = {
        "M": np.eye(2),
        "K": np.diag([100.0, 300.0]),
        "K_cos_1": 20.0 * np.ones((2, 2)),
        "period": 0.25,
    }
    total = (10.0 + np.sqrt(300.0)) / (2.0 * np.pi)
    skew = np.array([[0.0, 3.0], [-3.0, 0.0]])
    one_sided = 20.0 * np.ones((2, 2)) + np.diag([1e-12], k=1)
    for change, verdict, words, code in (
        ({}, "neutral", "stable (neutral): on the unit circle, proven", 0),
        ({"G": skew}, "neutral", "stable (neutral)", 0),
        ({"period": 1.0 / total}, "unstable", "unstable", 1),
        ({"K_cos_1": one_sided}, "undecided", "undecided: largest", 1),
        ({"C": 0.5 * np.eye(2)}, "stable", "stable: largest", 0),
    ):
        np.savez(tmp_path / "rotor.npz", **matrices | change)
        result = run("floquet", tmp_path / "rotor.npz")
        assert (result.exit_code, words in " ".join(result.stdout.split())) == (code, True)
        result = run("floquet", tmp_path / "rotor.npz", "--json")
        assert (json.loads(result.stdout)["verdict"], result.exit_code) == (verdict, code)
    np.savez(tmp_path / "rotor.npz", **matrices)
    chart = run("floquet", tmp_path / "rotor.npz", "--axis", "frequency=4:8:5", "--axis", "damping=0:1:2")
    assert "10 points, 0 stable, " in chart.stdout
    assert " stable (neutral), 0 undecided, " in chart.stdout


@pytest.mark.parametrize(("arguments", "word"), [
    (["none.npz"], "a file that exists"),
    (["text.npz"], "a .npz of arrays"),
    (["text.mat"], "a .mat of arrays"),
    (["text.nc"], "a .nc of arrays"),
    (["text.csv"], "a line of headings"),
    (["text.txt"], "a name ending in .npz, .mat, .nc, .csv"),
    (["rotor.npz", "--axis", "speed_rpm=1:2:3"], "one of frequency"),
    (["rotor.npz", "--period", "0.5"], "period = 0.5 s: allowed 0.4 s, that of the file"),
    (["rotor.npz", "--between", "cubic"], "a file with samples"),
    (["rotor.npz", "--period", "2 mm"], "a number in s"),
    (["rotor.npz", "--workers", "0"], "1 to 1024"),
])  # fmt: skip
def test_the_command_refuses_before_it_computes(tmp_path, monkeypatch, arguments, word):
    monkeypatch.chdir(tmp_path)
    for name in ("text.npz", "text.mat", "text.csv", "text.nc", "text.txt"):
        (tmp_path / name).write_text("no matrices")
    np.savez(tmp_path / "rotor.npz", **FIELDS)
    result = run("floquet", *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert word in " ".join(result.stderr.split())
