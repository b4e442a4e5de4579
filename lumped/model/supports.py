"""The supports of both gears: four springs, elastic shafts, or rigid bearings.

Each gives coordinates, forces and powers.

Sources: docs/theory/equations.md, eqs. 6 to 9 and "One degree of freedom"; docs/theory/shafts.md.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from lumped.model.equations import COORDINATES, X_P, Structure
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
    gears : (6, m) from z to the six coordinates, up to the common rotation
    reduction : (m, 6) from accelerations of both gears by forces on the gears to accelerations of z
    stiffness, damping : (m, m) with the teeth apart
    gyroscopic : (m, m) gyroscopic part of the damping, over the speed of the pinion
    torques : (2, m) accelerations per unit T_p and T_g
    deflection : (m,) u, with the dynamic transmission error u . z
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
    """The supports of both gears, in the m coordinates of the form "full".

    Attributes
    ----------
    name : value of the argument ``supports``
    places : names of the losses of ``powers``
    bearing_names : (b,)
    bearings : (b, 2, m) from z to the displacement in each bearing along x and y
    bearing_stiffness, bearing_dampers : (b, 2) [N/m], [N s/m]
    relative : (m - 1, m) from z to coordinates without the common rotation
    back : (m, m - 1) a right inverse of ``relative``
    common : (m,) motion of the common rotation
    common_weights : (m,) weights whose scalar product with z measures the common rotation
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

    @cached_property
    def to_relative_states(self) -> FloatArray:
        """Matrix (2m - 2, 2m) from states z, z' to states without the common rotation."""
        return np.asarray(np.kron(np.eye(2), self.relative), dtype=np.float64)

    @cached_property
    def from_relative_states(self) -> FloatArray:
        """Matrix (2m, 2m - 2) back to all states; the common rotation becomes 0."""
        return np.asarray(np.kron(np.eye(2), self.back), dtype=np.float64)

    @abstractmethod
    def coordinates(self, form: Form) -> Coordinates:
        """Return the equations of a form, with the teeth apart."""

    @abstractmethod
    def powers(self, rates: FloatArray) -> dict[str, FloatArray]:
        """Losses at rates (k, m), by the names of ``places``; each (k,) [W]."""

    def labelled(self, run: xr.Dataset, states: FloatArray) -> xr.Dataset:
        """Return the result of states (k, 2m) with the variables that only these supports have."""
        return run.assign_attrs(supports=self.name)

    def bearing_forces(self, states: FloatArray) -> FloatArray:
        """Forces of the bearings on their shafts, (b, 2, k) [N], of states (k, 2m)."""
        both = self.bearing_stiffness, self.bearing_dampers
        by_state = np.concatenate([one[..., None] * self.bearings for one in both], axis=2)
        return np.asarray(-by_state @ states.T, dtype=np.float64)

    def forces_by_gear(self, states: FloatArray) -> dict[str, FloatArray]:
        """Sum of the bearing forces of a gear along each coordinate x_p to y_g; (k,) [N]."""
        forces = self.bearing_forces(states)
        of_gear = np.array([name.startswith("gear") for name in self.bearing_names])
        by_gear = (forces[~of_gear].sum(axis=0), forces[of_gear].sum(axis=0))
        return {COORDINATES[2 + 2 * d + gear]: by_gear[gear][d] for d in (0, 1) for gear in (0, 1)}


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
        """Return the equations: "full" has both rotations, the others q = r_bp theta_p - r_bg theta_g."""
        s = self.structure
        m = {"full": 6, "elastic": 5, "mesh": 3}[form]
        if form == "full":
            names: tuple[str, ...] = COORDINATES
            reduction = lift = np.eye(6)
            deflection = s.deflection
        else:
            names = ("q", "x_p", "x_g", "y_p", "y_g")[:m]
            reduction = self.relative[:m]
            deflection = np.array([1.0, 1.0, -1.0, 0.0, 0.0])[:m]
            # Bearings act on translations. Every translation of the form is a coordinate.
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
        """Loss of the four dampers."""
        return {"bearings": np.einsum("km,m->k", rates**2, self.structure.damping)}


