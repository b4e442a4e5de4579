"""Pictures of the gallery: what an example saves is shown on its page instead."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

_saved: list[Figure] = []
_savefig = Figure.savefig


def _keep(self: Figure, *args: Any, **kwargs: Any) -> None:
    _saved.append(self)


def catch_saved_figures(gallery_conf: dict[str, Any], fname: str | Path) -> None:
    """Called before each example: its figures are kept, not written beside it."""
    _saved.clear()
    Figure.savefig = _keep  # type: ignore[method-assign, assignment]


def scraper(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Write the kept figures to the gallery's image folder."""
    paths = []
    while _saved:
        paths.append(next(block_vars["image_path_iterator"]))
        _savefig(_saved.pop(0), paths[-1], dpi=120)
    Figure.savefig = _savefig  # type: ignore[method-assign]
    return str(figure_rst(paths, gallery_conf["src_dir"]))
