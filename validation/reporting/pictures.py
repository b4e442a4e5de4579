"""Pictures of a page: files of their own, and data URIs for the page."""

from __future__ import annotations

import base64
from collections.abc import Callable, Sequence
from pathlib import Path

from validation.reporting.blocks import Picture


def draw_pictures(
    pictures: Sequence[Picture], folder: Path, tell: Callable[[float], None] | None = None
) -> dict[str, str]:
    """Draw pictures into a folder. Returns key of a picture -> data URI of its file.

    ``tell`` is told the done share before each picture.
    """
    from validation.plots.style import save

    folder.mkdir(exist_ok=True)
    images = {}
    for count, picture in enumerate(pictures):
        if tell is not None:
            tell(count / len(pictures))
        path = folder / f"{picture.key}.svg"
        save(picture.figure(), path, new=True)
        images[picture.key] = "data:image/svg+xml;base64," + base64.b64encode(path.read_bytes()).decode()
    return images
