"""Sheets of an .xlsx workbook become a table."""

from __future__ import annotations

import zipfile
from pathlib import Path

from lumped.errors import ParameterError, refuse, shown
from validation.check.reading.table import MOST_COLUMNS, Table
from validation.check.reading.text_table import Layout, table_of_text
from validation.files.matlab import check_size

#: Most rows of a sheet: more than Excel has.
_MOST_ROWS = 1_100_000


def read_workbook(path: Path, field: str = "theirs") -> Table:
    """Read the first sheet with headings above columns of numbers.

    Raises
    ------
    ParameterError : openpyxl is not installed, no workbook, no sheet with a table
    """
    try:
        import openpyxl  # type: ignore[import-untyped]
    except ImportError:
        action = "Type: pip install openpyxl. Or save the sheet as .csv."
        raise refuse(field, path, "a workbook, with openpyxl installed", action) from None
    try:
        with zipfile.ZipFile(path) as archive:
            check_size(sum(member.file_size for member in archive.infolist()))
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
    except Exception as error:  # noqa: BLE001  (readers raise anything of a damaged file)
        why = f"It cannot be read ({shown(str(error), 120)}). Save it again as .xlsx or .csv."
        raise refuse(field, path, "an .xlsx workbook", why) from None
    failures: list[ParameterError] = []
    try:
        for sheet in book.worksheets:
            text = _text(sheet, path, field)
            if not text.strip():
                continue
            try:
                table = table_of_text(text, path.stem, Layout("\t", None), field=field)
            except ParameterError as error:
                failures.append(error)
                continue
            if len(book.worksheets) == 1:
                return table
            note = f"The sheet {shown(sheet.title)} is read."
            return Table(table.name, table.columns, table.stated, remarks=(*table.remarks, note))
    finally:
        book.close()
    if failures:
        raise ParameterError(list(failures[0].problems), str(path))
    raise refuse(field, path, "a sheet with headings and numbers", "The sheets are empty: check the file.")


def _text(sheet: object, path: Path, field: str) -> str:
    """Cells of a sheet as text with tabs; a number has all its digits."""
    lines = []
    try:
        for number, row in enumerate(sheet.iter_rows(values_only=True)):  # type: ignore[attr-defined]
            if number > _MOST_ROWS or len(row) > MOST_COLUMNS:
                raise ValueError("it has too many rows or columns")
            cells = ["" if cell is None else " ".join(str(cell).split()) for cell in row]
            lines.append("\t".join(cells))
    except Exception as error:  # noqa: BLE001
        why = f"It cannot be read ({shown(str(error), 120)}). Save it again as .xlsx or .csv."
        raise refuse(field, path, "an .xlsx workbook", why) from None
    width = max((len(line.rstrip("\t").split("\t")) for line in lines), default=0)
    return "\n".join("\t".join(line.split("\t")[:width]) for line in lines if line.strip())
