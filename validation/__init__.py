"""Does the model deserve trust: cross-check, validity, verification report, and the command ``spurcheck``.

Names are imported on first use, so that ``spurcheck --help`` answers at once; ``__init__.pyi`` lists them.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
