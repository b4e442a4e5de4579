"""Does the report say what the comparison with a record found, in one unit a column, and close its gate?"""

import copy
import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from tests.validation.check.record.dynamic_motions import dynamic_record
from validation.check.record.channel import Record
from validation.exchange.new_pair_file import new_pair
from validation.prediction.motion import predicted
from validation.prediction.uncertainty import sampled_predictions, uncertainty
from validation.reporting.blocks import Picture, Quantity, Table, Text, chapter_data
from validation.reporting.build import findings
from validation.reporting.chapters import record as chapter
from validation.reporting.effort import QUICK
from validation.reporting.facts import facts_of
from validation.reporting.page_one import page_one
from validation.reporting.results import Results
from validation.reporting.tables import write_tables
from validation.reporting.verdict import Verdict, verdict_of

CHANNELS = ("dte", "x_p", "bearing_force_x_g")


@pytest.fixture(scope="module")
def pair():
    return new_pair("31/57", module=2, face_width=15, speed=5200, torque=20)


@pytest.fixture(scope="module")
def right(pair):
    return Results(pair, QUICK, record=dynamic_record(predicted(pair), CHANNELS))


@pytest.fixture(scope="module")
def wrong(pair):
    def change(quantity, values, u):
        return {"dte": 1.4, "x_p": -1.0}.get(quantity, 1.0) * values

    return Results(pair, QUICK, record=dynamic_record(predicted(pair), CHANNELS, change=change))


def blocks(results, kind):
    return [one for one in chapter.write(results).blocks if isinstance(one, kind)]


def test_the_chapter_is_left_out_without_a_record(pair):
    results = Results(pair, QUICK)
    assert chapter.write(results) is None
    assert "record" not in findings(results)


def test_a_record_closes_the_gate_where_it_does_not_confirm(right, wrong):
    assert right.measured_error.verdict is Record.CONFIRMS
    assert "record" not in findings(right)
    assert wrong.measured_error.verdict is Record.CONTRADICTS
    assert "record" in findings(wrong)


def test_the_result_says_the_verdict_and_both_sizes(wrong):
    sentence = chapter.write(wrong).result
    assert sentence.startswith("The record contradicts the prediction. Measured ")
    error = wrong.measured_error
    assert f"{abs(error.peak_to_peak.percent):.0f} % too low" in sentence
    assert error.peak_to_peak.percent == pytest.approx(100.0 * (1.0 / 1.4 - 1.0), abs=1.0)


def test_tables_are_the_comparison_in_one_unit_a_column(wrong):
    comparison = wrong.measured_error
    tables = {one.key: one for one in blocks(wrong, Table)}
    for table in tables.values():
        assert not any(isinstance(cell, Quantity) for row in table.rows for cell in row)
    table = tables["record_motions"]
    assert table.columns["measured"] == "measured, peak to peak [µm]"
    rows = {row[0]: dict(zip(table.columns, row, strict=True)) for row in table.rows}
    assert set(rows) == {"dte", "x_p"}
    for name, row in rows.items():
        one = next(channel for channel in comparison.channels if channel.name == name)
        sizes = one.measured.peak_to_peak, one.predicted.peak_to_peak
        assert [row["measured"], row["predicted"]] == pytest.approx(np.multiply(sizes, 1e6), rel=5e-3)
        assert row["percent"] == pytest.approx(100.0 * (sizes[1] / sizes[0] - 1.0), rel=1e-2, abs=0.02)
    assert rows["x_p"]["verdict"].label == "contradicts"
    assert tables["record_forces"].columns["measured"].endswith("[N]")
    uncertainties = tables["record_uncertainty"]
    shares = dict(zip(uncertainties.columns, uncertainties.rows[0], strict=True))
    parts = [shares[name] for name in ("record", "inputs", "numerics")]
    assert shares["u_val"] == pytest.approx(np.linalg.norm(parts), rel=2e-2)
    assert shares["inputs"] == pytest.approx(12.5, rel=1e-2)
    assert "not varied" in uncertainties.caption


def test_what_inputs_would_leave_is_blank_where_they_were_not_varied(wrong):
    table = next(one for one in blocks(wrong, Table) if one.key == "record_orders_motions")
    row = dict(zip(table.columns, table.rows[0], strict=True))
    assert row["predicted_deviation"] is None
    assert row["measured_deviation"] > 0.0


