"""Text with columns: separators, decimal sign, headings and units are recognised, whoever wrote the file.

The numbers are the longest block of lines with equally many numbers; the headings are the line before the
block, or the two lines before it where the second has units. Lines further up are the preamble of a
measuring machine or a program. Lines that begin with #, % or ! are comments; the last comment before
the numbers has the headings where no other line has them.
"""

from __future__ import annotations

import csv
import io
import re
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from lumped.errors import ParameterError, refuse, shown
from lumped.fields.text_file import read_bytes
from lumped.typing import FloatArray
from validation.check.reading.meaning import understood
from validation.check.reading.table import MOST_COLUMNS, Column, Table
from validation.check.reading.units import is_unit

if TYPE_CHECKING:
    import pandas as pd

#: Largest text file that is read: a bound against a wrong path.
_MAX_BYTES = 2_000_000_000
#: Lines in which the first line of numbers must stand.
_PREAMBLE = 2000
#: Lines by which the separators are recognised.
_SAMPLE = 200
_COMMENTS = ("#", "%", "!", "//")
_POINT = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")
_COMMA = re.compile(r"[+-]?(\d+,?\d*|,\d+)([eE][+-]?\d+)?")
#: Stands between a name and its unit while a line is split at blanks.
_JOINT = "\ue000"
_BLANKS = re.compile(r"\s+")

Decimal = Literal[".", ","]


class Layout(NamedTuple):
    """Separator of the cells and decimal sign; None: not stated. Separator " " is any number of blanks."""

    delimiter: str | None = None
    decimal: Decimal | None = None


#: Separator and decimal sign are recognised.
ANY_LAYOUT = Layout()


class Purpose(NamedTuple):
    """What the columns are for: whether a heading has a meaning, and two headings as an example."""

    has_meaning: Callable[[str], object]
    example: str


CURVES = Purpose(understood, "time [s], dte [um]")


class _Block(NamedTuple):
    """Lines of numbers: index of the first line and number of cells in a line."""

    first: int
    cells: int


class _Headings(NamedTuple):
    """Headings of the columns, their units where a line of units follows, and index of the first line."""

    names: list[str]
    units: list[str] | None
    first: int


def read_text_table(
    path: Path, layout: Layout = ANY_LAYOUT, *, field: str = "theirs", purpose: Purpose = CURVES
) -> Table:
    """Read a file of text with columns.

    Raises
    ------
    ParameterError : no text, no headings, no block of numbers, or a cell without a finite number
    """
    data = read_bytes(path, _MAX_BYTES, field=field, kind="CSV file")
    text, remarks = _decoded(data, path, field)
    try:
        return table_of_text(text, path.stem, layout, remarks=remarks, field=field, purpose=purpose)
    except ParameterError as error:
        raise ParameterError(list(error.problems), str(path)) from None


def _decoded(data: bytes, path: Path, field: str) -> tuple[str, tuple[str, ...]]:
    """Text of a file in UTF-8, UTF-16 or in the Windows code page of western Europe; then remarks."""
    is_utf_16 = data.startswith((b"\xff\xfe", b"\xfe\xff"))
    for encoding in ["utf-16"] if is_utf_16 else ["utf-8-sig", "cp1252"]:
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if re.search(r"[\x00-\x08\x0e-\x1f]", text[:100_000]):
            break
        if encoding == "cp1252":
            return text, ("The file is read as Windows-1252 text, because it is no UTF-8.",)
        return text, ()
    raise refuse(field, path, "a file of text with columns", "It is a binary file: save it as .csv or .mat.")


def table_of_text(
    text: str,
    name: str,
    layout: Layout = ANY_LAYOUT,
    *,
    remarks: tuple[str, ...] = (),
    field: str = "theirs",
    purpose: Purpose = CURVES,
) -> Table:
    """Make a table of text."""
    lines = text.splitlines()
    if not any(line.strip() for line in lines):
        action = "Check the file."
        raise refuse(field, "empty", "a line of headings and lines of numbers", action)
    layout = _layout(lines, layout, field)
    block = _block(lines, layout)
    if block is None:
        raise _no_numbers(lines, field, purpose)
    headings = _headings(lines, layout, block, field, purpose)
    body = "\n".join(line for line in lines[block.first :] if line.strip() and not _is_comment(line))
    cells = _cells(body, layout, len(headings.names), field)
    columns = _columns(cells, headings, layout, field)
    notes = list(remarks)
    if layout.decimal == ",":
        notes.append("Numbers are read with a decimal comma.")
    preamble = [line for line in lines[: headings.first] if line.strip() and not _is_comment(line)]
    if preamble:
        lines_are = "lines before the headings are" if len(preamble) > 1 else "line before the headings is"
        notes.append(f"{len(preamble)} {lines_are} not used.")
    return Table(name, columns, remarks=tuple(notes))


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(_COMMENTS)


