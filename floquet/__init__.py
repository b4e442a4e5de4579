"""Floquet theory for any linear system with periodic coefficients, and its application to the gear pair.

What the compiled kernels and the gear pair need is imported when it is first asked for.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

# Names that modules have as well must be here from the start: the import of a module takes its place.
from floquet.chart import chart, load_chart, save_chart, scan
from floquet.gear_block import gear_block
from floquet.monodromy import Monodromy, monodromy
from floquet.propagators import PROPAGATORS, Propagator
from floquet.spectrum import Spectrum
from floquet.system import PeriodicSystem

if TYPE_CHECKING:
    from floquet.coarsening import coarsened
    from floquet.fast import FastMonodromy, FastMultipliers, fast_monodromies, fast_multipliers
    from floquet.fast_steady import FastPeriodicMotion, fast_periodic_motions
    from floquet.forced import PeriodicMotion, periodic_motion
    from floquet.gear_axes import GEAR_AXES
    from floquet.gear_boundaries import predicted_lines, stability_boundaries
    from floquet.gear_campbell import campbell
    from floquet.gear_chart import stability_chart
    from floquet.gear_coverage import boundary_coverage
    from floquet.gear_friction_effect import friction_effect
    from floquet.gear_multipliers import GearPairMultipliers, gear_pair_multipliers, gear_pair_system
    from floquet.gear_paths import multiplier_paths
    from floquet.gear_reference import extended_monodromy, stress_test
    from floquet.gear_sensitivity import gear_sensitivities
    from floquet.gear_tongues import critical_damping, label_regions
    from floquet.modes import FloquetModes, floquet_modes
    from floquet.rank_one import Gains, ModalForm, RankOneSystem
    from floquet.tongues import Tongue
    from floquet.vaishya_singh import CoulombGearPair, stability_zones

_LATER = {
    "coarsening": ["coarsened"],
    "fast": ["FastMonodromy", "FastMultipliers", "fast_monodromies", "fast_multipliers"],
    "fast_steady": ["FastPeriodicMotion", "fast_periodic_motions"],
    "forced": ["PeriodicMotion", "periodic_motion"],
    "gear_axes": ["GEAR_AXES"],
    "gear_boundaries": ["predicted_lines", "stability_boundaries"],
    "gear_campbell": ["campbell"],
    "gear_paths": ["multiplier_paths"],
    "gear_chart": ["stability_chart"],
    "gear_coverage": ["boundary_coverage"],
    "gear_friction_effect": ["friction_effect"],
    "gear_multipliers": ["GearPairMultipliers", "gear_pair_multipliers", "gear_pair_system"],
    "gear_reference": ["extended_monodromy", "stress_test"],
    "gear_sensitivity": ["gear_sensitivities"],
    "gear_tongues": ["critical_damping", "label_regions"],
    "modes": ["FloquetModes", "floquet_modes"],
    "rank_one": ["Gains", "ModalForm", "RankOneSystem"],
    "tongues": ["Tongue"],
    "vaishya_singh": ["CoulombGearPair", "stability_zones"],
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
