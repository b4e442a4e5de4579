"""Compute the publication again: ``python -m reproductions.he_cho_singh_2008 [FOLDER]``.

Writes figures 2 to 7 (SVG; data as NetCDF and CSV), ``claims.json``, ``errata.json`` and pictures (PNG).
"""

from __future__ import annotations

import json
import sys
import warnings
from dataclasses import asdict
from pathlib import Path
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from lumped import LawRangeWarning, load_gear_pair
from reproductions.he_cho_singh_2008 import (
    DRAW,
    claims,
    draw_errata,
    errata_chapter,
    figure_records,
    law_runs,
)
from validation.plots.style import save

#: Samples of the Latin hypercube over what the paper does not give.
SAMPLES = 100


def main(folder: Path, samples: int = SAMPLES) -> None:
    """Write everything into a folder, which may exist."""
    folder.mkdir(parents=True, exist_ok=True)
    pair = load_gear_pair("nasa_28_28").with_({"mesh.contact": "prescribed"})
    with warnings.catch_warnings():
        # The paper takes laws to its operating points whether they suit them or not.
        warnings.simplefilter("ignore", LawRangeWarning)
        runs = law_runs(pair)
        for record in figure_records(pair, runs=runs):
            _draw(DRAW[record.number](record), folder, f"figure{record.number}")
            record.write(folder / "data")
            print(f"figure {record.number}: {record.title}")
        errata = errata_chapter(pair)
        _draw(draw_errata(errata), folder, "errata")
        table = claims(pair, samples=samples, runs=runs)
    for name, content in (("claims", asdict(table)), ("errata", asdict(errata))):
        (folder / f"{name}.json").write_text(
            json.dumps(content, indent=1, default=_plain) + "\n", encoding="utf-8"
        )
    print(f"{sum(c.verdict == 'reproduced' for c in table.claims)} of {len(table.claims)} claims reproduced")
    print(f"{len(errata.errata)} errata shown: {folder}")


def _draw(figure: Figure, folder: Path, name: str) -> None:
    """As SVG, and small as PNG for the page."""
    save(figure, folder / f"{name}.svg")
    (folder / "pictures").mkdir(exist_ok=True)
    figure.savefig(folder / "pictures" / f"{name}.png", dpi=72, metadata={"Software": None})


def _plain(value: Any) -> Any:
    return value.to_dict() if isinstance(value, xr.Dataset) else dict(value)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "build/reproductions/he_cho_singh_2008"))
