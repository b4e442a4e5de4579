"""Teeth that differ beside like teeth: tolerances, loads of meeting pairs, report, command."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import xarray as xr

import floquet
import lumped
from lumped.schema.tolerances import flank_tolerances
from tests.unlike_pairs import unlike_pair
from tests.validation.commands.conftest import refused, run
from validation.prediction.motion import Motion
from validation.reporting.build import findings
from validation.reporting.chapters import teeth as chapter
from validation.reporting.effort import QUICK
from validation.reporting.page_one import Verdict, page_one
from validation.reporting.results import Results
from validation.signals import indicators
from validation.signals.findings import TeethFindings, deviations_table


def one_tooth_off(name: str) -> lumped.GearPair:
    """An unlike pair of which one tooth of the pinion is off, and its neighbours a little; no friction."""
    index = [3.75] + [0.0] * (unlike_pair(name).pinion.teeth - 3) + [5.0, 10.0]
    deviations = {"pinion.deviations": {"index": index, "first_order": "steps"}}
    return unlike_pair(name).with_({"friction.law": "none"} | deviations)


PAIR = one_tooth_off("rack_25_degrees_always_pushing")
LOST = one_tooth_off("larger_gear_drives_contact_lost")
#: Few speeds: nothing of the teeth depends on them.
FEW = replace(QUICK, sweep_speeds=9, chart_speeds=101, chart_dampings=21, orders_speeds=9)


@pytest.fixture(scope="module")
def teeth_findings() -> TeethFindings:
    return TeethFindings(PAIR)


def test_deviations_are_compared_with_the_standard() -> None:
    table = deviations_table(PAIR).sel(gear="pinion")
    assert float(table["cumulative"]) == pytest.approx(10e-6)
    assert float(table["pitch"]) == pytest.approx(6.25e-6)  # from the last tooth to the first
    tolerance_class = int(table["tolerance_class"])
    limits = [
        flank_tolerances(23, PAIR.basic_rack.module, number)["f_p"]
        for number in (tolerance_class - 1, tolerance_class)
    ]
    assert limits[0] < 6.25e-6 <= limits[1]
    drawn = PAIR.with_({"pinion.deviations": {"tolerance_class": 6, "seed": 2}})
    assert int(deviations_table(drawn)["tolerance_class"][0]) == 6
    worse = PAIR.with_({"pinion.deviations": {"index": [0.0] * 22 + [500.0]}})
    assert int(deviations_table(worse)["tolerance_class"][0]) == 12


def test_one_tooth_off_is_told_as_sidebands_and_residual(teeth_findings: TeethFindings) -> None:
    hertz = PAIR.geometry.mesh_frequency / 23
    assert f"Sidebands at a spacing of {hertz:.3g} Hz" in teeth_findings.sentence
    assert "Contact is kept" in teeth_findings.sentence
    assert teeth_findings.contact_lost == ()
    assert "% of the mesh tone, at order" in teeth_findings.sentence
    table = teeth_findings.indicators("pinion")["value"].sel(indicator="RMS_residual")
    quiet = indicators(teeth_findings.twin, "pinion")["value"].sel(indicator="RMS", record="pair")
    # White noise of 1 % of the average's root mean square is all that the twin's residual has.
    assert float(table.sel(record="healthy twin")) == pytest.approx(0.01 * float(quiet), rel=0.1)
    assert float(table.sel(record="pair")) > 3.0 * float(table.sel(record="healthy twin"))
    times = f"Residual signal: {float(table[0] / table[1]):.2g} times that of perfect teeth."
    assert times in teeth_findings.sentence


@cache
def results_of(pair: lumped.GearPair) -> Results:
    """Shared results of a pair, computed as far as they were asked for."""
    return Results(pair, FEW)


@pytest.fixture(scope="module", params=[PAIR, LOST], ids=["contact kept", "contact lost"])
def results(request) -> Results:
    """Of the report of a pair whose teeth differ: everything but the teeth is that of the twin."""
    results = results_of(request.param)
    assert results.pair is request.param.healthy
    assert results.teeth.pair is request.param
    return results


@pytest.fixture(scope="module")
def blocks(results) -> dict:
    """Tables and pictures of the chapter by name."""
    content = chapter.write(results)
    assert content.result == results.teeth.sentence
    return {block.key: block for block in content.blocks if hasattr(block, "key")}


def values(block) -> list[float]:
    return [row[1].value for row in block.rows]


def test_meeting_teeth_lose_contact_where_the_total_load_is_zero(results) -> None:
    teeth_findings = results.teeth
    total = teeth_findings.motion["normal_load"].sum("pair").to_numpy()
    assert (len(teeth_findings.contact_lost) > 0) == (total.min() == 0.0) == (teeth_findings.pair is LOST)
    # As many as there are mesh cycles with such a time: each has teeth of its own that come last to A.
    when = teeth_findings.motion["time"].to_numpy()[total == 0.0] / teeth_findings.pair.geometry.mesh_period
    assert len(teeth_findings.contact_lost) == len(set(np.floor(when + 1e-9).astype(int)))


def mean_force(motion) -> float:
    """Mean over the period of the loads of all pairs together [N]."""
    return float(np.mean(np.sum(motion["normal_load"].to_numpy(), axis=0)))


def over_mean_force(motion) -> float:
    """Largest load of one tooth pair over the mean mesh force [-]."""
    return float(motion["normal_load"].to_numpy().max()) / mean_force(motion)


def test_the_chapter_has_the_numbers_of_the_motion(results, blocks) -> None:
    teeth_findings = results.teeth
    swing, load, rate, lost = values(blocks["teeth_numbers"])
    assert swing == pytest.approx(
        np.ptp(teeth_findings.motion["dte"].to_numpy()), rel=0.01
    )  # peaks lie between samples
    assert load == pytest.approx(over_mean_force(teeth_findings.motion))
    assert rate == pytest.approx(floquet.revolution_multipliers(teeth_findings.pair).rate)
    assert lost == len(teeth_findings.contact_lost)


def test_the_chapter_has_the_numbers_of_like_teeth_beside_them(results, blocks) -> None:
    teeth_findings = results.teeth
    _, load_note, growth_note, *_ = (note for _, _, note, *_ in blocks["teeth_numbers"].rows)
    assert f"{over_mean_force(teeth_findings.twin):.3g}" in load_note
    assert f"{floquet.gear_pair_multipliers(teeth_findings.pair.healthy).spectral_radius:.3g}" in growth_note


def test_the_chapter_has_the_deviations_and_indicators(results, blocks) -> None:
    table = blocks["teeth_deviations"]
    assert list(table.columns)[1:4] == ["cumulative", "pitch", "eccentricity"]
    assert [cell.value for cell in table.rows[0][1:4]] == pytest.approx([10e-6, 6.25e-6, 0.0])
    rows = {(row[0], row[1]): row[2:] for row in blocks["teeth_indicators"].rows}
    for gear in ("pinion", "gear"):
        wanted = results.teeth.indicators(gear)["value"].sel(indicator="RMS_residual").to_numpy()
        assert rows[gear, "RMS_residual"] == pytest.approx(tuple(wanted))


def test_the_curve_over_a_turn_repeats_that_of_like_teeth(results, blocks) -> None:
    shown = blocks["teeth_turn"].data
    z = results.pair.pinion.teeth
    cycle = shown.sizes["turn"] // z
    assert shown["healthy"].values[cycle:] == pytest.approx(shown["healthy"].values[:-cycle])
    assert shown["turn"].values[-1] == pytest.approx(1.0 - 1.0 / shown.sizes["turn"])
    assert np.ptp(shown["dte"].values - shown["healthy"].values) > 1e-7


def test_the_bars_are_the_largest_loads_of_the_teeth(results, blocks) -> None:
    teeth_findings = results.teeth
    axes = blocks["teeth_loads_pinion"].figure().axes[0]
    numbers, loads = (teeth_findings.motion[name].to_numpy() for name in ("pinion_tooth", "normal_load"))
    expected = [loads[numbers == tooth].max() for tooth in range(1, teeth_findings.pair.pinion.teeth + 1)]
    assert [bar.get_height() for bar in axes.patches] == pytest.approx(
        np.array(expected) / mean_force(teeth_findings.motion)
    )
    healthy = over_mean_force(teeth_findings.twin)
    assert axes.lines[0].get_ydata()[0] == pytest.approx(healthy)


def test_the_orders_of_like_teeth_are_those_of_the_mesh(results, blocks) -> None:
    teeth_findings = results.teeth
    z = results.pair.pinion.teeth
    data = blocks["teeth_orders_pinion"].data
    healthy = data["healthy"].to_numpy()
    amplitude = data["amplitude"].to_numpy()
    twin = teeth_findings.twin["dte"].to_numpy()
    assert healthy[z] == pytest.approx(2.0 * abs(np.fft.rfft(twin)[1]) / twin.size)
    assert set(np.flatnonzero(healthy) % z) == {0}
    tops = [
        line[1, 1] for line in blocks["teeth_orders_pinion"].figure().axes[0].collections[0].get_segments()
    ]
    assert len(tops) > z
    assert np.isin(np.round(tops, 9), np.round(np.multiply.outer([1.0, 1e6, 1e9], amplitude), 9)).all()


def test_page_1_judges_the_teeth_as_given(results) -> None:
    teeth_findings = results.teeth
    first = page_one(results)
    lost = len(teeth_findings.contact_lost)
    assert (first.verdict is Verdict.DO_NOT_RUN) == (lost > 0)
    assert ("the teeth lose contact" in first.headline) == (lost > 0)
    assert ("contact" in findings(results)) == (lost > 0)
    swing, load = values(results_table(results))[:2]
    assert [first.numbers[n].value for n in (0, 2)] == pytest.approx([swing, load])
    like = results.like.numbers
    beside = f"like teeth {like['dte_peak_to_peak'] * 1e6:.3g}\u00a0µm"
    swing_row, _, load_row, *_ = first.numbers
    assert swing_row.note == f"over {teeth_findings.period} mesh cycles; {beside}"
    assert load_row.note == f"like teeth {like['tooth_load']:.3g}"
    assert not any(math.isfinite(one.second) for one in first.numbers)  # the second program has like teeth
    hazard = next(one for one in first.numbers if one.key == "hazard")
    # The search and the proof are with like teeth.
    assert "; the linear motion is proven stable from " in hazard.note
    assert hazard.note.endswith(", with like teeth")


def results_table(results):
    return next(b for b in chapter.write(results).blocks if getattr(b, "key", "") == "teeth_numbers")


def test_what_a_class_leaves_open_is_told() -> None:
    results = copy.copy(results_of(PAIR))
    vars(results)["teeth_band"] = xr.Dataset(
        {"revolution_dte_peak_to_peak": ("end", [1e-6, 9e-6]), "sideband_ratio": ("end", [0.02, 0.03])},
        attrs={"samples": 20, "taken": 20, "asked": 32},
    )
    texts = [getattr(block, "text", "") for block in chapter.write(results).blocks]
    spread = next(text for text in texts if "largest sideband" in text)
    assert "is 1 to 9 µm and the largest sideband 2 to 3 %" in spread
    page = page_one(results)
    assert (
        "The range of teeth that differ is from 20 of 32 possible machines; the time of 10 s was"
        in page.sure[1]
    )
    first = page.numbers
    assert first[0].range.startswith("1.0 to 9.0\u00a0µm (")
    assert not any(one.range for one in first[1:])  # samples of the other numbers are of like teeth


def test_like_teeth_have_no_chapter_and_teeth_that_do_not_settle_have_the_linear_motion() -> None:
    assert chapter.write(Results(PAIR.healthy, QUICK)) is None
    light = unlike_pair("unlike_teeth_finite_elements").with_({"operating.pinion_torque": 0.01})
    results = Results(light, FEW)
    assert results.prediction.motion is Motion.LINEAR
    assert results.teeth.motion.attrs["contact"] == "linear"
    assert "has not closed" in results.prediction.reason


def test_the_command_prints_both(tmp_path, teeth_findings: TeethFindings) -> None:
    path = tmp_path / "own.toml"
    target = tmp_path / "motion.csv"
    path.write_text(PAIR.to_toml(), encoding="utf-8")
    result = run("teeth", path, "-o", target)
    assert teeth_findings.sentence in result.stdout
    peaks, loads = (
        next(line for line in result.stdout.splitlines() if words in line)
        for words in ("peak to peak", "largest load on one tooth")
    )
    for line, quantity in (
        (peaks, lambda d: 1e6 * d.attrs["dte_peak_to_peak"]),
        (loads, over_mean_force),
    ):
        pair, twin = (f"{quantity(one):.3g}" for one in (teeth_findings.motion, teeth_findings.twin))
        assert line.index(pair) < line.rindex(twin), line
    assert target.read_text(encoding="utf-8").count("\n") >= teeth_findings.motion.sizes["time"]
    assert "teeth that are alike" in refused("teeth", "nasa_28_28")


def test_a_command_about_like_teeth_says_so(tmp_path) -> None:
    path = tmp_path / "own.toml"
    motion = tmp_path / "motion.nc"
    path.write_text(PAIR.to_toml(), encoding="utf-8")
    assert "takes all teeth of a gear as alike" in run("stability", path).stderr
    result = run("simulate", path, "--steady", "--samples", 64, "-o", motion)
    assert "as alike" not in result.stderr
    with xr.open_dataset(motion, engine="h5netcdf") as data:
        assert data.attrs["period_cycles"] == 23
