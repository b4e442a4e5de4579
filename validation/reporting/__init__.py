"""The verification report: shared results, chapters of blocks, an HTML page and a JSON file.

Names are imported at their first use: a command without a report does not load chapters and figures.
"""

from lumped.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
