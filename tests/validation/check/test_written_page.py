"""Do check.json and the page of a check show the same numbers, and is every column what it says?"""

import dataclasses
import json
import math
import re

import numpy as np
import pandas as pd
import pytest

import lumped
import multibody
from lumped.errors import ParameterError
from tests.validation.check.written_check import (
    CHANNELS,
    CONTACT_RATIO_FACTOR,
    FACTORS,
    PHASE,
    SPEEDS,
    STEPS,
    checked,
    pair,
    softer,
    values_over_speed,
    written_check,
    wrong_curves,
)
from tests.validation.reporting.columns import wrong_cell
from tests.validation.reporting.recomputed import assert_printed, base_radii, path_of_contact
from validation.reporting.check_page import write_check

NAMES = ("wrong", "model", "over_speed", "right")


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    return {name: written_check(name, folder / name) for name in NAMES}


def fourier(values):
    """Complex amplitudes at orders 1 to 12 of equal samples over whole mesh cycles."""
    return 2.0 * np.fft.rfft(values)[1:13] / values.size


def fitted(values):
    """The same of the channels of ``wrong_curves``, from A on, by least squares over their last half."""
    cycles = np.arange(values.size) / 201.7
    used = cycles >= 2.0  # whole cycles
    waves = 2j * np.pi * np.multiply.outer(cycles[used], np.arange(1, 13))
    columns = np.hstack([np.ones((used.sum(), 1)), np.exp(waves).real, -np.exp(waves).imag])
    parts = np.linalg.lstsq(columns, values[used], rcond=None)[0]
    return parts[1:13] + 1j * parts[13:]


def motion(name, cycle):
    if name == "mesh_force":
        return cycle["normal_load"].to_numpy().sum(axis=0)
    return cycle[name].to_numpy()


@pytest.fixture(scope="module")
def ours():
    cycle = lumped.steady_state(pair(), contact="unilateral", samples_per_cycle=512)
    return {name: motion(name, cycle) for name in CHANNELS}


@pytest.fixture(scope="module")
def multibody_values():
    cycle = multibody.steady_state(pair(), fidelity="exact", samples_per_cycle=256, supports="springs")
    return {name: motion(name, cycle) for name in CHANNELS}


@pytest.fixture(scope="module")
def theirs():
    return {channel.name: channel.values for channel in wrong_curves().channels}


def shift_of(theirs, values):
    """The common shift by a search of its own: a grid, then parabolas by halving."""

    def squares(shift):
        turn = np.exp(2j * np.pi * np.arange(1, 13) * shift)
        total = 0.0
        for name in CHANNELS:
            one, other = fitted(theirs[name]), fourier(values[name])
            scale = max(np.linalg.norm(one), np.linalg.norm(other))
            total += np.linalg.norm(one - other * turn) ** 2 / scale**2
        return total

    best, step = min(np.arange(400) / 400, key=squares), 1.0 / 400
    while step > 1e-7:
        best = min((best - step, best, best + step), key=squares)
        step *= 0.7
    return best


def misfits(theirs, values):
    """Per channel: root of the sum of the squares of the orders and of the mean over the static value."""
    shift = shift_of(theirs, values)
    turn = np.exp(2j * np.pi * np.arange(1, 13) * shift)
    force = pair().operating.pinion_torque / pair().geometry.base_radius_pinion
    found = {}
    for name in CHANNELS:
        one, other = fitted(theirs[name]), fourier(values[name]) * turn
        scale = max(np.linalg.norm(one), np.linalg.norm(other))
        static = force if name == "mesh_force" else abs(np.mean(values["dte"]))
        mean = (np.mean(theirs[name][403:]) - np.mean(values[name])) / static
        found[name] = math.hypot(np.linalg.norm(one - other) / scale, mean)
    return found


