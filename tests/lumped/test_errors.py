"""Do errors of libraries reach a caller as the two typed errors, in Python and in the command?"""

import json
import tomllib
import zipfile

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import spurcheck
from lumped.errors import NumericalError, ParameterError, typed_errors
from validation.cli import app


def not_invertible():
    np.linalg.inv(np.zeros((2, 2)))


def not_finite():
    np.linalg.eigvals(np.full((2, 2), np.nan))


def zero_division():
    return 1 / 0


def overflow():
    return (1e300).__pow__(2)


@pytest.mark.parametrize("action", [not_invertible, not_finite, zero_division, overflow])
def test_an_error_of_arithmetic_is_a_numerical_error(action):
    with pytest.raises(NumericalError, match="The computation failed") as caught, typed_errors():
        action()
    assert caught.value.__cause__ is not None


def no_file(folder):
    (folder / "missing.csv").read_text()


def no_json(folder):
    json.loads("{")


def no_toml(folder):
    tomllib.loads("a = ")


def no_zip(folder):
    (folder / "a.npz").write_bytes(b"PK\3\4 nothing")
    with zipfile.ZipFile(folder / "a.npz"):
        pass


def missing_key(folder):
    with h5py.File(folder / "a.nc", "w") as file:
        return file["dte"]


@pytest.mark.parametrize("action", [no_file, no_json, no_toml, no_zip, missing_key])
def test_an_error_of_a_reader_is_a_refusal_of_the_file(action, tmp_path):
    with pytest.raises(ParameterError) as caught, typed_errors():
        action(tmp_path)
    (problem,) = caught.value.problems
    assert problem.field == "file"
    assert problem.action


@pytest.mark.parametrize("error", [KeyError("dte"), TypeError("no"), RuntimeError("no"), OSError("closed")])
def test_a_fault_of_the_program_passes(error):
    with pytest.raises(type(error)) as caught, typed_errors():
        raise error
    assert caught.value is error


def test_python_and_command_have_the_same_error(monkeypatch):
    """A matrix without an inverse deep inside a computation."""

    def singular(*_: object, **__: object) -> None:
        not_invertible()

    monkeypatch.setattr("validation.prediction.motion.periodic_motion", singular)
    monkeypatch.setattr("lumped.model.steady_state.periodic_motion", singular)
    with pytest.raises(NumericalError, match="Singular matrix"):
        spurcheck.predict("nasa_28_28")
    result = CliRunner().invoke(app, ["simulate", "nasa_28_28", "--steady"])
    assert result.exit_code == 3
    assert "The computation failed: Singular matrix" in result.stderr
    assert "a fault in spurcheck" not in result.stderr
