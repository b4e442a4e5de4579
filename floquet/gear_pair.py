"""The gear pair in Floquet theory: where the engine, which knows no gears, meets the lumped model."""

from floquet.gear_axes import GEAR_AXES, GearVariation
from floquet.gear_block import gear_block
from floquet.gear_chart import stability_chart
from floquet.gear_multipliers import (
    GearPairMultipliers,
    gear_pair_multipliers,
    gear_pair_system,
    mean_mesh_stiffness,
)

__all__ = [
    "GEAR_AXES",
    "GearPairMultipliers",
    "GearVariation",
    "gear_block",
    "gear_pair_multipliers",
    "gear_pair_system",
    "mean_mesh_stiffness",
    "stability_chart",
]
