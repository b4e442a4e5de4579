"""Which teeth meet, and after how many mesh cycles the same teeth meet again.

Pair n is at the start of contact A at t = n T_m. Its teeth are (a_p + n) mod z1 and (a_g + n) mod z2. The
errors of the teeth are in ``lumped.schema.tooth_errors``.

Sources: docs/theory/teeth.md, "Numbering and sign".
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from lumped.labelling import labelled_dataset, provenance
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.schema.tooth_errors import tooth_errors
from lumped.typing import IntArray

if TYPE_CHECKING:
    import xarray as xr


def first_teeth(pair: GearPair) -> tuple[int, int]:
    """Tooth of the pinion and tooth of the gear that are at A at t = 0, counted from 0."""
    pinion, gear = pair.mesh.first_teeth or (1, 1)
    return pinion - 1, gear - 1


def period_of(pair: GearPair) -> int:
    """Mesh cycles until every force repeats, see ``revolution``."""
    rippled = {ripple.shaft for ripple in pair.operating.torque_ripple}
    turns = [
        gear.teeth
        for name, gear in (("pinion", pair.pinion), ("gear", pair.gear))
        if gear.has_own_teeth or name in rippled
    ]
    return math.lcm(*turns)


def revolution(pair: AnyPair) -> int:
    """Mesh cycles after which a pair of gears repeats: docs/theory/teeth.md, "Numbering and sign".

    1 for like teeth. The number of teeth of a gear, if the teeth of this gear differ, the gear is eccentric,
    or the torque of its shaft has a ripple. The least common multiple of both numbers (the hunting period),
    if this is true for both gears.

    Parameters
    ----------
    pair : a validated gear pair
    """
    return period_of(load_gear_pair(pair))


def meeting_teeth(pair: AnyPair, cycles: int | None = None) -> xr.Dataset:
    """Teeth of the pairs in the order of the first contact at A: docs/theory/teeth.md, "Numbering and sign".

    Parameters
    ----------
    pair : a validated gear pair
    cycles : number of pairs; default the whole period, of ``revolution``

    Returns
    -------
    xarray.Dataset over ``meshing`` (the pair is at A after so many mesh cycles): ``pinion_tooth``,
    ``gear_tooth``, counted from 1
    """
    pair = load_gear_pair(pair)
    numbers = np.arange(period_of(pair) if cycles is None else cycles)
    pinion, gear = teeth_of_pairs(pair, numbers)
    return labelled_dataset(
        {
            "pinion_tooth": ("meshing", pinion + 1, "1", "tooth of the pinion"),
            "gear_tooth": ("meshing", gear + 1, "1", "tooth of the gear"),
        },
        {"meshing": (numbers, "1", "mesh cycles until the pair is at A")},
        _provenance(pair),
    )


def _provenance(pair: GearPair) -> dict[str, Any]:
    """Attributes of a result about the teeth of the file."""
    return provenance(pair) | {"teeth": "alike" if pair.healthy is pair else "as given"}


def teeth_of_pairs(pair: GearPair, numbers: IntArray) -> tuple[IntArray, IntArray]:
    """Teeth of the pinion and of the gear of tooth pairs, counted from 0.

    Parameters
    ----------
    pair : the gear pair
    numbers : (n,) of the tooth pairs: pair n is at A after n mesh cycles
    """
    first_pinion, first_gear = first_teeth(pair)
    return (first_pinion + numbers) % pair.pinion.teeth, (first_gear + numbers) % pair.gear.teeth


def tooth_gaps(pair: AnyPair) -> xr.Dataset:
    """Errors of the teeth along the line of action: docs/theory/teeth.md, "Numbering and sign".

    Parameters
    ----------
    pair : a validated gear pair

    Returns
    -------
    xarray.Dataset over ``pinion_tooth`` and ``gear_tooth``, counted from 1: ``pinion_error`` and
    ``gear_error``, without what turns as an eccentricity, and their sum ``gap`` over both, positive where
    the pair comes too late [m]; the attributes carry ``pinion_eccentricity``, ``gear_eccentricity`` [m],
    their phases [rad], and ``period``, mesh cycles until the same teeth meet again
    """
    pair = load_gear_pair(pair)
    pinion, gear = tooth_errors(pair)
    attributes = _provenance(pair) | {"period": period_of(pair)}
    for name, errors in (("pinion", pinion), ("gear", gear)):
        attributes |= {f"{name}_eccentricity": errors.eccentricity, f"{name}_phase": errors.phase}
    return labelled_dataset(
        {
            "pinion_error": ("pinion_tooth", pinion.error, "m", "error of a tooth of the pinion"),
            "gear_error": ("gear_tooth", gear.error, "m", "error of a tooth of the gear"),
            "gap": (
                ("pinion_tooth", "gear_tooth"),
                pinion.error[:, None] + gear.error,
                "m",
                "gap of a pair by the errors of its teeth",
            ),
        },
        {
            "pinion_tooth": (np.arange(pinion.error.size) + 1, "1", "tooth of the pinion"),
            "gear_tooth": (np.arange(gear.error.size) + 1, "1", "tooth of the gear"),
        },
        attributes,
    )
