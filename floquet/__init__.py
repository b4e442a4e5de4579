"""Floquet theory for any linear system with periodic coefficients, and its application to the gear pair."""

from floquet.chart import chart, load_chart, save_chart, scan
from floquet.gear_axes import GEAR_AXES
from floquet.gear_pair import (
    GearPairMultipliers,
    gear_pair_multipliers,
    gear_pair_system,
    stability_chart,
)
from floquet.monodromy import Monodromy, monodromy
from floquet.propagators import PROPAGATORS, Propagator
from floquet.spectrum import Spectrum
from floquet.system import PeriodicSystem

__all__ = [
    "GEAR_AXES",
    "PROPAGATORS",
    "GearPairMultipliers",
    "Monodromy",
    "PeriodicSystem",
    "Propagator",
    "Spectrum",
    "chart",
    "gear_pair_multipliers",
    "gear_pair_system",
    "load_chart",
    "monodromy",
    "save_chart",
    "scan",
    "stability_chart",
]