def check_static(written):
    parameters = pair().to_mapping()
    start, _, end, _ = path_of_contact(parameters)
    ratio = (end - start) / (
        math.pi * 1e-3 * parameters["basic_rack"]["module"]
        * math.cos(math.radians(parameters["basic_rack"]["pressure_angle"]))
    )  # fmt: skip
    radius = base_radii(parameters)[0]
    first, second = written.table("static")
    assert (first["quantity"], second["quantity"]) == ("contact ratio", "base radius of the pinion")
    assert first["theirs"]["value"] == pytest.approx(CONTACT_RATIO_FACTOR * ratio, rel=1e-9)
    assert [first["ours"]["value"], second["ours"]["value"]] == pytest.approx([ratio, radius], rel=1e-9)
    assert second["theirs"]["value"] == pytest.approx(radius, rel=1e-9)
    assert [one["difference"] for one in (first, second)] == pytest.approx([6.0, 0.0])
    assert [one["limit"] for one in (first, second)] == [0.5, 0.5]
    assert [one["verdict"]["text"] for one in (first, second)] == ["differs", "agrees"]


def check_explanations(written):
    rows = written.table("explanations")
    items = [STEPS[0], STEPS[0].alternatives[0], STEPS[1]]
    assert [row["step"] for row in rows] == ["1", "", "2"]
    assert [row["explanation"] for row in rows] == [
        STEPS[0].sentence, f"or: {items[1].sentence}", STEPS[1].sentence
    ]  # fmt: skip
    assert [row["value"] for row in rows] == [item.factor for item in items]
    assert [row["misfit"] for row in rows] == pytest.approx([100.0 * item.misfit for item in items])


def check_speeds(written):
    values = values_over_speed()
    first, second = written.table("speeds")
    assert [first["column"], second["column"]] == ["TE pp", "x order 1"]
    dte = values.columns[0].values
    right = dte / np.array(FACTORS)
    expected = 100.0 * np.linalg.norm(dte - right) / max(np.linalg.norm(dte), np.linalg.norm(right))
    assert [first["misfit"], second["misfit"]] == pytest.approx([expected, 0.0], rel=0.01, abs=0.05)
    assert first["speed"] == {"value": pytest.approx(SPEEDS[1]), "unit": "rpm"}
    assert second["speed"]["value"] in [pytest.approx(speed) for speed in SPEEDS]
    assert first["theirs"] == {"value": pytest.approx(dte[1]), "unit": "m"}
    assert first["ours"] == {"value": pytest.approx(dte[1] / FACTORS[1], rel=1e-6), "unit": "m"}
    place = SPEEDS.index(round(second["speed"]["value"]))
    for side in ("theirs", "ours"):
        assert second[side] == {
            "value": pytest.approx(values.columns[1].values[place], rel=1e-3),
            "unit": "m",
        }
    assert [first["verdict"]["text"], second["verdict"]["text"]] == ["differs", "agrees"]


@pytest.fixture
def check_channels(theirs, ours, multibody_values):
    expected, second = misfits(theirs, ours), misfits(theirs, multibody_values)
    words = {
        "dte": "transmission error", "x_p": "pinion displacement along the line of action",
        "y_g": "gear displacement off the line of action",
        "mesh_force": "mesh force, all tooth pairs together",
    }  # fmt: skip

    def check(written):
        rows = written.table("channels")
        assert [row["channel"] for row in rows] == list(CHANNELS)
        for row in rows:
            name = row["channel"]
            unit = "N" if name == "mesh_force" else "m"
            assert row["quantity"] == words[name]
            # Ours is taken at the times of the samples, which may miss its extremes by a little.
            for key, curve in (("theirs", theirs[name][403:]), ("ours", ours[name])):
                assert row[key] == {"value": pytest.approx(np.ptp(curve), rel=0.005), "unit": unit}
            for key, values in (("their_mean", theirs[name][403:]), ("our_mean", ours[name])):
                assert row[key] == {"value": pytest.approx(np.mean(values), rel=0.005), "unit": unit}
            # Both are read linearly between 512 samples.
            assert row["misfit"] == pytest.approx(100.0 * expected[name], rel=0.01)
            assert row["second"] == pytest.approx(100.0 * second[name], rel=0.02)
            assert row["verdict"] == {"state": "violated", "text": "differs"}

    return check


