"""Is every column of every table of the report recomputed by a test that sees a wrong value?"""

import dataclasses

import pytest

# The tests that recompute tables register themselves.
import tests.validation.reporting.test_numbers
import tests.validation.reporting.test_numbers_of_trust
import tests.validation.reporting.test_words  # noqa: F401
from tests.validation.reporting.columns import RECOMPUTED, Recomputation, complaints, wrong_cell


def tables_of(written):
    return [name for chapter in written.document["chapters"].values() for name in chapter.get("tables", {})]


def test_every_column_is_recomputed(written):
    missing = [text for name in tables_of(written) for text in complaints(written, name)]
    if missing:
        pytest.fail("\n".join(missing), pytrace=False)


def test_every_number_has_a_unit_or_a_heading_that_says_what_it_is(written):
    """A number in report.json stands beside its unit. A bare number is a share, which its heading says."""
    for name in tables_of(written):
        for column, heading in written.headings(name).items():
            bare = [row[column] for row in written.table(name) if isinstance(row[column], float)]
            assert not bare or heading, (name, column)


def test_every_variable_of_every_dataset_has_its_unit(written):
    """Variables are in SI or in the unit of their attribute: rpm, degrees and per cent are allowed there."""
    for file in sorted((written.folder / "data").glob("*.nc")):
        data = written.data(file.stem)
        numbers = [name for name in data.variables if data[name].dtype.kind in "fiub"]
        assert [name for name in numbers if not data[name].attrs.get("units")] == [], file.name


def test_a_column_without_a_recomputation_is_told_with_what_to_add(written, monkeypatch):
    orders = RECOMPUTED["orders"]
    fewer = {name: text for name, text in orders.headings.items() if name != "bearing"}
    monkeypatch.setitem(RECOMPUTED, "orders", dataclasses.replace(orders, headings=fewer))
    (text,) = complaints(written, "orders")
    assert 'No test recomputes the column "bearing" of the table "orders"' in text
    assert "tests/validation/reporting/test_numbers.py, test_the_table_of_orders" in text
    monkeypatch.delitem(RECOMPUTED, "orders")
    (text,) = complaints(written, "orders")
    assert '@recomputes("orders", order="...", frequency="...", dte="...", bearing="...")' in text


def test_a_recomputation_that_does_not_look_at_a_column_is_told(written, monkeypatch):
    def looks_at_frequencies_alone(report):
        frequencies = [row["frequency"]["value"] for row in report.table("orders")]
        assert frequencies == [row["frequency"]["value"] for row in written.table("orders")]

    blind = Recomputation("orders", looks_at_frequencies_alone, RECOMPUTED["orders"].headings)
    monkeypatch.setitem(RECOMPUTED, "orders", blind)
    texts = complaints(written, "orders")
    assert len(texts) == 3
    assert all("does not see a wrong value" in text for text in texts)


@pytest.mark.parametrize(("cell", "wrong"), [
    ({"value": 2.0, "unit": "N"}, {"value": 2.6, "unit": "N"}), ({"value": None, "unit": "N"},) * 2,
    (3, 4), (True, False), (0.0, 1.0), ("up", "x pu"), ("", ""), (None, None),
    ({"state": "ok", "text": "ok"}, {"state": "x ko", "text": "x ko"}),
])  # fmt: skip
def test_a_wrong_cell_differs_unless_it_is_empty(cell, wrong):
    assert wrong_cell(cell) == pytest.approx(wrong) if isinstance(cell, float) else wrong_cell(cell) == wrong
