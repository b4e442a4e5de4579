from .function_files import FunctionFamily as FunctionFamily
from .function_files import read_family as read_family
from .matrix_files import read_matrices as read_matrices
from .models import FirstOrderModel as FirstOrderModel
from .models import SecondOrderModel as SecondOrderModel
from .spectrum import spectrum_dataset as spectrum_dataset

__all__ = [
    "FirstOrderModel",
    "FunctionFamily",
    "SecondOrderModel",
    "read_family",
    "read_matrices",
    "spectrum_dataset",
]