@pytest.fixture
def check_orders(theirs, ours):
    turn = np.exp(2j * np.pi * np.arange(1, 13) * shift_of(theirs, ours))

    def check(written):
        rows = written.table("orders")
        assert len(rows) == 6 * len(CHANNELS)
        for number, name in enumerate(CHANNELS):
            unit = "N" if name == "mesh_force" else "m"
            one, other = fitted(theirs[name]), fourier(ours[name]) * turn
            largest = np.sort(np.argsort(-np.maximum(np.abs(one), np.abs(other)))[:6])
            of_channel = rows[6 * number : 6 * number + 6]
            assert [row["channel"] for row in of_channel] == 6 * [name]
            assert [row["order"] for row in of_channel] == [float(j + 1) for j in largest]
            least = 2e-3 * np.linalg.norm(one)
            for row, j in zip(of_channel, largest, strict=True):
                assert row["theirs"] == {
                    "value": pytest.approx(abs(one[j]), rel=0.01, abs=least),
                    "unit": unit,
                }
                assert row["ours"] == {
                    "value": pytest.approx(abs(other[j]), rel=0.01, abs=least),
                    "unit": unit,
                }
                degrees = math.degrees(np.angle(other[j] / one[j]))
                assert abs((row["phase"] - degrees + 180.0) % 360.0 - 180.0) < 2.0

    return check


HEADINGS = {
    "static": ["quantity", "theirs", "spurcheck", "theirs over ours, less 1 [%]", "limit [%]", ""],
    "channels": [
        "channel", "quantity", "theirs, peak to peak", "spurcheck, peak to peak", "their mean", "our mean",
        "misfit, lumped model [%]", "misfit, multibody model [%]", "",
    ],
    "orders": ["channel", "mesh order", "theirs", "spurcheck", "phase, ours less theirs [degrees]"],
    "explanations": ["step", "compatible with", "value", "misfit then [%]"],
    "speeds": ["column", "misfit [%]", "worst speed", "theirs there", "spurcheck there", ""],
}  # fmt: skip
TABLES = {
    "static": "wrong",
    "channels": "wrong",
    "orders": "wrong",
    "explanations": "wrong",
    "speeds": "over_speed",
}


@pytest.fixture
def recompute(request):
    """The function that recomputes a table."""
    plain = {"static": check_static, "explanations": check_explanations, "speeds": check_speeds}
    return lambda table: plain.get(table) or request.getfixturevalue(f"check_{table}")


def test_every_table_is_recomputed(pages):
    shown = {name for page in pages.values() for name in page.printed}
    assert shown == TABLES.keys() == HEADINGS.keys()


@pytest.mark.slow
@pytest.mark.parametrize("table", TABLES)
def test_a_table_is_what_it_says_and_a_wrong_value_of_any_column_is_seen(pages, recompute, table):
    written = pages[TABLES[table]]
    look = recompute(table)
    look(written)
    assert written.printed[table].headings == HEADINGS[table]
    rows = written.table(table)
    for column in rows[0]:
        wrong = [row | {column: wrong_cell(row[column])} for row in rows]
        chapters = {
            key: chapter | {table: wrong} if table in chapter else chapter
            for key, chapter in written.document["chapters"].items()
        }
        with pytest.raises(AssertionError):
            look(dataclasses.replace(written, document=written.document | {"chapters": chapters}))


@pytest.mark.parametrize("name", NAMES)
def test_the_page_prints_the_numbers_of_check_json(pages, name):
    written = pages[name]
    for table, printed in written.printed.items():
        rows = written.table(table)
        assert len(printed.rows) == len(rows)
        for cells, row in zip(printed.rows, rows, strict=True):
            for cell, value in zip(cells, row.values(), strict=True):
                if isinstance(value, dict) and "unit" in value:
                    if value["unit"] == "rpm":
                        assert float(cell.removesuffix(" rpm")) == pytest.approx(value["value"], rel=1e-3)
                    else:
                        assert_printed(cell, value["value"], value["unit"])
                elif isinstance(value, dict):
                    assert cell == value["text"]
                elif isinstance(value, float):
                    assert_printed(cell, value, "1")
                else:
                    assert cell == ("–" if value is None else str(value)) or value is None


