"""Which teeth meet, how long it takes until they meet again, and the errors that each brings to its pairs.

Pair n is at the start of contact A at t = n T_m. Its teeth are (a_p + n) mod z1 and (a_g + n) mod z2.

Sources: docs/theory/teeth.md, "Numbering and sign", "Eccentricity".
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from lumped.labelling import labelled_dataset, provenance
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.schema.teeth import Deviations
from lumped.schema.tolerances import drawn_index
from lumped.typing import FloatArray, IntArray

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class OwnTeeth:
    """Errors of the teeth of one gear, in order of engagement from tooth 1 on, SI.

    Attributes
    ----------
    index : (z,) index deviations as given or drawn, positive where the flank is further along the count [m]
    error : (z,) constant over the flank, positive where the teeth come too late [m]
    slope : (z,) profile slope deviations, material at the tip [m]
    relief : (z,) tip relief beyond the design's [m]
    eccentricity : amplitude of the error of the turning gear [m]
    phase : eps cos(rotation + phase), rotation counted from tooth 1 at A [rad]
    """

    index: FloatArray
    error: FloatArray
    slope: FloatArray
    relief: FloatArray
    eccentricity: float
    phase: float


def own_teeth(pair: GearPair) -> tuple[OwnTeeth, OwnTeeth]:
    """The errors of the pinion's and of the gear's teeth."""
    return _of_gear(pair, 0), _of_gear(pair, 1)


def _of_gear(pair: GearPair, which: int) -> OwnTeeth:
    gear = (pair.pinion, pair.gear)[which]
    z = (pair.pinion.teeth, pair.gear.teeth)[which]
    given = gear.deviations
    slope, relief = (_listed(given, name, z, 1.0) for name in ("profile_slope", "tip_relief"))
    phase = gear.mounting.phase if gear.mounting else 0.0
    error = np.zeros(z)
    index = np.zeros(z)
    eccentricity = gear.eccentricity
    if given is not None:
        index = _listed(given, "index", z, -1.0)
        if given.tolerance_class is not None:
            index = drawn_index(z, pair.basic_rack.module, given.tolerance_class, given.seed)
        # A flank further along the count is material missing of the pinion's, material in excess of the
        # gear's.
        error = (1.0 - 2.0 * which) * math.cos(pair.basic_rack.pressure_angle) * index
        if given.first_order == "eccentricity":
            turn = 2.0 * np.pi * np.arange(z) / z
            first = 2.0 / z * np.sum(error * np.exp(-1j * turn))
            error = error - (first * np.exp(1j * turn)).real
            # A tooth's index is that of its contact at the pitch point.
            g = pair.geometry
            radius = (g.base_radius_pinion, g.base_radius_gear)[which]
            eccentricity = abs(first)
            phase = float(np.angle(first)) - (g.L_XP - g.L_XA) / radius
    return OwnTeeth(index, error, slope, relief, float(eccentricity), float(phase))


def _listed(given: Deviations | None, name: str, teeth: int, mirrored: float) -> FloatArray:
    """A list in order of engagement; numbered against it, tooth 1 stays the first one."""
    values = getattr(given, name) if given is not None else None
    if values is None:
        return np.zeros(teeth)
    found = np.array(values, dtype=float)
    if given is not None and given.counted == "against":
        found = mirrored * found[-np.arange(teeth)]
    return found


def first_teeth(pair: GearPair) -> tuple[int, int]:
    """Teeth at A at t = 0, counted from 0."""
    pinion, gear = pair.mesh.first_teeth or (1, 1)
    return pinion - 1, gear - 1


def ripples(pair: GearPair) -> FloatArray:
    """Rows of shaft, angle a mesh cycle, phase at t = 0, amplitude and cycles a turn of each harmonic."""
    rows = []
    for one in pair.operating.torque_ripple:
        which = ("pinion", "gear").index(one.shaft)
        teeth = (pair.pinion.teeth, pair.gear.teeth)[which]
        angle = 2.0 * math.pi * one.order / teeth
        start = one.phase + angle * first_teeth(pair)[which]
        rows.append([which, angle, start, one.amplitude, teeth])
    return np.reshape(np.array(rows, dtype=float), (-1, 5))


def period_of(pair: GearPair) -> int:
    """Mesh cycles until every force repeats."""
    ripples = {one.shaft for one in pair.operating.torque_ripple}
    turns = [
        gear.teeth
        for name, gear in (("pinion", pair.pinion), ("gear", pair.gear))
        if gear.has_own_teeth or name in ripples
    ]
    return math.lcm(*turns)


def revolution(pair: AnyPair) -> int:
    """Mesh cycles after which a pair of gears repeats: docs/theory/teeth.md, "Numbering and sign".

    1 for like teeth, the number of teeth of the gear that alone has teeth that differ, is eccentric or
    carries a ripple of its torque, and the least common multiple, the hunting period, where both do.

    Parameters
    ----------
    pair : a validated gear pair
    """
    return period_of(load_gear_pair(pair))


def meeting_teeth(pair: AnyPair, cycles: int | None = None) -> xr.Dataset:
    """Teeth of the pairs in the order in which they come to A: docs/theory/teeth.md, "Numbering and sign".

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
    number = np.arange(period_of(pair) if cycles is None else cycles)
    pinion, gear = numbers(pair, number)
    return labelled_dataset(
        {
            "pinion_tooth": ("meshing", pinion + 1, "1", "tooth of the pinion"),
            "gear_tooth": ("meshing", gear + 1, "1", "tooth of the gear"),
        },
        {"meshing": (number, "1", "mesh cycles until the pair is at A")},
        _provenance(pair),
    )


def _provenance(pair: GearPair) -> dict[str, Any]:
    """Attributes of a result about the teeth as given."""
    return provenance(pair) | {"teeth": "alike" if pair.healthy is pair else "as given"}


def numbers(pair: GearPair, number: IntArray) -> tuple[IntArray, IntArray]:
    """Teeth of pairs of any numbers, counted from 0."""
    a_p, a_g = first_teeth(pair)
    return (a_p + number) % pair.pinion.teeth, (a_g + number) % pair.gear.teeth


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
    pinion, gear = own_teeth(pair)
    attributes = _provenance(pair) | {"period": period_of(pair)}
    for name, one in (("pinion", pinion), ("gear", gear)):
        attributes |= {f"{name}_eccentricity": one.eccentricity, f"{name}_phase": one.phase}
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
