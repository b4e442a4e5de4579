"""Are the tables of the page, the CSV files and report.json the same, with the expected headings?"""

import re

import pandas as pd

import tests.validation.reporting.test_numbers
import tests.validation.reporting.test_numbers_of_trust
import tests.validation.reporting.test_words  # noqa: F401  (its recomputations register themselves)
from tests.validation.reporting import recomputed
from tests.validation.reporting.columns import RECOMPUTED
from tests.validation.reporting.test_numbers import close


def test_the_tables_on_the_page_are_those_of_report_json(written):
    """Every cell: numbers to four digits in their unit, words as they are; and each CSV in SI."""
    tables = {
        n: about for c in written.document["chapters"].values() for n, about in c.get("tables", {}).items()
    }
    assert set(tables) == set(written.printed) - {"numbers"}
    for name, about in tables.items():
        shown = written.printed[name]
        rows = written.table(name)
        assert len(shown.rows) == len(rows), name
        for cells, row in zip(shown.rows, rows, strict=True):
            for text, value in zip(cells, row.values(), strict=True):
                if value is None:
                    assert text == "–", (name, row)
                elif isinstance(value, dict) and "unit" in value:
                    number = value["value"]
                    assert (
                        text == "n/a"
                        if number is None
                        else recomputed.assert_printed(text, number, value["unit"]) is None
                    )
                elif isinstance(value, (int, float)) and not isinstance(value, bool):
                    recomputed.assert_printed(text, float(value), "1")
                elif isinstance(value, bool):
                    assert text == ("yes" if value else "no")
                elif isinstance(value, dict):
                    assert text == value["text"]
                elif not re.search(r"e[-+]\d", value):
                    assert text == " ".join(value.replace("\u00a0", " ").replace("\u2212", "-").split())
        assert shown.caption.startswith(about["caption"][:20])


def test_headings_name_their_columns(written):
    """The headings on the page are those that stand above the recomputation of each column."""
    for name, recomputation in RECOMPUTED.items():
        if name in written.printed:
            assert written.headings(name) == recomputation.headings, (
                f"The headings of the table {name} on the page are not those of @recomputes in "
                f"{recomputation.place}: give each column there its heading."
            )


def test_tables_as_csv_have_the_numbers_in_si(written):
    for chapter in written.document["chapters"].values():
        for name in chapter.get("tables", {}):
            data = pd.read_csv(
                written.folder / "tables" / f"{name}.csv", keep_default_na=False, na_values=[""]
            )
            for column in chapter[name][0]:
                cells = [one[column] for one in chapter[name]]
                measured = [one for one in cells if isinstance(one, dict) and "unit" in one]
                units = {one["unit"] for one in measured}
                only = units.pop() if len(units) == 1 else "1"
                column_values = data[column if only == "1" else f"{column} [{only}]"]
                for place, cell in enumerate(cells):
                    value = cell["value"] if isinstance(cell, dict) and "unit" in cell else cell
                    if isinstance(value, float):
                        assert float(column_values[place]) == close(value), (name, column)
                        if len({one["unit"] for one in measured}) > 1:
                            assert data[f"{column} unit"][place] == (cell["unit"])
