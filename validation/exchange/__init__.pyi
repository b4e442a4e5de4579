from .commented_toml import parameter_text as parameter_text
from .linear_model import scipy_state_space as scipy_state_space
from .linear_model import write_state_space as write_state_space
from .matrices import FILE_AXES as FILE_AXES
from .matrices import SecondOrderModel as SecondOrderModel
from .matrices import read_second_order as read_second_order
from .results import read_netcdf as read_netcdf
from .results import write_results as write_results
from .rexs.exporting import write_rexs as write_rexs
from .rexs.importing import gear_pair_from_rexs as gear_pair_from_rexs
from .rexs.stages import Stage as Stage
from .rexs.stages import rexs_stages as rexs_stages

__all__ = [
    "FILE_AXES",
    "SecondOrderModel",
    "Stage",
    "gear_pair_from_rexs",
    "parameter_text",
    "read_netcdf",
    "read_second_order",
    "rexs_stages",
    "scipy_state_space",
    "write_results",
    "write_rexs",
    "write_state_space",
]
