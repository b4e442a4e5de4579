"""The verification report: shared results, chapters of blocks, an HTML page and a JSON file.

Names are imported at their first use: a command without a report does not load chapters and figures.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
