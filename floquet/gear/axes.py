"""What a stability chart of a gear pair can vary: units, how the pair changes, and the range to show.

Friction changes with speed: speeds over which one fit serves, with factors, are a family.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np
import numpy.typing as npt

from floquet.engine.chart import Axes, ChartAxis, checked_axes
from lumped.arguments import one_of, real_array
from lumped.errors import refuse, shown
from lumped.fields.units import SIValue, to_stated
from lumped.friction import mean_coefficient
from lumped.friction.average_coefficient import longer_path, without_factor
from lumped.friction.base import PITCH_RESOLUTION, ContactPath, FrictionLaw, FrictionSettings
from lumped.friction.benedict_kelley import LAW as BENEDICT_KELLEY
from lumped.friction.registry import law_of
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import AnySupports, Supports, supports_of
from lumped.path_of_contact.friction import coefficient_for, contact_path, fit_law, violations_of
from lumped.ranges import warn_violations
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import LARGEST_SPEED, GearPair
from lumped.typing import FloatArray, IntArray

_POSITIONS = 8
# Agreement along the path, relative to mu: rounding of the laws, far below the 1e-10 to which mu is fitted.
_SAME = 1e-12


@dataclass(frozen=True)
class GearVariation:
    """A gear pair with the variations of a chart.

    Attributes
    ----------
    pair : the validated pair
    friction_mean : wanted mean of |mu| over the path; None: as the law gives it
    stiffness_variation : factor on the variation of the total mesh stiffness about its mean over the cycle
    supports : "springs", the pair's ``bearings``, its "shafts", or "rigid" bearings
    """

    pair: GearPair
    friction_mean: float | None = None
    stiffness_variation: float = 1.0
    supports: AnySupports = field(kw_only=True)

    @classmethod
    def of(cls, source: AnyPair | GearVariation, supports: Supports | None = None) -> GearVariation:
        """Return the variation of a pair without any change. A variation is returned unchanged.

        The default supports of a pair are the shafts, if the pair has shafts. A variation already has
        supports; other supports are refused.
        """
        if not isinstance(source, GearVariation):
            pair = load_gear_pair(source)
            return cls(pair, supports=supports_of(pair, supports))
        if supports not in (None, source.supports):
            allowed = f'"{source.supports}", those of the variation'
            raise refuse("supports", supports, allowed, "Leave them out, or give the pair.")
        return source

    @property
    def friction_scale(self) -> float:
        """Factor on the friction law of the pair for the mean coefficient ``friction_mean``."""
        if self.friction_mean is None:
            return 1.0
        mean = mean_coefficient(MeshCycle.of(self.pair).elements.friction)
        if mean == 0.0:
            allowed = "a law that is not zero along the whole path"
            action = 'Choose friction.law = "coulomb".'
            raise refuse("friction_coefficient", self.friction_mean, allowed, action)
        return self.friction_mean / mean

    def cycle(self) -> MeshCycle:
        """Mesh cycle, with the friction law scaled."""
        cycle = MeshCycle.of(self.pair)
        if self.friction_mean is None:
            return cycle
        scaled = cycle.elements.friction.scaled(self.friction_scale)
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
    return lambda variation, value: replace(variation, pair=variation.pair.with_(dict.fromkeys(paths, value)))


def _bearings(variation: GearVariation, value: float) -> GearVariation:
    """One stiffness of all four springs. The springs must hold the gears."""
    _check_springs(variation.supports)
    return _SPRINGS(variation, value)


def _friction(variation: GearVariation, value: float) -> GearVariation:
    """Mean coefficient: a parameter of some laws, a scale of all other laws."""
    law = variation.pair.friction.law
    if law == "none":
        law = "coulomb"
        variation = replace(variation, pair=variation.pair.with_({"friction.law": law}))
    if law_of(variation.pair.friction).coefficient:
        coefficient = coefficient_for(variation.pair, value)
        return replace(variation, pair=variation.pair.with_({"friction.coefficient": coefficient}))
    return replace(variation, friction_mean=value)


def _contact_ratio(variation: GearVariation, value: float) -> GearVariation:
    """Set the contact ratio by both tip diameters. Approach and recess keep the same shares of the path.

    The path of contact ends where the tip circles cut the line of action: r_ap^2 = r_bp^2 + L_XD^2 and
    r_ag^2 = r_bg^2 + (L_XY - L_XA)^2. A relief moves with the end of the active flank and keeps the length.
    """
    pair = variation.pair
    g = pair.geometry
    factor = value / g.contact_ratio
    recess = g.L_XP + factor * (g.L_XD - g.L_XP)
    approach = g.L_XY - g.L_XP + factor * (g.L_XP - g.L_XA)
    later = recess - g.L_XD
    earlier = approach - (g.L_XY - g.L_XA)
    changes: dict[str, object] = {}
    for name, gear, radius, flank, tip, root in (
        ("pinion", pair.pinion, g.base_radius_pinion, recess, later, -earlier),
        ("gear", pair.gear, g.base_radius_gear, approach, earlier, -later),
    ):
        changes[f"{name}.tip_diameter"] = 2e3 * math.hypot(radius, flank)
        for end, relief, shift in (("tip", gear.tip_relief, tip), ("root", gear.root_relief, root)):
            if relief is not None:
                start = relief.start_roll_angle + shift / radius
                changes[f"{name}.{end}_relief.start_roll_angle"] = SIValue(start, "rad")
    return replace(variation, pair=pair.with_(changes))


def _variation(variation: GearVariation, value: float) -> GearVariation:
    return replace(variation, stiffness_variation=value)


def operating_rpm(pair: GearPair) -> float:
    """Operating speed of the pinion [rpm]."""
    return float(pair.operating.pinion_speed * 30.0 / np.pi)


_SPRINGS = _field(*(f"bearings.{g}.{d}_stiffness" for g in ("pinion", "gear") for d in ("loa", "oloa")))
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
        lambda pair: mean_coefficient(MeshCycle.of(pair).elements.friction), low=0.0, high=1.0,
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
        "N/m", "stiffness of all bearings, LOA and OLOA", _bearings,
        lambda pair: pair.bearings.pinion.loa_stiffness, low=0.0, open_low=True,
    ),
}  # fmt: skip
"""Axis name -> axis."""


def gear_grid(axes: Axes, supports: AnySupports) -> dict[str, FloatArray]:
    """Axes of gear-pair parameters as 1-D arrays, or the refusal of names, values or supports."""
    grid = checked_axes(axes)
    for name, values in grid.items():
        GEAR_AXES[one_of("axes", name, GEAR_AXES)].check(name, values)
    if "bearing_stiffness" in grid:
        _check_springs(supports)
    return grid


def _check_springs(supports: AnySupports) -> None:
    """Refuse to vary springs that hold nothing."""
    if supports == "rigid":
        action = "Take the chart of the pair on springs: stability_chart(pair, axes)."
        raise refuse("axes", "bearing_stiffness", "not on rigid bearings", action)
    if supports == "shafts":
        action = 'Set shafts.pinion.bearings.1.loa_stiffness and so on, or give supports="springs".'
        raise refuse("axes", "bearing_stiffness", "not with shafts", action)


def vary(
    pair: GearPair | GearVariation, point: Mapping[str, float], supports: Supports | None = None
) -> GearVariation:
    """Return the pair at one point of a chart."""
    variation = GearVariation.of(pair, supports)
    for name, value in point.items():
        variation = GEAR_AXES[name].apply(variation, value)
    return variation


def speed_range(pair: GearPair) -> tuple[float, float]:
    """Pinion speeds [rpm] that charts, sweeps and margins cover: ``operating.speed_range`` or a default.

    The default range is from near zero to about twice the operating speed, rounded to two digits.
    """
    request = pair.operating.speed_range
    if request is not None:
        return to_stated(request[0], "rpm"), to_stated(request[1], "rpm")
    top = 2.0 * operating_rpm(pair)
    digit = 10.0 ** (np.floor(np.log10(top)) - 1)
    top = min(float(np.ceil(top / digit * (1.0 - 1e-9)) * digit), LARGEST_SPEED)
    return 0.05 * top, top


def checked_range(field: str, speeds: tuple[float, float]) -> tuple[float, float]:
    """Slowest and fastest speed [rpm] of an argument; anything else is refused."""
    request = np.atleast_1d(real_array(field, speeds))
    if request.shape != (2,) or not 0.0 < request[0] < request[1] <= LARGEST_SPEED:
        allowed = f"slowest and fastest speed, 0 < low < high <= {LARGEST_SPEED:g} rpm"
        raise refuse(field, shown(speeds), allowed, "Give (low, high) in rpm.")
    return float(request[0]), float(request[1])


def chart_axes(pair: GearPair, speeds: int = 801, dampings: int = 201) -> dict[str, FloatArray]:
    """Nodes of the stability chart: numbers of speeds [rpm] and of mesh damping ratios."""
    largest = min(max(0.08, 1.5 * pair.mesh.damping_ratio), 1.0)
    return {
        "speed_rpm": with_point(np.linspace(*speed_range(pair), speeds), operating_rpm(pair)),
        "damping_ratio": with_point(np.linspace(0.0, largest, dampings), pair.mesh.damping_ratio),
    }


def with_point(values: FloatArray, point: float) -> FloatArray:
    """Axis values with the node nearest to a point moved onto this point, if the point is within the axis."""
    nodes = values.copy()
    if nodes.min() <= point <= nodes.max():
        nodes[np.argmin(np.abs(nodes - point))] = point
    return nodes


@dataclass(frozen=True, eq=False)
class FrictionFamily:
    """Speeds at which mu is a weighted sum of two functions of the position.

    Attributes
    ----------
    speed_rpm : the speed whose friction law is the reference
    members : (k,) indices of the speeds
    level : |mu| of the second function, which only changes sign at the pitch point; None: there is none
    factors : (k, 1) of mu at the reference speed; or (k, 2) of mu less the level, and of the level
    law : the law at other speeds; None: the law is the same at all speeds
    """

    speed_rpm: float
    members: npt.NDArray[np.intp]
    level: float | None
    factors: FloatArray
    law: LawOverSpeed | None

    def factors_at(self, speeds_rpm: FloatArray) -> FloatArray | None:
        """Factors (k, 1 or 2) at further speeds; None: some of these speeds are not of the family."""
        if self.law is None:
            return np.ones((speeds_rpm.size, 1))
        members, weights = self.law.weights(self.speed_rpm, speeds_rpm)
        if members.size < speeds_rpm.size or (self.level is None and weights[:, 1].any()):
            return None
        return self.law.factors(self.speed_rpm, self.level is not None, weights)

    def smooth_groups(self, speeds_rpm: FloatArray) -> IntArray:
        """Number (k,) of the group of each speed; the speeds increase. Factors are smooth within a group.

        The mean coefficient of laws I and IV is the mean of law II. This mean is linear in the logarithm of
        speed as long as the bounds of law II do not move. Factors of other laws are smooth at all speeds.
        """
        if self.law is None or not self.law.mean_is_of_law_two(self.speed_rpm):
            return np.zeros(speeds_rpm.size, dtype=np.int64)
        law_two = self.law.law_two()
        start = float(speeds_rpm[0])
        begins_group = np.zeros(speeds_rpm.size, dtype=bool)
        for k, rpm in enumerate(map(float, speeds_rpm)):
            if not law_two.shifts_alone(start, rpm):
                begins_group[k] = True
                start = rpm
        return np.cumsum(begins_group)


def depends_on_speed(pair: GearPair) -> bool:
    """Whether mu(xi) changes with speed. Only a constant law with a given coefficient does not change."""
    return not law_of(pair.friction).is_constant(pair.friction)


def friction_families(variation: GearVariation, speeds_rpm: FloatArray) -> list[FrictionFamily]:
    """Group different speeds (k,) into families. Friction needs only one fit for a family.

    Speed scales law III, and laws I and IV through the mean coefficient. Speed adds a constant to law II, a
    logarithm, as long as the bounds of this law do not move. Law V is one of these laws where one regime
    covers the whole path. Laws II and V are also evaluated along the path at every speed, and the switches
    are compared.
    """
    pair = variation.pair
    rest = np.arange(speeds_rpm.size)
    if not depends_on_speed(pair):
        for rpm in {speeds_rpm.min(), speeds_rpm.max()}:  # a table is for one speed
            path = contact_path(pair).at_speed(float(rpm) * np.pi / 30.0)
            warn_violations(violations_of(path, pair.friction, pair.friction.law))
        return [FrictionFamily(operating_rpm(pair), rest, None, np.ones((rest.size, 1)), None)]
    law = LawOverSpeed.of(variation)
    families = []
    while rest.size:
        reference = float(speeds_rpm[rest[rest.size // 2]])
        members, weights = law.weights(reference, speeds_rpm[rest])
        apart = bool(weights[:, 1].any())
        level = (variation.friction_mean or law.mean(reference)) if apart else None
        factors = law.factors(reference, apart, weights)
        families.append(FrictionFamily(reference, rest[members], level, factors, law))
        rest = np.delete(rest, members)
    return families


class LawOverSpeed:
    """The friction law of a pair at other speeds than the operating speed."""

    def __init__(
        self,
        path: ContactPath,
        ends: tuple[float, float],
        settings: FrictionSettings,
        law: FrictionLaw,
        *,
        to_mean: bool,
    ) -> None:
        self.path = path
        self.settings = settings
        self.law = law
        self.to_mean = to_mean
        self.ends = ends
        self.positions = _positions(replace(self.path, L_XA=self.ends[0], L_XD=self.ends[1]))
        self.values = cache(self._values)
        self.at = cache(self._at)

    @classmethod
    def of(cls, variation: GearVariation) -> LawOverSpeed:
        """The law of a variation, over the positions of loaded teeth."""
        settings = variation.pair.friction
        ends = MeshCycle.of(variation.pair).elements.friction.interval
        to_mean = variation.friction_mean is not None
        return cls(contact_path(variation.pair), ends, settings, law_of(settings), to_mean=to_mean)

    def mean_is_of_law_two(self, reference: float) -> bool:
        """Whether mu changes with speed by the mean coefficient, and this is the mean of law II."""
        law = self.in_force(reference)
        return law is not None and law.coefficient and self.settings.coefficient is None and not self.to_mean

    def law_two(self) -> LawOverSpeed:
        """Law II from A to D, where its mean is taken, and as the mean is taken: without a factor."""
        ends = self.path.L_XA, self.path.L_XD
        return LawOverSpeed(without_factor(self.path), ends, self.settings, BENEDICT_KELLEY, to_mean=False)

    def shifts_alone(self, reference: float, rpm: float) -> bool:
        """Whether mu at a speed is mu at a reference speed, apart from a factor and a constant."""
        return self._pair(self.in_force(reference), reference, rpm) is not None

    def _at(self, rpm: float) -> ContactPath:
        return self.path.at_speed(rpm * np.pi / 30.0)

    def in_force(self, rpm: float) -> FrictionLaw | None:
        """The law in force on the whole path; None: several laws are in force.

        A law may consist of several laws for parts of the path: then one of the parts is in force.
        """
        if self.law.parts is None:
            return self.law
        parts = self.law.parts(self.positions, self.at(rpm), self.settings)
        used = [part for part, inside in parts if inside.any()]
        return used[0] if len(used) == 1 else None

    def _values(self, rpm: float) -> tuple[FloatArray, FloatArray]:
        """Mu at the positions, and the positions of the switches of mu, at a speed."""
        there, settings = self.where_friction_acts(rpm)
        mu = self.law.signed(self.positions, there, settings)
        return mu, np.sort(self.law.switches(there, settings))

    def where_friction_acts(self, rpm: float) -> tuple[ContactPath, FrictionSettings]:
        """The contact at a speed from the first to the last position of loaded teeth, and settings there."""
        return longer_path(self.at(rpm), self.ends, self.law, self.settings), self.settings

    def weights(self, reference: float, speeds_rpm: FloatArray) -> tuple[npt.NDArray[np.intp], FloatArray]:
        """Speeds (k,) at which mu = a mu_reference + b sign(xi - L_XP), and the weights a, b (k, 2)."""
        law = self.in_force(reference)
        members = []
        result = []
        for i, rpm in enumerate(map(float, speeds_rpm)):
            weights = self._pair(law, reference, rpm)
            if weights is not None:
                members.append(i)
                result.append(weights)
        return np.array(members, dtype=np.intp), np.array(result).reshape(-1, 2)

    def _pair(self, law: FrictionLaw | None, reference: float, rpm: float) -> tuple[float, float] | None:
        """Weights a and b of `weights` at one speed; None: mu is not this sum.

        By the formula of the law in force alone.
        """
        if rpm == reference:
            return 1.0, 0.0
        if law is None or self.in_force(rpm) is not law:
            return None
        reference_path = self.at(reference)
        path = self.at(rpm)
        if law.factor is not None:
            unit = law.factor(reference_path, self.settings)
            weights = law.factor(path, self.settings) / unit if unit else 1.0, 0.0
        elif law.shift is not None:
            weights = 1.0, law.rise(path, self.settings) - law.rise(reference_path, self.settings)
        else:
            return None
        if law.factor is not None and law is self.law:
            return weights
        # The formula holds as long as no switch moves.
        mu, switches = self.values(reference)
        mu_at_speed, switches_at_speed = self.values(rpm)
        expected = weights[0] * mu + weights[1] * np.sign(self.positions - self.path.L_XP)
        same = switches.shape == switches_at_speed.shape and np.allclose(
            switches, switches_at_speed, 0.0, _SAME * self.path.L_XY
        )
        return (
            weights
            if same and np.abs(expected - mu_at_speed).max() <= _SAME * np.abs(mu_at_speed).max()
            else None
        )

    def factors(self, reference: float, apart: bool, weights: FloatArray) -> FloatArray:
        """Factors of mu, or of mu less its mean and of the mean, from the weights of mu and of the sign.

        mu = a mu_0 + b sign = a (mu_0 - mean sign) + (a + b/mean) (mean sign)
        """
        a, b = weights.T
        if self.to_mean:  # the law is scaled to one mean, whatever the speed
            mean = self.mean(reference)
            a, b = weights.T * (mean / (a * mean + b))
        return np.stack([a, a + b / self.mean(reference)], axis=1) if apart else a[:, None]

    def mean(self, reference: float) -> float:
        """Mean of |mu| where friction acts, as in ``GearVariation.friction_scale``."""
        return mean_coefficient(fit_law(*self.where_friction_acts(reference), self.law.name))


def _positions(path: ContactPath) -> FloatArray:
    """Positions on either side of P, from where laws are held constant to the ends of the path."""
    sides = []
    for reach in (path.L_XA - path.L_XP, path.L_XD - path.L_XP):
        near = np.geomspace(math.copysign(0.5 * PITCH_RESOLUTION, reach), 0.1 * reach, _POSITIONS)
        sides += [near, np.linspace(0.1 * reach, reach, _POSITIONS + 2)[1:-1]]
    return path.L_XP + np.concatenate(sides)
