"""The resonance nearest to the operating speed: where a mesh order meets a natural frequency.

Speeds are judged by the linear motion, on the supports and with the mean stiffness of the prediction; the
dynamic factor at the resonance is that of the prediction there.

Sources: docs/theory/validity.md, "Resonances".
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from lumped.errors import NumericalError
from lumped.model.averaged import Mode, modes
from lumped.model.periodic_system import Supports
from lumped.model.steady import periodic_solution, sample_times
from lumped.model.sweep import systems_over_speed
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.prediction.motion import ORDERS, mesh_orders, predicted

#: The operating speed is on a resonance that is nearer than this share of it.
NEAR = 0.05
#: An order matters whose force is at least this share of the static mesh force, ...
_MATTERS = 0.05
#: ... and that is amplified: beside the resonance, by this share of the speed, it is smaller by this factor.
_BESIDE = 0.1
_AMPLIFIED = 1.2
#: Crossings that are judged, the nearest first, and times in a mesh cycle of a motion.
_MOST = 24
_TIMES = 128
#: Speeds at which a resonance may be left, over the operating speed.
_LEAVING = 0.025 * np.arange(1, 13)
#: A resonance is left where at most this share of the force that it amplifies remains, rms.
_LEFT = 0.5
#: Forces that a resonance can amplify.
_PLACES = ("mesh force", "force on the pinion bearings", "force on the gear bearings")
#: Largest coordinate of a mode's shape -> its name.
_NAMES = {
    "q": "mesh mode",
    "x_p": "mode of the pinion along the line of action",
    "x_g": "mode of the gear along the line of action",
    "y_p": "mode of the pinion off the line of action",
    "y_g": "mode of the gear off the line of action",
}


@dataclass(frozen=True)
class Resonance:
    """A mesh order that meets a natural frequency.

    Attributes
    ----------
    order : mesh order
    mode : name of the mode
    frequency : natural frequency of the pair with its mean mesh stiffness [Hz]
    speed_rpm : pinion speed at which they meet [rpm]
    apart : frequency of the order at the operating speed over the natural frequency, less 1
    dynamic_factor : of the prediction at ``speed_rpm``; NaN where it has none
    place : which force it amplifies most: "mesh force", "force on the pinion bearings" or "... gear bearings"
    force : amplitude of that force at the order, by the linear motion at ``speed_rpm`` [N]
    below_rpm, above_rpm : nearest speeds on either side of the operating speed at which the root mean square
        of that force about its mean is at most half of that at ``speed_rpm``, NaN where none was found within
        30 %, and where the operating speed is not on the resonance [rpm]
    """

    order: int
    mode: str
    frequency: float
    speed_rpm: float
    apart: float
    dynamic_factor: float
    place: str
    force: float
    below_rpm: float = math.nan
    above_rpm: float = math.nan

    @property
    def near(self) -> bool:
        """Whether the operating speed is on the resonance, within ``NEAR``."""
        return abs(self.apart) <= NEAR


def nearest_resonance(pair: GearPair, speeds_rpm: tuple[float, float]) -> Resonance | None:
    """Return the resonance nearest to the operating speed of a pair with like teeth.

    Mesh orders are 1 to 10. A crossing counts where the order's force at the teeth or on a bearing is at
    least 5 % of the static mesh force, and is amplified there.

    ``speeds_rpm``: range that is looked over [rpm]. None: no crossing in it counts, or a mode is overdamped.
    """
    supports: Supports = "springs" if pair.shafts is None else "shafts"
    try:
        found = modes(pair, supports)
    except NumericalError:
        return None
    own = pair.operating.pinion_speed * 30.0 / math.pi
    crossings = [(mode.resonant_speed / order, order, mode) for mode in found for order in _ORDERS]
    inside = [one for one in crossings if speeds_rpm[0] <= one[0] <= speeds_rpm[1]]
    inside.sort(key=lambda one: abs(math.log(one[0] / own)))
    for speed, order, mode in inside[:_MOST]:
        found_here = _amplified(pair, speed, order, supports)
        if found_here is not None:
            return _resonance(pair, speed, order, mode, found_here)
    return None


_ORDERS = range(1, ORDERS + 1)


def _resonance(
    pair: GearPair, speed: float, order: int, mode: Mode, amplified: tuple[int, float]
) -> Resonance:
    own = pair.operating.pinion_speed * 30.0 / math.pi
    place, force = amplified
    try:
        factor = predicted(pair.at_speed(speed)).dynamic_factor
    except NumericalError:
        factor = math.nan
    apart = own / speed - 1.0
    ends = _ways_out(pair, speed, place) if abs(apart) <= NEAR else (math.nan, math.nan)
    name = mode_name(mode)
    frequency = mode.natural_frequency
    return Resonance(order, name, frequency, speed, apart, factor, _PLACES[place], force, *ends)


def mode_name(mode: Mode) -> str:
    """Name of a mode by the coordinate that moves most."""
    largest = max(mode.shape, key=lambda name: abs(mode.shape[name]))
    return _NAMES.get(largest, "mode of the shafts")


def _amplified(pair: GearPair, speed: float, order: int, supports: Supports) -> tuple[int, float] | None:
    """Place in ``_PLACES`` and amplitude [N] of the largest force that counts at a speed; None: none does."""
    speeds = speed * np.array([1.0 - _BESIDE, 1.0, 1.0 + _BESIDE])
    before, there, after = (
        np.full(len(_PLACES), np.nan) if motion is None else _amplitudes(motion)[:, order - 1]
        for motion in _linear_motions(pair, speeds, supports)
    )
    static = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    counts = (there >= _MATTERS * static) & (there >= _AMPLIFIED * 0.5 * (before + after))
    if not counts.any():
        return None
    place = int(np.argmax(np.where(counts, there, 0.0)))
    return place, float(there[place])


def _ways_out(pair: GearPair, speed: float, place: int) -> tuple[float, float]:
    """Nearest speeds below and above the operating speed at which a resonance is left [rpm]."""
    supports: Supports = "springs" if pair.shafts is None else "shafts"
    own = pair.operating.pinion_speed * 30.0 / math.pi
    speeds = np.concatenate([[speed], own * (1.0 - _LEAVING), own * (1.0 + _LEAVING)])
    sizes = np.array(
        [
            np.nan if motion is None else np.hypot(*(np.std(one) for one in _forces(motion)[place]))
            for motion in _linear_motions(pair, speeds, supports)
        ]
    )
    left = sizes[1:].reshape(2, -1) <= _LEFT * sizes[0]
    found = [
        float(own * (1.0 + sign * _LEAVING[int(np.argmax(side))])) if side.any() else math.nan
        for sign, side in zip((-1.0, 1.0), left, strict=True)
    ]
    return found[0], found[1]


def _linear_motions(
    pair: GearPair, speeds_rpm: FloatArray, supports: Supports
) -> Iterable[Mapping[str, FloatArray] | None]:
    """Linear motions over a mesh cycle at speeds; None where there is none."""
    pairs = [pair.at_speed(float(rpm)) for rpm in speeds_rpm]
    for system in systems_over_speed(pairs, supports, warn=False):
        times = sample_times(system.period, _TIMES)
        try:
            yield periodic_solution(system, times, estimate_error=False).values
        except NumericalError:
            yield None


def _forces(motion: Mapping[str, FloatArray]) -> FloatArray:
    """(place, 2, times) both directions of the mesh force, which has one, and of the bearing forces [N]."""
    mesh = motion["normal_load"].sum(axis=0)
    bearings = [[motion[f"bearing_force_{line}_{gear}"] for line in "xy"] for gear in "pg"]
    return np.array([[mesh, np.zeros_like(mesh)], *bearings])


def _amplitudes(motion: Mapping[str, FloatArray]) -> FloatArray:
    """(place, order) amplitudes of the forces at the mesh orders [N], of both directions together."""
    return np.array([np.hypot(mesh_orders(along), mesh_orders(off)) for along, off in _forces(motion)])
