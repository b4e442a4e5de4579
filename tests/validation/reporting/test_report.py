"""Is the report whole, short, and the same each time? Does page 1 say one thing, with its reason?"""

import copy
import html
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import openpyxl
import pytest
import xarray as xr

import lumped
from tests.validation.reporting.written import PAIRS, SMALL, known, write_report
from validation.reporting import build
from validation.reporting import results as of_results
from validation.reporting.actions import advice_on_inputs
from validation.reporting.blocks import plain
from validation.reporting.chapters import contact_loss
from validation.reporting.relations import broken_relations
from validation.reporting.results import Results
from validation.reporting.verdict import Verdict


def words(page: str) -> list[str]:
    text = re.sub(r"<style>.*?</style>|<[^>]+>", " ", page, flags=re.DOTALL)
    return html.unescape(text).split()


def test_the_page_needs_nothing_else_and_is_short(written):
    assert not re.search(r'(src|href)="(?!#|data:)', written.page)
    assert "<script" not in written.page
    assert len(written.document["chapters"]) == 9
    assert len(words(written.page)) <= 4500


def test_no_internal_name_is_on_page_1(written):
    first = written.page.split("<main>")[0]
    text = " ".join(words(first))
    assert not re.search(r"\b(dte|y_p|x_p|normal_load|rms_over|_peak)\b", text)


def test_tables_are_in_the_workbook(written):
    book = openpyxl.load_workbook(written.folder / "tables" / "tables.xlsx")
    names = {name for chapter in written.document["chapters"].values() for name in chapter.get("tables", {})}
    assert {name[:31] for name in names} == set(book.sheetnames)
    rows = list(book["orders"].values)
    table = written.document["chapters"]["response"]["orders"]
    dte = rows[0].index("dte [m]")
    assert rows[1][dte] == pytest.approx(table[0]["dte"]["value"])


def test_the_motions_at_the_operating_speed_and_the_share_of_the_starts(written):
    if written.document["gear_pair"] != "lost":
        return
    results = known("lost")
    search = results.jump_search
    orbits = 2 * tuple(search.at(results.operating_rpm))
    names = "kind n dte_peak_to_peak largest_load share share_interval starts"
    values = (
        ("beats", 0, 2e-6, 900.0, 0.2, (0.1, 0.4), 3),
        ("periodic", 2, 1e-6, 700.0, 0.8, (0.6, 0.9), 12),
    )
    basins = [SimpleNamespace(**dict(zip(names.split(), one, strict=True))) for one in values]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(type(search), "at", lambda *_: orbits)
        patch.setattr(type(search.branches[0]), "basins", lambda _: basins)
        blocks = contact_loss.write(results).blocks
    rows = {
        block.key: [tuple(map(plain, row)) for row in block.rows]
        for block in blocks
        if hasattr(block, "rows")
    }
    shown = [(o.n, o.stable, o.dte_range[1] - o.dte_range[0], o.largest_load) for o in orbits]
    assert [
        tuple(v["value"] if isinstance(v, dict) else v for v in row) for row in rows["motions_here"]
    ] == shown
    for row, (kind, n, size, load, share, ends, _) in zip(rows["basins"], values, strict=True):
        assert row[:2] == (kind, n)
        assert [(one["value"], one["unit"]) for one in row[2:]] == [
            (size, "m"), (load, "N"), *((v, "1") for v in (share, *ends))
        ]  # fmt: skip


def test_the_same_pair_gives_the_same_json(written, tmp_path):
    if written.document["gear_pair"] != "calm":
        pytest.skip("one pair will do")
    document = write_report("calm", tmp_path / "again", drawn=False).document  # all is computed again
    for one in (document, written.document):
        one.pop("timestamps", None)
    assert document == written.document


def test_a_report_checks_the_variant_too(monkeypatch):
    """The other tests do without it: the report asks for what ``crosscheck`` does by default."""
    asked = []
    monkeypatch.setattr(of_results, "crosscheck", lambda pair, **options: asked.append(options))
    Results(PAIRS["calm"](), SMALL, "calm").check  # noqa: B018  (a property that computes)
    assert [{"fidelities", "variant"} & options.keys() for options in asked] == [set()]


