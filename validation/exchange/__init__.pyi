from .new_pair_file import new_pair as new_pair
from .new_pair_file import parameter_text as parameter_text
from .results import read_netcdf as read_netcdf
from .results import write_results as write_results
from .results import write_state_space as write_state_space
from .rexs.exporting import write_rexs as write_rexs
from .rexs.importing import gear_pair_from_rexs as gear_pair_from_rexs

__all__ = [
    "gear_pair_from_rexs",
    "new_pair",
    "parameter_text",
    "read_netcdf",
    "write_results",
    "write_rexs",
    "write_state_space",
]
