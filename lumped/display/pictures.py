"""The figure of a result. A package above this one draws it, by the function that it hands down.

No import points upwards: ``draw_with`` takes the function, and without a function results have no figure.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Callable
from typing import TYPE_CHECKING

from lumped.errors import refuse

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Width of the picture in a notebook [pixels], and its resolution [dots per inch].
_WIDTH = 430
_DOTS_PER_INCH = 110
_drawing: list[Callable[[object], Figure]] = []


def draw_with(draw: Callable[[object], Figure]) -> None:
    """Let a function draw the figures of results. The function refuses a result that has no figure."""
    _drawing[:] = [draw]


def figure_of(result: object) -> Figure:
    """Return the figure of a result.

    Raises
    ------
    ParameterError : the result has no figure, or no package that draws is imported
    """
    if not _drawing:
        raise refuse(
            "plot", type(result).__name__, "a result of import spurcheck", "Write import spurcheck first."
        )
    return _drawing[0](result)


def element_of(figure: Figure) -> str:
    """Return a figure as an element of HTML."""
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=_DOTS_PER_INCH)
    data = base64.b64encode(image.getvalue()).decode("ascii")
    size = f"flex:none;width:{_WIDTH}px"
    return f'<img alt="figure of the result" style="{size}" src="data:image/png;base64,{data}"/>'
