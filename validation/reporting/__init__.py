"""The verification report: results computed once, chapters of blocks, one HTML page and one JSON file.

Names are imported on first use: commands that only write a number in words do without chapters and figures.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
