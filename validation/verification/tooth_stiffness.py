"""Is the stiffness of the teeth right? Beams and standard beside plane elasticity of the same gears.

Both models of the dynamics take k from one place, so their agreement says nothing about it. Plane finite
elements of the gears share the outline of the teeth with the other ways to k and no formula.

Sources: docs/theory/elasticity.md, "The gate".
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lumped import GearPair, plane_compliance
from lumped.labelling import labelled_dataset
from lumped.stiffness import iso6336
from lumped.stiffness.elastic_teeth import alone, elastic_teeth, pair_error
from lumped.stiffness.energy import energy_curve
from lumped.typing import FloatArray
from validation.verification.checks import Check, check

if TYPE_CHECKING:
    import xarray as xr

#: Root over bore radius of the clamped, untwisted ring that the energy method's foundation stands for.
_RING = 4.0
#: Energy stiffness over the elastic one at nu = 0.3, and its growth with nu: the foundation's fit has no nu.
_EXPECTED, _PER_POISSON = 0.955, 0.22
#: Loads per face width of steel between which ISO 6336-1's stiffness does not depend on the load [N/m].
_LOADS = (100e3, 1600e3)
#: Mean stiffness of the pair's own model over the elastic one: what no usual gear pair leaves.
PLAUSIBLE = (0.7, 1.35)
_STEEL = 206e9  # [Pa]
#: Half tooth angle on the root circle below which the foundation is not fitted [rad].
_NARROWEST = 0.01
_POINTS = 101


@dataclass(frozen=True)
class Stiffness:
    """Stiffness of the teeth by one way.

    Attributes
    ----------
    name, counted : of the way, and what its deflections count from
    largest, mean : of a pair alone, and of the mesh over the cycle [N/m]
    single_ratio, mean_ratio : over c' and c_gamma of ISO 6336-1 times face width [-]
    elastic_ratio : mean over that by elasticity on the energy method's ring [-]
    """

    name: str
    counted: str
    largest: float
    mean: float
    single_ratio: float
    mean_ratio: float
    elastic_ratio: float


@dataclass(frozen=True, eq=False)
class ToothStiffness:
    """Stiffness of a gear pair by all ways.

    Attributes
    ----------
    curves : ``stiffness`` of a pair alone over ``way`` and ``position`` [N/m]
    ways : its largest value and mean
    own : ratio of the pair's own model to elasticity on the ring, mean values [-]
    checks : what must hold whatever the pair's own model is
    error : of the elastic compliance, from two meshes [-]
    warnings : what the elastic stiffness does not hold for
    """

    curves: xr.Dataset
    ways: tuple[Stiffness, ...]
    own: float
    checks: tuple[Check, ...]
    error: float
    warnings: tuple[str, ...]

    @property
    def passes(self) -> bool:
        """Whether every check passes."""
        return all(check.passes for check in self.checks)

    @property
    def plausible(self) -> bool:
        """Whether the own model is near elasticity."""
        return PLAUSIBLE[0] <= self.own <= PLAUSIBLE[1]


def tooth_stiffness(pair: GearPair) -> ToothStiffness:
    """Compare the ways to the stiffness of a gear pair.

    Parameters
    ----------
    pair : a validated gear pair

    Raises
    ------
    ParameterError, NumericalError : a way does not apply to this pair
    """
    g = pair.geometry
    xi = np.linspace(g.L_XA, g.L_XD, _POINTS + 2)[1:-1]
    ring = elastic_teeth(pair, support="untwisted", bore=_RING)
    free = plane_compliance(pair, phases=1).attrs
    model = pair.mesh.stiffness
    curves = {
        "elastic, energy method's ring": 1.0 / alone(pair, ring, xi),
        "elastic, free gears": 1.0 / alone(pair, elastic_teeth(pair), xi),
        "energy method": energy_curve(pair)(xi),
        f"this report: {model.model}": model.curve(pair)(xi),
    }
    elastic, _, energy, own = curves.values()
    iso = iso6336.single_of(pair), iso6336.mean_of(pair)
    path = g.contact_ratio

    def way(name: str, counted: str, largest: float, mean: float) -> Stiffness:
        return Stiffness(
            name,
            counted,
            largest,
            mean,
            largest / iso[0],
            mean / iso[1],
            mean / (path * float(elastic.mean())),
        )

    names, on_ring = list(curves), "bore of a ring, without its twist"
    ways = (
        way(names[0], on_ring, float(elastic.max()), path * float(elastic.mean())),
        way(names[1], "mean motion of the gears", free["largest_alone"], free["mean_alone"]),
        way(f"{names[1]}, with neighbours", "mean motion of the gears", free["largest_alone"], free["mean"]),
        way(names[2], on_ring, float(energy.max()), path * float(energy.mean())),
        way("ISO 6336-1, method B", "measurements", *iso),
        way(names[3], "", float(own.max()), path * float(own.mean())),
    )
    return ToothStiffness(
        curves=_dataset(curves, xi),
        ways=ways,
        own=float(own.mean() / elastic.mean()),
        checks=(*_energy(pair, float(np.mean(energy / elastic))), _standard(pair, iso[1], xi)),
        error=float(pair_error(pair, ring, xi).max()),
        warnings=tuple(free["range_warnings"]),
    )


def _energy(pair: GearPair, ratio: float) -> Iterator[Check]:
    narrow = min(wheel.tooth.root_half_angle for wheel in pair.wheels) < _NARROWEST
    if narrow and pair.mesh.stiffness.model != "energy":
        return  # the foundation's fit goes to infinity there, which harms this model only
    poisson = 0.5 * (pair.pinion.poisson_ratio + pair.gear.poisson_ratio)
    expected = _EXPECTED + _PER_POISSON * (poisson - 0.3)
    yield check("energy_elastic", abs(ratio - expected), ratio=f"{ratio:.3f}", expected=f"{expected:.3f}")


def _standard(pair: GearPair, mean: float, xi: FloatArray) -> Check:
    g = pair.geometry
    # Softer gears dent alike under loads that are smaller as their moduli.
    modulus = 2.0 / (1.0 / pair.pinion.youngs_modulus + 1.0 / pair.gear.youngs_modulus)
    lever = g.reference_radius_pinion * g.face_width * modulus / _STEEL
    torque = min(max(pair.operating.pinion_torque, _LOADS[0] * lever), _LOADS[1] * lever)
    loaded = pair.with_(operating__pinion_torque=torque)
    elastic = 1.0 / alone(loaded, elastic_teeth(pair, support="untwisted", bore=_RING), xi)
    ratio = mean / (g.contact_ratio * float(elastic.mean()))
    return check("standard_elastic", abs(ratio - 1.0), ratio=f"{ratio:.3f}")


def _dataset(curves: dict[str, FloatArray], xi: FloatArray) -> xr.Dataset:
    return labelled_dataset(
        {
            "stiffness": (
                ("way", "position"),
                np.stack(list(curves.values())),
                "N/m",
                "stiffness of a tooth pair alone",
            )
        },
        {
            "way": (list(curves), "1", "way to the stiffness"),
            "position": (xi, "m", "position from X along the line of action"),
        },
        {},
    )
