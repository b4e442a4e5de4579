"""The resonance nearest to the operating speed: a mesh order meets a natural frequency.

The linear motion judges the speeds, on the supports and with the mean stiffness of the prediction. The
dynamic factor at the resonance is that of the prediction at this speed.

Sources: docs/theory/validity.md, "Resonances".
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from lumped.errors import NumericalError
from lumped.model.averaged import Mode, modes
from lumped.model.periodic_system import Supports
from lumped.model.steady import solutions_over_speed
from lumped.model.sweep import systems_over_speed
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.prediction.motion import ORDERS, mesh_orders, predicted

#: The operating speed is on a resonance where the distance is less than this share of the speed.
NEAR = 0.05
#: A force counts where its amplitude is at least this share of the static mesh force ...
_MATTERS = 0.05
#: ... and ``_AMPLIFIED`` times the mean amplitude at the speeds that are this share below and above.
_BESIDE = 0.1
_AMPLIFIED = 1.2
#: Crossings that are judged, the nearest first.
_MOST = 24
#: Times in a mesh cycle of a motion.
_TIMES = 128
#: Distances from the operating speed at which the force may be half, over the operating speed.
_LEAVING = 0.025 * np.arange(1, 13)
#: A speed is off the resonance where at most this share of the amplified force remains, rms.
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
    speed_rpm : pinion speed at which order and frequency meet [rpm]
    apart : frequency of the order at the operating speed over the natural frequency, less 1
    dynamic_factor : dynamic factor of the prediction at ``speed_rpm``; NaN: there is no prediction
    place : the most amplified force: "mesh force", "force on the pinion bearings" or "... gear bearings"
    force : amplitude of this force at the order, in the linear motion at ``speed_rpm`` [N]
    below_rpm, above_rpm : nearest speeds below and above the operating speed at which the force is at most
        half as large as at ``speed_rpm``, root mean square about the mean [rpm]. NaN: there is none within
        30 %, or the operating speed is not on the resonance
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

    Mesh orders are 1 to 10. A crossing of an order and a natural frequency counts where the force of the
    order, at the teeth or on a bearing, is amplified and is at least 5 % of the static mesh force.

    ``speeds_rpm``: searched range [rpm]. None: no crossing in the range counts, or a mode is overdamped.
    """
    supports: Supports = "springs" if pair.shafts is None else "shafts"
    try:
        pair_modes = modes(pair, supports)
    except NumericalError:
        return None
    operating_rpm = pair.operating.pinion_speed * 30.0 / math.pi
    low_rpm, high_rpm = speeds_rpm
    crossings = [
        _Crossing(mode.resonant_speed / order, order, mode)
        for mode in pair_modes
        for order in range(1, ORDERS + 1)
    ]
    inside = [crossing for crossing in crossings if low_rpm <= crossing.speed_rpm <= high_rpm]
    inside.sort(key=lambda crossing: abs(math.log(crossing.speed_rpm / operating_rpm)))
    for crossing in inside[:_MOST]:
        amplified = _amplified(pair, crossing, supports)
        if amplified is not None:
            return _resonance(pair, crossing, amplified)
    return None


class _Crossing(NamedTuple):
    """A mesh order meets the frequency of a mode at a pinion speed [rpm]."""

    speed_rpm: float
    order: int
    mode: Mode


class _Amplified(NamedTuple):
    """The largest amplified force: its number in ``_PLACES`` and its amplitude [N]."""

    place: int
    amplitude: float


def _resonance(pair: GearPair, crossing: _Crossing, amplified: _Amplified) -> Resonance:
    """The resonance at a crossing, with the speeds off the resonance where the operating speed is on it."""
    operating_rpm = pair.operating.pinion_speed * 30.0 / math.pi
    try:
        factor = predicted(pair.at_speed(crossing.speed_rpm)).dynamic_factor
    except NumericalError:
        factor = math.nan
    apart = operating_rpm / crossing.speed_rpm - 1.0
    below_rpm = above_rpm = math.nan
    if abs(apart) <= NEAR:
        below_rpm, above_rpm = _speeds_off(pair, crossing.speed_rpm, amplified.place)
    return Resonance(
        order=crossing.order,
        mode=mode_name(crossing.mode),
        frequency=crossing.mode.natural_frequency,
        speed_rpm=crossing.speed_rpm,
        apart=apart,
        dynamic_factor=factor,
        place=_PLACES[amplified.place],
        force=amplified.amplitude,
        below_rpm=below_rpm,
        above_rpm=above_rpm,
    )


