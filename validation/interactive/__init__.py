"""A page to hover, zoom and slice, without network: stability chart and response over speed."""

from validation.interactive.page import write_interactive_page
from validation.interactive.results import PageResults, compute

__all__ = ["PageResults", "compute", "write_interactive_page"]
