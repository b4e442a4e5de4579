"""Exchange with the tools that gear engineers own: REXS in and out, results and linear models out.

Names are imported on first use, so that the command line answers at once; ``__init__.pyi`` lists them.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