class TestRelations:
    """Each relation between results is seen when it is broken."""

    @pytest.fixture
    def results(self):
        return copy.copy(known("calm"))  # what a test computes with a fault stays in its copy

    @pytest.mark.parametrize(("name", "change", "word"), [
        ("dynamic_factor", lambda v: 0.9, "dynamic factor"),
        ("least_force", lambda v: -0.2, "smallest mesh force"),
        ("efficiency", lambda v: 1.2, "efficiency"),
        ("bearing_rms", lambda v: 0.1 * v, "orders of the bearing force"),
        ("dte_peak_to_peak", lambda v: 2.0 * v, "another dte_peak_to_peak"),
    ])  # fmt: skip
    def test_a_wrong_number_is_seen(self, results, name, change, word, monkeypatch):
        prediction = results.prediction
        numbers = dict(results.prediction.numbers)
        numbers[name] = change(numbers[name])
        assert results.uncertainty is not None  # computed before the fault
        monkeypatch.setattr(type(prediction), "numbers", property(lambda self: numbers))
        assert any(word in text for text in broken_relations(results))

    def test_a_force_that_the_torque_does_not_bear_is_seen(self, results, monkeypatch):
        """A mesh force that is 1 % too large breaks the balance of the moments on the pinion."""
        prediction = results.prediction
        assert not any("do not balance" in text for text in broken_relations(known("calm")))
        monkeypatch.setitem(vars(prediction), "mean_force", 1.01 * prediction.mean_force)
        assert any("do not balance" in text for text in broken_relations(results))

    def test_a_broken_relation_is_a_failed_check_and_the_verdict(self, results, tmp_path, monkeypatch):
        monkeypatch.setattr("validation.reporting.relations._SAME", -1.0)
        made = write_report("calm", tmp_path / "r", drawn=False, results=results).result
        assert made.first.verdict is Verdict.BROKEN
        assert made.failed


def test_a_law_outside_its_range_is_told_on_the_page_and_nowhere_else(tmp_path, monkeypatch, recwarn):
    # No sentence on the law needs the jumps, whose search would take all its time.
    monkeypatch.setattr(build, "QUICK", replace(SMALL, sweep_speeds=9, chart_speeds=25, jump_seconds=0.5))
    changes = {
        "operating.pinion_torque": 0.5,
        "operating.pinion_speed": 20000.0,
        "friction.law": "benedict_kelley",
    }
    small_load = PAIRS["calm"]().with_(changes)
    written = build.report(small_load, tmp_path / "report", quick=True)
    assert not [w for w in recwarn if issubclass(w.category, lumped.LawRangeWarning)]
    text = (written.folder / "index.html").read_text(encoding="utf-8")
    assert "friction number" in text


def test_each_advice_gains_what_its_own_input_moves():
    """Inputs whose names begin alike: each has the swing of its own row, and an advice of its own."""
    inputs = ["mesh.stiffness", "mesh.stiffness_factor", "pinion.tip_relief.amount", "gear.tip_relief.amount"]
    swing = np.array([[2.0, 3.4], [3.1, 3.3], [0.9, 1.6], [2.8, 3.2]]) * 1e-6
    results = SimpleNamespace(
        uncertainty=xr.Dataset({"dte_peak_to_peak_swing": (("input", "end"), swing)}, {"input": inputs}),
        like=SimpleNamespace(peak_to_peak=1e-6),
    )
    gains = {one.command: one.gain.replace("\u00a0", " ") for one in advice_on_inputs(results)}
    assert {name: gains[name].removeprefix("it moves the transmission error from ") for name in gains} == {
        "mesh.stiffness": "2.0 to 3.4 µm",
        "mesh.stiffness_factor": "3.1 to 3.3 µm",
        "pinion.tip_relief.amount": "0.90 to 1.6 µm",
    }