class Shafts(Supports):
    """Elastic shafts in their bearings, as modes with the teeth apart; modal masses are 1."""

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
        self.units = np.full(m, np.sqrt(s.mass[X_P]))

    def coordinates(self, form: Form) -> Coordinates:
        """Return the equations of all modes. Only "full" has the common rotation."""
        modes = self.modes
        shown = slice(0 if form == "full" else 1, None)
        gears = modes.gears[:, shown]
        return Coordinates(
            names=modes.names[shown],
            gears=gears,
            reduction=gears.T * self.structure.mass,
            stiffness=np.diag(modes.frequencies[shown] ** 2),
            damping=(modes.damping + self.speed * modes.gyroscopic)[shown, shown],
            gyroscopic=modes.gyroscopic[shown, shown],
            torques=np.stack([modes.torque_pinion[shown], modes.torque_gear[shown]]),
            deflection=modes.deflection[shown],
        )

    def powers(self, rates: FloatArray) -> dict[str, FloatArray]:
        """Losses of the dashpots of the bearings, and of the shafts with their couplings."""
        inside = self.modes.modal_damping + self.modes.coupling_damping
        taken = {"bearings": self.modes.bearing_damping, "shafts": inside}
        return {place: np.sum((rates @ c) * rates, axis=1) for place, c in taken.items()}

    def labelled(self, run: xr.Dataset, states: FloatArray) -> xr.Dataset:
        """Return the result with the force of every bearing on its shaft."""
        forces = self.bearing_forces(states)
        variable = ("bearing", "direction", "time"), forces, {"units": "N", "long_name": "force on the shaft"}
        run = super().labelled(run, states).assign(bearing_force=variable)
        return run.assign_coords(bearing=list(self.bearing_names), direction=["loa", "oloa"])


class Rigid(Supports):
    """Rigid bearings: the gears turn and do not move sideways. One degree of freedom beside the rotation."""

    name = "rigid"
    bearing_names = ()

    def __init__(self, pair: GearPair, s: Structure) -> None:
        del pair
        self.structure = s
        self.bearings = np.zeros((0, 2, 2))
        self.bearing_stiffness = self.bearing_dampers = np.zeros((0, 2))
        radii = s.deflection[:2]
        self.relative = radii[None]
        self.back = np.array([[1.0 / radii[0]], [0.0]])
        self.units = 1.0 / np.abs(radii)
        self.common = self.units
        self.common_weights = s.mass[:2] * self.common

    def coordinates(self, form: Form) -> Coordinates:
        """Return the equations: "full" has both rotations, the others q = r_bp theta_p - r_bg theta_g."""
        s = self.structure
        rotations = np.eye(2, 6)
        reduction = rotations if form == "full" else self.relative @ rotations
        m = len(reduction)
        return Coordinates(
            names=COORDINATES[:2] if form == "full" else ("q",),
            gears=rotations.T if form == "full" else rotations.T @ self.back,
            reduction=reduction,
            stiffness=np.zeros((m, m)),
            damping=np.zeros((m, m)),
            gyroscopic=np.zeros((m, m)),
            torques=np.stack([reduction[:, 0] / s.mass[0], -reduction[:, 1] / s.mass[1]]),
            deflection=s.deflection[:2] if form == "full" else np.ones(1),
        )

    def forces_by_gear(self, states: FloatArray) -> dict[str, FloatArray]:
        """No entry: forces of rigid bearings do not follow from displacements, which are zero."""
        del states
        return {}

    def powers(self, rates: FloatArray) -> dict[str, FloatArray]:
        """No loss."""
        return {"bearings": np.zeros(len(rates))}


#: Name of the supports -> their class.
SUPPORTS: dict[str, type[Springs] | type[Shafts] | type[Rigid]] = {
    kind.name: kind for kind in (Springs, Shafts, Rigid)
}
