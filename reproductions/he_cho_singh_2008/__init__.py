"""Reproduction of the paper: figures 2 to 7, claims with verdicts, errata by computation.

Names are imported on first use; ``__init__.pyi`` lists them with their homes.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
