"""Does the model deserve trust: cross-check, validity, verification report, and the command ``spurcheck``.

Names are imported on first use, so that ``spurcheck --help`` answers at once; ``__init__.pyi`` lists them.
"""

from __future__ import annotations

from lumped.public_names import public_names

_of_stub, __dir__, __all__ = public_names(__name__, __file__)


def __getattr__(name: str) -> object:
    value = _of_stub(name)
    if name in __all__:
        from validation.plots import hand_down

        hand_down()  # results draw themselves from now on
    return value
