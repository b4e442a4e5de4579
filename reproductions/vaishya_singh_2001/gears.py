"""The gear pairs on which statements are judged, and their zones of instability.

The abstracts name no gears, friction coefficient or damping. Chosen here: three published pairs with constant
stiffness of every tooth pair and Coulomb friction. Their arms of friction are constant (28/28, equal
inertias), grow by a quarter from A to D (25/31), and by a factor of two (16/24).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

import floquet
from floquet import LinearSegments, SingleDegree
from lumped import GearPair, load_gear_pair, mesh_cycle
from lumped.typing import FloatArray

#: Presets on which every statement is judged.
PAIRS = ("nasa_28_28", "nasa_art_25_31", "fzg_c")
#: Coefficient of friction of all statements.
MU = 0.1
#: Mesh damping ratio of statements about damped motions.
DAMPING = 0.02
#: Nodes over the speeds about a zone, and the speeds as shares of the speed of the zone.
NODES = 4001
AROUND = (0.75, 1.25)


def with_friction(name: str, mu: float, damping: float) -> GearPair:
    """Preset with constant |mu| and a mesh damping ratio."""
    return load_gear_pair(name).with_(law="coulomb", friction__coefficient=mu, mesh__damping_ratio=damping)


def model_of(name: str, mu: float = MU, damping: float = 0.0) -> SingleDegree:
    """Model with one degree of freedom and rectangular stiffness."""
    return floquet.single_degree(with_friction(name, mu, damping), stiffness="rectangular")


@dataclass(frozen=True)
class Zone:
    """A zone of instability without damping about the mesh frequency 2 omega_n/order.

    Attributes
    ----------
    low, high : edges of the zone as shares of that mesh frequency
    """

    low: float
    high: float

    @property
    def width(self) -> float:
        """Width as a share of the mesh frequency."""
        return self.high - self.low


@dataclass(frozen=True)
class Gears:
    """One of the pairs.

    Attributes
    ----------
    name : name of the preset
    """

    name: str

    @cached_property
    def natural_frequency(self) -> float:
        """omega_n [rad/s] of the mean mesh stiffness without friction."""
        model = model_of(self.name, 0.0)
        return float(np.sqrt(mesh_cycle(model.rigid_pair).mean_stiffness / model.mass))

    def speed_rpm(self, ratio: float) -> float:
        """Pinion speed [rpm] at which the mesh frequency is this ratio of the natural frequency."""
        teeth = load_gear_pair(self.name).pinion.teeth
        return ratio * self.natural_frequency * 30.0 / np.pi / teeth

    def at_ratio(self, ratio: float, mu: float = MU, damping: float = DAMPING) -> SingleDegree:
        """Model at a mesh frequency over the natural frequency."""
        pair = with_friction(self.name, mu, damping).with_(speed=self.speed_rpm(ratio))
        return floquet.single_degree(pair, stiffness="rectangular")

    def zone(self, order: int, mu: float) -> Zone:
        """Zone of instability of an order, without damping: |tr M| > 2."""
        shares = np.linspace(*AROUND, NODES)
        chart = floquet.single_degree_chart(
            with_friction(self.name, mu, 0.0),
            {"speed_rpm": shares * self.speed_rpm(2.0 / order)},
            stiffness="rectangular",
            refine=False,
            store="all",
        )
        excess = np.abs(chart["multipliers"].sum("multiplier").to_numpy()) - 2.0
        return Zone(*_nearest_to_one(shares, excess))


def _nearest_to_one(shares: FloatArray, excess: FloatArray) -> tuple[float, float]:
    """Roots of ``excess`` that bound the interval with positive excess whose middle is nearest to 1."""
    start = np.flatnonzero((excess[:-1] < 0.0) & (excess[1:] >= 0.0))
    edges = []
    for i in start:
        (ends,) = np.nonzero(excess[i + 1 :] < 0.0)
        if ends.size:
            j = i + int(ends[0])
            edges.append([_root(shares, excess, k) for k in (i, j)])
    low, high = min(edges, key=lambda one: abs(0.5 * (one[0] + one[1]) - 1.0))
    return low, high


def _root(shares: FloatArray, excess: FloatArray, i: int) -> float:
    """Root of the straight line through nodes i and i + 1."""
    return float(shares[i] - excess[i] * (shares[i + 1] - shares[i]) / (excess[i + 1] - excess[i]))


def without_force_of_friction(segments: LinearSegments) -> FloatArray:
    """Mean force F (n,) of segments with friction of a mean load: a force of equal mean without friction."""
    lengths = np.diff(segments.edges)
    mean = lengths @ (0.5 * (segments.force_start + segments.force_end)) / segments.period
    return np.full(lengths.size, mean)
