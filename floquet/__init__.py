"""Floquet theory for any linear system with periodic coefficients, and its application to the gear pair.

What the compiled kernels and the gear pair need is imported when it is first asked for.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

# Names that modules have as well must be here from the start: the import of a module takes its place.
from floquet.engine.chart import chart, load_chart, save_chart, scan
from floquet.engine.monodromy import Monodromy, monodromy
from floquet.engine.propagators import PROPAGATORS, Propagator
from floquet.engine.spectrum import Spectrum
from floquet.engine.system import PeriodicSystem
from floquet.gear.block import gear_block

if TYPE_CHECKING:
    from floquet.engine.forced import PeriodicMotion, periodic_motion
    from floquet.engine.modes import FloquetModes, floquet_modes
    from floquet.engine.tongues import Tongue
    from floquet.gear.axes import GEAR_AXES
    from floquet.gear.boundaries import predicted_lines, stability_boundaries
    from floquet.gear.campbell import campbell
    from floquet.gear.chart import stability_chart
    from floquet.gear.coverage import boundary_coverage
    from floquet.gear.friction_effect import friction_effect
    from floquet.gear.multipliers import GearPairMultipliers, gear_pair_multipliers, gear_pair_system
    from floquet.gear.paths import multiplier_paths
    from floquet.gear.reference import extended_monodromy, stress_test
    from floquet.gear.sensitivities import gear_sensitivities
    from floquet.gear.tongues import critical_damping, label_regions
    from floquet.gear.vaishya_singh import CoulombGearPair, stability_zones
    from floquet.rank_one.batch import FastMonodromy, FastMultipliers, fast_monodromies, fast_multipliers
    from floquet.rank_one.batch_steady import FastPeriodicMotion, fast_periodic_motions
    from floquet.rank_one.coarsening import coarsened
    from floquet.rank_one.system import Gains, ModalForm, RankOneSystem

_LATER = {
    "rank_one.coarsening": ["coarsened"],
    "rank_one.batch": ["FastMonodromy", "FastMultipliers", "fast_monodromies", "fast_multipliers"],
    "rank_one.batch_steady": ["FastPeriodicMotion", "fast_periodic_motions"],
    "engine.forced": ["PeriodicMotion", "periodic_motion"],
    "gear.axes": ["GEAR_AXES"],
    "gear.boundaries": ["predicted_lines", "stability_boundaries"],
    "gear.campbell": ["campbell"],
    "gear.paths": ["multiplier_paths"],
    "gear.chart": ["stability_chart"],
    "gear.coverage": ["boundary_coverage"],
    "gear.friction_effect": ["friction_effect"],
    "gear.multipliers": ["GearPairMultipliers", "gear_pair_multipliers", "gear_pair_system"],
    "gear.reference": ["extended_monodromy", "stress_test"],
    "gear.sensitivities": ["gear_sensitivities"],
    "gear.tongues": ["critical_damping", "label_regions"],
    "engine.modes": ["FloquetModes", "floquet_modes"],
    "rank_one.system": ["Gains", "ModalForm", "RankOneSystem"],
    "engine.tongues": ["Tongue"],
    "gear.vaishya_singh": ["CoulombGearPair", "stability_zones"],
}
_MODULES = {name: module for module, names in _LATER.items() for name in names}

__all__ = [
    "GEAR_AXES",
    "PROPAGATORS",
    "CoulombGearPair",
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
    "boundary_coverage",
    "campbell",
    "chart",
    "coarsened",
    "critical_damping",
    "extended_monodromy",
    "fast_monodromies",
    "fast_multipliers",
    "fast_periodic_motions",
    "floquet_modes",
    "friction_effect",
    "gear_block",
    "gear_pair_multipliers",
    "gear_pair_system",
    "gear_sensitivities",
    "label_regions",
    "load_chart",
    "monodromy",
    "multiplier_paths",
    "periodic_motion",
    "predicted_lines",
    "save_chart",
    "scan",
    "stability_boundaries",
    "stability_chart",
    "stability_zones",
    "stress_test",
]


def __getattr__(name: str) -> object:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value: object = getattr(import_module(f"floquet.{_MODULES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
