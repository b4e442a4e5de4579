"""Does ``spurcheck compare`` print what was computed, for two variants and for three?"""

import json

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest

import spurcheck
from tests.validation.prediction.test_compare import GREATER, RELIEVED, TORQUE
from validation.exchange import read_netcdf
from validation.prediction.compare import compare, of_hundred

from .conftest import refused, run

AMOUNT = "pinion.tip_relief.amount"


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("variants")
    pairs = {"relieved": RELIEVED, "light": TORQUE, "heavy": GREATER}
    paths = {name: folder / f"{name}.toml" for name in pairs}
    for name, pair in pairs.items():
        paths[name].write_text(pair.to_toml())
    return paths


def lines_of(text):
    """First cell of each line of a table -> its other cells."""
    rows = [
        [cell.strip() for cell in line.strip("│").split("│")] for line in text.splitlines() if "│" in line
    ]
    return {row[0]: row[1:] for row in rows if len(row) > 2}


def test_two_files_in_one_table(files, tmp_path):
    out = [tmp_path / f"machines.{suffix}" for suffix in ("nc", "csv", "png", "svg")]
    arguments = [word for path in out for word in ("-o", path)]
    result = run("compare", files["light"], files["heavy"], "--samples", 16, *arguments)
    assert result.exit_code == 0, result.stderr
    comparison = compare(TORQUE, GREATER, samples=16)
    text = result.stdout.replace("\u00a0", " ")
    first, a, b, *_ = text.splitlines()
    assert first == str(comparison["sentence"][0].item()).replace("\u00a0", " ")
    assert "A is better than B in 100 of 100 possible machines: transmission error" in first
    assert (a, b) == (f"A  {files['light']}", f"B  {files['heavy']}")
    cells = lines_of(text)["transmission error [µm]"]
    as_given = comparison["dte_peak_to_peak_given"].to_numpy() * 1e6
    assert [float(one) for one in cells[:2]] == pytest.approx(as_given, rel=6e-3)
    low, high = 0.02 * as_given[0] * np.array([0.964, 1.036])  # 2 % of the A of each machine
    _, _, difference, *_ = cells
    between = difference.split(" to ")
    assert [float(one) for one in between] == pytest.approx([low, high], rel=0.06)
    assert cells[3:] == ["A, B", "100 (83 to 100)"]
    assert lines_of(text)["dynamic factor"][2:] == ["0 to 0", "A = B", "100 (83 to 100)"]
    assert lines_of(text)["contact is lost [of 100]"][:2] == ["0", "0"]
    assert "16 possible machines, seed 1\n" in text
    np.testing.assert_allclose(read_netcdf(out[0])["dte_peak_to_peak"], comparison["dte_peak_to_peak"])
    table = pd.read_csv(out[1])
    np.testing.assert_allclose(table["dte_peak_to_peak_variantB [m]"], comparison["dte_peak_to_peak"][1])
    assert len(table) == 16
    assert min(path.stat().st_size for path in out) > 1000


def test_changes_of_one_pair_as_json_and_as_a_table(files):
    changes = ["--variant", f"{AMOUNT}=9 um; torque=250", "--variant", "gear.face_width=30"]
    line = ["compare", files["relieved"], *changes, "--samples", 16, "--seed", 5]
    printed = json.loads(run(*line, "--json").stdout)
    pairs = [RELIEVED, RELIEVED.with_({AMOUNT: 9.0, "torque": 250.0}), RELIEVED.with_(gear__face_width=30.0)]
    comparison = compare(*pairs, samples=16, seed=5)
    assert printed["variants"] == {
        "A": str(files["relieved"]),
        "B": f"{AMOUNT}=9 um; torque=250",
        "C": "gear.face_width=30",
    }
    assert (printed["samples"], printed["seed"], printed["supports"]) == (16, 5, "springs")
    for name, row in printed["results"].items():
        result = comparison.sel(result=name)
        assert row["holds"] == float(result["holds"])
        assert row["better"]["B"]["A"] == float(result["better"].sel(variant="B", other="A"))
        assert row["given"]["C"] == pytest.approx(float(comparison[f"{name}_given"].sel(variant="C")))
        assert row["difference"]["C"]["A"][1] == pytest.approx(
            float(comparison[f"{name}_difference"].sel(variant="C", other="A", percentile=50.0))
        )
    rows = lines_of(run(*line).stdout.replace("\u00a0", " "))
    best = comparison["best"].sel(result="efficiency").to_numpy()
    expected = f"{'ABC'[best.argmax()]} in {of_hundred(float(best.max()))}"
    _, _, _, best_variant, *_ = rows["efficiency, larger is better [%]"]
    assert best_variant == expected


