"""Teeth that differ beside like teeth: tolerances, loads of meeting pairs, report, command."""

from __future__ import annotations

from copy import copy

import numpy as np
import pytest
import xarray as xr

import floquet
import lumped
from lumped.schema.tolerances import flank_tolerances
from tests.validation.commands.conftest import refused, run
from validation.reporting.build import findings
from validation.reporting.chapters import teeth as chapter
from validation.reporting.page_one import Verdict, page_one
from validation.reporting.results import QUICK, Results
from validation.signals import indicators
from validation.signals.findings import TeethFindings, deviations_table

ONE_TOOTH = [1.5] + [0.0] * 25 + [2.0, 4.0]
PAIR = lumped.load_gear_pair("nasa_28_28").with_(
    {"pinion.deviations": {"index": ONE_TOOTH, "first_order": "steps"}, "friction.law": "none"}
)


@pytest.fixture(scope="module")
def found() -> TeethFindings:
    return TeethFindings(PAIR)


def test_deviations_are_compared_with_the_standard() -> None:
    table = deviations_table(PAIR).sel(gear="pinion")
    assert float(table["cumulative"]) == pytest.approx(4e-6)
    assert float(table["pitch"]) == pytest.approx(2.5e-6)  # from the last tooth to the first
    held = int(table["tolerance_class"])
    limits = [flank_tolerances(28, PAIR.basic_rack.module, number)["f_p"] for number in (held - 1, held)]
    assert limits[0] < 2.5e-6 <= limits[1]
    drawn = PAIR.with_({"pinion.deviations": {"tolerance_class": 6, "seed": 2}})
    assert int(deviations_table(drawn)["tolerance_class"][0]) == 6
    worse = PAIR.with_({"pinion.deviations": {"index": [0.0] * 27 + [500.0]}})
    assert int(deviations_table(worse)["tolerance_class"][0]) == 12


def test_one_tooth_off_is_told_as_sidebands_and_residual(found: TeethFindings) -> None:
    hertz = PAIR.geometry.mesh_frequency / 28
    assert f"every {hertz:.3g} Hz" in found.sentence
    assert "contact is kept" in found.sentence
    assert found.contact_lost == ()
    assert "% of it at order" in found.sentence
    table = found.indicators("pinion")["value"].sel(indicator="RMS_residual")
    quiet = indicators(found.twin, "pinion")["value"].sel(indicator="RMS", record="pair")
    # White noise of 1 % of the average's root mean square is all that the twin's residual has.
    assert float(table.sel(record="healthy twin")) == pytest.approx(0.01 * float(quiet), rel=0.1)
    assert float(table.sel(record="pair")) > 3.0 * float(table.sel(record="healthy twin"))
    assert f"{float(table[0] / table[1]):.2g} times the residual" in found.sentence


