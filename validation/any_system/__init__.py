"""Periodic systems of anybody: matrices in files, functions in files of Python.

Names are imported on first use; ``__init__.pyi`` lists them.
"""

from lumped.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