def test_the_figure_draws_both_motions_and_their_orders(wrong, tmp_path):
    picture, ladder = blocks(wrong, Picture)
    assert ladder.key == "explanations"  # what a record that contradicts is compatible with
    comparison = wrong.measured_error
    figure = picture.figure()
    for row, one in enumerate(comparison.channels):
        motions, orders = figure.axes[2 * row : 2 * row + 2]
        curves = {line.get_gid(): np.ptp(line.get_ydata()) for line in motions.lines if line.get_gid()}
        ratio = curves["predicted"] / curves["measured"]
        assert ratio == pytest.approx(one.peak_to_peak.predicted / one.peak_to_peak.measured, rel=1e-2)
        heights = [bar.get_height() for bar in orders.patches]
        half = len(heights) // 2
        shown = one.measured.amplitudes[one.measured.orders <= 10.0]
        assert np.array(heights[:half]) / heights[0] == pytest.approx(shown / shown[0])
        assert motions.get_ylabel().startswith(f"{one.name} [")
    write_tables(blocks(wrong, Table), [picture], tmp_path)
    data = pd.read_csv(tmp_path / "figure_record.csv")
    assert {"channel", "phase"} <= set(data)


def test_the_chapter_is_plain_data_and_says_its_scope(wrong):
    text = json.dumps(chapter_data("The record", chapter.write(wrong)), allow_nan=False)
    assert "Means are not compared" in text
    assert "mesh cycle" in blocks(wrong, Text)[0].text


def test_varied_inputs_reach_the_comparison(pair):
    results = Results(pair, QUICK, record=dynamic_record(predicted(pair), ("dte",)))
    results.uncertainty = uncertainty(pair, 16)
    results.effort = type(QUICK)(**{**vars(QUICK), "band_samples": 16})
    comparison = results.measured_error
    assert comparison.varied
    samples = sampled_predictions(pair, results.uncertainty, 16)
    moves = [one.peak_to_peak - samples.given.peak_to_peak for one in samples.samples]
    assert comparison.peak_to_peak.inputs == pytest.approx(np.sqrt(np.mean(np.square(moves))), rel=2e-2)


def test_page_1_says_the_verdict_of_the_record_and_where_it_is_shown(right, wrong, pair):
    first = page_one(wrong)
    assert (first.verdict, first.actions[0].command) == (Verdict.CONTRADICTED, "chapter “The record”")
    assert chapter.CHAPTER.title == "The record"
    assert first.sure[-1].startswith(
        "Compared with a measurement? The record contradicts the prediction. Meas"
    )
    assert " x_p (pinion " in first.reason  # not the name of a variable alone
    sentence = page_one(right).sure[-1]
    assert sentence.startswith("Compared with a measurement? The record confirms the prediction. Measured ")

    def mirrored(quantity, values, u):
        return -values if quantity == "x_p" else values

    # The channel that contradicts leads, though the transmission error is the leading one.
    words = Results(
        pair, QUICK, record=dynamic_record(predicted(pair), CHANNELS, change=mirrored)
    ).measured_error.words
    assert words.startswith(
        "Order 1 of x_p (pinion displacement along the line of action) has the opposite sign"
    )
    assert "Measured" in words


def test_a_record_that_confirms_within_a_wide_range_is_said_beside_it(right):
    """The range is that of machines that were not measured."""
    results = copy.copy(right)
    ranges = {
        f"{name}_percentile": ("percentile", [0.5 * v, v, 2.0 * v]) for name, v in right.like.numbers.items()
    }
    values = {name: ("sample", [v]) for name, v in right.like.numbers.items()}
    attrs = {f"given_{name}": value for name, value in right.like.numbers.items()}
    attrs |= {"taken": 64, "asked": 64, "refused": 0, "linear": 0, "alone": 1, "seconds": 30.0}
    attrs |= {"contact_lost": 0, "unstable": 0, "lost_or_unstable": 0}
    vars(results)["uncertainty"] = xr.Dataset(ranges | values, attrs=attrs).assign_coords(
        input=["mesh.damping_ratio"]
    )
    judgement = verdict_of(results, facts_of(results))
    assert judgement.verdict is Verdict.UNCERTAIN
    assert (
        "A record confirms the prediction; the range is that of every possible machine." in judgement.reason
    )
