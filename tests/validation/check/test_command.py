"""Does ``spurcheck check`` print the verdict, write the page, and end with the right code?"""

import json

import numpy as np
import pandas as pd
import pytest

from tests.validation.check.motions import lumped_motion
from tests.validation.check.written_check import CHANNELS, checked, pair, softer
from tests.validation.commands.conftest import refused, run
from validation.check.words import percent


def columns(one, quantities):
    """Curves of five mesh cycles of a pair as a table with units in its headings."""
    motion = lumped_motion(one)
    cycles = np.arange(1000) / 200.0
    units = {"mesh_force": ("kN", 1e-3)}
    table = {"time [ms]": 1e3 * cycles * one.geometry.mesh_period}
    for name in quantities:
        unit, factor = units.get(name, ("um", 1e6))
        table[f"{name} [{unit}]"] = factor * motion.at(name, cycles)
    return pd.DataFrame(table)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("curves")
    paths = {name: folder / f"{name}.csv" for name in ("right", "wrong", "slightly_wrong", "speeds")}
    columns(pair(), CHANNELS).to_csv(paths["right"], index=False)
    columns(softer(), CHANNELS).to_csv(paths["wrong"], index=False)
    slightly = columns(pair(), ("dte", "x_p"))
    # 5 % of x_p alone: e = 0.05/sqrt 2 of the motion, and less of the mean.
    slightly["x_p [um]"] = (
        1.05 * (slightly["x_p [um]"] - slightly["x_p [um]"].mean()) + slightly["x_p [um]"].mean()
    )
    slightly.to_csv(paths["slightly_wrong"], index=False)
    over = checked("over_speed").over_speed
    values = {"speed [rpm]": over.theirs.speeds * 30 / np.pi, "dte pp [m]": over.theirs.columns[0].values}
    pd.DataFrame(values).to_csv(paths["speeds"], index=False)
    paths["pair"] = folder / "mypair.toml"
    paths["pair"].write_text(pair().to_toml())
    return paths


def cells(text):
    rows = [
        [cell.strip() for cell in line.strip("│").split("│")] for line in text.splitlines() if "│" in line
    ]
    return {row[0]: row[1:] for row in rows if len(row) > 2}


def test_curves_that_agree_end_with_0(files):
    result = run("check", files["pair"], files["right"])
    assert result.exit_code == 0, result.output
    text = result.stdout.replace("\u00a0", " ")
    assert text.startswith("Your model agrees: misfit ")
    found = cells(text)
    assert [found[name][-1] for name in CHANNELS] == len(CHANNELS) * ["agrees"]
    assert "Peaks to peak are those of the samples." in text


def test_curves_that_differ_end_with_4_and_the_table_says_where(files):
    result = run("check", files["pair"], files["wrong"], "--no-explain")
    assert result.exit_code == 4, result.output
    text = result.stdout.replace("\u00a0", " ")
    assert text.startswith("Your model differs: misfit ")
    found = cells(text)
    rows = {row.channel.channel.name: row for row in checked("wrong").nearer.channels}
    assert {name: found[name][-1] for name in CHANNELS} == dict.fromkeys(CHANNELS, "differs")
    for name in CHANNELS:  # the same curves in other samples
        assert float(found[name][2].removesuffix(" %")) == pytest.approx(100.0 * rows[name].total, rel=0.05)


@pytest.mark.parametrize(("limit", "code"), [("3%", 4), ("0.03", 4), ("4 %", 0), (None, 0)])
def test_the_limit_decides(files, limit, code):
    more = [] if limit is None else ["--limit", limit]
    result = run("check", files["pair"], files["slightly_wrong"], "--no-explain", *more)
    assert result.exit_code == code, result.output
    assert (
        f"limit {limit.replace('0.03', '3%').replace('%', '').strip()} %"
        if limit
        else "limit 5 %" in result.stdout
    )


def test_json_is_the_document_of_the_page_and_nothing_else(files, tmp_path):
    folder = tmp_path / "out"
    result = run("check", files["pair"], files["slightly_wrong"], "--limit", "3%", "--no-explain", "--json")
    assert result.exit_code == 4
    printed = json.loads(result.stdout)
    assert run(
        "check", files["pair"], files["slightly_wrong"], "--limit", "3%", "--no-explain", "-o", folder
    ).exit_code == 4  # fmt: skip
    written = json.loads((folder / "check.json").read_text())
    written.pop("timestamps")
    assert printed == written
    assert printed["verdict"] == "not comparable"  # both programs differ by more here
    assert printed["limit"] == 0.03
    # 5 % of one of two channels.
    assert printed["misfit"] == pytest.approx(0.05 / 1.05 / np.sqrt(2.0), rel=0.05)


def test_the_page_is_written_once_and_again_by_force(files, tmp_path):
    folder = tmp_path / "check"
    first = run("check", files["pair"], files["right"], "-o", folder)
    assert first.exit_code == 0, first.output
    assert "page:" in first.stdout
    assert (folder / "index.html").is_file()
    assert "check" in refused("check", files["pair"], files["wrong"], "-o", folder)
    again = run("check", files["pair"], files["wrong"], "-o", folder, "--force", "--no-explain")
    assert again.exit_code == 4, again.output
    assert json.loads((folder / "check.json").read_text())["verdict"] == "differs"


def test_values_over_speed(files):
    result = run("check", files["pair"], files["speeds"])
    assert result.exit_code == 4, result.output
    assert "The largest difference is at 1100 rpm." in result.stdout
    found = cells(result.stdout.replace("\u00a0", " "))
    share = checked("over_speed").over_speed.by_column[0]
    assert found["dte pp [m]"][:2] == [percent(share), "1100 rpm"]
    assert found["dte pp [m]"][-1] == "differs"


def test_a_folder_or_curves_that_cannot_be_used_end_with_2(files, tmp_path):
    message = refused("check", files["pair"])
    assert "THEIRS" in message
    assert "spurcheck check mypair.toml theirs.csv" in " ".join(message.split())
    assert "missing.csv" in refused("check", files["pair"], tmp_path / "missing.csv")
    assert "limit" in refused("check", files["pair"], files["right"], "--limit", "0")
    assert "limit" in refused("check", files["pair"], files["right"], "--limit", "much")
    assert "budget" in refused("check", files["pair"], files["right"], "--budget", "-1")
    nonsense = tmp_path / "nonsense.csv"
    nonsense.write_text("a,b\n1,2\n3,4\n")
    assert "nonsense.csv" in refused("check", files["pair"], nonsense)


def test_what_was_assumed_is_a_note(files, tmp_path):
    table = pd.read_csv(files["right"])
    bare = tmp_path / "bare.csv"
    pd.DataFrame({"time": 1e-3 * table["time [ms]"], "dte": 1e-6 * table["dte [um]"]}).to_csv(
        bare, index=False
    )
    result = run("check", files["pair"], bare)
    assert result.exit_code == 0, result.output
    assert "Columns without a unit are read in SI" in result.stderr
