"""The picture of the page on tooth stiffness from elasticity."""

from __future__ import annotations

import runpy
from collections.abc import Callable

from computed import DOCS
from computed.diagrams import svg


def stressed_teeth() -> str:
    """The example of the gallery."""
    example = runpy.run_path(str(DOCS.parent / "examples" / "18_stressed_teeth.py"))
    return svg(example["draw"](example["compute"]()))


FILES: dict[str, Callable[[], str]] = {"stressed_teeth.svg": stressed_teeth}