def test_long_names_stay_above_the_table(files):
    """A column has a letter for a heading, so a name of any length leaves the table as it is."""
    change = "bearings.gear.loa_stiffness=2e8; mesh.damping_ratio=0.08; gear.face_width=30"
    printed = run("compare", files["relieved"], "--variant", change, "--samples", 16)
    assert f"B  {change}\n" in printed.stdout
    table = [line for line in printed.stdout.splitlines() if line.startswith(("│", "┃"))]
    assert max(map(len, table)) < 110


def test_a_range_of_one_variant_alone_is_noted(files):
    printed = run("compare", files["relieved"], "--variant", "uncertainty={}", "--samples", 16)
    assert printed.exit_code == 2  # equal but for what is known of them
    change = 'torque=250; uncertainty={"mesh.damping_ratio"="+- 20 %"}'
    printed = run("compare", files["relieved"], "--variant", change, "--samples", 16)
    assert (
        "note: bearings.gear.loa_stiffness and 1 more vary in A only: state ranges in [uncertainty]"
        in printed.stderr
    )


def test_what_is_no_set_of_variants_is_refused(files):
    one = files["light"]
    other = files["heavy"]
    assert "two pairs or more" in refused("compare", one)
    assert "one pair, which it changes" in refused("compare", one, other, "--variant", "torque=60")
    assert "--variant torque" in refused("compare", one, "--variant", "torque=-3")
    assert "set 2 times" in refused("compare", one, "--set", "torque=50", "--variant", "torque=60")
    assert "They are equal" in refused("compare", one, one)


def test_the_figure_has_each_machine_on_its_side(files):
    variants = [RELIEVED, RELIEVED.with_({AMOUNT: 9.0}), RELIEVED.with_(torque=252.0)]
    comparison = compare(*variants, samples=16)
    figure = spurcheck.plot(comparison)
    for ax, name in zip(figure.axes, comparison["result"].to_numpy(), strict=True):
        texts = [text.get_text() for text in ax.texts]
        dots = [line for line in ax.lines if line.get_marker() == "."]
        bars = {line.get_gid(): line.get_xdata() for line in ax.lines if line.get_gid()}
        scale = None
        for letter in "BC":
            shares = comparison["better"].sel(result=name, variant=letter, other="A")
            assert f"{letter} better in {of_hundred(float(shares))} of 100" in texts
            ends = comparison[f"{name}_difference"].sel(variant=letter, other="A", percentile=[5.0, 95.0])
            ratio = ends.to_numpy() / bars[f"{name}_{letter}"]
            scale = scale or ratio[0]
            np.testing.assert_allclose(ratio, scale)
        drawn = np.sort(np.concatenate([line.get_xdata() for line in dots])) * scale
        expected = (comparison[name] - comparison[name].sel(variant="A")).sel(variant=["B", "C"])
        np.testing.assert_allclose(drawn, np.sort(expected.to_numpy().ravel()), atol=1e-18)
        blue = sum(len(line.get_xdata()) for line in dots if line.get_color() == "#0072B2")
        better = comparison["better"].sel(result=name, variant=["B", "C"], other="A").sum()
        assert blue == round(float(better) * comparison.sizes["sample"])
    plt.close(figure)
