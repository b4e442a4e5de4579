"""Floquet theory for any linear system with periodic coefficients, and its application to the gear pair."""

from floquet.chart import chart, load_chart, save_chart, scan
from floquet.fast import FastMonodromy, FastMultipliers, fast_monodromies, fast_multipliers
from floquet.fast_steady import FastPeriodicMotion, fast_periodic_motions
from floquet.forced import PeriodicMotion, periodic_motion
from floquet.gear_boundaries import predicted_lines, stability_boundaries
from floquet.gear_pair import (
    GEAR_AXES,
    GearPairMultipliers,
    gear_block,
    gear_pair_multipliers,
    gear_pair_system,
    stability_chart,
)
from floquet.modes import FloquetModes, floquet_modes
from floquet.monodromy import Monodromy, monodromy
from floquet.propagators import PROPAGATORS, Propagator
from floquet.rank_one import Gains, ModalForm, RankOneSystem
from floquet.spectrum import Spectrum
from floquet.system import PeriodicSystem
from floquet.tongues import Tongue

__all__ = [
    "GEAR_AXES",
    "PROPAGATORS",
    "FastMonodromy",
    "FastMultipliers",
    "FastPeriodicMotion",
    "FloquetModes",
    "Gains",
    "GearPairMultipliers",
    "ModalForm",
    "Monodromy",
    "PeriodicMotion",
    "PeriodicSystem",
    "Propagator",
    "RankOneSystem",
    "Spectrum",
    "Tongue",
    "chart",
    "fast_monodromies",
    "fast_multipliers",
    "fast_periodic_motions",
    "floquet_modes",
    "gear_block",
    "gear_pair_multipliers",
    "gear_pair_system",
    "load_chart",
    "monodromy",
    "periodic_motion",
    "predicted_lines",
    "save_chart",
    "scan",
    "stability_boundaries",
    "stability_chart",
]
