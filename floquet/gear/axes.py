"""What a stability chart of a gear pair can vary: units, how the pair changes, and the range to show."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import get_args

import numpy as np

from floquet.engine.chart import Axes, ChartAxis, checked_axes
from lumped.arguments import one_of, real_array
from lumped.errors import refuse, shown
from lumped.fields.units import SIValue, to_stated
from lumped.friction import LAWS, mean_coefficient
from lumped.labelling import Coordinate
from lumped.model.mesh_cycle import MeshCycle, mesh_cycle
from lumped.model.periodic_system import Supports
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import LARGEST_SPEED, GearPair
from lumped.typing import FloatArray


@dataclass(frozen=True)
class GearVariation:
    """A gear pair as a chart varies it.

    Attributes
    ----------
    pair : the validated pair
    friction_mean : wanted mean of |mu| over the path; None: as the law gives it
    stiffness_variation : factor on the variation of the total mesh stiffness about its mean over the cycle
    supports : "springs", the pair's ``bearings``, or its "shafts"
    """

    pair: GearPair
    friction_mean: float | None = None
    stiffness_variation: float = 1.0
    supports: Supports = "springs"

    @classmethod
    def of(cls, source: AnyPair | GearVariation, supports: Supports = "springs") -> GearVariation:
        """A pair as it is on these supports, or a variation of one, which names its own."""
        if isinstance(source, GearVariation):
            return source
        one_of("supports", supports, get_args(Supports))
        return cls(load_gear_pair(source), supports=supports)

    def cycle(self) -> MeshCycle:
        """Mesh cycle, with the friction law scaled to ``friction_mean``."""
        cycle = mesh_cycle(self.pair)
        if self.friction_mean is None:
            return cycle
        friction = cycle.elements.friction
        mean = mean_coefficient(friction)
        if mean == 0.0:
            raise refuse(
                "friction_coefficient",
                self.friction_mean,
                "a law that is not zero along the whole path",
                'Choose friction.law = "coulomb".',
            )
        scaled = friction.scaled(self.friction_mean / mean)
        return MeshCycle(cycle.geometry, replace(cycle.elements, friction=scaled))


@dataclass(frozen=True)
class GearAxis(ChartAxis):
    """One parameter of a gear-pair chart.

    Attributes
    ----------
    apply : (variation, value) -> variation
    own : pair -> value that the pair itself has
    """

    apply: Callable[[GearVariation, float], GearVariation] = field(repr=False)
    own: Callable[[GearPair], float] = field(repr=False)


def _field(*paths: str) -> Callable[[GearVariation, float], GearVariation]:
    def apply(variation: GearVariation, value: float) -> GearVariation:
        return replace(variation, pair=variation.pair.with_(dict.fromkeys(paths, value)))

    return apply


def _friction(variation: GearVariation, value: float) -> GearVariation:
    """Mean coefficient: a parameter of some laws; the others are scaled, keeping their shape."""
    law = variation.pair.friction.law
    if law == "none":
        law = "coulomb"
        variation = replace(variation, pair=variation.pair.with_({"friction.law": law}))
    if LAWS[law].coefficient:
        return replace(variation, pair=variation.pair.with_({"friction.coefficient": value}))
    return replace(variation, friction_mean=value)


def _contact_ratio(variation: GearVariation, value: float) -> GearVariation:
    """Set the contact ratio by both tip diameters; approach and recess keep their shares of the path.

    The path of contact ends where the tip circles cut the line of action: r_ap^2 = r_bp^2 + L_XD^2 and
    r_ag^2 = r_bg^2 + (L_XY - L_XA)^2. A relief moves with the end of the active flank and keeps its length.
    """
    pair = variation.pair
    g = pair.geometry
    factor = value / g.contact_ratio
    recess = g.L_XP + factor * (g.L_XD - g.L_XP)
    approach = g.L_XY - g.L_XP + factor * (g.L_XP - g.L_XA)
    later, earlier = recess - g.L_XD, approach - (g.L_XY - g.L_XA)
    changes: dict[str, object] = {}
    for name, gear, radius, flank, tip, root in (
        ("pinion", pair.pinion, g.base_radius_pinion, recess, later, -earlier),
        ("gear", pair.gear, g.base_radius_gear, approach, earlier, -later),
    ):
        changes |= {f"{name}.addendum": None, f"{name}.tip_diameter": 2e3 * math.hypot(radius, flank)}
        for end, relief, moved in (("tip", gear.tip_relief, tip), ("root", gear.root_relief, root)):
            if relief is not None:
                start = relief.start_roll_angle + moved / radius
                changes[f"{name}.{end}_relief.start_roll_angle"] = SIValue(start, "rad")
    return replace(variation, pair=pair.with_(changes))


def _variation(variation: GearVariation, value: float) -> GearVariation:
    return replace(variation, stiffness_variation=value)


def operating_rpm(pair: GearPair) -> float:
    """Operating speed of the pinion [rpm]."""
    return float(pair.operating.pinion_speed * 30.0 / np.pi)


GEAR_AXES: Mapping[str, GearAxis] = {
    "speed_rpm": GearAxis(
        "rpm", "pinion speed", _field("operating.pinion_speed"), operating_rpm, low=0.0, open_low=True
    ),
    "damping_ratio": GearAxis(
        "1", "mesh damping ratio", _field("mesh.damping_ratio"),
        lambda pair: pair.mesh.damping_ratio, low=0.0, high=1.0,
    ),
    "friction_coefficient": GearAxis(
        "1", "mean friction coefficient", _friction,
        lambda pair: mean_coefficient(mesh_cycle(pair).elements.friction), low=0.0, high=1.0,
    ),
    "torque": GearAxis(
        "N m", "pinion torque", _field("operating.pinion_torque"),
        lambda pair: pair.operating.pinion_torque, low=0.0, open_low=True,
    ),
    "stiffness_variation": GearAxis(
        "1", "variation of mesh stiffness about its mean, 1 as given", _variation, lambda pair: 1.0,
        low=0.0, high=2.0,
    ),
    "contact_ratio": GearAxis(
        "1", "contact ratio, by the tip diameters", _contact_ratio,
        lambda pair: pair.geometry.contact_ratio, low=1.0, high=3.0,
    ),
    "bearing_stiffness": GearAxis(
        "N/m", "stiffness of all bearings, LOA and OLOA",
        _field(*(f"bearings.{g}.{d}_stiffness" for g in ("pinion", "gear") for d in ("loa", "oloa"))),
        lambda pair: pair.bearings.pinion.loa_stiffness, low=0.0, open_low=True,
    ),
}  # fmt: skip
"""Axis name -> what it varies."""


def gear_axis(name: str) -> GearAxis:
    """Return the axis of this name.

    Raises
    ------
    ParameterError : unknown name
    """
    return GEAR_AXES[one_of("axes", name, GEAR_AXES)]


def gear_grid(axes: Axes, supports: Supports = "springs") -> dict[str, FloatArray]:
    """Axes of gear-pair parameters as 1-D arrays.

    Raises
    ------
    ParameterError : unknown name, values outside the range of their axis, or an axis of other supports
    """
    grid = checked_axes(axes)
    for name, values in grid.items():
        gear_axis(name).check(name, values)
    if supports == "shafts" and "bearing_stiffness" in grid:
        raise refuse("axes", "bearing_stiffness", "not with shafts", "Their bearings are fields of [shafts].")
    return grid


def axis_coordinates(grid: Mapping[str, FloatArray]) -> dict[str, Coordinate]:
    """Values of some axes with units and plain names; "value" for a name that is no axis."""
    unnamed = ("1", "value")
    known = {name: (axis.units, axis.long_name) for name, axis in GEAR_AXES.items()}
    return {name: (values, *known.get(name, unnamed)) for name, values in grid.items()}


def vary(
    pair: GearPair | GearVariation, point: Mapping[str, float], supports: Supports = "springs"
) -> GearVariation:
    """Return the pair at one point of a chart."""
    variation = GearVariation.of(pair, supports)
    for name, value in point.items():
        variation = gear_axis(name).apply(variation, value)
    return variation


def speed_range(pair: GearPair) -> tuple[float, float]:
    """Pinion speeds [rpm] that charts, sweeps and margins cover: ``operating.speed_range``, or its default.

    The default runs from near zero to about twice the operating speed; its upper end has two digits.
    """
    given = pair.operating.speed_range
    if given is not None:
        return to_stated(given[0], "rpm"), to_stated(given[1], "rpm")
    top = 2.0 * operating_rpm(pair)
    digit = 10.0 ** (np.floor(np.log10(top)) - 1)
    top = min(float(np.ceil(top / digit * (1.0 - 1e-9)) * digit), LARGEST_SPEED)
    return 0.05 * top, top


def checked_range(field: str, speeds: tuple[float, float]) -> tuple[float, float]:
    """Slowest and fastest speed [rpm] that an argument gives.

    Raises
    ------
    ParameterError : no range of speeds
    """
    given = np.atleast_1d(real_array(field, speeds))
    if given.shape != (2,) or not 0.0 < given[0] < given[1] <= LARGEST_SPEED:
        allowed = f"slowest and fastest speed, 0 < low < high <= {LARGEST_SPEED:g} rpm"
        raise refuse(field, shown(speeds), allowed, "Give (low, high) in rpm.")
    return float(given[0]), float(given[1])


def chart_axes(pair: GearPair, speeds: int, dampings: int) -> dict[str, FloatArray]:
    """Nodes of the stability chart: so many speeds [rpm] and mesh damping ratios."""
    largest = min(max(0.08, 1.5 * pair.mesh.damping_ratio), 1.0)
    return {
        "speed_rpm": with_point(np.linspace(*speed_range(pair), speeds), operating_rpm(pair)),
        "damping_ratio": with_point(np.linspace(0.0, largest, dampings), pair.mesh.damping_ratio),
    }


def with_point(values: FloatArray, point: float) -> FloatArray:
    """Axis values with the node nearest to a point moved onto it, where the point is within the axis."""
    nodes = values.copy()
    if nodes.min() <= point <= nodes.max():
        nodes[np.argmin(np.abs(nodes - point))] = point
    return nodes
