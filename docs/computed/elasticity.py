"""Picture and tables of the page on tooth stiffness from elasticity."""

from __future__ import annotations

import runpy
from collections.abc import Callable

from computed import DOCS
from computed.diagrams import svg
from computed.markdown import table
from lumped import load_gear_pair, preset_names
from tests.evidence.published_stiffness import framed, framed_pairs, published_stiffness


def thin_rims() -> str:
    """The example of the gallery."""
    example = runpy.run_path(str(DOCS.parent / "examples" / "18_thin_rims.py"))
    return svg(example["draw"](example["compute"]()))


def published() -> str:
    """Published stiffness beside ours."""
    columns = ("gears", "quantity", "published by", "unit", "published", "plane elasticity", "ratio")
    rows = (
        (r.gears, r.quantity, r.source, r.unit, f"{r.published:.2f}", f"{r.elastic:.2f}", f"{r.ratio:.3f}")
        for r in published_stiffness()
    )
    return table(columns, rows)


def frames() -> str:
    """Stiffness over ISO's in every frame."""
    pairs = [*(load_gear_pair(name) for name in preset_names()), *framed_pairs()]
    columns = (
        "gears",
        "deflections count from",
        "largest of a pair",
        "mean, pairs alone",
        "mean, neighbours",
    )
    rows = (
        (r.gears, r.frame, f"{r.largest:.3f}", f"{r.alone:.3f}", f"{r.mean:.3f}")
        for pair in pairs
        for r in framed(pair)
    )
    return table(columns, rows)


FILES: dict[str, Callable[[], str]] = {
    "thin_rims.svg": thin_rims,
    "published_stiffness.md": published,
    "stiffness_frames.md": frames,
}