def mode_name(mode: Mode) -> str:
    """Return the name of a mode: the coordinate with the largest motion names the mode."""
    largest = max(mode.shape, key=lambda name: abs(mode.shape[name]))
    return _NAMES.get(largest, "mode of the shafts")


def _amplified(pair: GearPair, crossing: _Crossing, supports: Supports) -> _Amplified | None:
    """The largest force that counts at a crossing. None: no force counts."""
    speeds = crossing.speed_rpm * np.array([1.0 - _BESIDE, 1.0, 1.0 + _BESIDE])
    before, at_resonance, after = (
        np.full(len(_PLACES), np.nan) if motion is None else _amplitudes(motion)[:, crossing.order - 1]
        for motion in _linear_motions(pair, speeds, supports)
    )
    static = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    counts = (at_resonance >= _MATTERS * static) & (at_resonance >= _AMPLIFIED * 0.5 * (before + after))
    if not counts.any():
        return None
    place = int(np.argmax(np.where(counts, at_resonance, 0.0)))
    return _Amplified(place, float(at_resonance[place]))


def _speeds_off(pair: GearPair, speed: float, place: int) -> tuple[float, float]:
    """Nearest speeds below and above the operating speed that are off a resonance [rpm]; NaN: there is none.

    ``speed``: speed of the resonance [rpm]; ``place``: number of the amplified force in ``_PLACES``.
    """
    supports: Supports = "springs" if pair.shafts is None else "shafts"
    operating_rpm = pair.operating.pinion_speed * 30.0 / math.pi
    speeds = np.concatenate([[speed], operating_rpm * (1.0 - _LEAVING), operating_rpm * (1.0 + _LEAVING)])
    sizes = np.array(
        [
            np.nan
            if motion is None
            else np.hypot(*(np.std(direction) for direction in _forces(motion)[place]))
            for motion in _linear_motions(pair, speeds, supports)
        ]
    )
    below, above = sizes[1:].reshape(2, -1) <= _LEFT * sizes[0]
    below_rpm = operating_rpm * (1.0 - _LEAVING[int(np.argmax(below))]) if below.any() else math.nan
    above_rpm = operating_rpm * (1.0 + _LEAVING[int(np.argmax(above))]) if above.any() else math.nan
    return float(below_rpm), float(above_rpm)


def _linear_motions(
    pair: GearPair, speeds_rpm: FloatArray, supports: Supports
) -> Iterable[Mapping[str, FloatArray] | None]:
    """Linear motions over a mesh cycle at each speed. None: there is no motion at the speed."""
    pairs = [pair.at_speed(float(rpm)) for rpm in speeds_rpm]
    for solution in solutions_over_speed(systems_over_speed(pairs, supports, warn=False), _TIMES):
        yield None if solution is None else solution.values


def _forces(motion: Mapping[str, FloatArray]) -> FloatArray:
    """(place, direction, time) forces of ``_PLACES`` [N]; the second direction of the mesh force is 0."""
    mesh = motion["normal_load"].sum(axis=0)
    bearings = [[motion[f"bearing_force_{line}_{gear}"] for line in "xy"] for gear in "pg"]
    return np.array([[mesh, np.zeros_like(mesh)], *bearings])


def _amplitudes(motion: Mapping[str, FloatArray]) -> FloatArray:
    """(place, order) amplitudes of the forces at the mesh orders [N], both directions together."""
    return np.array([np.hypot(mesh_orders(along), mesh_orders(across)) for along, across in _forces(motion)])
