"""Pictures of the gallery: what an example saves is shown on its page instead."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from sphinx.application import Sphinx
from sphinx_gallery import gen_gallery
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


def no_sections(*args: Any, **kwargs: Any) -> list[str]:
    """Folders inside ``examples`` are no sections of the gallery, though each has a README.md."""
    return []


def setup(app: Sphinx) -> dict[str, Any]:
    """Leave folders inside ``examples`` out of the gallery."""
    gen_gallery.get_subsections = no_sections
    return {"parallel_read_safe": True, "parallel_write_safe": True}
