"""How simultaneous tooth pairs share the load.

Sources: docs/theory/mesh_physics.md, "Load sharing and static transmission error" and "Losses".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from lumped.arguments import one_of
from lumped.losses.cycle import CyclePositions
from lumped.path_function import PathFunction
from lumped.path_of_contact import pair_stiffness
from lumped.quasi_static.contacts import mesh_elements
from lumped.quasi_static.prescribed import loaded_mesh
from lumped.typing import FloatArray

if TYPE_CHECKING:
    from lumped.schema.pair import GearPair

_KINDS = ("elements", "loaded", "stiffness", "uniform")
#: "elements": stiffness and tooth error as the dynamic model has them; "loaded": with the relief of the
#: flanks under the operating torque; "stiffness": the stiffness model without tooth errors; "uniform": equal
#: shares; or a path function of relative stiffness.
Sharing = Literal["elements", "loaded", "stiffness", "uniform"] | PathFunction


@dataclass(frozen=True, eq=False)
class Springs:
    """Tooth pairs as springs k_i with unloaded errors e_i under a mesh force.

    Attributes
    ----------
    stiffness : k(xi), any unit
    error : e(xi) [m], or None for none
    force : total normal load [N], in the unit of ``stiffness`` times m where there is an error
    """

    stiffness: PathFunction
    error: PathFunction | None
    force: float

    @property
    def functions(self) -> list[PathFunction]:
        """The path functions that the shares are made of."""
        return [self.stiffness] if self.error is None else [self.stiffness, self.error]

    def share(self, at: CyclePositions) -> FloatArray:
        """Fraction of the mesh load on each pair; (pairs, k), sums to 1 over the pairs.

        All pairs deflect by the same delta = (F + SUM k_i e_i)/SUM k_i and carry k_i (delta - e_i).
        """
        k = np.where(at.contact, self.stiffness(at.position), 0.0)
        if self.error is None:
            return np.asarray(k / k.sum(axis=0), dtype=np.float64)
        e = np.where(at.contact, self.error(at.position), 0.0)
        delta = (self.force + (k * e).sum(axis=0)) / k.sum(axis=0)
        return np.asarray(k * (delta - e) / self.force, dtype=np.float64)


def springs(pair: GearPair, sharing: Sharing) -> Springs:
    """Return the springs that share the load of a gear pair.

    Raises
    ------
    ParameterError : not one of the kinds
    NumericalError : "loaded", and at some position no pair touches
    """
    g = pair.geometry
    force = pair.operating.pinion_torque / g.base_radius_pinion
    if isinstance(sharing, PathFunction):
        return Springs(sharing, None, force)
    one_of("sharing", sharing, _KINDS, "Choose one of them, or pass a PathFunction.")
    if sharing == "uniform":
        return Springs(PathFunction.constant(1.0, g.L_XA, g.L_XD), None, force)
    if sharing == "stiffness":
        return Springs(pair_stiffness(pair), None, force)
    if sharing == "loaded":
        mesh = loaded_mesh(pair)
        return Springs(mesh.stiffness, mesh.error, force)
    elements = mesh_elements(pair.with_(mesh__contact="prescribed"))  # the positions are those from A to D
    return Springs(elements.stiffness, elements.error, force)
