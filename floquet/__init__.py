"""Floquet theory for any linear system with periodic coefficients, and its application to the gear pair.

Names are imported on first use; ``__init__.pyi`` lists them with their homes.
``floquet/proven.py`` says what is proven, and which function proves it.
"""

from lumped.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
