"""Margins of stability of a gear pair: every tongue over speed, and the mesh damping that closes it.

Every number is a root: edges over speed and over damping by bisection, tips by `tongue_tip`.

Sources: docs/theory/floquet.md, "Where instability is, and what it is called".
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from floquet.engine.tongues import TongueTip, UnstableInterval, seeded_nodes, tongue_tip, unstable_intervals
from floquet.gear.axes import checked_range, operating_rpm, vary
from floquet.gear.multipliers import gear_block
from floquet.gear.regions import label_variation
from floquet.gear.tongues import predicted_lines
from floquet.rank_one.batch import spectral_radii
from lumped.friction import mean_coefficient
from lumped.labelling import labelled_dataset
from lumped.path_of_contact import friction_path_function
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import LARGEST_SPEED, GearPair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr

Radius = Callable[[npt.ArrayLike, npt.ArrayLike], FloatArray]
"""(pinion speeds [rpm], mesh damping ratios), broadcast -> spectral radii of the feedback block."""

#: Largest order k of the predicted lines (omega_i +- omega_j)/k that seed the search.
_ORDERS = 12
_RTOL = 1e-8
# As in floquet.engine.tongues: undamped bearings sit at 1 within rounding.
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
    """

    rpm: float
    damping: float
    speed_range: tuple[float, float]
    friction_coefficient: float
    tongues: tuple[TongueMargin, ...]
    above: TongueMargin | None
    unstable_here: FloatArray
    damping_at_speed: float | None

    @property
    def speed_margin(self) -> float | None:
        """Distance to the nearest unstable speed at the given damping [rpm]; None: the range has none."""
        away = np.abs(np.clip(self.rpm, *self.unstable_here.T) - self.rpm)
        return float(away.min()) if away.size else None

    @property
    def critical_damping(self) -> float:
        """Mesh damping ratio above which the whole range is stable; 0 where it always is."""
        return max((t.critical_damping for t in self.tongues), default=0.0)

    @property
    def dataset(self) -> xr.Dataset:
        """Tongues for a file, over ``tongue`` (coordinate label) and ``row``, from zero damping to the tip.

        ``damping_ratio``, ``lower`` and ``upper`` [rpm], NaN beyond the tip; ``critical_damping``,
        ``tip_speed`` [rpm] and ``peak_radius`` of each tongue.
        """
        tongues = self.tongues
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
                "friction_coefficient_held": self.friction_coefficient,
            },
        ).assign_coords(label=("tongue", np.array([t.label for t in tongues], dtype=object)))


def stability_margins(pair: AnyPair, speed_rpm: tuple[float, float]) -> StabilityMargins:
    """Find every tongue over speed and its distance to the operating point, in speed and in damping.

    Friction is constant at its mean over the path of contact: it moves tongues by far less than their width,
    and a law that depends on speed would have to be fitted at every speed.

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
    low, high = checked_range("speed_rpm", speed_rpm)
    rpm, here = operating_rpm(pair), pair.mesh.damping_ratio
    coefficient = mean_coefficient(friction_path_function(pair))
    constant = pair.with_({"friction.law": "coulomb", "friction.coefficient": coefficient})
    radius = _radius(constant)
    lines = np.array(list(predicted_lines(constant, _ORDERS).values()))

    def unstable(damping: float, low: float = low, high: float = high) -> list[UnstableInterval]:
        nodes = seeded_nodes(lines, low, high, _SPEED_NODES)
        return unstable_intervals(lambda speeds: radius(speeds, damping), nodes, xtol=1e-8)

    def tongue(interval: UnstableInterval, window: tuple[float, float]) -> TongueMargin:
        return _tongue(radius, constant, interval, window)

    undamped = unstable(0.0)
    tongues = tuple(map(tongue, undamped, _windows(undamped, low, high)))
    top = min((1.0 + _PAST) * float(lines.max()), LARGEST_SPEED)
    beyond = unstable(0.0, high, top) if top > high else []
    # What is open below began within the range.
    above = (pair for pair in zip(beyond, _windows(beyond, high, top), strict=True) if not pair[0].open_below)
    dampings = np.concatenate([[0.0], np.geomspace(1e-7, _LARGEST_DAMPING, 150)])
    at_speed = unstable_intervals(lambda z: radius(rpm, z), dampings, xtol=1e-8)
    return StabilityMargins(
        rpm=rpm,
        damping=here,
        speed_range=(low, high),
        friction_coefficient=coefficient,
        tongues=tongues,
        above=next(itertools.starmap(tongue, above), None),
        unstable_here=np.array([(i.lower, i.upper) for i in unstable(here)]).reshape(-1, 2),
        damping_at_speed=max((i.upper for i in at_speed), default=None),
    )


def _radius(pair: GearPair) -> Radius:
    """Spectral radius over speed and mesh damping ratio, from one fit; friction must not depend on speed."""
    block = gear_block(vary(pair, {"damping_ratio": _LARGEST_DAMPING}), rtol=0.1 * _RTOL)

    def radius(speeds: npt.ArrayLike, dampings: npt.ArrayLike) -> FloatArray:
        rpm, zeta = np.broadcast_arrays(np.asarray(speeds, dtype=float), np.asarray(dampings, dtype=float))
        periods = block.period * operating_rpm(pair) / rpm.ravel()
        result = spectral_radii(block, periods, zeta.ravel() / _LARGEST_DAMPING, tolerance=1e-3 * _RTOL)
        return result.reshape(rpm.shape)

    return radius


def _windows(intervals: list[UnstableInterval], low: float, high: float) -> list[tuple[float, float]]:
    """Speeds around each interval: a quarter of its width aside, since damping shifts a tongue a little
    while it closes it, but not beyond half the way to a neighbour.
    """
    ends = [low, *(0.5 * (a.upper + b.lower) for a, b in itertools.pairwise(intervals)), high]
    windows = []
    for interval, least, most in zip(intervals, ends, ends[1:], strict=False):  # without a tongue, none
        aside = 0.25 * (interval.upper - interval.lower)
        windows.append((max(interval.lower - aside, least), min(interval.upper + aside, most)))
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
    first, end = unstable[rows].argmax(axis=1), speeds.shape[1] - 1
    last = end - unstable[rows, ::-1].argmax(axis=1)
    inside = np.stack([speeds[rows, first], speeds[rows, last]])
    outside = np.stack([speeds[rows, np.maximum(first - 1, 0)], speeds[rows, np.minimum(last + 1, end)]])
    for _ in range(_EDGE_ROUNDS):
        half = 0.5 * (inside + outside)
        still = radius(half, dampings[rows]) > 1.0 + _THRESHOLD
        inside, outside = np.where(still, half, inside), np.where(still, outside, half)
    return (
        np.concatenate([[0.0], dampings[rows], [tip.damping]]),
        np.concatenate([[interval.lower], inside[0], [tip.place]]),
        np.concatenate([[interval.upper], inside[1], [tip.place]]),
    )