def _split(line: str, delimiter: str) -> list[str]:
    """Cells of a line without surrounding blanks and quotes."""
    if delimiter == " ":
        single = _BLANKS.sub(" ", line.strip())
        joined = re.sub(r" (?=[\[({])", _JOINT, single)  # a unit belongs to the name before it
        quoted = re.findall(r'"[^"]*"|\S+', joined)
        return [cell.strip('"').replace(_JOINT, " ") for cell in quoted]
    if '"' in line or "'" in line:
        quote = '"' if '"' in line else "'"
        try:
            rows = list(csv.reader([line], delimiter=delimiter, quotechar=quote, skipinitialspace=True))
        except csv.Error:
            return [line]
        return [cell.strip() for cell in rows[0]] if rows else []
    return [cell.strip() for cell in line.split(delimiter)]


def _is_number(cell: str, decimal: str) -> bool:
    return (_POINT if decimal == "." else _COMMA).fullmatch(cell) is not None


def _numeric(line: str, delimiter: str, decimal: str) -> int:
    """Number of cells where most cells of a line are numbers and the first is; else 0.

    Some cells may be damaged: they are refused later, with their place.
    """
    cells = _split(line, delimiter)
    while len(cells) > 1 and not cells[-1]:
        cells.pop()
    good = sum(_is_number(cell, decimal) for cell in cells)
    if not cells or len(cells) > MOST_COLUMNS or not _is_number(cells[0], decimal):
        return 0
    return len(cells) if 2 * good > len(cells) else 0


def _layout(lines: list[str], stated: Layout, field: str) -> Layout:
    """Separator and decimal sign with which most lines become lines of numbers."""
    sample = [line for line in lines[: _PREAMBLE + _SAMPLE] if line.strip() and not _is_comment(line)]
    middle = sample[len(sample) // 2 :][:_SAMPLE] or sample[:_SAMPLE]
    delimiters = [stated.delimiter] if stated.delimiter else ["\t", ";", ",", "|", " "]
    decimals: list[Decimal] = [stated.decimal] if stated.decimal else [".", ","]
    best = Layout(delimiters[0], decimals[0])
    score = (0, 0)
    for delimiter in delimiters:
        for decimal in decimals:
            if delimiter == decimal and not any('"' in line for line in middle):
                continue
            counts = [_numeric(line, delimiter, decimal) for line in middle]
            whole = sum(count > 0 for count in counts)
            reached = (whole, max(counts, default=0))
            if delimiter == " " and reached[1] < 2:
                continue
            if reached > score:
                best, score = Layout(delimiter, decimal), reached
    if stated.decimal is None and best.delimiter is not None:
        _refuse_two_decimal_signs(middle, best.delimiter, field)
    return best


def _refuse_two_decimal_signs(lines: list[str], delimiter: str, field: str) -> None:
    cells = [cell for line in lines for cell in _split(line, delimiter)]
    both = next((cell for cell in cells if re.fullmatch(r"[+-]?\d{1,3}([.,]\d{3})+[.,]\d+", cell)), None)
    comma = next((cell for cell in cells if re.fullmatch(r"[+-]?\d+,\d+([eE][+-]?\d+)?", cell)), None)
    point = next((cell for cell in cells if re.fullmatch(r"[+-]?\d+\.\d+([eE][+-]?\d+)?", cell)), None)
    if both or (comma and point):
        refused = both or f"{comma} and {point}"
        action = "Export the numbers without separators of thousands."
        raise refuse(field, refused, "one decimal sign, a point or a comma", action)


def _block(lines: list[str], layout: Layout) -> _Block | None:
    """The longest block of lines with equally many numbers."""
    delimiter, decimal = str(layout.delimiter), str(layout.decimal)
    best = _Block(0, 0)
    length = 0
    first = 0
    count = 0
    run = 0
    for index, line in enumerate(lines[: 2 * _PREAMBLE]):
        if not line.strip() or _is_comment(line):
            continue
        here = _numeric(line, delimiter, decimal)
        if here and here == count:
            run += 1
        else:
            first, count, run = index, here, 1 if here else 0
        if run > length:
            best, length = _Block(first, count), run
    return best if length else None


def _no_numbers(lines: list[str], field: str, purpose: Purpose) -> ParameterError:
    first = next(line for line in lines if line.strip())
    return refuse(
        field,
        shown(first),
        f"a line of headings such as '{purpose.example}', then lines of numbers",
        "Export a table with one column for each quantity.",
    )


def _headings(lines: list[str], layout: Layout, block: _Block, field: str, purpose: Purpose) -> _Headings:
    """Headings before the block of numbers."""
    delimiter = str(layout.delimiter)
    above = [
        (index, cells)
        for index in range(block.first - 1, max(block.first - 50, -1), -1)
        if lines[index].strip() and not _is_comment(lines[index])
        if (cells := _trimmed(_split(lines[index], delimiter), block.cells))
    ]
    if above and len(above) > 1 and _units_row(above[0][1]) and not _units_row(above[1][1]):
        return _Headings(above[1][1], [_bare(cell) for cell in above[0][1]], above[1][0])
    if len(above) == 1 or (above and not _units_row(above[0][1])):
        return _Headings(above[0][1], None, above[0][0])
    for index in range(block.first - 1, max(block.first - 50, -1), -1):
        if _is_comment(lines[index]):
            text = lines[index].lstrip(" \t#%!/")
            cells = _trimmed(_split(text, delimiter), block.cells) or _trimmed(_split(text, " "), block.cells)
            if cells and any(purpose.has_meaning(cell) for cell in cells):
                return _Headings(cells, None, index)
    others = [line for line in lines[: block.first] if line.strip() and not _is_comment(line)]
    if others:
        count = len(_split(others[-1], delimiter))
        raise refuse(
            field, f"{block.cells} columns of numbers, {count} headings", "one heading for each column",
            "Give one heading for each column; put headings with commas in quotes.",
        )  # fmt: skip
    raise refuse(
        field, "no headings", "a first line that names the columns",
        f"Write a line such as '{purpose.example}' before the numbers.",
    )  # fmt: skip


def _trimmed(cells: list[str], count: int) -> list[str]:
    """Cells of a line of headings: as many as numbers, or more where columns of texts follow; else none."""
    while len(cells) > count and not cells[-1]:
        cells = cells[:-1]
    return cells if len(cells) == count or (len(cells) == count + 1 and _is_note(cells[-1])) else []


def _is_note(heading: str) -> bool:
    """Whether a column holds texts: LabVIEW adds the column "Comment"."""
    return heading.strip().lower() in ("comment", "comments", "kommentar", "remark", "note")


def _bare(cell: str) -> str:
    """A unit without its brackets."""
    return cell.strip().strip("[](){}<>").strip() or "-"


def _units_row(cells: Sequence[str]) -> bool:
    """Whether the cells of a line are units, at least one of them more than a sign of no unit."""
    stated = [cell for cell in cells if cell.strip()]
    units = [cell for cell in stated if is_unit(_bare(cell))]
    names = sum(understood(cell) is not None for cell in stated)
    return bool(stated) and len(units) == len(stated) and names < len(stated)


def _cells(body: str, layout: Layout, count: int, field: str) -> pd.DataFrame:
    """Read the numbers. A column with anything but numbers stays a column of texts."""
    import pandas as pd

    separator = r"\s+" if layout.delimiter == " " else str(layout.delimiter)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)  # lines longer than the headings
            return pd.read_csv(
                io.StringIO(body), sep=separator, decimal=str(layout.decimal), header=None,
                skipinitialspace=True, index_col=False, low_memory=False, keep_default_na=False,
                quotechar="'" if "'" in body[:2000] and '"' not in body[:2000] else '"', comment="#",
            )  # fmt: skip
    except (ValueError, OverflowError, pd.errors.ParserWarning) as error:
        allowed = f"{count} cells in every line, as there are headings"
        raise refuse(field, "a line", allowed, f"{shown(str(error).strip())}.") from None


