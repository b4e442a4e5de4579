"""How far the operating point is from instability: tongues over speed, and the damping that closes them.

Every number is a root: edges of tongues over speed and over damping by bisection, tips by `tongue_tip`. No
chart is read.

Sources: docs/theory/floquet.md, "Where instability is, and what it is called".
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from floquet.engine.intervals import UnstableInterval, seeded_nodes, unstable_intervals
from floquet.engine.tongues import TongueTip, tongue_tip
from floquet.gear.axes import operating_rpm, vary
from floquet.gear.block import gear_block
from floquet.gear.boundaries import checked_range, label_variation, predicted_lines
from floquet.gear.chart import stability_chart
from floquet.rank_one.batch import spectral_radii
from lumped import GearPair
from lumped.friction import mean_coefficient
from lumped.labelling import labelled_dataset
from lumped.path_of_contact import friction_path_function
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import LARGEST_SPEED
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr

Radius = Callable[[npt.ArrayLike, npt.ArrayLike], FloatArray]
"""(pinion speeds [rpm], mesh damping ratios), broadcast -> spectral radii of the feedback block."""

#: Largest order k of the predicted lines (omega_i +- omega_j)/k that seed the search.
ORDERS = 12
_RTOL = 1e-8
# Radii below 1 + this count as stable, as in floquet.engine.intervals: undamped bearings sit at 1 within
# rounding.
_THRESHOLD = 1e-9
_LARGEST_DAMPING = 1.0  # what the schema allows for a mesh
_SPEED_NODES = 400
_PAST = 0.1  # how far past the highest line its tongue may reach
_EDGE_ROWS, _EDGE_SPEEDS, _EDGE_ROUNDS = 25, 49, 14


@dataclass(frozen=True, eq=False)
class TongueMargin:
    """One tongue of instability at zero mesh damping, bearings damped as given, and what closes it.

    Attributes
    ----------
    label : modes and order, e.g. "2w3/2": mesh frequency 2 omega_3/2
    lower, upper : boundaries at zero mesh damping [rpm]
    radius : largest multiplier at zero mesh damping
    critical_damping : mesh damping ratio from which on no speed of the tongue is unstable; 1, the largest
        ratio allowed, where the tongue is still open there
    tip_speed : speed at which it closes [rpm]
    damping, left, right : edges of the tongue, left and right [rpm] over the mesh damping ratio, (k,)
    """

    label: str
    lower: float
    upper: float
    radius: float
    critical_damping: float
    tip_speed: float
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
    above : the next tongue above the range, at zero mesh damping; None: there is none up to the highest line
    unstable_here : intervals (k, 2) [rpm] that are unstable at the given damping
    damping_at_speed : mesh damping ratio above which the operating speed is stable; None: it is at any
    law_difference : largest difference of the spectral radius between the friction law and the constant
        coefficient, at the middle of every tongue without mesh damping; None without tongues
    """

    rpm: float
    damping: float
    speed_range: tuple[float, float]
    friction_coefficient: float
    tongues: tuple[TongueMargin, ...]
    above: TongueMargin | None
    unstable_here: FloatArray
    damping_at_speed: float | None
    law_difference: float | None

    @property
    def speed_margin(self) -> float | None:
        """Distance to the nearest unstable speed at the given damping [rpm]; None: the range has none."""
        nearest = self.nearest_unstable
        return None if nearest is None else abs(nearest - self.rpm)

    @property
    def nearest_unstable(self) -> float | None:
        """Nearest unstable speed at the given damping [rpm], the operating speed itself if it is one."""
        if not self.unstable_here.size:
            return None
        inside = np.clip(self.rpm, *self.unstable_here.T)
        return float(inside[np.argmin(np.abs(inside - self.rpm))])

    @property
    def unstable_above(self) -> float | None:
        """Where the next tongue above the range begins at the given damping [rpm]; None: it is closed."""
        if self.above is None or self.above.critical_damping <= self.damping:
            return None
        return float(np.interp(self.damping, self.above.damping, self.above.left))

    @property
    def nearest(self) -> TongueMargin | None:
        """Tongue nearest in speed at zero mesh damping."""
        return min(self.tongues, key=lambda t: t.distance(self.rpm), default=None)

    @property
    def critical_damping(self) -> float:
        """Mesh damping ratio above which the whole range is stable; 0 where it always is."""
        return max((t.critical_damping for t in self.tongues), default=0.0)


