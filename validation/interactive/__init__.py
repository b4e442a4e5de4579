"""A page to hover, zoom and slice, without network: stability chart and response over speed."""

from validation.interactive.page import write_interactive_page

__all__ = ["write_interactive_page"]
