"""Types that annotations of all packages share."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]


class Progress(Protocol):
    """Called by long work with the finished fraction and, where there are several stages, the present one."""

    def __call__(self, fraction: float, stage: str = "", /) -> None:
        """Take the finished fraction, 0 to 1, and the words for what is being done."""


#: Argument ``progress`` of public functions, see ``lumped.display.progress``.
ProgressRequest = Progress | bool | None


def unheard(fraction: float, stage: str = "", /) -> None:
    """A ``Progress`` for work of which nobody asks how far it is."""