def stability_margins(pair: AnyPair, speed_rpm: tuple[float, float]) -> StabilityMargins:
    """Find every tongue over speed and its distance to the operating point, in speed and in damping.

    Friction is held at its mean over the path of contact: it moves tongues by far less than their width
    (``law_difference`` says how much), and a law that depends on speed would have to be fitted at every
    speed.

    Parameters
    ----------
    pair : the gear pair
    speed_rpm : pinion speeds searched [rpm]

    Raises
    ------
    ParameterError : not two increasing positive speeds
    NumericalError : a monodromy matrix cannot be computed; the text says what to try
    """
    pair = load_gear_pair(pair)
    speed_range = checked_range(speed_rpm)
    rpm = operating_rpm(pair)
    here = pair.mesh.damping_ratio
    coefficient = mean_coefficient(friction_path_function(pair))
    held = pair.with_({"friction.law": "coulomb", "friction.coefficient": coefficient})
    radius = feedback_radius(held)
    lines = np.array(list(predicted_lines(held, ORDERS).values()))
    nodes = seeded_nodes(lines, *speed_range, _SPEED_NODES)

    def unstable(damping: float) -> list[UnstableInterval]:
        return unstable_intervals(lambda speeds: radius(speeds, damping), nodes, xtol=1e-8)

    undamped = unstable(0.0)
    tongues = tuple(
        _tongue(radius, held, interval, window)
        for interval, window in zip(undamped, _windows(undamped, speed_range), strict=True)
    )
    dampings = np.concatenate([[0.0], np.geomspace(1e-7, _LARGEST_DAMPING, 150)])
    at_speed = unstable_intervals(lambda z: radius(rpm, z), dampings, xtol=1e-8)
    return StabilityMargins(
        rpm=rpm,
        damping=here,
        speed_range=speed_range,
        friction_coefficient=coefficient,
        tongues=tongues,
        above=_above(radius, held, lines, speed_range[1]),
        unstable_here=np.array([(i.lower, i.upper) for i in unstable(here)]),
        damping_at_speed=max((i.upper for i in at_speed), default=None),
        law_difference=_law_difference(pair, held, tongues),
    )


def _above(radius: Radius, pair: GearPair, lines: FloatArray, high: float) -> TongueMargin | None:
    """First tongue without mesh damping that begins above the range, searched up to the highest line."""
    top = min((1.0 + _PAST) * float(lines.max()), LARGEST_SPEED)
    if top <= high:
        return None
    nodes = seeded_nodes(lines, high, top, _SPEED_NODES)
    found = unstable_intervals(lambda speeds: radius(speeds, 0.0), nodes, xtol=1e-8)
    windows = _windows(found, (high, top))
    for interval, window in zip(found, windows, strict=True):
        if not interval.open_below:  # that one began within the range
            return _tongue(radius, pair, interval, window)
    return None


def margins_dataset(margins: StabilityMargins) -> xr.Dataset:
    """Tongues, their edges over damping and what closes them, for a file.

    Returns
    -------
    Dataset over ``tongue`` (coordinate label) and ``row``: ``damping_ratio``, ``lower`` and ``upper`` [rpm],
    the edges from zero mesh damping to the tip, NaN beyond it; ``critical_damping``, ``tip_speed`` [rpm] and
    ``peak_radius`` of each
    """
    tongues = margins.tongues
    edges = np.full((3, len(tongues), max((t.damping.size for t in tongues), default=0)), np.nan)
    for index, t in enumerate(tongues):
        edges[:, index, : t.damping.size] = t.damping, t.left, t.right
    tips = np.array([(t.critical_damping, t.tip_speed, t.radius) for t in tongues]).reshape(-1, 3).T
    edge = ("tongue", "row")
    return labelled_dataset(
        {
            "damping_ratio": (edge, edges[0], "1", "mesh damping ratio of a point of the edges"),
            "lower": (edge, edges[1], "rpm", "lower edge of the tongue"),
            "upper": (edge, edges[2], "rpm", "upper edge of the tongue"),
            "critical_damping": ("tongue", tips[0], "1", "mesh damping that closes the tongue"),
            "tip_speed": ("tongue", tips[1], "rpm", "pinion speed where the tongue closes"),
            "peak_radius": ("tongue", tips[2], "1", "largest multiplier without mesh damping"),
        },
        {},
        {
            "title": "tongues of instability over speed and mesh damping",
            "friction_coefficient_held": margins.friction_coefficient,
        },
    ).assign_coords(label=("tongue", np.array([t.label for t in tongues], dtype=object)))


