from .averages import difference as difference
from .averages import indicators as indicators
from .averages import residual as residual
from .averages import sidebands as sidebands
from .averages import time_synchronous_average as time_synchronous_average
from .orders import order_spectrum as order_spectrum
from .orders import waterfall as waterfall
from .records import synthetic_record as synthetic_record

__all__ = [
    "difference",
    "indicators",
    "order_spectrum",
    "residual",
    "sidebands",
    "synthetic_record",
    "time_synchronous_average",
    "waterfall",
]