@pytest.mark.parametrize("name", NAMES)
def test_the_page_is_self_contained_and_its_figures_and_tables_are_files(pages, name):
    written = pages[name]
    assert not re.search(r"""(?:src|href)=["'](?!data:|#)""", written.page)
    assert "<script" not in written.page
    named = [key for chapter in written.document["chapters"].values() for key in chapter.get("figures", [])]
    files = {path.stem: path.read_text(encoding="utf-8") for path in (written.folder / "figures").iterdir()}
    assert named
    assert sorted(named) == sorted(files)
    assert all(text.rstrip().endswith("</svg>") for text in files.values())
    assert written.page.count("data:image/svg+xml;base64,") == len(files)
    for table in written.printed:
        frame = pd.read_csv(written.folder / "tables" / f"{table}.csv")
        assert len(frame) == len(written.table(table))


@pytest.mark.parametrize(("name", "verdict", "failed", "headline"), [
    ("wrong", "differs", "static", "Your model differs before anything moves."),
    ("model", "differs", "low speed", "Your model differs at low speed."),
    ("over_speed", "differs", "over speed", "Your model differs over speed."),
    ("right", "agrees", None, "Your model agrees."),
])  # fmt: skip
def test_the_verdict_of_the_page_is_that_of_the_check(pages, name, verdict, failed, headline):
    written, result = pages[name], checked(name)
    document = written.document
    assert (document["verdict"], document["failed"]) == (verdict, failed)
    assert document["misfit"] == pytest.approx(result.misfit)
    assert document["limit"] == 0.05
    assert document["words"] == result.words == str(result)
    assert document["remarks"] == list(result.remarks)
    text = re.sub(r"<[^>]+>", " ", written.page).replace("\u00a0", " ")
    assert headline in text
    for words in (document["words"], *document["remarks"], *document["look_first"]):
        assert (
            words.replace("\u00a0", " ").split()[:4]
            == re.findall(
                re.escape(" ".join(words.replace("\u00a0", " ").split()[:4])), " ".join(text.split())
            )[0].split()
        )
    assert document["parameters"] == result.pair.to_mapping()


def test_what_to_look_at_first(pages):
    static, step, last = pages["wrong"].document["look_first"]
    assert static.startswith("contact ratio 1.505, spurcheck 1.42")
    assert step == (
        "A mesh stiffness 0.85 times ours. The curves do not tell this from: A face width 0.85 times ours."
    )
    assert last == "No friction."
    (statics,) = pages["model"].document["look_first"]
    assert "Give contact_ratio" in statics
    assert pages["right"].document["look_first"] == []
    assert [one["name"] for one in pages["wrong"].document["explanations"]] == ["stiffness", "friction_law"]


def test_the_search_that_its_budget_ended_says_so(pages):
    assert (
        "The search was ended by its budget"
        in pages["wrong"].document["chapters"]["explanations"]["text"][0][0]
    )


def test_the_common_shift_is_that_of_the_samples(pages):
    (words,) = re.findall(r"first sample lies (\S+) mesh cycles", pages["right"].page)
    assert float(words) == pytest.approx(PHASE, abs=1e-3)


def test_the_page_says_of_which_orders_the_peaks_to_peak_are(pages):
    page = pages["right"].page.replace("\u00a0", " ")
    assert "Peaks to peak are those of the samples. The misfit is that of the mesh orders up to 12." in page


def test_a_folder_in_use_is_refused_and_force_replaces_it(tmp_path):
    folder = tmp_path / "check"
    write_check(checked("over_speed"), folder)
    with pytest.raises(ParameterError):
        write_check(checked("over_speed"), folder)
    write_check(checked("right"), folder, force=True)
    assert json.loads((folder / "check.json").read_text())["verdict"] == "agrees"
    assert not (folder / "figures" / "over_speed.svg").exists()


def test_the_pair_with_softer_bearings_is_no_copy():
    assert softer() != pair()
