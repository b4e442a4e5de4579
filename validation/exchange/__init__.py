"""Exchange with the tools that gear engineers own: REXS in and out, results and linear models out.

Names are imported on first use, so that the command line answers at once; ``__init__.pyi`` lists them.
"""

from lumped.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
