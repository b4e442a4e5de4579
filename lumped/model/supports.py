"""What holds both gears: four springs, or elastic shafts; each gives coordinates, forces and powers.

Sources: docs/theory/equations.md, eqs. 6 to 9; docs/theory/shafts.md.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from lumped.model.equations import COORDINATES, Structure
from lumped.schema.pair import GearPair
from lumped.shafts.pair import shafted_pair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr

Form = Literal["full", "elastic", "mesh"]


@dataclass(frozen=True, eq=False)
class Coordinates:
    """Coordinates z of a form, z'' = -stiffness z - damping z' + reduction (f / mass) + torques T, SI.

    Attributes
    ----------
    names : (m,)
    gears : (6, m) rows that make the six coordinates of z, up to the common rotation
    reduction : (m, 6) takes accelerations of both gears by forces on them alone to those of z
    stiffness, damping, gyroscopic : (m, m) with the teeth apart; the last over the speed of the pinion, and
        part of the damping
    torques : (2, m) per unit T_p and T_g
    deflection : (m,) u with dynamic transmission error u . z
    """

    names: tuple[str, ...]
    gears: FloatArray
    reduction: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    gyroscopic: FloatArray
    torques: FloatArray
    deflection: FloatArray


class Supports(ABC):
    """What holds both gears, in the m coordinates of the form "full".

    Attributes
    ----------
    name : of the member
    places : where ``powers`` finds losses
    bearing_names : (b,)
    bearings : (b, 2, m) rows that make the displacement in each bearing along x and y
    bearing_stiffness, bearing_dampers : (b, 2) [N/m], [N s/m]
    relative, back : (m - 1, m) to coordinates without the common rotation, and (m, m - 1) a right inverse
    common, common_weights : (m,) the motion of the common rotation, and what it is measured by
    units : (m,) size of each coordinate where lengths are of order 1
    """

    name: ClassVar[str]
    places: ClassVar[tuple[str, ...]] = ("bearings",)
    bearing_names: tuple[str, ...]
    bearings: FloatArray
    bearing_stiffness: FloatArray
    bearing_dampers: FloatArray
    relative: FloatArray
    back: FloatArray
    common: FloatArray
    common_weights: FloatArray
    units: FloatArray

    @abstractmethod
    def coordinates(self, form: Form) -> Coordinates:
        """The equations of a form, teeth apart."""

    @abstractmethod
    def powers(self, rates: FloatArray) -> dict[str, FloatArray]:
        """Power that "bearings", and what else there is, take at rates (k, m), by place; (k,) [W]."""

    def labelled(self, run: xr.Dataset, states: FloatArray) -> xr.Dataset:
        """The result of states (k, 2m) with what these supports alone have."""
        return run.assign_attrs(supports=self.name)

    def bearing_forces(self, states: FloatArray) -> FloatArray:
        """Forces of the bearings on their shafts, (b, 2, k) [N], of states (k, 2m)."""
        both = self.bearing_stiffness, self.bearing_dampers
        by_state = np.concatenate([one[..., None] * self.bearings for one in both], axis=2)
        return np.asarray(-by_state @ states.T, dtype=np.float64)

    def forces_by_gear(self, states: FloatArray) -> dict[str, FloatArray]:
        """Coordinate x_p to y_g -> sum of the bearing forces of this gear along it (k,) [N]."""
        forces = self.bearing_forces(states)
        of_gear = np.array([name.startswith("gear") for name in self.bearing_names])
        own = (forces[~of_gear].sum(axis=0), forces[of_gear].sum(axis=0))
        return {COORDINATES[2 + 2 * d + which]: own[which][d] for d in (0, 1) for which in (0, 1)}


class Springs(Supports):
    """A spring and a damper of each gear along and off the line of action."""

    name = "springs"
    bearing_names = ("pinion", "gear")

    def __init__(self, pair: GearPair, s: Structure) -> None:
        g = pair.geometry
        self.structure = s
        self.bearings = np.zeros((2, 2, 6))
        self.bearings[[0, 1, 0, 1], [0, 0, 1, 1], [2, 3, 4, 5]] = 1.0
        self.bearing_stiffness = s.stiffness[2:].reshape(2, 2).T
        self.bearing_dampers = s.damping[2:].reshape(2, 2).T
        u = s.deflection[:2]
        self.relative = np.zeros((5, 6))
        self.back = np.zeros((6, 5))
        self.relative[0, :2] = u
        self.relative[1:, 2:] = np.eye(4)
        self.back[0, 0] = 1.0 / u[0]
        self.back[2:, 1:] = np.eye(4)
        self.units = np.array([1 / g.base_radius_pinion, 1 / g.base_radius_gear, 1.0, 1.0, 1.0, 1.0])
        self.common = self.units * [1.0, 1.0, 0.0, 0.0, 0.0, 0.0]
        self.common_weights = s.mass * self.common

    def coordinates(self, form: Form) -> Coordinates:
        """Both rotations, or q = r_bp theta_p - r_bg theta_g; y only where they are asked for."""
        s = self.structure
        m = {"full": 6, "elastic": 5, "mesh": 3}[form]
        if form == "full":
            names: tuple[str, ...] = COORDINATES
            reduction = np.eye(6)
            deflection = s.deflection
        else:
            names = ("q", "x_p", "x_g", "y_p", "y_g")[:m]
            reduction = self.relative[:m]
            deflection = np.array([1.0, 1.0, -1.0, 0.0, 0.0])[:m]
        # Bearings act on translations, which every form keeps as coordinates of their own.
        lift = np.asarray(np.linalg.pinv(reduction), dtype=np.float64)
        return Coordinates(
            names=names,
            gears=lift,
            reduction=reduction,
            stiffness=reduction @ np.diag(s.stiffness / s.mass) @ lift,
            damping=reduction @ np.diag(s.damping / s.mass) @ lift,
            gyroscopic=np.zeros((m, m)),
            torques=np.stack([reduction[:, 0] / s.mass[0], -reduction[:, 1] / s.mass[1]]),
            deflection=deflection,
        )

    def powers(self, rates: FloatArray) -> dict[str, FloatArray]:
        """What the four dampers take."""
        return {"bearings": np.einsum("km,m->k", rates**2, self.structure.damping)}


class Shafts(Supports):
    """Elastic shafts in their bearings, by their modes with the teeth apart; modal masses are 1."""

    name = "shafts"
    places = ("bearings", "shafts")

    def __init__(self, pair: GearPair, s: Structure) -> None:
        self.structure = s
        self.speed = pair.geometry.omega_pinion
        self.modes = modes = shafted_pair(pair)
        self.bearing_names = modes.bearing_names
        self.bearings = modes.bearings
        self.bearing_stiffness = modes.bearing_stiffness
        self.bearing_dampers = modes.bearing_dampers
        m = modes.frequencies.size
        self.relative = np.eye(m)[1:]
        self.back = np.eye(m)[:, 1:]
        self.common = self.common_weights = np.eye(m)[0]
        self.units = np.full(m, np.sqrt(s.mass[2]))

    def coordinates(self, form: Form) -> Coordinates:
        """All modes; without the common rotation but in "full", for gyroscopic moments couple y."""
        modes = self.modes
        kept = slice(0 if form == "full" else 1, None)
        gears = modes.gears[:, kept]
        return Coordinates(
            names=modes.names[kept],
            gears=gears,
            reduction=gears.T * self.structure.mass,
            stiffness=np.diag(modes.frequencies[kept] ** 2),
            damping=(modes.damping + self.speed * modes.gyroscopic)[kept, kept],
            gyroscopic=modes.gyroscopic[kept, kept],
            torques=np.stack([modes.torque_pinion[kept], modes.torque_gear[kept]]),
            deflection=modes.deflection[kept],
        )

    def powers(self, rates: FloatArray) -> dict[str, FloatArray]:
        """What the dashpots of the bearings, then the shafts with their couplings take."""
        inside = self.modes.modal_damping + self.modes.coupling_damping
        taken = {"bearings": self.modes.bearing_damping, "shafts": inside}
        return {place: np.sum((rates @ c) * rates, axis=1) for place, c in taken.items()}

    def labelled(self, run: xr.Dataset, states: FloatArray) -> xr.Dataset:
        """With the force of every bearing on its shaft."""
        forces = self.bearing_forces(states)
        variable = ("bearing", "direction", "time"), forces, {"units": "N", "long_name": "force on the shaft"}
        run = super().labelled(run, states).assign(bearing_force=variable)
        return run.assign_coords(bearing=list(self.bearing_names), direction=["loa", "oloa"])


#: Name of the argument ``supports`` -> what it stands for.
SUPPORTS: dict[str, type[Springs] | type[Shafts]] = {kind.name: kind for kind in (Springs, Shafts)}