def test_the_report_has_a_chapter_on_teeth_that_differ(found: TeethFindings) -> None:
    results = Results(PAIR, QUICK)
    assert results.pair is PAIR.healthy
    # A copy whose contact is lost at one time, and whose pinion alone carries more.
    lost, (motion, twin, force) = copy(found), (found.motion, found.twin, found.static_force)
    lost.__dict__.pop("contact_lost", None)
    apart = motion["normal_load"].where(motion["time"] != motion["time"][9], 0)
    lost.motion = motion.assign(normal_load=apart)
    lost.largest_loads = found.largest_loads.copy()
    lost.largest_loads[3, 5] = 2.0 * force
    results.__dict__["teeth"] = lost
    content = chapter.write(results)
    assert content is not None
    assert content.result == lost.sentence
    assert len(lost.contact_lost) == 1
    blocks = {block.key: block for block in content.blocks if hasattr(block, "key")}
    numbers = [(row[1].value, row[2]) for row in blocks["teeth_numbers"].rows]
    expected = [motion.attrs["dte_peak_to_peak"], found.load(motion) / force, 1.0]
    expected.insert(2, floquet.revolution_multipliers(PAIR).rate)
    assert [value for value, _ in numbers] == pytest.approx(expected)
    assert f"{found.rates[1]:.3g}" in numbers[2][1]
    assert f"{found.load(twin) / force:.3g}" in numbers[1][1]
    rows = {(row[0], row[1]): row[2:] for row in blocks["teeth_indicators"].rows}
    wanted = found.indicators("gear")["value"].sel(indicator="RMS_residual").to_numpy()
    assert rows["gear", "RMS_residual"] == pytest.approx(tuple(wanted))
    shown = blocks["teeth_turn"].data
    cycle = shown.sizes["turn"] // 28
    assert shown["healthy"].values[cycle:] == pytest.approx(shown["healthy"].values[:-cycle])
    assert shown["turn"].values[-1] == pytest.approx(1.0 - 1.0 / shown.sizes["turn"])
    loads, orders = (blocks[f"teeth_{key}_pinion"].figure().axes[0] for key in ("loads", "orders"))
    share = np.diag(found.largest_loads) / force  # 28/28: tooth i meets tooth i alone
    assert share.max() == pytest.approx(found.load(motion) / force)
    assert np.isfinite(found.largest_loads).sum() == 28
    share[3] = 2.0
    table = blocks["teeth_deviations"]
    assert [cell.value for cell in table.rows[0][1:4]] == pytest.approx([4e-6, 2.5e-6, 0.0])
    assert list(table.columns)[1:4] == ["cumulative", "pitch", "eccentricity"]
    assert [bar.get_height() for bar in loads.patches] == pytest.approx(share)
    assert loads.lines[0].get_ydata()[0] == pytest.approx(found.load(twin) / force)
    tops = [line[1, 1] for line in orders.collections[0].get_segments()]
    healthy = blocks["teeth_orders_pinion"].data["healthy"].to_numpy()
    assert healthy[28] == pytest.approx(2.0 * abs(np.fft.rfft(twin["dte"])[1]) / twin.sizes["time"])
    assert set(np.flatnonzero(healthy) % 28) == {0}
    amplitude = blocks["teeth_orders_pinion"].data["amplitude"].to_numpy()
    assert len(tops) > 40
    assert np.isin(np.round(tops, 9), np.round(np.multiply.outer([1.0, 1e6, 1e9], amplitude), 9)).all()
    assert chapter.write(Results(PAIR.healthy, QUICK)) is None
    unstable = Results(PAIR.with_({"mesh.damping_ratio": 0.001, "operating.pinion_speed": "6350 rpm"}), QUICK)
    assert (unstable.teeth, "of like teeth" in unstable.warnings[-1]) == (None, True)
    first = page_one(results)
    assert (first.verdict, "lose contact, at 1 pairs" in first.headline) == (Verdict.DO_NOT_RUN, True)
    assert (findings(results), "class" in first.actions[0].text) == ({"contact", "holds"}, True)
    words = "with the teeth as given"
    assert first.numbers[0].note == f"{words} {expected[0] * 1e6:.3g}\u00a0µm over 28 mesh cycles"
    assert first.numbers[2].note == f"{words} {expected[1]:.3g}"
    assert first.numbers[5].note.endswith(", with like teeth")
    results.__dict__["teeth_band"] = np.array([[1e-6, 0.02], [9e-6, 0.03]])
    assert "µm, 1.0 to 9.0\u00a0µm, over 28" in page_one(results).numbers[0].note
    spread = chapter.write(results).blocks[4].text
    assert "is 1 to 9 µm and the largest sideband 2 to 3 %" in spread


def test_the_command_prints_both(tmp_path, found: TeethFindings) -> None:
    path, target = tmp_path / "own.toml", tmp_path / "motion.csv"
    path.write_text(PAIR.to_toml(), encoding="utf-8")
    result = run("teeth", path, "-o", target)
    assert found.sentence in result.stdout
    peaks, loads = (
        next(line for line in result.stdout.splitlines() if words in line)
        for words in ("peak to peak", "largest load on one tooth")
    )
    for line, of in (
        (peaks, lambda d: 1e6 * d.attrs["dte_peak_to_peak"]),
        (loads, lambda d: found.load(d) / found.static_force),
    ):
        pair, twin = (f"{of(one):.3g}" for one in (found.motion, found.twin))
        assert line.index(pair) < line.rindex(twin), line
    assert target.read_text(encoding="utf-8").count("\n") >= found.motion.sizes["time"]
    assert "teeth that are alike" in refused("teeth", "nasa_28_28")


def test_a_command_about_like_teeth_says_so(tmp_path) -> None:
    path, motion = tmp_path / "own.toml", tmp_path / "motion.nc"
    path.write_text(PAIR.to_toml(), encoding="utf-8")
    assert "takes all teeth of a gear as alike" in run("stability", path).stderr
    result = run("simulate", path, "--steady", "--samples", 64, "-o", motion)
    assert "as alike" not in result.stderr
    with xr.open_dataset(motion, engine="h5netcdf") as data:
        assert data.attrs["period_cycles"] == 28
