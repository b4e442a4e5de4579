"""Does the model deserve trust: cross-check, validity, verification report, and the command ``spurcheck``.

Names are imported on first use, so that ``spurcheck --help`` answers at once; ``__init__.pyi`` lists them.
A result draws its figure in a notebook by the function that this package hands down to ``lumped``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import lazy_loader

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def _drawn(result: object) -> Figure:
    from validation.plots.of_result import plot  # matplotlib and all models, for a result that exists

    return plot(result)


def _hand_down() -> None:
    from lumped.display import pictures

    pictures.draw_with(_drawn)


_hand_down()