def feedback_radius(pair: GearPair) -> Radius:
    """Spectral radius of (q, x_p, x_g) as a function of speed and mesh damping ratio, from one fit.

    Parameters
    ----------
    pair : the gear pair, with a friction law that does not depend on speed
    """
    block = gear_block(vary(pair, {"damping_ratio": _LARGEST_DAMPING}), rtol=0.1 * _RTOL)

    def radius(speeds: npt.ArrayLike, dampings: npt.ArrayLike) -> FloatArray:
        rpm, zeta = np.broadcast_arrays(np.asarray(speeds, dtype=float), np.asarray(dampings, dtype=float))
        found = spectral_radii(
            block,
            block.period * operating_rpm(pair) / rpm.ravel(),
            zeta.ravel() / _LARGEST_DAMPING,
            tolerance=1e-3 * _RTOL,
        )
        return found.reshape(rpm.shape)

    return radius


def _windows(intervals: list[UnstableInterval], limits: tuple[float, float]) -> list[tuple[float, float]]:
    """Speeds around each interval: a quarter of its width aside, since damping shifts a tongue a little
    while it closes it, but not beyond half the way to a neighbour.
    """
    middles = [0.5 * (a.upper + b.lower) for a, b in itertools.pairwise(intervals)]
    ends = [limits[0], *middles, limits[1]]
    windows = []
    for interval, low, high in zip(intervals, ends, ends[1:], strict=False):  # without a tongue, none
        aside = 0.25 * (interval.upper - interval.lower)
        windows.append((max(interval.lower - aside, low), min(interval.upper + aside, high)))
    return windows


def _tongue(
    radius: Radius, pair: GearPair, interval: UnstableInterval, window: tuple[float, float]
) -> TongueMargin:
    """Follow one tongue up to the damping that closes it."""

    def excess(speeds: FloatArray, damping: float) -> FloatArray:
        return radius(speeds, damping) - _THRESHOLD

    if (excess(np.linspace(*window, 33), _LARGEST_DAMPING) > 1.0).any():
        tip = TongueTip(_LARGEST_DAMPING, interval.peak)
    else:
        tip = tongue_tip(excess, window, (0.0, _LARGEST_DAMPING))
    damping, left, right = _edges(radius, interval, window, tip)
    return TongueMargin(
        label=str(label_variation(vary(pair, {"damping_ratio": 0.0, "speed_rpm": interval.peak}))),
        lower=interval.lower,
        upper=interval.upper,
        radius=interval.peak_radius,
        critical_damping=tip.damping,
        tip_speed=tip.place,
        damping=damping,
        left=left,
        right=right,
    )


def _edges(
    radius: Radius, interval: UnstableInterval, window: tuple[float, float], tip: TongueTip
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Damping ratios from zero to the tip, and the edges of the tongue there [rpm].

    The width of a tongue goes with the root of the distance to its tip, so ratios are spaced by squares.
    """
    u = np.linspace(1.0, 0.0, _EDGE_ROWS)[1:-1]
    dampings = tip.damping * (1.0 - u**2)
    # Between these samples lies the place that stays unstable longest, or nearly.
    middle = tip.place + (interval.peak - tip.place) * u**2
    speeds = np.broadcast_to(np.linspace(*window, _EDGE_SPEEDS), (u.size, _EDGE_SPEEDS))
    speeds = np.sort(np.concatenate([speeds, middle[:, None]], axis=1), axis=1)
    unstable = radius(speeds, dampings[:, None]) > 1.0 + _THRESHOLD
    rows = np.flatnonzero(unstable.any(axis=1))
    first = unstable[rows].argmax(axis=1)
    last = speeds.shape[1] - 1 - unstable[rows, ::-1].argmax(axis=1)
    inside = np.stack([speeds[rows, first], speeds[rows, last]])
    outside = np.stack(
        [speeds[rows, np.maximum(first - 1, 0)], speeds[rows, np.minimum(last + 1, speeds.shape[1] - 1)]]
    )
    for _ in range(_EDGE_ROUNDS):
        half = 0.5 * (inside + outside)
        still = radius(half, dampings[rows]) > 1.0 + _THRESHOLD
        inside, outside = np.where(still, half, inside), np.where(still, outside, half)
    left, right = inside
    return (
        np.concatenate([[0.0], dampings[rows], [tip.damping]]),
        np.concatenate([[interval.lower], left, [tip.place]]),
        np.concatenate([[interval.upper], right, [tip.place]]),
    )


def _law_difference(pair: GearPair, held: GearPair, tongues: tuple[TongueMargin, ...]) -> float | None:
    if not tongues:
        return None
    middles = [0.5 * (t.lower + t.upper) for t in tongues]
    axes = {"speed_rpm": middles, "damping_ratio": [0.0]}
    radii = [stability_chart(p, axes, rtol=_RTOL)["spectral_radius"].to_numpy() for p in (pair, held)]
    return float(np.abs(radii[0] - radii[1]).max())
