"""Exchange with the tools that gear engineers own: REXS in and out, results and linear models out.

Names are imported on first use, so that the command line answers at once.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from validation.exchange.commented_toml import parameter_text
    from validation.exchange.linear_model import scipy_state_space, write_state_space
    from validation.exchange.results import read_netcdf, write_results
    from validation.exchange.rexs.exporting import write_rexs
    from validation.exchange.rexs.importing import gear_pair_from_rexs
    from validation.exchange.rexs.stages import Stage, rexs_stages

_HOMES = {
    "Stage": "validation.exchange.rexs.stages",
    "gear_pair_from_rexs": "validation.exchange.rexs.importing",
    "parameter_text": "validation.exchange.commented_toml",
    "read_netcdf": "validation.exchange.results",
    "rexs_stages": "validation.exchange.rexs.stages",
    "scipy_state_space": "validation.exchange.linear_model",
    "write_results": "validation.exchange.results",
    "write_rexs": "validation.exchange.rexs.exporting",
    "write_state_space": "validation.exchange.linear_model",
}

__all__ = [
    "Stage",
    "gear_pair_from_rexs",
    "parameter_text",
    "read_netcdf",
    "rexs_stages",
    "scipy_state_space",
    "write_results",
    "write_rexs",
    "write_state_space",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'validation.exchange' has no attribute {name!r}")
    return getattr(importlib.import_module(_HOMES[name]), name)
