"""The verification report: results computed once, chapters of blocks, one HTML page and one JSON file."""

from validation.reporting.build import Report, report

__all__ = ["Report", "report"]
