"""Which test recomputes which column of the tables of the report: ``recomputes`` above the test says so."""

import dataclasses
from collections.abc import Callable, Mapping

from tests.validation.reporting.written import Written

#: A change of a number that a recomputation must see: another quantity or another unit changes more.
FACTOR = 1.3


@dataclasses.dataclass(frozen=True)
class Recomputation:
    """The test of one table: it reads ``written.table(table)`` and compares every column.

    Attributes
    ----------
    table : key of the table in report.json
    test : the test function, called with a written report
    headings : name of each column -> heading that the page must print
    """

    table: str
    test: Callable[[Written], None]
    headings: Mapping[str, str]

    @property
    def place(self) -> str:
        """File and name of the test."""
        return f"{self.test.__module__.replace('.', '/')}.py, {self.test.__name__}"


#: Key of a table -> its recomputation.
RECOMPUTED: dict[str, Recomputation] = {}
#: Columns of a table of named numbers.
NAMED_NUMBERS = {"name": "", "value": "value", "note": ""}


def recomputes(table: str, **headings: str) -> Callable[[Callable], Callable]:
    """Decorate the test that recomputes a table: name of each column = its heading on the page."""

    def register(test: Callable[[Written], None]) -> Callable[[Written], None]:
        RECOMPUTED[table] = Recomputation(table, test, headings)
        return test

    return register


def complaints(written: Written, table: str) -> list[str]:
    """Columns of a table that no test recomputes, or whose wrong values the test does not see."""
    columns = list(written.table(table)[0]) if written.table(table) else []
    recomputation = RECOMPUTED.get(table)
    if recomputation is None:
        headings = ", ".join(f'{name}="..."' for name in columns)
        return [
            f'No test recomputes the table "{table}". Write a test above which stands '
            f'@recomputes("{table}", {headings}) in tests/validation/reporting/test_numbers.py.'
        ]
    mistakes = []
    for name in columns:
        if name not in recomputation.headings:
            mistakes.append(
                f'No test recomputes the column "{name}" of the table "{table}". In {recomputation.place}: '
                f'add {name}="<its heading>" to @recomputes, and compare one["{name}"] with a value that is '
                "computed from the saved data."
            )
        elif _unseen(written, recomputation, name):
            mistakes.append(
                f'{recomputation.place} does not see a wrong value in the column "{name}" of the table '
                f'"{table}". Compare one["{name}"] with a value that is computed from the saved data.'
            )
    return mistakes


def _unseen(written: Written, recomputation: Recomputation, column: str) -> bool:
    """Whether the test passes though every cell of a column is wrong. An empty column cannot be wrong."""
    rows = written.table(recomputation.table)
    wrong = [row | {column: wrong_cell(row[column])} for row in rows]
    if wrong == rows:
        return False
    chapters = {
        key: chapter | {recomputation.table: wrong} if recomputation.table in chapter else chapter
        for key, chapter in written.document["chapters"].items()
    }
    document = written.document | {"chapters": chapters}
    try:
        recomputation.test(dataclasses.replace(written, document=document))
    except Exception:  # noqa: BLE001  (a test may fail in any way)
        return False
    return True


def wrong_cell(cell: object) -> object:
    """A cell of report.json with another value; empty cells stay empty."""
    if isinstance(cell, dict) and "unit" in cell:
        return cell | {"value": wrong_cell(cell["value"])}
    if isinstance(cell, dict):
        return {name: wrong_cell(word) for name, word in cell.items()}
    if isinstance(cell, bool):
        return not cell
    if isinstance(cell, int):
        return cell + 1
    if isinstance(cell, float):
        return FACTOR * cell if cell else 1.0
    if isinstance(cell, str):  # a test may look at a part of the words
        return f"x {cell[::-1]}" if cell else cell
    return cell
