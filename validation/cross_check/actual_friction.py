"""The lumped model's friction law at the velocities and radii of a contact as finite motions leave it.

The law in force is that of the lumped model, sign included: what is predicted is by how much its coefficient
changes, as the ratio of the published law at the actual contact to the same law at the nominal one.

Sources: Abbas Al-Zubaidi 2008, eqs. 14, 18, 20 (docs/theory/friction.md).
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from lumped import GearPair
from lumped.errors import NumericalError
from lumped.friction import (
    LAWS,
    ContactPath,
    FrictionSettings,
    benedict_kelley,
)
from lumped.friction.base import PITCH_RESOLUTION
from lumped.friction.benedict_kelley import average_coefficient
from lumped.lubrication.film import regime
from lumped.path_of_contact.friction import contact_path
from lumped.typing import FloatArray


@dataclass(frozen=True, eq=False)
class ActualContact(ContactPath):
    """Contacts at given places whose velocities and radii are not those of the nominal motion.

    Attributes
    ----------
    sliding, rolling : size of the sliding velocity, sum of the rolling velocities, each (k,) [m/s]
    arm_pinion, arm_gear : radii of curvature, each (k,) [m]
    """

    sliding: FloatArray
    rolling: FloatArray
    arm_pinion: FloatArray
    arm_gear: FloatArray

    def radius(self, xi: FloatArray) -> FloatArray:
        """Reduced radius of curvature [m]."""
        return self.arm_pinion * self.arm_gear / (self.arm_pinion + self.arm_gear)

    def sliding_velocity(self, xi: FloatArray) -> FloatArray:
        """Size of the sliding velocity [m/s]."""
        return self.sliding

    def entraining_velocity(self, xi: FloatArray) -> FloatArray:
        """Sum of the rolling velocities [m/s]."""
        return self.rolling


def law_ratio(
    pair: GearPair,
    interval: tuple[float, float],
    slides_as: FloatArray,
    rolling: FloatArray,
    arm_pinion: FloatArray,
    arm_gear: FloatArray,
) -> FloatArray:
    """Coefficient at the actual contact over that of the nominal motion where it slides as fast, (k,).

    Parameters
    ----------
    pair : a validated gear pair, whose friction law is read
    interval : places between which the lumped law is read; beyond it keeps its value [m]
    slides_as : (k,) where the nominal motion slides as fast as the teeth do [m]
    rolling : (k,) sum of the rolling velocities [m/s]
    arm_pinion, arm_gear : (k,) distances of the contact from both tangent points [m]

    Raises
    ------
    NumericalError : the flanks roll backwards, where the laws have no value
    """
    path, settings, name = contact_path(pair), pair.friction, pair.friction.law
    if name not in ("benedict_kelley", "xu_kahraman", "composite"):  # one coefficient, whatever the contact
        return np.ones_like(slides_as)
    if rolling.min() <= 0.0:
        raise NumericalError(
            "Vibration makes the flanks roll backwards; lower the torque or raise the speed."
        )
    if name == "composite":
        settings = settings.model_copy(update={"coefficient": average_coefficient(path, settings)})
    nominal = {field.name: getattr(path, field.name) for field in fields(path)}
    speeds = path.omega_pinion + path.omega_gear
    sliding = speeds * np.maximum(np.abs(slides_as - path.L_XP), PITCH_RESOLUTION)
    held = np.clip(slides_as, *interval)
    actual = ActualContact(
        **nominal, sliding=sliding, rolling=rolling, arm_pinion=arm_pinion, arm_gear=arm_gear
    )
    size, reference = _size(name, actual, settings, slides_as), _size(name, path, settings, held)
    return np.divide(size, reference, out=np.ones_like(size), where=reference > 0.0)


def _size(name: str, path: ContactPath, settings: FrictionSettings, xi: FloatArray) -> FloatArray:
    if name == "benedict_kelley":
        sliding = np.maximum(
            path.sliding_velocity(xi), PITCH_RESOLUTION * (path.omega_pinion + path.omega_gear)
        )
        return benedict_kelley(
            path.unit_load * 1e-3,
            path.viscosity * 1e3,
            sliding,
            path.entraining_velocity(xi),
            path.roughness * 1e6,
            maximum=settings.maximum,
        )
    if name != "composite":
        return np.abs(LAWS[name].signed(xi, path, settings))
    film = regime(path.film_parameter(xi), settings.thresholds)
    sizes = [_size(law, path, settings, xi) for law in ("smoothed_coulomb", "benedict_kelley", "xu_kahraman")]
    return np.asarray(np.choose(np.minimum(film, 2), sizes), dtype=np.float64)
