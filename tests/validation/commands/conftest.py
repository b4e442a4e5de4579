"""Parameter files shared by the tests of the commands."""

import pytest
from typer.testing import CliRunner

import lumped
from validation.cli import app


@pytest.fixture(scope="session")
def shafted_file(tmp_path_factory):
    """A file of a pair on two equal shafts, gears in the middle."""
    bearings = [{"position": z, "loa_stiffness": 2e8, "oloa_stiffness": 1.5e8} for z in (20, 120)]
    shaft = {"segments": [{"length": 140, "diameter": 30}], "gear_position": 70, "bearings": bearings}
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__relief="ignored", shafts={"damping_ratio": 0.02, "pinion": shaft, "gear": shaft}
    )
    path = tmp_path_factory.mktemp("shafted") / "shafted.toml"
    path.write_text(pair.to_toml())
    return path


def run(*arguments):
    """Result of the command, which ends by itself or with an exit code."""
    result = CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "200", "NO_COLOR": "1"})
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


def refused(*arguments):
    """Message of a refused call: one line on stderr, nothing on stdout, exit code 2."""
    result = run(*arguments)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert result.stderr.count("error:") == 1
    return result.stderr
