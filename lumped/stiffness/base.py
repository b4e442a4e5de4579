"""What every stiffness model shares: what it reads of a gear pair, and the section of the parameter file.

Sources: docs/theory/mesh_physics.md, "Stiffness of a tooth pair".
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Protocol

from lumped.fields.section import Section
from lumped.gear_geometry.geometry import Geometry, Wheel
from lumped.path_function import PathFunction
from lumped.ranges import RangeViolation


class Material(Protocol):
    """Material of one gear, fields of ``pinion`` and ``gear`` in a parameter file.

    Attributes
    ----------
    youngs_modulus, poisson_ratio : E [Pa], nu [-]
    """

    youngs_modulus: float
    poisson_ratio: float


class Operation(Protocol):
    """Operating point, the fields of ``operating``.

    Attributes
    ----------
    pinion_torque : torque driving the pinion [N m]
    """

    pinion_torque: float


class MeshingPair(Protocol):
    """What stiffness models read of a gear pair; a ``GearPair`` has it all."""

    @property
    def pinion(self) -> Material:
        """Material of the driving gear."""

    @property
    def gear(self) -> Material:
        """Material of the driven gear."""

    @property
    def wheels(self) -> tuple[Wheel, Wheel]:
        """Pinion and gear as the basic rack cuts them."""

    @property
    def operating(self) -> Operation:
        """Operating point."""

    @property
    def geometry(self) -> Geometry:
        """Geometry of the pair."""


class StiffnessModel(Section):
    """Base of the stiffness models: the section ``mesh.stiffness`` with the curve that it stands for."""

    @abstractmethod
    def curve(self, pair: MeshingPair) -> PathFunction:
        """Stiffness k_i(xi) of one tooth pair from A to D [N/m].

        Raises
        ------
        ParameterError : the model's parameters do not fit this pair
        """

    def violations(self, pair: MeshingPair) -> tuple[RangeViolation, ...]:
        """Validity ranges that a gear pair leaves under this model.

        They are returned, not warned about: ordinary gears leave the fit of the fillet foundation, and a
        warning at every evaluation of a sweep would hide the others. The report lists them.
        """
        return ()

    def neighbours(self, pair: MeshingPair) -> tuple[PathFunction, ...]:
        """How far a unit load on a pair moves the pair m base pitches ahead, m = 1, 2, ... [m/N].

        Functions of the position of the pair behind; none for stiffness in which pairs stand alone.
        """
        return ()

    def softening(self, pair: MeshingPair) -> float:
        """How the compliance of a pair falls with load: D in 1/k(T) = 1/k(T_0) - D ln(T/T_0) [m/N].

        0 for stiffness that does not depend on the load.
        """
        return 0.0
