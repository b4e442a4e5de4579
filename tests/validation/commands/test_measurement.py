"""Does the command write a whole folder, refuse bad input, and find a friction that is known?"""

import json

import pytest

from .conftest import refused, run


@pytest.fixture(scope="module")
def example(tmp_path_factory):
    folder = tmp_path_factory.mktemp("records") / "example"
    # Speed and torque are not the preset's: the prediction must take them from the record.
    values = {"law": "friction.law=coulomb", "mu": "friction.coefficient=0.05"}
    values |= {"torque": "operating.pinion_torque=30", "speed": "operating.pinion_speed=4000"}
    changes = [item for value in values.values() for item in ("--set", value)]
    assert run("measurement", folder, *changes, "--example").exit_code == 0
    return folder


def test_measurement_identifies_the_friction_that_made_the_record(example, tmp_path):
    out = tmp_path / "evaluation"
    # Predicted with another law: the identified constant must not follow the prediction's friction.
    result = run("measurement", example / "measurement.toml", "--identify", "mu", "-o", out)
    assert result.exit_code == 0, result.stderr
    data = json.loads((out / "measurement.json").read_text(encoding="utf-8"))
    found = data["identified"][0]
    # Five standard errors: a right estimate misses by more once in two million records.
    assert abs(found["estimate"] - 0.05) < 5 * found["standard_error"]
    assert found["high"] - found["low"] < 0.005  # 2 % noise leaves less than a tenth of mu
    assert f"mu = {found['estimate']:.4g}" in result.stdout
    # A law that stays far from 0.05 predicts friction badly and normal loads well.
    assert data["metrics"]["normal_A"]["correlation"] > 0.99
    assert data["metrics"]["normal_A"]["relative_rms"] < 0.05  # 2 % noise, and a law's small effect
    assert data["metrics"]["friction_A"]["relative_rms"] > 0.2
    assert {p.name for p in out.iterdir()} == {
        "contents.json",
        "measurement.json",
        "overlay.csv",
        "overlay.nc",
        "overlay.png",
        "overlay.svg",
    }


def test_measurement_beside_a_prediction_without_friction(example, tmp_path):
    result = run("measurement", example / "measurement.toml", "--law", "none", "-o", tmp_path / "out")
    assert result.exit_code == 0, result.output
    metrics = json.loads((tmp_path / "out" / "measurement.json").read_text(encoding="utf-8"))["metrics"]
    assert metrics["friction_A"]["relative_rms"] is None


def test_measurement_refuses_what_it_cannot_use(example, tmp_path):
    assert "no.toml" in refused("measurement", tmp_path / "no.toml")
    assert "xu_kahraman" in refused("measurement", example / "measurement.toml", "--identify", "sandpaper")
    assert "--force" in refused("measurement", example, "--example")
    (tmp_path / "notes.txt").write_text("mine")
    assert "nothing in it is replaced" in refused(
        "measurement", example / "measurement.toml", "-o", tmp_path, "--force"
    )