def _columns(cells: pd.DataFrame, headings: _Headings, layout: Layout, field: str) -> tuple[Column, ...]:
    """Columns with numbers; a column without any number or without a heading is left out."""
    columns = []
    for place, heading in enumerate(headings.names):
        if place >= cells.shape[1] or _is_note(heading):
            continue
        texts = cells.iloc[:, place]
        if texts.dtype.kind not in "iuf" and not texts.astype(str).str.strip().any():
            continue
        unit = headings.units[place] if headings.units and place < len(headings.units) else None
        columns.append(_column(texts, heading, unit, str(layout.decimal), field))
    return tuple(columns)


def _column(texts: pd.Series[Any], heading: str, unit: str | None, decimal: str, field: str) -> Column:
    """Column of the numbers of cells."""
    values = _numbers(texts, decimal)
    bad = np.flatnonzero(~np.isfinite(values))
    if not bad.size:
        return Column(heading, values, unit)
    cell = str(texts.iloc[int(bad[0])]).strip()
    damage = refuse(
        field,
        f"{shown(cell) or 'an empty cell'} in row {bad[0] + 1} after the headings, column {shown(heading)}",
        "a finite number in every cell of a column",
        "Remove or repair the row; gaps are not filled.",
    )
    return Column(heading, values, unit, damage=damage)


def _numbers(texts: pd.Series[Any], decimal: str) -> FloatArray:
    """Numbers of cells; NaN for a cell without a number."""
    import pandas as pd

    if texts.dtype.kind in "iuf":
        return np.asarray(texts.to_numpy(dtype=np.float64))
    plain = texts.astype(str).str.strip().str.replace(decimal, ".", regex=False)
    plain = plain.str.replace("[dD](?=[+-]?\\d)", "e", regex=True)
    plain = plain.where(~plain.str.contains("[xX_]", regex=True))  # hexadecimal numbers, digits in groups
    return np.asarray(pd.to_numeric(plain, errors="coerce").to_numpy(dtype=np.float64))
