"""Does the model deserve trust: cross-check, validity, verification report, and the command ``spurcheck``.

Names are imported on first use, so that ``spurcheck --help`` answers at once.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from validation.cross_check.comparison import CrossCheck, crosscheck
    from validation.interactive import write_interactive_page
    from validation.reporting import Report, report
    from validation.validity.flag import Flag
    from validation.validity.flags import validity_flags

_HOMES = {
    "CrossCheck": "validation.cross_check.comparison",
    "crosscheck": "validation.cross_check.comparison",
    "Report": "validation.reporting",
    "report": "validation.reporting",
    "Flag": "validation.validity.flag",
    "validity_flags": "validation.validity.flags",
    "write_interactive_page": "validation.interactive",
}

__all__ = [
    "CrossCheck",
    "Flag",
    "Report",
    "crosscheck",
    "report",
    "validity_flags",
    "write_interactive_page",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'validation' has no attribute {name!r}")
    return getattr(importlib.import_module(_HOMES[name]), name)
