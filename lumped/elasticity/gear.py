"""Compliances of the flanks of one gear, as functions of the places of load and point."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from lumped.cache import cached
from lumped.elasticity.blas import one_thread
from lumped.elasticity.ring import Support, compliances
from lumped.elasticity.sector import Sector, sector, stations
from lumped.errors import NumericalError
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.typing import FloatArray

#: Elements at the surface of the mesh, and of the coarser one that shows its error [modules].
FINE = 0.2
COARSE = 0.3
#: Loads along the flank; terms in each direction for the motion of neighbours, which hardly depends on the
#: places.
_LOADS = 14
_TERMS = 4
#: Least distance of a load from the edge of the tip, where the half plane of the load ends [modules].
_EDGE = 0.05
#: Least length of a load on the base tangent: the flank is too curved near the base circle [modules].
_BASE = 0.25
#: Root over bore radius of the mesh of a gear without a bore. So small a hole hardly changes a free body.
_SOLID = 10.0


@dataclass(frozen=True)
class PlaneGear:
    """The data on which the deflection of a gear depends. Lengths are in modules; ``profile`` has the module
    1.

    ``bore`` is a radius, 0 for a solid gear; ``poisson`` that of plane stress, nu/(1 - nu) for plane strain;
    ``reach`` the number of teeth ahead whose motion is wanted. A "free" gear balances the load by its own
    inertia and moves against its mean motion; of a "clamped" one the bore is held.
    """

    profile: ToothProfile
    tip: float
    bore: float
    poisson: float
    support: Support
    reach: int


@dataclass(frozen=True, eq=False)
class FlankCompliance:
    """Compliances of a gear along the line of action, times E (plane strain: E/(1 - nu^2)) and width.

    Attributes
    ----------
    interval : lengths along the base tangent between which loads were computed [modules]
    own : (n,) Chebyshev coefficients of the smooth part u_c of the deflection under a unit load; with a
        Hertzian pressure of half width a [modules] in its place the point moves by
        u_c + (2 ln(2/a) - nu)/pi, nu of plane stress
    cross : (reach, k, k) coefficients of the motion of the tooth m + 1 ahead, over the lengths of load and
        point
    """

    interval: tuple[float, float]
    own: FloatArray
    cross: FloatArray

    def deflection(self, length: ArrayLike) -> FloatArray:
        """u_c at lengths along the base tangent, any shape [-]."""
        return np.asarray(chebyshev.chebval(self._at(length), self.own), dtype=np.float64)

    def neighbour_motion(self, apart: int, loaded: ArrayLike, length: ArrayLike) -> FloatArray:
        """Motion of the tooth ``apart`` pitches ahead of a loaded one, at lengths of the same shape [-]."""
        result = chebyshev.chebval2d(self._at(loaded), self._at(length), self.cross[apart - 1])
        return np.asarray(result, dtype=np.float64)

    def _at(self, length: ArrayLike) -> FloatArray:
        low, high = self.interval
        return (2.0 * np.asarray(length) - low - high) / (high - low)


@lru_cache(maxsize=128)
def flank_compliance(gear: PlaneGear, size: float = FINE) -> FlankCompliance:
    """Compliances of a gear over the usable length of its flanks.

    ``size`` of the elements at the surface [modules]; the difference to ``COARSE`` ones shows the error.
    """
    profile = gear.profile
    mesh = meshed(profile, gear.tip, bore_radius(gear), size)
    tip_length = math.sqrt(gear.tip**2 - profile.base_radius**2)
    low = max(profile.form_length, _BASE)
    high = tip_length - _EDGE * profile.base_radius / tip_length
    numbers = np.array([low, high, gear.poisson, profile.teeth, gear.reach, _LOADS, _TERMS])

    def compute() -> dict[str, FloatArray]:
        nodes = chebyshev.chebpts1(_LOADS)
        lengths = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        with one_thread():
            motions = compliances(mesh, gear.poisson, profile.teeth, lengths, gear.reach, gear.support)
        own_tooth = chebyshev.chebfit(nodes, np.diag(motions[0]), _LOADS - 1)
        basis = np.linalg.pinv(chebyshev.chebvander(nodes, _TERMS - 1))
        # Rows of the matrices are points, columns loads.
        return {"own": own_tooth, "cross": np.einsum("li,mji,kj->mlk", basis, motions[1:], basis)}

    inputs = mesh.nodes.tobytes() + gear.support.encode() + numbers.tobytes()
    result = cached("elasticity", sorted(Path(__file__).parent.glob("*.py")), inputs, compute)
    return FlankCompliance((low, high), result["own"], result["cross"])


def bore_radius(gear: PlaneGear) -> float:
    """Radius of the bore in the mesh [modules]."""
    return gear.bore or gear.profile.root_radius / _SOLID


def meshed(profile: ToothProfile, tip: float, bore: float, size: float) -> Sector:
    """One pitch of a gear with elements of a size at the surface [modules]; refuse teeth without a mesh."""
    mesh = sector(profile, tip, bore, stations(profile, tip, bore, size))
    corners = mesh.nodes[mesh.elements[:, [0, 6, 8, 2]]]  # round the element
    turn = np.roll(corners, -1, axis=1) - corners
    before = np.roll(turn, 1, axis=1)
    if not (before[..., 0] * turn[..., 1] - before[..., 1] * turn[..., 0] > 0.0).all():
        raise NumericalError(
            f"The finite elements of the gear with {profile.teeth} teeth fold over: tooth or rim is too thin."
        )
    return mesh
