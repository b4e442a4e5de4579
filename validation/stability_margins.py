"""How far the operating point is from instability: tongues over speed, and the damping that closes them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from floquet import stability_boundaries, stability_chart
from lumped import GearPair
from lumped.friction import friction_path_function, mean_coefficient

FloatArray = NDArray[np.float64]

_SPEEDS = 65
_DAMPINGS = 81
_RTOL = 1e-8


@dataclass(frozen=True, eq=False)
class TongueMargin:
    """One tongue of instability at zero mesh damping, bearings damped as given, and what closes it.

    Attributes
    ----------
    label : modes and order, e.g. "2w3/2": mesh frequency 2 omega_3/2
    lower, upper : boundaries at zero mesh damping [rpm]
    radius : largest multiplier at zero mesh damping
    critical_damping : largest mesh damping ratio at which some speed of the tongue is unstable
    damping, left, right : edges of the tongue, left and right [rpm] over the mesh damping ratio, (k,)
    """

    label: str
    lower: float
    upper: float
    radius: float
    critical_damping: float
    damping: FloatArray
    left: FloatArray
    right: FloatArray

    def distance(self, rpm: float) -> float:
        """Distance of a speed to the tongue at zero mesh damping; 0 inside [rpm]."""
        return max(self.lower - rpm, rpm - self.upper, 0.0)


@dataclass(frozen=True, eq=False)
class StabilityMargins:
    """Distances of the operating point to instability.

    Attributes
    ----------
    rpm, damping : operating point, pinion speed [rpm] and mesh damping ratio
    speed_range : range searched [rpm]
    friction_coefficient : constant coefficient that stands for the friction law here
    tongues : at zero mesh damping, by speed
    unstable_here : intervals (k, 2) [rpm] that are unstable at the given damping
    damping_at_speed : largest mesh damping ratio at which the operating speed is unstable; None: not even 0
    law_difference : largest difference of the spectral radius between the friction law and the constant
        coefficient, at the middle of every tongue without mesh damping; None without tongues
    """

    rpm: float
    damping: float
    speed_range: tuple[float, float]
    friction_coefficient: float
    tongues: tuple[TongueMargin, ...]
    unstable_here: FloatArray
    damping_at_speed: float | None
    law_difference: float | None

    @property
    def speed_margin(self) -> float | None:
        """Distance to the nearest unstable speed at the given damping [rpm]; None: the range has none."""
        if not self.unstable_here.size:
            return None
        low, high = self.unstable_here.T
        return float(np.maximum(np.maximum(low - self.rpm, self.rpm - high), 0.0).min())

    @property
    def nearest(self) -> TongueMargin | None:
        """Tongue nearest in speed at zero mesh damping."""
        return min(self.tongues, key=lambda t: t.distance(self.rpm), default=None)

    @property
    def critical_damping(self) -> float:
        """Mesh damping ratio above which the whole range is stable; 0 where it always is."""
        return max((t.critical_damping for t in self.tongues), default=0.0)


def stability_margins(
    pair: GearPair, speed_range: tuple[float, float], *, largest_damping: float = 0.1
) -> StabilityMargins:
    """Find every tongue over speed and its distance to the operating point, in speed and in damping.

    Friction is held at its mean over the path of contact: it moves tongues by far less than their width
    (``law_difference`` says how much), and a law that depends on speed would have to be fitted at every
    speed.

    Parameters
    ----------
    pair : the gear pair
    speed_range : pinion speeds searched [rpm]
    largest_damping : mesh damping ratio up to which tongues are followed

    Raises
    ------
    NumericalError : a monodromy matrix cannot be computed; the text says what to try
    """
    rpm = pair.operating.pinion_speed * 30.0 / np.pi
    here = pair.mesh.damping_ratio
    coefficient = mean_coefficient(friction_path_function(pair))
    held = pair.with_({"friction.law": "coulomb", "friction.coefficient": coefficient})
    found = stability_boundaries(held, speed_range, {"damping_ratio": [0.0]}, rtol=_RTOL, xtol=1e-6)
    tongues = tuple(
        _tongue(held, found.isel(tongue=row, damping_ratio=0), speed_range, largest_damping)
        for row in range(found.sizes["tongue"])
    )
    own = stability_boundaries(held, speed_range, {"damping_ratio": [here]}, rtol=_RTOL, xtol=1e-6)
    intervals = np.stack([own["lower"].to_numpy()[:, 0], own["upper"].to_numpy()[:, 0]], axis=1)
    dampings = np.linspace(0.0, largest_damping, _DAMPINGS)
    column = stability_chart(held, {"speed_rpm": [rpm], "damping_ratio": dampings}, rtol=_RTOL)
    unstable = dampings[column["spectral_radius"].to_numpy()[0] > 1.0]
    return StabilityMargins(
        rpm=float(rpm),
        damping=here,
        speed_range=speed_range,
        friction_coefficient=coefficient,
        tongues=tuple(sorted(tongues, key=lambda t: t.lower)),
        unstable_here=intervals,
        damping_at_speed=float(unstable.max()) if unstable.size else None,
        law_difference=_law_difference(pair, held, tongues),
    )


def _tongue(
    held: GearPair, found: xr.Dataset, speed_range: tuple[float, float], largest_damping: float
) -> TongueMargin:
    """Follow one tongue up to the damping that closes it, in two rounds of a chart around it."""
    low, high = float(found["lower"]), float(found["upper"])
    # Friction and damping shift a tongue a little while they close it.
    aside = 0.25 * (high - low)
    speeds = np.linspace(max(low - aside, speed_range[0]), min(high + aside, speed_range[1]), _SPEEDS)
    top = largest_damping
    for _ in range(3):
        dampings = np.linspace(0.0, top, _DAMPINGS)
        chart = stability_chart(held, {"speed_rpm": speeds, "damping_ratio": dampings}, rtol=_RTOL)
        unstable = chart["spectral_radius"].transpose("damping_ratio", "speed_rpm").to_numpy() > 1.0
        open_ = np.flatnonzero(unstable.any(axis=1))
        if open_.size == 0:  # narrower than the chart's step: closed by any damping that the chart has
            break
        if open_[-1] > _DAMPINGS // 4 or open_[-1] == _DAMPINGS - 1:
            break
        top = float(dampings[open_[-1] + 1])
    rows = open_ if open_.size else np.array([0])
    left = np.array([speeds[row][0] if row.any() else low for row in unstable[rows]])
    right = np.array([speeds[row][-1] if row.any() else high for row in unstable[rows]])
    left[0], right[0] = low, high
    return TongueMargin(
        label=str(found["label"].item()),
        lower=low,
        upper=high,
        radius=float(found["peak_radius"]),
        critical_damping=float(dampings[rows[-1]]),
        damping=dampings[rows],
        left=left,
        right=right,
    )


def _law_difference(pair: GearPair, held: GearPair, tongues: tuple[TongueMargin, ...]) -> float | None:
    if not tongues:
        return None
    middles = [0.5 * (t.lower + t.upper) for t in tongues]
    axes = {"speed_rpm": middles, "damping_ratio": [0.0]}
    radii = [stability_chart(p, axes, rtol=_RTOL)["spectral_radius"].to_numpy() for p in (pair, held)]
    return float(np.abs(radii[0] - radii[1]).max())
