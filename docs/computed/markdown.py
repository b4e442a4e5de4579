"""Tables and numbers in Markdown."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence

from validation.files.formatting import number

_NAMES = "alpha|delta|epsilon|zeta|eta|theta|lambda|mu|xi|pi|rho|sigma|omega|Lambda|Phi|Omega"
_GREEK = re.compile(rf"(?<![\w`])(?:{_NAMES})(?![a-zA-Z0-9`])")

Cell = str | float | int | bool | None


class Code(str):
    """A cell that is shown as code."""


class CheckFailed(RuntimeError):
    """A number that the site is about to show is outside its limit."""


def text(cell: Cell) -> str:
    """A cell as one line in which nothing is markup by accident."""
    if isinstance(cell, bool):
        return "yes" if cell else "no"
    if isinstance(cell, float):
        return number(cell, 3)
    if cell is None:
        return "–"
    if isinstance(cell, Code):
        return f"`` {' '.join(cell.split())} ``".replace("|", "\\|")
    return " ".join(str(cell).split()).replace("|", "\\|").replace("*", "\\*").replace("<", "&lt;")


def table(columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> str:
    """A Markdown table."""
    lines = [columns, ["---"] * len(columns), *([text(c) for c in row] for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def greek(words: str) -> str:
    """Letters for the names of Greek letters, as in ``rho_r`` or ``2 pi``."""
    return _GREEK.sub(lambda match: unicodedata.lookup(_letter(match[0])), words)


def _letter(name: str) -> str:
    case = "CAPITAL" if name[0].isupper() else "SMALL"
    return f"GREEK {case} LETTER {'LAMDA' if name.lower() == 'lambda' else name.upper()}"


def must_pass(name: str, passes: bool) -> None:
    """Stop the build where a check fails.

    Raises
    ------
    CheckFailed : always, where ``passes`` is false
    """
    if not passes:
        raise CheckFailed(f"{name} fails; run the tests.")
